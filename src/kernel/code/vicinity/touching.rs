//! What can be read off the pairs who may touch, which the forces list anyhow: any other two are farther apart than an edge.
//!
//! Whether everybody's gap is above a bound, where the bound is no more than the edge; and the least gap of all,
//! where that is: then no other two have it, however far they are apart.

use super::answers::All;
use super::{Around, Asker, MARGIN, Question, Vicinity, square, value};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::close::Close;
use crate::kernel::code::node::Measure;
use crate::kernel::state::State;

impl Vicinity {
    /// Answers everybody who is there; false where only a search can. Of centres that near nobody asks.
    pub(super) fn touching(&mut self, around: &Around<'_>, question: Question, all: &mut All) -> bool {
        let Some(close) = around.close else { return false };
        let members = self.set(around, around.own);
        match question {
            Question::AllFar { measure, test, wanted, bound } if measure != Measure::Centres => {
                let bound = f64::from_bits(bound);
                if bound > close.edge {
                    return false;
                }
                all.far.clear();
                all.far.extend(around.state.present.iter().map(|&here| (here, here)));
                let members = &self.sets[members].1;
                each_gap(around.state, (close, bound), measure, members, |asker, gap| {
                    if test.of(gap, bound) != wanted {
                        all.far[asker / LANES].1 &= !Mask::lane(asker % LANES);
                    }
                });
                true
            }
            Question::LeastOf { measure, askers } if measure != Measure::Centres => {
                let askers = self.set(around, askers);
                let (members, askers) = (&self.sets[members].1, &self.sets[askers].1);
                let mut least = f64::INFINITY;
                all.nearest.clear();
                all.nearest.resize(around.state.x.len(), Lanes::splat(f64::INFINITY));
                each_gap(around.state, (close, close.edge), measure, members, |asker, gap| {
                    let (block, lane) = (asker / LANES, asker % LANES);
                    let nearest = &mut all.nearest[block].0[lane];
                    *nearest = if gap < *nearest { gap } else { *nearest };
                    least = if gap < least && askers[block].has(lane) { gap } else { least };
                });
                least <= close.edge
            }
            _ => false,
        }
    }

    /// Where a list is, as a set of each block of agents.
    fn set(&mut self, around: &Around<'_>, list: u32) -> usize {
        if let Some(known) = self.sets.iter().position(|(known, _)| *known == list) {
            return known;
        }
        let mut set = vec![Mask::NONE; around.state.agents.div_ceil(LANES)];
        for &agent in &around.lists[list as usize] {
            set[agent as usize / LANES] |= Mask::lane(agent as usize % LANES);
        }
        self.sets.push((list, set));
        self.sets.len() - 1
    }
}

/// Calls `f` with each asker and the gap to each member who may touch them; perhaps not where the gap is above a bound.
#[inline(always)]
fn each_gap(
    state: &State,
    (close, bound): (Close<'_>, f64),
    measure: Measure,
    members: &[Mask],
    mut f: impl FnMut(usize, f64),
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
                f(asker.agent, value(measure, distance, asker.radius, member.radius));
            }
        }
    }
}
