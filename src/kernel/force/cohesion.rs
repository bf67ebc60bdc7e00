//! Attraction within groups (Moussaid, Perozo, Garnier, Helbing, Theraulaz 2010): a constant force towards the centroid of
//! the n members present, on those farther than (n - 1)/2 m from it. Without lanes: groups are few, and this is the same
//! for both layouts.

use super::pair::Sum;
use crate::base::geometry::Vec2;
use crate::kernel::state::State;
use crate::model::{Periods, Scenario};

/// Members that attract each other.
#[derive(Clone, Debug)]
pub(super) struct Cohesion {
    members: Vec<u32>,
    /// N.
    attraction: f64,
}

impl Cohesion {
    /// The groups of a scenario with an attraction.
    pub(super) fn all(scenario: &Scenario) -> Vec<Self> {
        let groups = scenario.groups.iter();
        groups
            .filter(|group| group.attraction != 0.0 && group.members.len() > 1)
            .map(|group| Self {
                members: group.members.iter().map(|member| member.0).collect(),
                attraction: group.attraction,
            })
            .collect()
    }

    /// Adds the attraction of a group.
    pub(super) fn add(&self, periods: &Periods, state: &State, sums: &mut [Sum]) {
        for lane in state.occupied.iter() {
            // On a closed plane of each the image that is nearest to the first.
            let mut first = None;
            let mut place = |member: u32| {
                let slot = state.slot(member as usize, lane);
                let here = state.present[slot.block].has(slot.lane);
                here.then(|| {
                    let (x, y) = (&state.motion.x[slot.block], &state.motion.y[slot.block]);
                    let at = Vec2::new(x.0[slot.lane], y.0[slot.lane]);
                    let first = *first.get_or_insert(at);
                    (slot, if periods.are_none() { at } else { first + periods.way(at - first) })
                })
            };
            let (mut n, mut sum) = (0.0, Vec2::zeros());
            for (_, at) in self.members.iter().filter_map(|&member| place(member)) {
                n += 1.0;
                sum += at;
            }
            for (slot, at) in self.members.iter().filter_map(|&member| place(member)) {
                let way = sum / n - at;
                let distance = way.dot(&way).sqrt();
                if distance > 0.0 && distance > 0.5 * (n - 1.0) {
                    let pull = way * (self.attraction / distance);
                    sums[slot.block].x.0[slot.lane] += pull.x;
                    sums[slot.block].y.0[slot.lane] += pull.y;
                }
            }
        }
    }
}
