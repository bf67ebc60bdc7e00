//! What can be read off pairs who are close, where any other two are farther apart than an edge.
//!
//! Whether everybody's measure is above a bound, and the smallest measures up to a bound, where that is no more than the
//! edge; and the least of all, where that is: then no other two have it, however far they are apart. Such pairs the forces
//! list anyhow, of those who may touch.

use super::asker::{Asker, MARGIN, square, value};
use super::question::{All, Question};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::code::node::{Cut, Measure};
use crate::kernel::near::Close;
use crate::kernel::state::State;

/// Who is asked about whom.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    /// Those who have an answer.
    pub(super) known: &'a [Mask],
    pub(super) members: &'a [Mask],
    /// Whose least is wanted, where that is.
    pub(super) askers: &'a [Mask],
}

/// Answers all who are known, if the pairs can; gives what was searched up to: the bound, or the least.
pub(super) fn read_off(
    state: &State,
    close: Close<'_>,
    question: Question,
    asked: Asked<'_>,
    all: &mut All,
) -> Option<f64> {
    let reach = match question {
        Question::AllFar { bound, .. } | Question::Nearest { cut: Cut::Above(bound), .. } => {
            // Nothing is below an edge that is not known.
            Some(f64::from_bits(bound)).filter(|bound| f64::NEG_INFINITY < *bound && *bound <= close.edge)?
        }
        Question::Nearest { cut: Cut::Least(_), .. } => close.edge,
        Question::Nearest { cut: Cut::Nowhere, .. } => return None,
    };
    let measure = question.measure();
    if let Question::AllFar { test, wanted, .. } = question {
        all.far.clear();
        all.far.extend(asked.known.iter().map(|&known| (known, known)));
        each(state, (close, reach), measure, asked.members, |asker, found| {
            if test.of(found, reach) != wanted {
                all.far[asker / LANES].1 &= !Mask::lane(asker % LANES);
            }
            reach
        });
        return Some(reach);
    }
    let cut_at_least = matches!(question, Question::Nearest { cut: Cut::Least(_), .. });
    let mut least = f64::INFINITY;
    all.nearest.clear();
    all.nearest.extend(asked.known.iter().map(|&known| start(known)));
    each(state, (close, reach), measure, asked.members, |asker, found| {
        let (block, lane) = (asker / LANES, asker % LANES);
        let nearest = &mut all.nearest[block].0[lane];
        *nearest = if found < *nearest { found } else { *nearest };
        least = if found < least && asked.askers[block].has(lane) { found } else { least };
        if cut_at_least && least < reach { least } else { reach }
    });
    if cut_at_least { (least <= close.edge).then_some(least) } else { Some(reach) }
}

/// Nobody near is found yet of those who are known.
#[inline(always)]
fn start(known: Mask) -> Lanes {
    let mut start = Lanes::splat(f64::INFINITY);
    for lane in (!known).iter() {
        start.0[lane] = f64::NAN;
    }
    start
}

/// Calls `f` with each asker and what is measured to each member close to them; perhaps not where that is above a bound,
/// of which `f` gives the next.
#[inline(always)]
fn each(
    state: &State,
    (close, mut bound): (Close<'_>, f64),
    measure: Measure,
    members: &[Mask],
    mut f: impl FnMut(usize, f64) -> f64,
) {
    for &(a, b) in close.pairs {
        let one = Asker::new(state, a as usize, measure);
        let other = Asker::new(state, b as usize, measure);
        let (dx, dy) = (one.at.x - other.at.x, one.at.y - other.at.y);
        let squared = dx * dx + dy * dy;
        let both = one.radius + other.radius;
        if squared > square((both + bound) + (both + bound.abs()) * MARGIN + 1e-30) {
            continue;
        }
        let distance = squared.sqrt();
        for (asker, member) in [(one, other), (other, one)] {
            if members[member.agent / LANES].has(member.agent % LANES) {
                bound = f(asker.agent, value(measure, distance, asker.radius, member.radius));
            }
        }
    }
}
