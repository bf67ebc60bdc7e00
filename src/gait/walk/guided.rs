//! The guided choice of a step: one of some candidates, with weight exp(-12 (detour + 0.35 heading error)).
//!
//! The candidate with the largest sum of log weight and Gumbel noise has the law of a draw by weight, and passing over those that
//! meet a barrier gives the law among the others. So only few candidates are swept.

use super::candidate::{Candidate, Change, Pose};
use super::others::{Gaps, WIDE, log_weight};
use super::placed::PlacedStep;
use super::task::Walk;
use crate::base::geometry::rotated;
use crate::base::math;
use crate::gait::{Draws, Stance};
use crate::route::grid::Way;

/// The draws of the choice among candidates have these numbers and the ones after.
const CHOICE: u32 = 2048;

/// Angle between the directions in which somebody who stands gets out of the way, rad.
const ASIDE: f64 = 45.0 * std::f64::consts::PI / 180.0;

/// Most candidates of a choice.
pub(super) const MOST: u32 = 512;

/// Why no candidate was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rejected {
    /// All meet a barrier.
    Barriers,
    /// Those that meet no barrier meet another body.
    Bodies,
}

/// A choice among options by key (log weight and Gumbel noise): the best one that is clear, its gap to others weighed.
pub(super) fn choose<T: Clone>(
    options: &[(f64, T)],
    is_clear: impl Fn(&T) -> bool,
    gap: impl Fn(&T) -> Option<f64>,
) -> Result<(T, f64), Rejected> {
    let mut order: Vec<(f64, &T)> = options.iter().map(|(key, option)| (*key, option)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut best: Option<(f64, &T, f64)> = None;
    let mut rejected = Rejected::Barriers;
    for (key, option) in order {
        if best.is_some_and(|(known, ..)| known >= key) {
            break;
        }
        if !is_clear(option) {
            continue;
        }
        let gap = gap(option).unwrap_or(f64::INFINITY);
        match log_weight(gap) {
            None => rejected = Rejected::Bodies,
            Some(log) if best.is_none_or(|(known, ..)| known < key + log) => {
                best = Some((key + log, option, gap));
            }
            Some(_) => {}
        }
    }
    best.map(|(_, option, gap)| (option.clone(), gap)).ok_or(rejected)
}

impl Walk<'_> {
    /// Gumbel noise and a uniform number for a choice.
    pub(super) fn choice(&self, number: u32, candidate: u32) -> (f64, f64) {
        let [u, v] = Draws::of(self.stream, number, CHOICE + candidate).uniform_pair(0);
        (-math::ln(-math::ln(u)), v)
    }

    /// One of some candidates.
    pub(super) fn guided(
        &self,
        (pose, way, number): (&Pose, &Way, u32),
        candidates: u32,
        others: Option<Gaps>,
    ) -> Result<(PlacedStep, Stance), Rejected> {
        let count = candidates.clamp(1, MOST);
        let drawn = self.drawn(pose, (0..count).map(|k| Draws::of(self.stream, number, k)));
        let course = self.course(pose.at, way);
        let option = |pose: &Pose, k: u32, noise: f64, change: Change<'_>| {
            let found = self.candidate(pose, way, drawn[(k % count) as usize], change)?;
            Some((noise - found.cost, found))
        };
        let is_clear = |found: &Candidate| self.is_clear(&found.step) && self.goes_on(found);
        let gap = |found: &Candidate| others.map(|others| others(&found.step));
        let mut options: Vec<_> = (0..count)
            .filter_map(|k| {
                let (noise, share) = self.choice(number, k);
                option(pose, k, noise, Change::Steer { share, course: Some(&course) })
            })
            .collect();
        let chosen = match choose(&options, is_clear, gap) {
            Ok((chosen, gap)) if gap >= WIDE => chosen,
            _ => {
                // Somebody or a barrier is near: the same steps to the side and shorter, too.
                options.extend((count..2 * count).filter_map(|k| {
                    let (noise, share) = self.choice(number, k);
                    // The path of somebody who stands may begin to the side.
                    let side =
                        if pose.stance.last.is_none() { ASIDE * f64::from(k % 5) - 2.0 * ASIDE } else { 0.0 };
                    let pose = Pose { heading: rotated(pose.heading, side), ..*pose };
                    option(&pose, k, noise, Change::Swerve(2.0 * share - 1.0, 1.0 - 0.35 * f64::from(k % 3)))
                }));
                choose(&options, is_clear, gap)?.0
            }
        };
        Ok((chosen.step, chosen.after))
    }
}
