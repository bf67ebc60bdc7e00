//! Units and words that are misspelt, so that they read as names.

use super::super::elaborator::{Elaborator, Locals};
use super::super::nearest::nearest;
use super::super::told::Told;
use super::{BUILT_IN, DISTRIBUTIONS, FUNCTIONS};
use crate::base::tick::Clock;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Value};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::parse::unit_meant;
use crate::syntax::source::Span;

/// Units of a bound.
const TIMES: [&str; 6] = ["s", "ms", "min", "h", "step", "steps"];
/// The word before a shape in which somebody starts.
const PLACES: &str = "uniform";

impl Elaborator<'_> {
    /// `F<=1 sec (p)`, where the bound is a bare number and `sec (p)` a call: says so, and whether it is so.
    pub(super) fn misread_bound(&mut self, end: &Expr, body: &Expr, locals: &Locals) -> bool {
        let is_bare = matches!(&end.kind, ExprKind::Quantity(quantity) if quantity.unit.is_none());
        let Some((name, span)) = leading_name(body).filter(|_| is_bare) else { return false };
        let between = Span { start: end.span.end, end: span.start, ..span };
        if end.span.end > span.start || !self.text(between).is_empty() || self.is_known(name, locals) {
            return false;
        }
        let meant = unit_meant(name).filter(|(unit, _)| TIMES.contains(&unit.as_str()));
        let Some((unit, is_sure)) = meant else { return false };
        let number = self.text(end.span);
        let hint = match self.clock {
            // There a bare number is a bound, and nothing but the name is amiss.
            Clock::Steps if !is_sure || self.told < Told::Stepped => return false,
            Clock::Steps => format!("steps have no length here: write `#{number}` or `{number} steps`"),
            _ => format!("did you mean `{number} {unit}`?"),
        };
        self.note(Diagnostic::error("E0113", span, format!("unknown unit `{name}`")).hint(hint));
        true
    }

    /// Whether a name stands for anything.
    fn is_known(&self, name: &str, locals: &Locals) -> bool {
        locals.names.iter().any(|(bound, _)| bound == name)
            || self.is_inside(name, locals)
            || self.find(name, locals.scope).is_some()
            || FUNCTIONS.contains(&name)
            || DISTRIBUTIONS.contains(&name)
            || BUILT_IN.contains(&name)
    }

    /// `at = unifrom in exit`, which reads as a condition, and with a rectangle as a truncated value: says so, and whether
    /// it is so.
    pub(in crate::compile) fn misread_placement(&mut self, value: &Value) -> bool {
        let (word, shape) = match value {
            Value::Plain(Expr { kind: ExprKind::Binary(BinaryOp::In, word, region), .. }) => {
                (&**word, &**region)
            }
            Value::Truncated { law, low, .. } => (law, low),
            _ => return false,
        };
        let ExprKind::Name(name) = &word.kind else { return false };
        let locals = Locals::default();
        if nearest(name, std::iter::once(PLACES)).is_none() || self.is_known(name, &locals) {
            return false;
        }
        let error = Diagnostic::error("E0201", word.span, format!("unknown name `{name}`"));
        self.note(error.hint(format!("did you mean `{PLACES}`?")));
        match (&shape.kind, value) {
            (ExprKind::Call { arguments, .. }, Value::Truncated { high, .. }) => {
                let _ = self.lower_all(arguments.iter().chain([high]), &locals);
            }
            _ => drop(self.lower(shape, &locals)),
        }
        true
    }

    /// `1 m/sec`, `0.1 /m2`: of an unknown name that stands below or beside a unit, the unit it may mean.
    #[cold]
    pub(super) fn suggest_unit(&mut self, op: BinaryOp, left: &Expr, right: &Expr) {
        let (ExprKind::Name(name), BinaryOp::Over | BinaryOp::Times) = (&right.kind, op) else { return };
        let before = last_operand(left);
        let ExprKind::Quantity(quantity) = &before.kind else { return };
        if quantity.unit.is_none() && op == BinaryOp::Times {
            return;
        }
        let Some((unit, is_sure)) = unit_meant(name).filter(|(unit, _)| unit != name) else { return };
        let mut written = self.text(Span { end: right.span.start, ..before.span }).trim_end().to_owned();
        if op == BinaryOp::Times {
            written.truncate(written.trim_end_matches(['*', ' ']).len());
            written.push('*');
        }
        let unknown = self.diagnostics.iter_mut().rev().find(|one| {
            one.code == "E0201" && one.place.as_ref().is_some_and(|place| place.span == right.span)
        });
        if let Some(unknown) = unknown.filter(|one| is_sure || one.hint.is_none()) {
            unknown.hint = Some(format!("did you mean `{written}{unit}`?"));
        }
    }
}

/// The name that an expression starts with: of a call, or by itself.
fn leading_name(expr: &Expr) -> Option<(&str, Span)> {
    let mut expr = expr;
    loop {
        expr = match &expr.kind {
            ExprKind::Name(name) => return Some((name, expr.span)),
            ExprKind::Call { function, .. } => return Some((&function.name, function.span)),
            ExprKind::Binary(_, left, _)
            | ExprKind::TemporalPair(_, _, left, _)
            | ExprKind::Member(left, _)
            | ExprKind::Index(left, _) => left,
            _ => return None,
        };
    }
}

/// The operand that an expression ends with.
fn last_operand(expr: &Expr) -> &Expr {
    let mut expr = expr;
    while let ExprKind::Binary(_, _, right) = &expr.kind {
        expr = right;
    }
    expr
}
