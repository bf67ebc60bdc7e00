//! Families: claims that hold jointly, because they share one error (Bonferroni 1936).
//!
//! A claim is what one query certifies at one point of a sweep: a verdict, an interval, a choice. Files of one call
//! that each name a family make one family of all their claims.

use crate::stats::Spec;
use crate::stats::spec::{ERRORS, Make, Serves};
use crate::syntax::ast::{self, Clauses, PropertyFile, PropertyItem, QueryKind};
use crate::syntax::source::Span;

/// What error one claim of a query may spend.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowance {
    /// The share of one claim of the family, if the query is in one.
    pub(crate) family: Option<f64>,
    /// Claims of this query alone, which hold jointly with or without a family.
    pub(crate) claims: usize,
}

impl Allowance {
    /// The error of a claim, from what the query states itself or else the default.
    pub(crate) fn claim_error(self, stated: Option<f64>, default: f64) -> f64 {
        match (stated, self.family) {
            (None, Some(share)) => share,
            (stated, _) => self.of(stated.unwrap_or(default)),
        }
    }

    /// The part of an error of the whole query that one of its claims may spend.
    pub(crate) fn of(self, error: f64) -> f64 {
        error / self.claims.max(1) as f64
    }
}

/// The number of claims that share the error of a family, in a call that answers each query at so many points.
pub(crate) fn members(files: &[PropertyFile], points: usize) -> usize {
    let named = |file: &&PropertyFile| file.items.iter().any(|i| matches!(i, PropertyItem::Family { .. }));
    let queries = files.iter().filter(named).flat_map(|file| &file.items).map(|item| match item {
        PropertyItem::Query(query) => match &query.kind {
            QueryKind::Estimate(measures) => measures.len(),
            QueryKind::Check { .. }
            | QueryKind::Compare { .. }
            | QueryKind::Curve { .. }
            | QueryKind::Rank { .. }
            | QueryKind::Pareto { .. } => 1,
        },
        _ => 0,
    });
    queries.sum::<usize>().saturating_mul(points)
}

/// The number of claims that a list of estimates shares its error among.
pub(crate) fn claims(measures: &[ast::Measure], clauses: &Clauses) -> usize {
    // A band holds all quantiles of a metric at once.
    let named = clauses.by.as_ref().and_then(|method| Spec::find(&method.name.name, Serves::Quantile));
    if named.is_none_or(|spec| !matches!(spec.make, Make::Quantile { band: true })) {
        return measures.len();
    }
    let mut metrics: Vec<Span> = measures.iter().map(|measure| measure.body.span).collect();
    metrics.sort_unstable();
    metrics.dedup();
    metrics.len()
}

/// Where a query states errors of its own.
pub(crate) fn own_errors(clauses: &Clauses) -> Option<Span> {
    let named = |name: &str| ERRORS.contains(&name);
    let argument = clauses.by.iter().flat_map(|method| &method.arguments).find(|a| named(&a.name.name));
    clauses.confidence.as_ref().map(|c| c.span).or(argument.map(|a| a.name.span))
}
