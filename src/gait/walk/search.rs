//! A person's walk to a goal point: the next step, or all of them.

use super::candidate::Pose;
use super::guided::Rejected;
use super::last::Chain;
use super::no_step::NoStep;
use super::others::{Gaps, least_gap};
use super::placed::{PlacedStep, angle};
use super::task::{HybridAStar, Search, Walk};
use super::turn;
use super::walker::Walker;
use crate::base::geometry::{Vec2, rotated};
use crate::gait::{Draws, Stance};
use crate::route::grid::Way;
use std::f64::consts::{FRAC_PI_2, PI};

/// Somebody at most this far from the goal, m, is there.
const THERE: f64 = 1e-6;

/// Standard deviation of the direction in which somebody without a heading sets off, rad.
const NOISE: f64 = 5.0 * PI / 180.0;

/// Somebody who walks stops and turns on the spot if the way leads back by more than this, rad; before the last step if it
/// leads aside by more than the other.
const BACK: f64 = 100.0 * PI / 180.0;
const ASIDE: f64 = 40.0 * PI / 180.0;

/// Radii of the arc of a turn on the spot that are tried, m; the last one for who touches a barrier nearly.
const ARCS: [f64; 3] = [0.03, 1e-3, 1e-8];

/// The search where all candidates meet barriers.
const FALLBACK: HybridAStar =
    HybridAStar { cell: 0.08, starters: 30, successors: 10, expansions: 3000, is_as_published: false };

/// The draws of the heading at the begin have this number.
const HEADING: u32 = 4095;

impl Walk<'_> {
    /// The next step of a person, who has made it afterwards; `None` at the goal. Without a step the person does not change.
    /// `others` is the gap to other bodies on a step: steps that meet one are not made, steps with small gaps rarely. A retry
    /// with the same number draws the same candidates.
    pub fn next(&self, walker: &mut Walker, others: Option<Gaps>) -> Result<Option<PlacedStep>, NoStep> {
        if self.is_over(walker) {
            return Ok(None);
        }
        if let Some((step, after)) = walker.planned.last().copied()
            && (step.start - walker.at).norm() <= THERE
            && others.is_none_or(|others| others(&step) > 0.0)
        {
            walker.planned.pop();
            walker.make(&step, &after);
            return Ok(Some(step));
        }
        if !self.ground.is_free(self.goal) {
            return Err(NoStep::GoalBlocked);
        }
        walker.planned.clear();
        let found = self.new_step(walker, others);
        if !matches!(found, Err(NoStep::Exhausted { .. } | NoStep::Crowded)) || walker.stance.last.is_none() {
            return found.map(Some);
        }
        // Somebody who walked into a dead end or up to others stops, and goes on from there.
        let mut stopped = walker.clone();
        stopped.stance.last = None;
        let step = self.new_step(&mut stopped, others)?;
        *walker = stopped;
        Ok(Some(step))
    }

    fn new_step(&self, walker: &mut Walker, others: Option<Gaps>) -> Result<PlacedStep, NoStep> {
        let way = self.way(walker.at).ok_or(NoStep::NoWay { x: walker.at.x, y: walker.at.y })?;
        let number = walker.number;
        if let Some(turn) = self.turn_needed(walker, &way) {
            let step = self.turned_on_the_spot(walker, turn, others)?;
            walker.make(&step, &Stance { last: None, ..walker.stance });
            return Ok(step);
        }
        let pose = self.pose(walker, &way);
        let mut chain = match self.search {
            Search::HybridAStar(search) => search.steps(self, (&pose, &way, number))?,
            Search::GridAStar => self.along_cells(walker).ok_or(NoStep::Exhausted { expansions: 0 })?,
            Search::Guided { candidates } => match self.guided_steps(&pose, &way, number, candidates, others)
            {
                Ok(chain) => chain,
                Err(Rejected::Bodies) => return Err(NoStep::Crowded),
                // Who walks up to the goal and has no last step stops first.
                Err(Rejected::Barriers)
                    if self.field.is_straight()
                        || pose.stance.last.is_some() && self.remaining(&pose, &way) == Some(1) =>
                {
                    return Err(NoStep::Exhausted { expansions: 0 });
                }
                Err(Rejected::Barriers) => FALLBACK.steps(self, (&pose, &way, number))?,
            },
        };
        chain.reverse();
        let (step, after) = chain.pop().ok_or(NoStep::Exhausted { expansions: 0 })?;
        if others.is_some_and(|others| others(&step) <= 0.0) {
            return Err(NoStep::Crowded);
        }
        walker.planned = chain;
        walker.make(&step, &after);
        Ok(step)
    }

    /// Whether a step meets no barrier, and none of those around whom the walk leads.
    pub(super) fn is_clear(&self, step: &PlacedStep) -> bool {
        let reach = self.ground.free().reach();
        self.ground.is_clear(step) && (self.around.is_empty() || least_gap(step, reach, self.around) > 0.0)
    }

    /// All steps of a person to the goal.
    pub fn whole(&self, mut walker: Walker) -> Result<Vec<PlacedStep>, NoStep> {
        let length = self.way(walker.at).map_or(0.0, |way| way.length);
        let most = 40 + (8.0 * length / self.usual().max(0.01)) as u32;
        let mut steps = Vec::new();
        for _ in 0..most {
            match self.next(&mut walker, None)? {
                Some(step) => steps.push(step),
                None => return Ok(steps),
            }
        }
        Err(NoStep::TooLong { steps: most })
    }

    /// Whether a person is where the walk ends: at the goal point; in the paper where the search ends, near it.
    pub fn is_over(&self, walker: &Walker) -> bool {
        let is_as_published = matches!(self.search, Search::HybridAStar(search) if search.is_as_published);
        (walker.at - self.goal).norm() <= THERE
            || is_as_published && walker.planned.is_empty() && walker.stance.last.is_some()
    }

    /// The way to the goal from a place.
    pub(super) fn way(&self, from: Vec2) -> Option<Way> {
        self.field.way(self.ground.grid(), from, self.goal)
    }

    fn guided_steps(
        &self,
        pose: &Pose,
        way: &Way,
        number: u32,
        candidates: u32,
        others: Option<Gaps>,
    ) -> Result<Chain, Rejected> {
        if let Some(steps) = self.remaining(pose, way) {
            let last = self.last_steps((pose, steps, number), candidates, others);
            if last.is_ok() || steps == 1 {
                return last;
            }
        }
        self.guided((pose, way, number), candidates, others).map(|step| vec![step])
    }

    /// The angle, rad, by which somebody turns on the spot before the next step.
    fn turn_needed(&self, walker: &Walker, way: &Way) -> Option<f64> {
        if self.search == Search::GridAStar {
            return None;
        }
        let error = angle(walker.heading?, way.direction);
        let is_standing = walker.stance.last.is_none();
        let is_close = way.is_straight && way.length < self.usual();
        let widest = if is_standing {
            turn::WIDEST
        } else if is_close {
            ASIDE
        } else {
            BACK
        };
        (error.abs() > widest).then(|| error.clamp(-FRAC_PI_2, FRAC_PI_2))
    }

    fn turned_on_the_spot(
        &self,
        walker: &Walker,
        by: f64,
        others: Option<Gaps>,
    ) -> Result<PlacedStep, NoStep> {
        let heading = walker.heading.unwrap_or(Vec2::x());
        let steps = ARCS.map(|radius| {
            let shape = turn::on_the_spot(by, radius, self.gait.duration());
            PlacedStep::new(walker.foot, walker.at, heading, shape)
        });
        let mut clear = steps.iter().filter(|step| self.ground.is_clear(step)).peekable();
        if clear.peek().is_none() {
            return Err(NoStep::Exhausted { expansions: 0 });
        }
        let gap = |step: &PlacedStep| others.is_none_or(|others| others(step) > 0.0);
        clear.find(|step| gap(step)).copied().ok_or(NoStep::Crowded)
    }

    /// Where the next step begins. The path of somebody who stands may begin in any direction.
    fn pose(&self, walker: &Walker, way: &Way) -> Pose {
        let pose = |heading| Pose { at: walker.at, heading, stance: walker.stance, foot: walker.foot };
        if let (Some(heading), Some(_)) = (walker.heading, walker.stance.last) {
            return pose(heading);
        }
        let [noise, _] = Draws::of(self.stream, walker.number, HEADING).normal_pair(0);
        pose(rotated(way.direction, NOISE * noise))
    }
}
