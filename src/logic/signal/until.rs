//! Until in continuous time: `q` at some moment of the window and `p` at every instant before it.
//!
//! An open span is many instants: to reach one of those strictly inside it from before, `p` must hold in the span
//! too; and where `p` fails in a span, only what comes before the span, or the present instant itself, can still be reached.

use super::moment::{Moment, instant};
use super::track::{Known, Track};
use super::truth::{Ref, Seen, Truth, fresh, look, never};

/// Learns from what the operands newly know.
pub(super) fn learn(track: &mut Track, cells: &[Truth], window: (Moment, Moment), p: Ref, q: Ref) {
    for piece in fresh(cells, p) {
        if piece.truth {
            first_holds(track, cells, window, (p, q), (piece.from, piece.to));
        } else {
            first_fails(track, cells, window, q, (piece.from, piece.to));
        }
    }
    for piece in fresh(cells, q) {
        if piece.truth {
            second_holds(track, cells, window, p, (piece.from, piece.to));
        } else {
            second_fails(track, cells, window, (p, q), (piece.from, piece.to));
        }
    }
}

/// `p` holds in `from .. to`: moments of its run reach what `q` has beyond `from`.
fn first_holds(
    track: &mut Track,
    cells: &[Truth],
    (a, b): (Moment, Moment),
    (p, q): (Ref, Ref),
    (from, _): (Moment, Moment),
) {
    let (start, end, _) = look(cells, p, from);
    let reach = instant(end);
    let mut at = from + 1;
    while at <= reach {
        let (left, right, known) = look(cells, q, at);
        if known == Known::True {
            track.settle((left - b).max(start), (right.min(reach + 1) - a).min(end), true);
        }
        at = right;
    }
}

/// `q` holds in `from .. to`: it is reached from there, and along runs of `p`.
fn second_holds(
    track: &mut Track,
    cells: &[Truth],
    (a, b): (Moment, Moment),
    p: Ref,
    (from, to): (Moment, Moment),
) {
    if a == 0 {
        track.settle(from, to, true);
    }
    let mut at = from - 1;
    while at < to {
        let (start, end, known) = look(cells, p, at);
        let right = to.min(instant(end).saturating_add(1));
        if known == Known::True && from < right {
            track.settle((from - b).max(start), (right - a).min(end), true);
        }
        at = end;
    }
}

/// `p` fails in `from .. to`: nothing behind that is reached from before it.
fn first_fails(
    track: &mut Track,
    cells: &[Truth],
    (a, _): (Moment, Moment),
    q: Ref,
    (from, to): (Moment, Moment),
) {
    if a > 0 {
        // The window begins behind it.
        track.settle(instant(from) + 1 - a, to, false);
    }
    let mut at = instant(from);
    while at < to {
        let (left, right, known) = look(cells, q, at);
        if known == Known::False {
            blocked(track, a, left, (to - 1).min((right - 1) | 1));
            if a == 0 {
                track.settle(from.max(left), to.min(right), false);
            }
        }
        at = right;
    }
}

/// `q` fails in the run from `left` on, and `p` at `failed`: moments between reach nothing.
fn blocked(track: &mut Track, a: Moment, left: Moment, failed: Moment) {
    if instant(failed) >= left {
        track.settle(left - a, failed, false);
    }
}

/// `q` fails in `from .. to`.
fn second_fails(
    track: &mut Track,
    cells: &[Truth],
    (a, b): (Moment, Moment),
    (p, q): (Ref, Ref),
    (from, to): (Moment, Moment),
) {
    never(track, cells, q, from, Seen::Within { from: a, to: b });
    let (left, right, _) = look(cells, q, from);
    // The last failure of `p` before the end of the run.
    let mut at = ((right - 1) | 1).min(cells[p.cell].track.end - 1);
    while at >= left {
        let (start, _, known) = look(cells, p, at);
        if known == Known::False {
            blocked(track, a, left, at);
            break;
        }
        if start == Moment::MIN {
            break;
        }
        at = start - 1;
    }
    if a == 0 {
        let mut at = from;
        while at < to {
            let (_, end, known) = look(cells, p, at);
            if known == Known::False {
                track.settle(at, end.min(to), false);
            }
            at = end;
        }
    }
}
