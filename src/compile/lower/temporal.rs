//! Temporal operators, windows and their bounds.

use super::super::dimension::Dimension;
use super::super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::super::moments;
use super::super::number::Number;
use super::super::typed::Typed;
use crate::base::decimal::Decimal;
use crate::base::tick::{Clock, Tick};
use crate::logic::{Aggregation, Node, Term, Window};
use crate::syntax::ast::expression::{Temporal, TemporalPair};
use crate::syntax::ast::{Aggregate, Bound, Expr};
use crate::syntax::source::Span;

const ALWAYS: Window = Window { from: Tick(0), to: None };

impl Elaborator<'_> {
    fn expect_temporal(&mut self, span: Span, locals: &Locals) -> Lowered<()> {
        if locals.running > 0 {
            return self
                .report(error!(E0504, span, "a temporal formula is not allowed inside a fold over agents"));
        }
        if !self.temporal {
            let error = error!(E0504, span, "temporal operators are allowed only in property files");
            return self.report(error);
        }
        Ok(())
    }

    fn operand(&mut self, body: &Expr, locals: &Locals) -> Lowered<crate::logic::NodeId> {
        let typed = self.lower(body, locals)?;
        self.as_formula(typed, body.span)
    }

    pub(super) fn lower_temporal(
        &mut self,
        span: Span,
        op: Temporal,
        bound: Option<&Bound>,
        body: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        self.expect_temporal(span, locals)?;
        let window = self.window(bound, body, locals);
        let body = self.operand(body, locals);
        let (window, body) = (window?, body?);
        let node = match op {
            Temporal::Finally => Node::Finally(window, body),
            Temporal::Globally => Node::Globally(window, body),
            Temporal::Next => {
                if self.clock.is_jumps() {
                    let error = error!(E0507, span, "`X` is not available in continuous time";
                            hint: "write `F[a, b]`, or set a `step` in the scenario");
                    return self.report(error);
                }
                // X<=k p: p at exactly the k-th state, as in the paper; X p is X<=1.
                let at = match (bound, window.to) {
                    (None, _) => Tick(1),
                    (Some(Bound::Interval(start, end)), _) => {
                        let place = start.span.to(end.span);
                        let error = error!(E0503, place, "`X` needs one time, not an interval";
                            hint: "`X<=0.5 s p` means p at exactly 0.5 s; for an interval write `F[a, b]` or `G[a, b]`");
                        return self.report(error.formal());
                    }
                    (Some(_), Some(to)) => to,
                    (Some(_), None) => {
                        return self.report(error!(E0503, span, "`X` needs a finite time"));
                    }
                };
                Node::Finally(Window { from: at, to: Some(at) }, body)
            }
        };
        Ok(Typed::Formula(self.node(node)))
    }

    pub(super) fn lower_temporal_pair(
        &mut self,
        span: Span,
        op: TemporalPair,
        bound: Option<&Bound>,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        self.expect_temporal(span, locals)?;
        let window = self.window(bound, right, locals);
        let sides = (self.operand(left, locals), self.operand(right, locals));
        let (window, left, right) = (window?, sides.0?, sides.1?);
        let node = match op {
            TemporalPair::Until => Node::Until(window, left, right),
            TemporalPair::Release => Node::Release(window, left, right),
            TemporalPair::WeakUntil => Node::WeakUntil(window, left, right),
        };
        Ok(Typed::Formula(self.node(node)))
    }

    pub(super) fn lower_window(
        &mut self,
        span: Span,
        aggregate: Aggregate,
        bound: &Bound,
        body: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        self.expect_temporal(span, locals)?;
        if aggregate == Aggregate::Sum && self.clock.is_jumps() {
            let error = error!(E0508, span, "`sum` over time is not available in continuous time";
                    hint: "write `mean`, the time average");
            return self.report(error);
        }
        let window = self.window(Some(bound), body, locals);
        let typed = self.lower(body, locals)?;
        let (term, dimension) = self.as_term(typed, body.span)?;
        let aggregation = match aggregate {
            Aggregate::Min => Aggregation::Min,
            Aggregate::Max => Aggregation::Max,
            Aggregate::Sum => Aggregation::Sum,
            Aggregate::Mean => Aggregation::Mean,
        };
        Ok(Typed::Term(self.term(Term::Window(aggregation, window?, term)), dimension))
    }

    /// The window of a bound, behind which `body` stands.
    fn window(&mut self, bound: Option<&Bound>, body: &Expr, locals: &Locals) -> Lowered<Window> {
        match bound {
            None => Ok(ALWAYS),
            Some(Bound::AtMost(end)) if self.misread_bound(end, body, locals) => Err(Reported),
            Some(Bound::AtMost(end)) => Ok(Window { from: Tick(0), to: self.time(end, locals)? }),
            Some(Bound::Interval(start, end)) => {
                let ends = (self.time(start, locals), self.time(end, locals));
                let Some(from) = ends.0? else {
                    return self.report(error!(E0503, start.span, "the start of an interval must be finite"));
                };
                let to = ends.1?;
                if to.is_some_and(|to| to < from) {
                    return self.report(error!(
                        E0503,
                        start.span.to(end.span),
                        "the interval ends before it starts"
                    ));
                }
                Ok(Window { from, to })
            }
        }
    }

    /// A time as ticks; `None` for infinity.
    pub(in crate::compile) fn time(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Option<Tick>> {
        let number = match self.lower(expr, locals)? {
            Typed::Infinity => return Ok(None),
            Typed::Number(number) => number,
            found => return self.mismatch(expr.span, "a time known before a trial starts", &found),
        };
        self.ticks(number, expr.span).map(Some)
    }

    /// A time known now, as ticks.
    pub(in crate::compile) fn ticks(&mut self, number: Number, span: Span) -> Lowered<Tick> {
        if number.value < 0.0 {
            return self.report(error!(E0503, span, "a time bound cannot be negative"));
        }
        let steps = number.dimension == Dimension::STEPS
            || (number.dimension.is_none() && self.clock == Clock::Steps);
        if steps {
            return match number.as_whole().and_then(|n| u64::try_from(n).ok()) {
                Some(n) if !self.clock.is_jumps() => Ok(Tick(n)),
                Some(_) => self.report(
                    error!(E0503, span, "bounds in steps are not available in continuous time")
                        .formal()
                        .hint("write a time such as `5 s`"),
                ),
                None => {
                    let below = number.value.floor();
                    self.report(error!(E0501, span, "the number of steps must be whole";
                        hint: "the nearest bounds are #{below} and #{}", below + 1.0))
                }
            };
        }
        if number.dimension.is_none() {
            // A number as it is written is shown with its unit; steps are whole.
            let text = self.text(span);
            let is_number =
                text.starts_with(|c: char| c.is_ascii_digit() || c == '.') && Decimal::parse(&text).is_some();
            let is_whole = text.bytes().all(|byte| byte.is_ascii_digit());
            let hint = match (is_number, self.clock.is_jumps()) {
                (true, true) => format!("write a time: `{text} s`"),
                (false, true) => "write a time such as `10 s`".to_owned(),
                (true, false) if is_whole => {
                    let steps = if text == "1" { "step" } else { "steps" };
                    format!("write `{text} s`, or `#{text}` (`{text} {steps}`) for a number of steps")
                }
                (true, false) => format!("write `{text} s`"),
                (false, false) => {
                    "write a time such as `10 s`, or a number of steps such as `#10` (`10 steps`)".to_owned()
                }
            };
            let error = error!(E0503, span, "the bound needs a unit").formal();
            return self.report(error.hint(hint));
        }
        if number.dimension != Dimension::TIME {
            return self.wrong_dimension(span, Dimension::TIME, number.dimension);
        }
        let step = match self.clock {
            Clock::Stepped(step) => step,
            Clock::Jumps(tick) => return self.moment(number, tick, span),
            Clock::Steps => {
                let error = error!(E0503, span, "the steps of this scenario have no length")
                    .formal()
                    .hint("write the bound in steps: `#10` or `10 steps`");
                return self.report(error);
            }
        };
        let exact = number.exact.or_else(|| nearest_tick(number.value, step));
        let found = match exact {
            Some(time) => Some(self.clock.tick_at(time)),
            // `pi * 1 s`
            None => {
                let below = (number.value / step.to_f64()).floor();
                (below < 9e15).then(|| Err((Tick(below as u64), Tick(below as u64 + 1))))
            }
        };
        match found {
            Some(Ok(tick)) => Ok(tick),
            Some(Err((below, above))) if above.0 < u64::MAX => {
                // Of a step such as `1 s / 60` no number of seconds is a multiple.
                let seconds = |tick: Tick| {
                    let time = Decimal::whole(tick.0 as i64).mul(step).map_or(f64::NAN, Decimal::to_f64);
                    let same = Decimal::parse(&time.to_string()).map(|time| self.clock.tick_at(time));
                    if same == Some(Ok(tick)) { format!("{time} s") } else { format!("#{}", tick.0) }
                };
                self.report(
                    error!(E0501, span, "`{}` is not a multiple of the step of {step} s", self.text(span);
                    hint: "the nearest bounds are {} and {}", seconds(below), seconds(above)),
                )
            }
            _ => self.report(error!(E0501, span, "the time is out of range")),
        }
    }

    /// A time in continuous time, as ticks. One between two ticks is noted: all will be compiled again.
    fn moment(&mut self, number: Number, tick: Decimal, span: Span) -> Lowered<Tick> {
        let Some(time) = number.exact.or_else(|| moments::nearest(number.value, tick)) else {
            return self.report(error!(E0501, span, "the time is out of range"));
        };
        match self.clock.tick_at(time) {
            Ok(found) => Ok(found),
            Err((below, above)) if above.0 < u64::MAX => {
                let horizon = Decimal::whole(self.horizon.0 as i64).mul(tick);
                if horizon.and_then(|horizon| moments::finer(tick, horizon, time)).is_none() {
                    return self.report(error!(E0501, span, "the time is too short for the horizon";
                        hint: "the horizon can be at most about 10^12 times the shortest time"));
                }
                self.between.push(time);
                Ok(below)
            }
            Err(_) => self.report(error!(E0501, span, "the time is out of range")),
        }
    }
}

/// The multiple of the step that a rounded time means, if it is one to within rounding.
fn nearest_tick(value: f64, step: Decimal) -> Option<Decimal> {
    let ticks = value / step.to_f64();
    let near = ticks.round();
    ((ticks - near).abs() <= 1e-9 * near.max(1.0) && near < 9e15)
        .then(|| Decimal::whole(near as i64).mul(step))
        .flatten()
}
