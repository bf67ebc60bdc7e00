//! How bounds follow from those of operands: largest values of windows and of ways to a goal, piece by piece.
//!
//! Smallest values are largest ones with the sign turned. An operand that is not known yet has minus infinity as
//! its lower bound and plus infinity as its upper one, so that each bound is worked out for itself.

use super::reader::Reader;
use crate::logic::signal::moment::{FOREVER, Moment};
use crate::logic::signal::stream::Stream;
use crate::logic::signal::truth::Seen;
use std::collections::VecDeque;

const NEVER: f64 = f64::NEG_INFINITY;

pub(super) fn larger(x: f64, y: f64) -> f64 {
    if y > x { y } else { x }
}

pub(super) fn smaller(x: f64, y: f64) -> f64 {
    if y < x { y } else { x }
}

/// The largest of some operands from `from` on.
pub(super) fn any(own: &mut Stream, operands: &[Reader<'_>], from: Moment) {
    let mut at = from;
    while at < own.end {
        let (mut stop, mut value) = (own.end, NEVER);
        for operand in operands {
            let (end, one) = operand.around(at);
            (stop, value) = (stop.min(end), larger(value, one));
        }
        own.extend(stop, value);
        at = stop;
    }
}

/// The largest that moments from `from` on see of an operand: a sliding maximum (Lemire 2006), whose pieces come
/// into sight and go out of it in order.
pub(super) fn slide(own: &mut Stream, operand: Reader<'_>, from: Moment, seen: Seen) {
    let first = match seen {
        Seen::Within { from: ahead, .. } => from + ahead,
        Seen::Soon { .. } => from,
    };
    let mut coming = operand.pieces(first).map(|(s, e, value)| (seen.of(s, e), value)).peekable();
    let mut here: VecDeque<(Moment, f64)> = VecDeque::new();
    let mut at = from;
    while at < own.end {
        while let Some(((_, gone), value)) = coming.next_if(|((comes, _), _)| *comes <= at) {
            while here.back().is_some_and(|last| last.1 <= value) {
                here.pop_back();
            }
            here.push_back((gone, value));
        }
        while here.front().is_some_and(|first| first.0 <= at) {
            here.pop_front();
        }
        let comes = coming.peek().map_or(own.end, |((comes, _), _)| *comes);
        let (gone, value) = here.front().copied().unwrap_or((own.end, NEVER));
        let stop = comes.min(gone).min(own.end);
        own.extend(stop, value);
        at = stop;
    }
}

/// The best way to a goal with the first operand until then, from `from` on (Donzé, Ferrère and Maler 2013): of
/// an unbounded until, worked out from its end, and a largest value of the window.
pub(super) fn until(
    own: &mut Stream,
    (first, second): (Reader<'_>, Reader<'_>),
    from: Moment,
    (a, b): (Moment, Moment),
) {
    let end = own.end.saturating_add(a);
    let goals = unbounded(first, second, from + a);
    let mut ways = Stream::new(from + a, end);
    for (stop, value) in goals {
        ways.extend(stop, value);
    }
    ways.extend(end, NEVER);
    let mut found = Stream::new(from + a, end);
    if b == FOREVER {
        found.extend(end, f64::INFINITY);
    } else {
        slide(&mut found, second, from + a, Seen::Within { from: 0, to: b - a });
    }
    // The first operand up to the window: what fails in it comes sooner.
    let mut fails = Stream::new(from, own.end);
    if a > 0 {
        let failing = Reader { negated: !first.negated, ..first };
        slide(&mut fails, failing, from, Seen::Soon { within: a, strictly: true });
    } else {
        fails.extend(own.end, NEVER);
    }
    let read = |curve| Reader { curve, negated: false };
    let (ways, found, fails) = (read(&ways), read(&found), read(&fails));
    let mut at = from;
    while at < own.end {
        let ((x_end, x), (y_end, y)) = (ways.around(at + a), found.around(at + a));
        let (z_end, z) = fails.around(at);
        let stop = z_end.min(x_end.min(y_end).saturating_sub(a)).min(own.end);
        own.extend(stop, smaller(smaller(x, y), -z));
        at = stop;
    }
}

/// Ends and values of the pieces of an until whose window never ends.
fn unbounded(first: Reader<'_>, second: Reader<'_>, from: Moment) -> Vec<(Moment, f64)> {
    let mut pieces = Vec::new();
    let mut at = from;
    while at < second.curve.end {
        let ((p_end, p), (q_end, q)) = (first.around(at), second.around(at));
        let stop = p_end.min(q_end).min(second.curve.end);
        pieces.push((stop, p, q));
        at = stop;
    }
    // What is reached from just before the piece at hand.
    let mut beyond = NEVER;
    let mut start = pieces.len();
    let mut values = vec![(from, NEVER); pieces.len()];
    while start > 0 {
        start -= 1;
        let (stop, p, q) = pieces[start];
        let value = larger(q, smaller(p, beyond));
        values[start] = (stop, value);
        let begin = if start > 0 { pieces[start - 1].0 } else { from };
        // To reach an instant inside an open span from before, the first must hold in the span too.
        beyond = if begin % 2 == 0 { value } else { smaller(p, value) };
    }
    values
}

/// How far an until has come that is asked about at one moment only.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// The next moment to look at.
    pub(super) next: Moment,
    /// The best way found.
    pub(super) best: f64,
    /// The first operand so far.
    pub(super) so_far: f64,
}

impl Way {
    pub(super) fn new(at: Moment) -> Self {
        Self { next: at, best: NEVER, so_far: f64::INFINITY }
    }

    /// Goes on up to before `to`, for a question asked at `asked` about the goals `from ..= last`.
    pub(super) fn go(
        &mut self,
        (first, second): (Option<Reader<'_>>, Reader<'_>),
        asked: Moment,
        (from, last): (Moment, Moment),
        to: Moment,
    ) {
        let to = to.min(last.saturating_add(1));
        while self.next < to {
            let at = self.next;
            let (p_end, p) = first.map_or((Moment::MAX, f64::INFINITY), |first| first.around(at));
            let (q_end, q) = second.around(at);
            let mut stop = p_end.min(q_end).min(to);
            if at < from {
                stop = stop.min(from);
            } else {
                let held = if at % 2 == 0 || at == asked { self.so_far } else { smaller(self.so_far, p) };
                self.best = larger(self.best, smaller(q, held));
            }
            self.so_far = smaller(self.so_far, p);
            self.next = stop;
        }
    }
}
