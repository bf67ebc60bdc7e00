//! A time average that moves with the moment asked about, compared with a constant.
//!
//! The integral of x − c over the window is continuous and, between the instants at which an end of the window
//! meets a jump of x, linear; the comparison changes where it is zero.

use super::moment::{FOREVER, Moment, instant};
use super::stream::Stream;
use super::track::Track;
use crate::logic::formula::Relation;

/// The comparison. The window is `from ..= to` ahead, longer than nothing; it ends with the horizon.
#[derive(Clone, Debug)]
pub(super) struct Average {
    pub(super) of: usize,
    pub(super) from: Moment,
    pub(super) to: Moment,
    pub(super) relation: Relation,
    pub(super) constant: f64,
}

impl Average {
    /// The window's ends seen from an instant.
    fn window(&self, at: Moment, x: &Stream) -> (Moment, Moment) {
        (at + self.from, if self.to == FOREVER { x.end - 1 } else { at + self.to })
    }

    /// The integral of x − c over the window.
    fn integral(&self, at: Moment, x: &Stream) -> f64 {
        let (mut at, end) = self.window(at, x);
        let mut sum = 0.0;
        while at < end {
            let (stop, value) = x.around(at);
            let stop = stop.min(end);
            let length = stop / 2 - at / 2;
            if length > 0 {
                sum += (value - self.constant) * length as f64;
            }
            at = stop;
        }
        sum
    }

    /// Settles what is known from the cursor on.
    pub(super) fn learn(&self, track: &mut Track, cursor: &mut Moment, x: &Stream) {
        while *cursor < track.end {
            let at = instant(*cursor);
            let (start, end) = self.window(at, x);
            if *cursor == at {
                if x.known <= end {
                    return;
                }
                let excess =
                    if start == end { x.around(start).1 - self.constant } else { self.integral(at, x) };
                track.settle(at, at + 1, self.relation.holds(excess, 0.0));
                *cursor += 1;
                continue;
            }
            let next = if self.to == FOREVER {
                if x.known < x.end || start >= end {
                    return;
                }
                instant(x.around(start + 1).0) - self.from
            } else {
                if x.known <= end + 1 {
                    return;
                }
                (instant(x.around(start + 1).0) - self.from).min(instant(x.around(end + 1).0) - self.to)
            };
            self.span(track, (at, next), x);
            *cursor = next;
        }
    }

    /// Settles the open span between two instants, where the integral is linear.
    fn span(&self, track: &mut Track, (from, to): (Moment, Moment), x: &Stream) {
        let holds = |excess: f64| self.relation.holds(excess, 0.0);
        let (first, last) = (self.integral(from, x), self.integral(to, x));
        if !(first.is_finite() && last.is_finite()) {
            let middle = self.integral(instant(from + (to - from) / 2), x);
            track.settle(from + 1, to, holds(middle));
        } else if (first < 0.0 && last > 0.0 || first > 0.0 && last < 0.0) && to - from > 2 {
            // In this order it is exact where the instant is a whole number.
            let units = first * ((to - from) / 2) as f64 / (first - last);
            let zero = (from + 2 * (units + 0.5).floor() as i64).max(from + 2).min(to - 2);
            track.settle(from + 1, zero, holds(first));
            track.settle(zero, zero + 1, holds(0.0));
            track.settle(zero + 1, to, holds(last));
        } else {
            track.settle(from + 1, to, holds(if first == 0.0 { last } else { first }));
        }
    }
}
