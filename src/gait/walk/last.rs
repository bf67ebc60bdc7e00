//! The last one or two steps: drawn from the gait, then scaled and bent so that the walk ends at the goal point.

use super::candidate::{DETOUR, Pose};
use super::guided::{Rejected, choose};
use super::others::Gaps;
use super::placed::{PlacedStep, angle, end_of, turned};
use super::task::Walk;
use super::turn;
use crate::base::geometry::Vec2;
use crate::gait::{Draws, Stance};
use crate::route::grid::Way;

/// Two last steps begin within so many usual lengths of the goal, one step within so many of them; a person who stands makes
/// one step only within the last of these.
const TWO: f64 = 2.1;
const ONE: f64 = 1.25;
const ONE_FROM_STANDING: f64 = 0.7;

/// The draws of last steps have these numbers and the ones after.
const FIRST: u32 = 1024;

/// Steps with their stances after them.
pub(super) type Chain = Vec<(PlacedStep, Stance)>;

/// `v` in a frame whose +x has this direction.
fn seen(v: Vec2, heading: Vec2) -> Vec2 {
    turned(v, Vec2::new(heading.x, -heading.y))
}

impl Walk<'_> {
    /// How many last steps lead from a pose to the goal: 1 or 2; `None` farther away.
    pub(super) fn remaining(&self, pose: &Pose, way: &Way) -> Option<u32> {
        let usual = self.usual();
        let one = if pose.stance.last.is_some() { ONE } else { ONE_FROM_STANDING };
        let is_near = way.is_straight && way.length <= TWO * usual;
        is_near.then_some(if way.length <= one * usual { 1 } else { 2 })
    }

    /// The usual length of a step at the preferred speed, m: it grows about with the root of the speed.
    pub(super) fn usual(&self) -> f64 {
        self.gait.length() * self.share.max(0.0).sqrt()
    }

    /// Last steps from a pose, the first one first.
    pub(super) fn last_steps(
        &self,
        (pose, steps, number): (&Pose, u32, u32),
        candidates: u32,
        others: Option<Gaps>,
    ) -> Result<Chain, Rejected> {
        let drawn = self.drawn(pose, (0..candidates).map(|k| Draws::of(self.stream, number, FIRST + k)));
        let is_clear = |chain: &Chain| chain.iter().all(|(step, _)| self.is_clear(step));
        let gap = |chain: &Chain| others.zip(chain.first()).map(|(others, (step, _))| others(step));
        let chosen = |is_straight: bool| {
            let option = |(candidate, first): (u32, &Stance)| {
                let (cost, chain) =
                    self.last_option(pose, (*first, steps, is_straight), number, candidate)?;
                Some((self.choice(number, candidate).0 - cost, chain))
            };
            choose(&(FIRST..).zip(&drawn).filter_map(option).collect::<Vec<_>>(), is_clear, gap)
        };
        // Close to a barrier there is no room to sway.
        let swaying = chosen(false);
        let found = if let Err(Rejected::Barriers) = swaying { chosen(true) } else { swaying };
        found.map(|(chain, _)| chain)
    }

    /// The last steps of which `first` is the first one as it was drawn, with what they cost. The very last one may be straight.
    fn last_option(
        &self,
        pose: &Pose,
        (first, steps, is_straight): (Stance, u32, bool),
        number: u32,
        candidate: u32,
    ) -> Option<(f64, Chain)> {
        let second = |before: &Stance| {
            let draws = Draws::of(self.stream, number + 1, candidate);
            let after = self.gait.step(before, pose.foot.other(), self.share, draws);
            Some((after.last?.1, after))
        };
        let place = |pose: &Pose, shape, mut after: Stance| {
            after.last = Some((pose.foot, shape));
            let step = PlacedStep::new(pose.foot, pose.at, pose.heading, shape);
            (Pose::after(&step, after), (step, after))
        };
        let mut chain = Chain::new();
        let (mut at, mut cost, mut common) = (*pose, 0.0, None);
        let (mut shape, mut after) = (first.last?.1, first);
        if steps > 1 {
            let target = seen(self.goal - pose.at, pose.heading);
            let (next, _) = second(&first)?;
            let both = end_of(&shape) + turned(end_of(&next), shape.curve().tangent(1.0));
            let scale = target.norm() / both.norm().max(1e-9);
            // Half of the turn of both steps.
            let by = angle(both, target);
            shape = turn::bent(&shape, by, scale);
            if !turn::is_legal(&shape) {
                return None;
            }
            let (next, made) = place(pose, shape, first);
            (at, common) = (next, Some(scale));
            cost += by.abs();
            chain.push(made);
            (shape, after) = second(&at.stance)?;
        }
        let fit = if is_straight { turn::straightened } else { turn::fitted };
        let (shape, scale, by) = fit(&shape, seen(self.goal - at.at, at.heading))?;
        let uneven = scale / common.unwrap_or(scale);
        cost += by.abs() + (uneven - 1.0).abs();
        chain.push(place(&at, shape, after).1);
        Some((DETOUR * 0.35 * cost, chain))
    }
}
