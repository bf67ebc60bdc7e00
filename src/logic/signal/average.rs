//! A time average that moves with the moment asked about, compared with zero.
//!
//! The integral of x over the window is continuous and, between the instants at which an end of the window meets a
//! change of x, linear; the comparison changes where it is zero. That follows from the integral at the last such instant and the
//! values at both ends, so it depends on x alone and not on the moments at which somebody looked at x.

use super::integral::Integral;
use super::moment::{FOREVER, Moment, instant};
use super::stream::Stream;
use super::track::Track;
use crate::base::rounding::{quotient, sum};
use crate::logic::formula::Relation;

/// The comparison. The window is `from ..= to` ahead, longer than nothing; it ends with the horizon.
#[derive(Clone, Debug)]
pub(super) struct Average {
    pub(super) of: usize,
    pub(super) from: Moment,
    pub(super) to: Moment,
    pub(super) relation: Relation,
}

/// The integral between two instants at which it bends.
struct Segment {
    start: Moment,
    end: Moment,
    /// At the start.
    integral: (f64, f64),
    /// The values at the start and at the end of the window.
    values: (f64, f64),
}

impl Average {
    /// Settles what is known from the cursor on.
    pub(super) fn learn(&self, track: &mut Track, cursor: &mut Moment, x: &Stream) {
        let known = if self.to == FOREVER {
            if x.known < x.end {
                return;
            }
            track.end
        } else {
            track.end.min(x.known - self.to)
        };
        while *cursor < known {
            let at = instant(*cursor);
            if self.to == FOREVER && at + self.from >= x.end - 1 {
                // Nothing is left of the window but the horizon.
                track.settle(*cursor, known, self.relation.holds(x.around(x.end - 1).1, 0.0));
                *cursor = known;
                return;
            }
            let segment = self.segment(at, known, x);
            let end = if segment.end > at { segment.end.min(known) } else { at + 1 };
            self.settle(track, (*cursor, end), &segment);
            *cursor = end;
        }
    }

    /// The segment that begins at an instant or goes on there. Moments before `known` are known.
    fn segment(&self, at: Moment, known: Moment, x: &Stream) -> Segment {
        let (left, right) = (at + self.from + 1, at + self.to + Moment::from(at + 1 < known));
        let (mut start, mut end) =
            (instant(x.since(left)) - self.from, instant(x.around(left).0) - self.from);
        let mut values = (x.around(left).1, 0.0);
        if self.to != FOREVER {
            start = start.max(instant(x.since(right)) - self.to);
            end = end.min(instant(x.around(right).0) - self.to);
            values.1 = x.around(right).1;
        }
        let last = if self.to == FOREVER { x.end - 1 } else { start + self.to };
        let (mut from, mut integral) = (start + self.from + 1, Integral::EMPTY);
        while from < last {
            let (to, value) = x.around(from);
            integral.add(value, from, to.min(last));
            from = to;
        }
        Segment { start, end, integral: integral.sum(), values }
    }

    /// Settles moments `from .. to` of a segment.
    fn settle(&self, track: &mut Track, (from, to): (Moment, Moment), segment: &Segment) {
        let Segment { start, integral, values: (left, right), .. } = *segment;
        let mut set = |first: Moment, end: Moment, excess: f64| {
            track.settle(first.max(from), end.min(to), self.relation.holds(excess, 0.0));
        };
        let loss = sum(left, -right);
        set(start, start + 1, integral.0);
        if !(integral.0.is_finite() && loss.0.is_finite()) {
            set(start + 1, to, integral.0 + right);
        } else if integral.0 == 0.0 {
            set(start + 1, to, -loss.0);
        } else {
            let units = quotient(integral, loss);
            // A zero that is less than half a unit after the start lies right after it.
            let zero = if loss.0 != 0.0 && units.0 > 0.0 && units.0 < FOREVER as f64 / 4.0 {
                let whole = units.0.floor();
                let rest = (units.0 - whole) + units.1;
                start + 2 * (whole as i64 + (rest + 0.5).floor() as i64).max(1)
            } else {
                to
            };
            set(start + 1, zero, integral.0);
            set(zero, zero.saturating_add(1), 0.0);
            set(zero.saturating_add(1), to, -loss.0);
        }
    }
}
