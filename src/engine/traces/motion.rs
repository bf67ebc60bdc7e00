//! Where the agents of a trial were: positions in whole millimetres at evenly spaced states.

use crate::base::geometry::Vec2;
use crate::base::tick::{Clock, Tick};
use crate::kernel::plan::Plan;
use crate::kernel::{Slot, State};
use crate::model::{AgentId, Parameter, Period, Scenario};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// Time between two frames, s: the largest whole number of steps that is not longer, but one step at least.
pub const SPACING: f64 = 0.1;
/// Most numbers that are kept of a trial; one that has more keeps every second frame.
const MOST_NUMBERS: usize = 1 << 22;
/// How many points of a trajectory are kept.
const POINTS: u32 = 24;

/// A place in whole millimetres.
pub type Millimetres = [i32; 2];

/// The agents of a trial, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// Time between two frames, s; steps where steps have no length.
    pub spacing: f64,
    /// Number of frames; the first one is that of time 0.
    pub frames: usize,
    /// Who was where, in the order of coming in.
    pub tracks: Vec<Track>,
    /// What agents planned, in the order of time.
    pub plans: Vec<PlannedWay>,
    /// Groups that change, in the order of time.
    pub memberships: Vec<Membership>,
    /// Ticks between two frames.
    every: u64,
    /// The track that goes on, and the number of the person on the place, agent by agent.
    open: Vec<Option<(usize, u32)>>,
    /// The plan that was seen last, agent by agent.
    seen: Vec<Plan>,
    /// Numbers in tracks and plans.
    numbers: usize,
}

/// An agent from coming in to leaving.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    /// Its number in the scenario.
    pub agent: usize,
    /// Its name; that of a person who came in by a source has the number of the arrival.
    pub name: String,
    /// Radius of its body, mm.
    pub radius: i32,
    /// The first frame.
    pub first: usize,
    /// Where it was from that frame on.
    #[serde(flatten, serialize_with = "differences")]
    pub points: Vec<Millimetres>,
}

/// What an agent plans from a frame on; no points where it goes without a plan again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedWay {
    /// Its number in the scenario.
    pub agent: usize,
    /// The first frame.
    pub first: usize,
    /// The points of the way.
    #[serde(flatten, serialize_with = "differences")]
    pub points: Vec<Millimetres>,
}

/// A member of a group from a frame on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Membership {
    /// The first frame.
    pub first: usize,
    /// Number of the agent.
    pub agent: usize,
    /// Number of the group; in none for `None`.
    pub group: Option<u64>,
}

/// The first place, then the differences, as `x` and `y`: they are short to write.
fn differences<S: Serializer>(points: &[Millimetres], to: S) -> Result<S::Ok, S::Error> {
    let of = |axis: usize| -> Vec<i32> {
        let before = std::iter::once(0).chain(points.iter().map(|point| point[axis]));
        points.iter().zip(before).map(|(point, before)| point[axis] - before).collect()
    };
    to.collect_map([("x", of(0)), ("y", of(1))])
}

pub(super) fn millimetres(place: Vec2) -> Millimetres {
    [place.x, place.y].map(|part| (part * 1000.0).round() as i32)
}

impl Motion {
    /// No frame yet.
    pub(super) fn new(scenario: &Scenario) -> Self {
        let every = match scenario.clock {
            Clock::Stepped(step) => (SPACING / step.to_f64() + 1e-9).floor().max(1.0) as u64,
            Clock::Steps | Clock::Jumps(_) => 1,
        };
        Self {
            spacing: scenario.clock.seconds(Tick(every)),
            every,
            open: vec![None; scenario.agents.len()],
            seen: vec![Plan::Straight; scenario.agents.len()],
            ..Self::default()
        }
    }

    /// That of a recording, with the time between two frames, s, and their number.
    pub(super) fn recorded(
        (spacing, frames): (f64, usize),
        tracks: Vec<Track>,
        memberships: Vec<Membership>,
    ) -> Self {
        let mut motion = Self { spacing, frames, tracks, memberships, ..Self::default() };
        motion.count();
        while motion.numbers > MOST_NUMBERS {
            motion.halve();
        }
        motion.finish();
        motion
    }

    /// The next state, which is kept if its turn has come.
    pub(super) fn see(&mut self, scenario: &Scenario, state: &State) {
        if !state.ticks[0].is_multiple_of(self.every) {
            return;
        }
        for agent in 0..scenario.agents.len() {
            self.see_agent(scenario, state, agent);
        }
        self.frames += 1;
        if self.numbers > MOST_NUMBERS {
            self.halve();
        }
    }

    fn see_agent(&mut self, scenario: &Scenario, state: &State, agent: usize) {
        let slot = state.slot(agent, 0);
        if !state.is_present(slot) {
            self.open[agent] = None;
            return;
        }
        let place = millimetres(state.position(slot));
        let person = state.queues.later(agent, 0);
        self.numbers += 2;
        match self.open[agent] {
            Some((track, last)) if last == person && !self.jumps(scenario, track, place) => {
                self.tracks[track].points.push(place);
            }
            _ => {
                self.open[agent] = Some((self.tracks.len(), person));
                self.tracks.push(Track {
                    agent,
                    name: state.name_of(scenario, AgentId(agent as u32), 0),
                    radius: (slot.of(&state.bodies[Parameter::Radius]) * 1000.0).round() as i32,
                    first: self.frames,
                    points: vec![place],
                });
            }
        }
        self.see_plan(state, (agent, slot), place);
    }

    /// Whether a track leaves a periodic scene at one end for the other: it goes on as a track of its own.
    fn jumps(&self, scenario: &Scenario, track: usize, [x, y]: Millimetres) -> bool {
        let jumps = |period: Option<Period>, way: i32| {
            period.is_some_and(|period| f64::from(way.abs()) > 500.0 * period.length)
        };
        let periods = scenario.scene.periods;
        let Some([old_x, old_y]) = self.tracks[track].points.last() else { return false };
        let at = |x: &i32, y: &i32| Vec2::new(f64::from(*x), f64::from(*y)) / 1000.0;
        jumps(periods.x, x - old_x)
            || jumps(periods.y, y - old_y)
            || scenario.scene.storeys.separate(at(old_x, old_y), at(&x, &y))
    }

    fn see_plan(&mut self, state: &State, (agent, slot): (usize, Slot), place: Millimetres) {
        let Some(plan) = state.plans.plan(slot).filter(|plan| !is_same(plan, &self.seen[agent])) else {
            return;
        };
        let points: Vec<Millimetres> = match plan {
            Plan::Way(points) | Plan::Through(points) => {
                std::iter::once(place).chain(points.iter().map(|p| millimetres(*p))).collect()
            }
            Plan::Follow(trajectory, _) => {
                let at = |k: u32| trajectory.at(trajectory.duration() * f64::from(k) / f64::from(POINTS))[0];
                (0..=POINTS).map(|k| millimetres(at(k))).collect()
            }
            _ => Vec::new(),
        };
        let was_shown = is_shown(&self.seen[agent]);
        self.seen[agent] = plan.clone();
        if was_shown || !points.is_empty() {
            self.numbers += 2 * points.len();
            self.plans.push(PlannedWay { agent, first: self.frames, points });
        }
    }

    /// Every second frame is dropped.
    pub fn halve(&mut self) {
        for track in &mut self.tracks {
            let mut frame = track.first;
            track.points.retain(|_| {
                frame += 1;
                frame % 2 == 1
            });
            track.points.shrink_to_fit();
            track.first = track.first.div_ceil(2);
        }
        for plan in &mut self.plans {
            plan.first = plan.first.div_ceil(2);
        }
        for membership in &mut self.memberships {
            membership.first = membership.first.div_ceil(2);
        }
        (self.frames, self.every, self.spacing) =
            (self.frames.div_ceil(2), 2 * self.every, 2.0 * self.spacing);
        self.count();
    }

    /// Only some of the agents stay.
    pub fn keep(&mut self, is_kept: impl Fn(&Track) -> bool) {
        self.tracks.retain(&is_kept);
        let kept: std::collections::BTreeSet<usize> = self.tracks.iter().map(|track| track.agent).collect();
        self.plans.retain(|plan| kept.contains(&plan.agent));
        self.memberships.retain(|one| kept.contains(&one.agent));
        self.count();
    }

    /// Tracks between two frames leave no point, and are dropped.
    pub(super) fn finish(&mut self) {
        self.tracks.retain(|track| !track.points.is_empty());
        (self.open, self.seen) = (Vec::new(), Vec::new());
    }

    /// How many numbers there are in tracks and plans.
    pub fn numbers(&self) -> usize {
        self.numbers
    }

    fn count(&mut self) {
        let tracks: usize = self.tracks.iter().map(|track| track.points.len()).sum();
        let plans: usize = self.plans.iter().map(|plan| plan.points.len()).sum();
        self.numbers = 2 * (tracks + plans);
    }
}

/// Whether a plan is the one that was seen last.
fn is_same(plan: &Plan, last: &Plan) -> bool {
    match (plan, last) {
        (Plan::Way(a), Plan::Way(b)) | (Plan::Through(a), Plan::Through(b)) => Arc::ptr_eq(a, b),
        (Plan::Follow(a, _), Plan::Follow(b, _)) => Arc::ptr_eq(a, b),
        _ => !is_shown(plan) && !is_shown(last),
    }
}

/// Whether a plan is drawn.
fn is_shown(plan: &Plan) -> bool {
    matches!(plan, Plan::Way(_) | Plan::Through(_) | Plan::Follow(..))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(first: usize, places: &[i32]) -> Track {
        let points = places.iter().map(|x| [*x, 0]).collect();
        Track { agent: 0, name: "a".into(), radius: 200, first, points }
    }

    #[test]
    fn every_second_frame_stays_at_its_time() {
        // The x of a point is ten times its frame.
        let tracks = vec![track(0, &[0, 10, 20, 30, 40]), track(3, &[30, 40]), track(3, &[30])];
        let mut motion = Motion { spacing: 0.1, frames: 5, tracks, every: 5, ..Motion::default() };
        motion.halve();
        motion.finish();
        assert_eq!((motion.frames, motion.spacing, motion.every), (3, 0.2, 10));
        for track in &motion.tracks {
            for (k, [x, _]) in track.points.iter().enumerate() {
                assert_eq!(*x, 20 * (track.first + k) as i32, "{track:?}");
            }
        }
        assert_eq!(motion.tracks.len(), 2, "who was there between two frames is not shown");
        assert_eq!(motion.numbers(), 8);
    }
}
