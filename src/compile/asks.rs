//! Checks, comparisons and rankings: claims, thresholds, tests, sides, options.

use super::dimension::Dimension;
use super::elaborator::{Locals, Lowered, Reported};
use super::families::Allowance;
use super::measures::Observed;
use super::queries::Compiler;
use super::study::{Ask, Measure, MeasureKind, Ranking, Target};
use super::symbols::ScopeId;
use crate::model::Who;
use crate::syntax::ast::{self, BinaryOp, Binding, Clauses, Expr};
use crate::syntax::diagnostic::Diagnostic;

/// Most options of a ranking.
const MOST_OPTIONS: usize = 4096;

impl<'a> Compiler<'a> {
    /// A check: its claim, threshold and test.
    pub(super) fn check(
        &mut self,
        site: usize,
        measure: &ast::Measure,
        relation: BinaryOp,
        threshold: &Expr,
        clauses: &Clauses,
        family: Option<f64>,
        scope: ScopeId,
    ) -> Lowered<(Ask, bool)> {
        let locals = Locals::of(scope);
        let observed = self.sites[site].elaborator.measure(measure, scope);
        let dimension = match (observed.as_ref().map(|o| &o.kind), &measure.kind) {
            (Ok(MeasureKind::Expectation { dimension, .. } | MeasureKind::Quantile { dimension, .. }), _) => {
                *dimension
            }
            (_, ast::MeasureKind::Probability) => Dimension::NONE,
            // Without a metric nobody knows the unit of the threshold.
            _ => return Err(Reported),
        };
        let elaborator = &mut self.sites[site].elaborator;
        let bound = elaborator.number_of(threshold, dimension, &locals)?;
        let allowance = Allowance { family, claims: 1 };
        if matches!(measure.kind, ast::MeasureKind::Probability) && (bound.value <= 0.0 || bound.value >= 1.0)
        {
            let theta = bound.value;
            let hint = if theta > 1.0 && theta <= 100.0 {
                format!("a share is written with its sign: `{theta} %`")
            } else {
                let near = if theta <= 0.0 { "`<= 0.001`" } else { "`>= 0.999`" };
                format!(
                    "that something is certain or impossible cannot be decided by sampling; ask for {near}"
                )
            };
            let error = Diagnostic::error(
                "E0601",
                threshold.span,
                format!("a probability is compared with a number between 0 and 1, not with {theta}"),
            );
            return elaborator.report(error.hint(hint));
        }
        // Where a confidence is stated, or comes from a family, it is also that of the interval.
        let beside = allowance.error(elaborator.delta(clauses, &locals)?, super::methods::DEFAULT_DELTA);
        let mut at_least = matches!(relation, BinaryOp::AtLeast | BinaryOp::Greater);
        let or_equal = matches!(relation, BinaryOp::AtLeast | BinaryOp::AtMost);
        if observed.is_err() && matches!(measure.kind, ast::MeasureKind::Probability) {
            // What is wrong with the procedure is said beside what is wrong with the formula.
            let _ = elaborator.test(clauses, bound.value, threshold.span, allowance, &locals);
        }
        let Observed { column, kind, unbounded } = observed?;
        let (column, kind, theta) = match kind {
            // A quantile is at most x exactly if P(metric <= x) is at least its level. It is below x if
            // P(metric < x) is above its level, and not if that is below. So strictness goes with the side:
            // `<= x` and `> x` are settled by P(metric <= x), `< x` and `>= x` by P(metric < x).
            MeasureKind::Quantile { level, .. } => {
                let below = elaborator.below(&column, at_least != or_equal, bound.value, bound.dimension);
                at_least = !at_least;
                (below, MeasureKind::Probability, level)
            }
            kind => (column, kind, bound.value),
        };
        let test = match &kind {
            MeasureKind::Expectation { range, .. } => {
                if let Some(method) = &clauses.by {
                    let error = Diagnostic::error(
                        "E0603",
                        method.span,
                        "a check of an expectation has one procedure only",
                    );
                    return elaborator.report(error);
                }
                if theta <= range.0 || theta >= range.1 {
                    let error = Diagnostic::error(
                        "E0601",
                        threshold.span,
                        "this threshold lies outside the range of the metric",
                    );
                    return elaborator.report(error);
                }
                let stated = elaborator.delta(clauses, &locals)?;
                super::study::Test::Interval { delta: allowance.error(stated, super::methods::DEFAULT_ALPHA) }
            }
            _ => elaborator.test(clauses, theta, threshold.span, allowance, &locals)?,
        };
        let column = self.column(site, column);
        let measure = Measure { target: Target { world: site, column }, kind };
        Ok((Ask::Check { measure, at_least, or_equal, threshold: theta, test, beside }, unbounded))
    }

    /// A comparison: its sides, width and error; and the world of the first side.
    pub(super) fn compare(
        &mut self,
        site: usize,
        measure: &ast::Measure,
        [first, second]: [&'a [Binding]; 2],
        clauses: &Clauses,
        family: Option<f64>,
        scope: ScopeId,
    ) -> Lowered<(Ask, bool, usize)> {
        // What `under` sets at the end of the query holds for both sides.
        let common = self.sites[site].settings.clone();
        let sides = (self.under(first, scope, site, &common), self.under(second, scope, site, &common));
        let ((one, first_settings), (two, second_settings)) = (sides.0?, sides.1?);
        let (a, unbounded) = self.measured(one, measure, scope)?;
        let (b, _) = self.measured(two, measure, scope)?;
        let settings = [first_settings, second_settings];
        let elaborator = &mut self.sites[site].elaborator;
        let dimension = match &a.kind {
            MeasureKind::Probability => Dimension::NONE,
            MeasureKind::Expectation { .. } if a.kind != b.kind => {
                return elaborator.report(unlike(measure, [&a.kind, &b.kind], &settings));
            }
            MeasureKind::Expectation { dimension, .. } => *dimension,
            MeasureKind::Quantile { .. } => {
                let error = Diagnostic::error("E0607", measure.span, "quantiles cannot be compared directly")
                    .hint("compare `P(metric <= bound)`, or estimate both");
                return elaborator.report(error);
            }
        };
        let allowance = Allowance { family, claims: 1 };
        let locals = Locals::of(scope);
        let (within, delta) =
            elaborator.comparison_clauses(clauses, &a.kind, dimension, allowance, &locals)?;
        Ok((Ask::Compare { first: a, second: b, settings, within, delta }, unbounded, one))
    }

    /// A ranking: whose moves, by which score.
    pub(super) fn rank(
        &mut self,
        site: usize,
        what: &ast::Ident,
        agent: &Expr,
        measure: &ast::Measure,
        clauses: &Clauses,
        family: Option<f64>,
        scope: ScopeId,
    ) -> Lowered<(Ask, bool)> {
        let locals = Locals::of(scope);
        let measured = self.measured(site, measure, scope);
        let elaborator = &mut self.sites[site].elaborator;
        if what.name != "moves" {
            let error =
                Diagnostic::error("E0606", what.span, format!("`{}` cannot be ranked here", what.name))
                    .hint("write `rank moves of …`");
            return elaborator.report(error);
        }
        let typed = elaborator.lower(agent, &locals)?;
        let Who::Agent(id) = elaborator.as_agent(typed, agent.span)? else { return Err(Reported) };
        let (measured, unbounded) = measured?;
        let dimension = match &measured.kind {
            MeasureKind::Probability => Dimension::NONE,
            MeasureKind::Expectation { dimension, .. } => *dimension,
            MeasureKind::Quantile { .. } => {
                let error = Diagnostic::error("E0607", measure.span, "moves are ranked by `P(…)` or `E(…)`");
                return elaborator.report(error);
            }
        };
        let allowance = Allowance { family, claims: 1 };
        let (epsilon, delta, ranking) =
            elaborator.ranking(clauses, (&measured.kind, measure.span), dimension, allowance, &locals)?;
        if let (Ranking::Okamoto, MeasureKind::Expectation { .. }, Some(method)) =
            (ranking, &measured.kind, &clauses.by)
        {
            let error = Diagnostic::error("E0607", method.span, "`okamoto` ranks moves by `P(…)` only")
                .hint("the default ranks by `E(…)` too, and needs fewer trials");
            return elaborator.report(error);
        }
        let Some(scenario) = &self.sites[site].scenario else { return Err(Reported) };
        let Some(moves) = scenario.moves.iter().position(|m| m.agent == id) else {
            // One that could not be declared was reported.
            let Some(agent_of) = scenario.agents.get(id.0 as usize) else { return Err(Reported) };
            let name = agent_of.name.clone();
            let error = Diagnostic::error(
                "E0606",
                agent.span,
                format!("the scenario declares no moves of `{name}`"),
            )
            .hint(format!(
                "for example `moves {name} for 2 s {{ heading from -60 deg to 60 deg by 15 deg  stop }}`"
            ));
            return self.sites[site].elaborator.report(error);
        };
        let options = scenario.moves[moves].options.len();
        if options > MOST_OPTIONS {
            let said = format!("a ranking is of at most {MOST_OPTIONS} options, and these are {options}");
            return self.sites[site].elaborator.report(Diagnostic::error("E0606", agent.span, said));
        }
        Ok((Ask::Rank { moves, measure: measured, epsilon, delta, ranking }, unbounded))
    }
}

/// The error of a comparison whose sides have ranges, or units, of their own.
fn unlike(
    measure: &ast::Measure,
    kinds: [&MeasureKind; 2],
    settings: &[Vec<(String, String)>; 2],
) -> Diagnostic {
    let side = |kind: &MeasureKind, settings: &[(String, String)]| {
        let range = match kind {
            MeasureKind::Expectation { range, dimension } => {
                let unit = if dimension.is_none() { String::new() } else { format!(" {dimension}") };
                format!("{}{unit} .. {}{unit}", range.0, range.1)
            }
            _ => "none".to_owned(),
        };
        let settings: Vec<String> =
            settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        format!("{range} with {}", settings.join(", "))
    };
    let (first, second) = (side(kinds[0], &settings[0]), side(kinds[1], &settings[1]));
    let place = measure.range.as_ref().map_or(measure.span, |(low, high)| low.span.to(high.span));
    Diagnostic::error(
        "E0605",
        place,
        format!("the sides of a comparison need one range: it is {first}, but {second}"),
    )
    .hint("write a range that holds for both sides and depends on none of the parameters that differ")
}
