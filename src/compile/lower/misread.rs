//! Units and words that are misspelt, so that they read as names.

use super::super::dimension;
use super::super::elaborator::{Elaborator, Locals, Lowered};
use super::super::nearest::nearest;
use super::super::told::Told;
use super::{BUILT_IN, DISTRIBUTIONS};
use crate::base::tick::Clock;
use crate::model::BuiltIn;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Moment, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::parse::{foreign_word, time_meant, unit_meant};
use crate::syntax::source::Span;

/// The word before a shape in which an agent starts.
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
        let Some((unit, is_sure)) = time_meant(name) else { return false };
        let number = self.text(end.span);
        let hint = match self.clock {
            // There a bare number is a bound, and nothing but the name is amiss.
            Clock::Steps if !is_sure || self.told < Told::Stepped => return false,
            Clock::Steps => {
                format!("the steps of this scenario have no length: write `#{number}` or `{number} steps`")
            }
            _ => format!("did you mean `{number} {unit}`?"),
        };
        self.note(error!(E0113, span, "unknown unit `{name}`"; hint: "{hint}"));
        true
    }

    /// A likely meaning of an unknown name: a variable of a process, a word of another language, a unit.
    pub(super) fn misread_name(&self, name: &str) -> Option<String> {
        let of_processes = self.paths_of(name);
        if !of_processes.is_empty() {
            return Some(format!("write {}", of_processes.join(" or ")));
        }
        foreign_word(name, "").or_else(|| {
            dimension::unit(name)?;
            Some(format!(
                "write a unit after a number: `1 {name}`, or `1 /{name}` (no blank after the slash)"
            ))
        })
    }

    /// `P(p) >= 0.9` and `(x at end) > 3` inside a formula: the error, if it is so.
    pub(super) fn misread_comparison<T>(
        &mut self,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Option<Lowered<T>> {
        if let ExprKind::Call { function, .. } = &left.kind
            && matches!(function.name.as_str(), "P" | "E" | "Q")
            && !self.is_known(&function.name, locals)
        {
            let title = format!("`{}` is allowed only in queries, not in formulas", function.name);
            let query = self.text(left.span.to(right.span));
            let error = error!(E0504, function.span, "{title}");
            return Some(self.report(error.hint(format!("write a separate query: `check {query}`"))));
        }
        let (span, inner, moment) = [left, right].into_iter().find_map(|side| match &side.kind {
            ExprKind::At(inner, moment) => Some((side.span, inner.span, moment)),
            _ => None,
        })?;
        let whole = left.span.to(right.span);
        let before = self.text(Span { end: span.start, ..whole });
        let behind = self.text(Span { start: span.end, ..whole });
        let compared = format!("{before} {} {behind}", self.text(inner));
        Some(self.misplaced_moment((span, inner), Some(compared.trim()), moment))
    }

    /// `… at end` elsewhere than around a whole metric.
    pub(super) fn misplaced_moment<T>(
        &mut self,
        (span, inner): (Span, Span),
        read: Option<&str>,
        moment: &Moment,
    ) -> Lowered<T> {
        let (time, written) = match moment {
            Moment::End => (self.duration(self.horizon.0), "at end".to_owned()),
            Moment::Time(time) => (self.text(time.span), format!("at {}", self.text(time.span))),
        };
        let title = format!("`{written}` must apply to the whole metric of `E(…)` or `Q(…)`");
        // `at` stands behind what is read, and a parenthesis behind it.
        let source = self.sources.iter().find(|source| source.id == span.source);
        let behind = source.map_or("", |source| source.slice(Span { start: inner.end, ..span }));
        let at = behind.find("at").unwrap_or(0);
        let start = inner.end + at as u32;
        let end = start + behind[at..].trim_end_matches([')', ' ']).len() as u32;
        let error = error!(E0504, Span { start, end, ..span }, "{title}");
        self.report(match read {
            Some(read) => error.hint(format!("for a condition write `F[{time}, {time}] ({read})`")),
            None => error.hint(format!("write it last: `E(… {written})`")),
        })
    }

    /// Whether a name stands for anything.
    fn is_known(&self, name: &str, locals: &Locals) -> bool {
        locals.names.iter().any(|(bound, _)| bound == name)
            || self.is_inside(name, locals)
            || self.find(name, locals.scope).is_some()
            || BuiltIn::find(name).is_some()
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
        self.note(
            error!(E0201, word.span, "unknown name `{name}`"; hint: "did you mean `{PLACES}`?")
                .about(About::Name(name.clone())),
        );
        match (&shape.kind, value) {
            (ExprKind::Call { arguments, .. }, Value::Truncated { high, .. }) => {
                let _ = self.lower_all(arguments.iter().chain([high]), &locals);
            }
            _ => drop(self.lower(shape, &locals)),
        }
        true
    }

    /// `5 kg/(m*sec)`: a product of units one of which is misspelt, so that all read as names. Says so, and whether it
    /// is so.
    #[cold]
    pub(super) fn misread_factors(&mut self, left: &Expr, right: &Expr, locals: &Locals) -> bool {
        let (before, mut factors) = (last_operand(left), Vec::new());
        let has_unit = matches!(&before.kind, ExprKind::Quantity(quantity) if quantity.unit.is_some());
        if !has_unit || !self.ends_with(left, before) || !named_factors(right, &mut factors) {
            return false;
        }
        let mut misspelt = Vec::new();
        for (name, span) in &factors {
            match unit_meant(name).filter(|_| !self.is_known(name, locals)) {
                None => return false,
                Some((unit, _)) if unit == *name => {}
                Some((unit, is_sure)) => misspelt.push((*name, *span, unit, is_sure)),
            }
        }
        // If all are units, or none is certainly one, they are unknown names.
        let is_sure = misspelt.len() < factors.len() || misspelt.iter().any(|(.., is_sure)| *is_sure);
        if misspelt.is_empty() || !is_sure {
            return false;
        }
        for (name, span, unit, _) in misspelt {
            self.note(error!(E0113, span, "unknown unit `{name}`"; hint: "did you mean `{unit}`?"));
        }
        true
    }

    /// `1 m/sec`, `0.1 /m2`, `1 m/sec^2`: of an unknown name that stands below or beside a unit, the unit it may mean.
    #[cold]
    pub(super) fn suggest_unit(&mut self, op: BinaryOp, left: &Expr, right: &Expr) {
        let (factor, power) = match &right.kind {
            ExprKind::Binary(BinaryOp::Power, base, _) => {
                (&**base, self.text(Span { start: base.span.end, ..right.span }))
            }
            _ => (right, String::new()),
        };
        let (ExprKind::Name(name), BinaryOp::Over | BinaryOp::Times) = (&factor.kind, op) else { return };
        let before = last_operand(left);
        let ExprKind::Quantity(quantity) = &before.kind else { return };
        if quantity.unit.is_none() && op == BinaryOp::Times {
            return;
        }
        let meant = unit_meant(name).filter(|(unit, _)| unit != name);
        let Some((unit, is_sure)) = meant.filter(|(unit, _)| is_power(unit, &power)) else { return };
        let mut written = self.text(Span { end: right.span.start, ..before.span }).trim_end().to_owned();
        if op == BinaryOp::Times {
            written.truncate(written.trim_end_matches(['*', ' ']).len());
            written.push('*');
        }
        // A unit behind parentheses belongs to no number.
        if !self.ends_with(left, before) {
            "1 ".clone_into(&mut written);
        }
        let unknown = self.diagnostics.iter_mut().rev().find(|one| {
            one.code == Code::E0201 && one.place.as_ref().is_some_and(|place| place.span == factor.span)
        });
        if let Some(unknown) = unknown.filter(|one| is_sure || one.hint.is_none()) {
            unknown.hint = Some(format!("did you mean `{written}{unit}{power}`?"));
        }
    }
}

impl Elaborator<'_> {
    /// Whether no parenthesis stands between the last operand of an expression and its end.
    fn ends_with(&self, expr: &Expr, last: &Expr) -> bool {
        expr.span.end == last.span.end && !self.text(last.span).starts_with('(')
    }
}

/// Whether a unit takes a power as it is written: it has none of its own, and that one is whole.
fn is_power(unit: &str, power: &str) -> bool {
    let digits = power.strip_prefix('^').map(|power| power.strip_prefix('-').unwrap_or(power));
    digits.is_none_or(|digits| !unit.contains('^') && digits.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Adds the names that an expression is a product of, with or without powers, and says whether it is one.
fn named_factors<'e>(expr: &'e Expr, found: &mut Vec<(&'e str, Span)>) -> bool {
    match &expr.kind {
        ExprKind::Name(name) => {
            found.push((name, expr.span));
            true
        }
        ExprKind::Binary(BinaryOp::Times, left, right) => {
            named_factors(left, found) && named_factors(right, found)
        }
        ExprKind::Binary(BinaryOp::Power, base, power) => {
            matches!(base.kind, ExprKind::Name(_))
                && matches!(power.kind, ExprKind::Quantity(_))
                && named_factors(base, found)
        }
        _ => false,
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
    while let ExprKind::Binary(_, _, last) | ExprKind::Unary(_, last) = &expr.kind {
        expr = last;
    }
    expr
}
