//! Property files (`.bltl`).

use super::{Expr, Ident, LetDecl};
use crate::syntax::source::Span;

/// A whole property file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PropertyFile {
    /// Declarations and queries in order of writing.
    pub items: Vec<PropertyItem>,
    /// Parts that ended early, since what follows on their line could not be read; that was reported.
    pub cut: Vec<Span>,
    /// Parts that could not be read, and heads of those whose values could not; that was reported.
    pub lost: Vec<Span>,
    /// What could not be read on its line, each up to where reading surely began again there. Without one, all of a line
    /// with an error is in doubt.
    pub doubts: Vec<Span>,
}

/// One declaration or query.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a file has few items")]
pub enum PropertyItem {
    /// `let gap(a) = …`
    Let(LetDecl),
    /// `const T = 10 s`
    Const {
        /// Its name.
        name: Ident,
        /// Its value.
        value: Expr,
    },
    /// `property safe = G<=10 s …`
    Property {
        /// Its name.
        name: Ident,
        /// The formula.
        formula: Expr,
    },
    /// `family confidence 95 %`: all queries of the file hold jointly.
    Family {
        /// The joint confidence.
        confidence: Expr,
        /// Where.
        span: Span,
    },
    /// A query.
    Query(Query),
}

/// One query.
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// The query.
    pub kind: QueryKind,
    /// How sure, by which procedure.
    pub clauses: Clauses,
    /// Where, from its keyword to its last clause.
    pub span: Span,
}

/// The kinds of queries.
#[derive(Clone, Debug, PartialEq)]
pub enum QueryKind {
    /// `check P(safe) >= 0.9`
    Check {
        /// The measured quantity.
        measure: Measure,
        /// `>=`, `>`, `<=` or `<`.
        relation: super::BinaryOp,
        /// Compared with this.
        threshold: Expr,
    },
    /// `estimate P(a), E(b) in 0 m .. 3 m`
    Estimate(Vec<Measure>),
    /// `compare P(safe) under density = 0.2 /m^2 with density = 0.8 /m^2`
    Compare {
        /// The measured quantity.
        measure: Measure,
        /// Settings of the first side.
        first: Vec<Binding>,
        /// Settings of the second side.
        second: Vec<Binding>,
    },
    /// `rank moves of user by P(safe)`
    Rank {
        /// `moves`; compilation refuses any other word.
        what: Ident,
        /// Whose.
        agent: Expr,
        /// The score.
        measure: Measure,
    },
}

/// `name = value` of a `under` clause.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// Parameter.
    pub name: Ident,
    /// Its value.
    pub value: Expr,
}

/// A number of the distribution of traces.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Which.
    pub kind: MeasureKind,
    /// The formula or metric inside the parentheses.
    pub body: Expr,
    /// `in lo .. hi` after an expectation.
    pub range: Option<(Expr, Expr)>,
    /// Where.
    pub span: Span,
}

/// Probability, expectation, quantile; a robustness is a metric inside of them.
#[derive(Clone, Debug, PartialEq)]
pub enum MeasureKind {
    /// `P(φ)`
    Probability,
    /// `E(metric)`
    Expectation,
    /// `Q(level, metric)`
    Quantile(Expr),
}

/// `by sprt(alpha = 0.01, beta = 0.01, indifference = 0.02)`
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Its name.
    pub name: Ident,
    /// Named arguments.
    pub arguments: Vec<Binding>,
    /// Where.
    pub span: Span,
}

/// How sure, by which procedure, under which settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clauses {
    /// `within 0.01`
    pub within: Option<Expr>,
    /// `confidence 95 %`
    pub confidence: Option<Expr>,
    /// `by okamoto(…)`
    pub by: Option<Method>,
    /// `under name = value, …` of check, estimate and rank.
    pub under: Vec<Binding>,
}
