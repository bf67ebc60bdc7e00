//! Windows over formulas: something holds at some state of a window. That it holds at every state is the
//! negation of the negation.

use super::cell::{Cell, Context, Machine, events};
use super::track::Track;
use crate::base::lanes::Mask;

pub(super) fn step(cell: &mut Cell, before: &[Cell], cx: &Context) {
    match &mut cell.machine {
        // The child reports each of its positions once, and they are those of the window.
        Machine::Count { child, left, .. } => {
            for (_, t, f) in events(before, *child, cx.now) {
                cell.t |= t & cx.work;
                let f = f & cx.work;
                if f != 0 {
                    for (lane, left) in left.iter_mut().enumerate() {
                        *left -= u64::from(f >> lane & 1);
                    }
                    let done = Mask(f).iter().filter(|&lane| left[lane] == 0);
                    cell.f |= done.fold(0, |all, lane| all | 1 << lane);
                }
            }
        }
        Machine::Slide { child, width, cut } => {
            for (at, t, f) in events(before, *child, cx.now) {
                slide(&mut cell.track, cx.now, *width, at, t, f);
            }
            if *cut && cx.ending != 0 {
                cut_off(&mut cell.track, cx);
            }
        }
        _ => {}
    }
}

/// At the horizon what is still open never comes.
fn cut_off(track: &mut Track, cx: &Context) {
    let mut at = cx.now;
    loop {
        let never = track.open(at, cx.now) & cx.ending;
        if never == 0 {
            return;
        }
        track.settle(at, cx.now, 0, never);
        at = at.wrapping_sub(1);
    }
}

/// Finally over `at ..= at + width`, after the child settled at `at`. It settles in order, so the open
/// positions of a lane are the last ones before `at` without a gap, and no true state was seen in the
/// windows of any of them. Each turn of the loop settles a position: constant work on average.
#[inline(always)]
fn slide(track: &mut Track, now: u64, width: u64, at: u64, t: u8, f: u8) {
    let oldest = at.wrapping_sub(width);
    let (mut position, mut hit) = (at, t);
    loop {
        hit &= track.open(position, now);
        if hit == 0 {
            break;
        }
        track.settle(position, now, hit, 0);
        if position == oldest {
            break;
        }
        position = position.wrapping_sub(1);
    }
    // The window of the oldest position ends here.
    let missed = (t | f) & track.open(oldest, now);
    if missed != 0 {
        track.settle(oldest, now, 0, missed);
    }
}
