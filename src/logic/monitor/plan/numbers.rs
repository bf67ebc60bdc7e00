//! Cells of numbers, and comparisons.

use super::{Builder, Made, NowKey, Span};
use crate::base::lanes::Lanes;
use crate::base::tick::Tick;
use crate::logic::formula::{Aggregation, NodeId, Operation, Relation, Term, TermId, Window, in_time};
use crate::logic::invalid::Invalid;
use crate::logic::monitor::cell::{Arithmetic, Extent, Machine, Place, Ref};
use crate::logic::monitor::numbers::combine;
use crate::logic::monitor::track::Numbers;

/// Most numbers that are added when a trial comes to its horizon: about a second, in which nothing looks at the clock.
const MOST_ADDED: u64 = 1 << 31;

impl Builder<'_> {
    /// A comparison at the positions `lo ..= hi`.
    pub(super) fn compare(
        &mut self,
        relation: Relation,
        x: TermId,
        y: TermId,
        (lo, hi): Span,
    ) -> Result<Made<bool>, Invalid> {
        match (self.constants[x.0 as usize], self.constants[y.0 as usize]) {
            (Some(x), Some(y)) => Ok(self.compared_constants(relation, x, y, (lo, hi))),
            (None, Some(y)) => self.against(relation, x, y, (lo, hi)),
            (Some(x), None) => self.against(relation.flipped(), y, x, (lo, hi)),
            (None, None) => {
                let (x, y) = (self.number(x, (lo, hi))?, self.number(y, (lo, hi))?);
                if let (Made::Constant(x), Made::Constant(y)) = (&x, &y) {
                    return Ok(Made::Constant(relation.holds(*x, *y)));
                }
                let (x, y) = (self.of(x), self.of(y));
                Ok(Made::Of(self.compared(relation, x, y, (lo, hi))))
            }
        }
    }

    /// A comparison with a constant. The smallest and the largest number of a window, and times, are
    /// compared state by state, so that the verdict falls as soon as a state forces it.
    fn against(
        &mut self,
        relation: Relation,
        x: TermId,
        c: f64,
        (lo, hi): Span,
    ) -> Result<Made<bool>, Invalid> {
        use Relation::{AtLeast, AtMost, Greater, Less};
        if let Some(x) = self.constants[x.0 as usize] {
            return Ok(self.compared_constants(relation, x, c, (lo, hi)));
        }
        if let Some((w, x, any)) = self.tree.within(relation, x) {
            let below = self.stretch(w, (lo, hi));
            let child = self.against(relation, x, c, below.span)?;
            return Ok(self.some_state(child.not_if(!any), w.from, below.width, (lo, hi)).not_if(!any));
        }
        match (&self.tree.terms[x.0 as usize], relation) {
            (Term::TimeUntil(goal), Less | AtMost) if !c.is_nan() => {
                self.in_time(relation, *goal, c, (lo, hi))
            }
            (Term::TimeUntil(goal), Greater | AtLeast) if !c.is_nan() => {
                let opposite = if relation == Greater { AtMost } else { Less };
                Ok(!self.in_time(opposite, *goal, c, (lo, hi))?)
            }
            _ => self.against_number(relation, x, c, (lo, hi)),
        }
    }

    fn against_number(
        &mut self,
        relation: Relation,
        x: TermId,
        c: f64,
        (lo, hi): Span,
    ) -> Result<Made<bool>, Invalid> {
        let x = match self.number(x, (lo, hi))? {
            // A number may turn out the same everywhere only here: the time until what never holds.
            Made::Constant(x) => return Ok(Made::Constant(relation.holds(x, c))),
            Made::Of(x) => x,
        };
        let c = self.fixed(c);
        Ok(Made::Of(self.compared(relation, x, c, (lo, hi))))
    }

    /// `time until goal < c` or `<= c` as finally within the ticks that fulfil it, up to the horizon.
    fn in_time(
        &mut self,
        relation: Relation,
        goal: NodeId,
        c: f64,
        (lo, hi): Span,
    ) -> Result<Made<bool>, Invalid> {
        if relation.holds(f64::INFINITY, c) {
            return Ok(Made::Constant(true));
        }
        let Some(within) = in_time(relation, c, self.clock, self.horizon - lo) else {
            return Ok(Made::Constant(false));
        };
        // Windows of the later positions may be cut; if all are, there is no bound.
        let is_bounded = hi + within <= self.horizon || lo + within < self.horizon;
        let width = is_bounded.then_some(within);
        let child = self.formula(goal, (lo, self.horizon.min(hi.saturating_add(within))))?;
        Ok(self.some_state(child, Tick(0), width, (lo, hi)))
    }

    fn compared_constants(&mut self, relation: Relation, x: f64, y: f64, (lo, hi): Span) -> Made<bool> {
        if !self.margins {
            return Made::Constant(relation.holds(x, y));
        }
        let (x, y) = (self.fixed(x), self.fixed(y));
        Made::Of(self.compared(relation, x, y, (lo, hi)))
    }

    fn compared(&mut self, relation: Relation, x: Ref, y: Ref, (lo, hi): Span) -> Ref {
        let ahead = common(x, y);
        if let (Some(ahead), true) = (ahead, of_now(x, y)) {
            let key = NowKey::Compare(relation as u8, x.cell, y.cell);
            let now = self.present(key, Machine::CompareNow(relation, x.cell, y.cell), false);
            return super::later(now, ahead);
        }
        if lo == hi {
            let (x, y) = (self.held(x, lo), self.held(y, lo));
            return self.answer(Machine::CompareHeld(relation, x, y), (lo, lo), self.horizon, false);
        }
        let pair = self.pair(x, y, (lo, hi));
        let machine = Machine::CompareLate(relation, pair.x, pair.y);
        super::later(self.late(machine, pair.range, pair.latency, pair.in_order, false), pair.ahead)
    }

    /// Two operands of a late cell.
    fn pair(&mut self, x: Ref, y: Ref, (lo, hi): Span) -> Pair {
        let aheads = [x, y].into_iter().filter(|child| child.place != Place::Fixed).map(|child| child.ahead);
        let ahead = aheads.min().unwrap_or(0);
        let less = |child: Ref| Ref { ahead: child.ahead.saturating_sub(ahead), ..child };
        let (x, y) = (less(x), less(y));
        let range = (lo + ahead, hi + ahead);
        let latency = self.delay(x).max(self.delay(y));
        for child in [x, y] {
            self.touch(child, range);
            self.keep(child, latency);
        }
        let in_order = self.facts[x.cell].in_order && self.facts[y.cell].in_order;
        Pair { x, y, ahead, range, latency, in_order }
    }

    fn of(&mut self, made: Made<f64>) -> Ref {
        match made {
            Made::Constant(value) => self.fixed(value),
            Made::Of(child) => child,
        }
    }

    /// The number `id`, asked about at the positions `lo ..= hi`.
    pub(super) fn number(&mut self, id: TermId, (lo, hi): Span) -> Result<Made<f64>, Invalid> {
        if let Some(value) = self.constants[id.0 as usize] {
            return Ok(Made::Constant(value));
        }
        if let Some(&made) = self.numbers.get(&(id.0, (lo, hi))) {
            return Ok(made);
        }
        self.check_size()?;
        let tree = self.tree;
        let made = match &tree.terms[id.0 as usize] {
            Term::Constant(value) => Made::Constant(*value),
            Term::Signal(signal) => {
                Made::Of(self.present(NowKey::Signal(signal.0), Machine::Signal(signal.0 as usize), true))
            }
            Term::Combine(operation, x, y) => {
                let (x, y) = (self.number(*x, (lo, hi))?, self.number(*y, (lo, hi))?);
                self.joined(Arithmetic::Of(*operation), x, y, (lo, hi))
            }
            Term::Abs(x) => {
                let x = self.number(*x, (lo, hi))?;
                self.joined(Arithmetic::Abs, x, x, (lo, hi))
            }
            Term::Later(by, x) => self.number(*x, (lo + by.0, hi + by.0))?.later(by.0),
            Term::Window(aggregation, w, x) => self.window(*aggregation, *w, *x, (lo, hi))?,
            Term::AtEnd(x) => match self.number(*x, (self.horizon, self.horizon))? {
                Made::Constant(value) => Made::Constant(value),
                Made::Of(end) => {
                    let end = self.held(end, self.horizon);
                    Made::Of(if lo == hi {
                        end
                    } else {
                        self.late(Machine::EndLate(end.cell), (lo, hi), self.horizon, true, true)
                    })
                }
            },
            Term::TimeUntil(goal) => match self.formula(*goal, (lo, self.horizon))? {
                Made::Constant(true) => Made::Constant(0.0),
                Made::Constant(false) => Made::Constant(f64::INFINITY),
                Made::Of(child) => Made::Of(self.time(child, (lo, hi))),
            },
        };
        self.numbers.insert((id.0, (lo, hi)), made);
        Ok(made)
    }

    /// Arithmetic, worked out at once where both numbers are the same everywhere.
    fn joined(&mut self, arithmetic: Arithmetic, x: Made<f64>, y: Made<f64>, (lo, hi): Span) -> Made<f64> {
        if let (Made::Constant(x), Made::Constant(y)) = (&x, &y) {
            return Made::Constant(combine(arithmetic, Lanes::splat(*x), Lanes::splat(*y)).0[0]);
        }
        Made::Of(self.combined(arithmetic, x, y, (lo, hi)))
    }

    fn combined(&mut self, arithmetic: Arithmetic, x: Made<f64>, y: Made<f64>, (lo, hi): Span) -> Ref {
        let (x, y) = (self.of(x), self.of(y));
        if let (Some(ahead), true) = (common(x, y), of_now(x, y)) {
            return super::later(self.combined_now(arithmetic, x, y), ahead);
        }
        if lo == hi {
            let (x, y) = (self.held(x, lo), self.held(y, lo));
            return self.answer(Machine::CombineHeld(arithmetic, x, y), (lo, lo), self.horizon, true);
        }
        self.combined_late(arithmetic, x, y, (lo, hi))
    }

    fn combined_now(&mut self, arithmetic: Arithmetic, x: Ref, y: Ref) -> Ref {
        let code = match arithmetic {
            Arithmetic::Of(operation) => operation as u8,
            Arithmetic::Abs => u8::MAX,
        };
        let key = NowKey::Combine(code, x.cell, y.cell);
        self.present(key, Machine::CombineNow(arithmetic, x.cell, y.cell), true)
    }

    fn combined_late(&mut self, arithmetic: Arithmetic, x: Ref, y: Ref, (lo, hi): Span) -> Ref {
        let pair = self.pair(x, y, (lo, hi));
        let machine = Machine::CombineLate(arithmetic, pair.x, pair.y);
        super::later(self.late(machine, pair.range, pair.latency, pair.in_order, true), pair.ahead)
    }

    fn window(
        &mut self,
        aggregation: Aggregation,
        window: Window,
        x: TermId,
        (lo, hi): Span,
    ) -> Result<Made<f64>, Invalid> {
        let below = self.stretch(window, (lo, hi));
        let child = match self.number(x, below.span)? {
            Made::Of(child) => child,
            // A sum of constants has as many states as the window; they count once they are seen.
            Made::Constant(value) => {
                let fixed = self.fixed(value);
                self.combined_now(Arithmetic::Of(Operation::Max), fixed, fixed)
            }
        };
        if below.width == Some(0) {
            return Ok(Made::Of(child).later(window.from.0));
        }
        let ahead = window.from.0 + child.ahead;
        let (lo, hi) = (lo + ahead, hi + ahead);
        let child = Ref { ahead: 0, ..child };
        let reach = below.width.map_or(self.horizon, |width| hi + width);
        self.touch(child, (lo, reach));
        if lo == hi && child.place == Place::Now {
            let (states, extent) = (reach - lo + 1, Box::new(Extent::EMPTY));
            let machine = Machine::Fold { aggregation, child: child.cell, states, extent };
            return Ok(Made::Of(self.answer(machine, (lo, reach), 0, true)));
        }
        let smallest = match aggregation {
            Aggregation::Min | Aggregation::First => Some(Operation::Min),
            Aggregation::Max => Some(Operation::Max),
            Aggregation::Sum | Aggregation::Mean => None,
        };
        if let (Some(operation), Some(width), true) = (smallest, below.width, lo < hi) {
            let arithmetic = Arithmetic::Of(operation);
            let half = self.doubled(child, width, (lo, hi), |all, [x, y], range| {
                all.combined_late(arithmetic, x, y, range)
            });
            return Ok(Made::Of(super::later(half, ahead)));
        }
        let (at, states) = (hi.saturating_sub(lo) + 1, self.horizon.saturating_sub(lo) + 1);
        // The windows shrink from state to state.
        let needed = at.saturating_mul(states.saturating_mul(2).saturating_sub(at.saturating_sub(1))) / 2;
        if smallest.is_none() && below.width.is_none() && needed > MOST_ADDED {
            return Err(Invalid::TooMany { needed, limit: MOST_ADDED });
        }
        let in_order = self.facts[child.cell].in_order;
        let latency = match below.width {
            Some(width) => width.saturating_add(self.delay(child)),
            None => self.horizon - lo,
        };
        self.keep(child, latency);
        let machine = Machine::FoldLate { aggregation, child, width: below.width, in_order };
        let all = in_order || below.width.is_none();
        Ok(Made::Of(super::later(self.late(machine, (lo, hi), latency, all, true), ahead)))
    }

    fn time(&mut self, child: Ref, (lo, hi): Span) -> Ref {
        self.touch(child, (lo, self.horizon));
        if child.place == Place::Held {
            return self.answer(Machine::TimeHeld(child), (lo, lo), self.horizon, true);
        }
        if lo == hi && child.place == Place::Now {
            return self.answer(Machine::Time { child, from: lo }, (lo, self.horizon), 0, true);
        }
        let latency = self.horizon - lo;
        self.keep(child, latency);
        let in_order = self.facts[child.cell].in_order;
        let machine = Machine::TimeLate { child, ticks: Numbers::default() };
        self.late(machine, (lo, hi), latency, in_order, true)
    }
}

/// How far ahead both look, if both do alike.
fn common(x: Ref, y: Ref) -> Option<u64> {
    match (x.place, y.place) {
        (Place::Fixed, _) => Some(y.ahead),
        (_, Place::Fixed) => Some(x.ahead),
        _ => (x.ahead == y.ahead).then_some(x.ahead),
    }
}

fn of_now(x: Ref, y: Ref) -> bool {
    [x, y].iter().all(|child| matches!(child.place, Place::Now | Place::Fixed))
}

/// Two operands of a late cell, and what follows for it.
struct Pair {
    x: Ref,
    y: Ref,
    ahead: u64,
    range: (u64, u64),
    latency: u64,
    in_order: bool,
}
