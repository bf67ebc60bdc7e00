//! The trials of `smc walk`: each is run until all legs that are asked for have ended. One trial is one lane, whatever the
//! number of threads, and results are put in order of trials.

use crate::base::geometry::Vec2;
use crate::base::math;
use crate::base::random::TrialKey;
use crate::base::tick::Tick;
use crate::engine::{Executor, Threads, divergence, no_start};
use crate::gait::{Foot, present_foot};
use crate::kernel::{End, Program, Run, State};
use crate::report::walked::{LegWalk, Place};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Whoever is slower keeps the heading, m/s.
const STANDS: f64 = 1e-6;

/// What is wanted of each trial.
#[derive(Debug)]
pub(super) struct Task<'p> {
    pub(super) program: &'p Program,
    pub(super) seed: u64,
    pub(super) trials: u64,
    /// Agents by number, and how many legs their routes have.
    pub(super) agents: Vec<(usize, usize)>,
    /// Whether places are kept, not only lengths and times.
    pub(super) keeps_places: bool,
}

/// What one trial gave.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    /// The legs that ended, agent by agent.
    pub(super) walks: Vec<Vec<LegWalk>>,
    /// Why it did not start or ended before the legs and the horizon, and whether the model is wrong.
    pub(super) broken: Option<(String, bool)>,
    pub(super) has_no_way: bool,
    pub(super) has_shrunk: bool,
}

/// An agent in a state: how many steps are made or begun, and with which foot.
#[derive(Clone, Copy)]
struct Moment {
    position: Vec2,
    heading: f64,
    steps: f64,
    foot: Option<Foot>,
}

impl Moment {
    fn now(state: &State, agent: usize, before: Option<&Self>) -> Self {
        let slot = state.slot(agent, 0);
        let at = |field: &[crate::base::lanes::Lanes]| field[slot.block].0[slot.lane];
        let mut along = Vec2::new(at(&state.motion.vx), at(&state.motion.vy));
        let heading = match before {
            Some(before) if along.norm() < STANDS => before.heading,
            _ => {
                if along.norm() < STANDS {
                    along = Vec2::new(at(&state.driving.ex), at(&state.driving.ey));
                }
                math::atan2(along.y, along.x).to_degrees()
            }
        };
        Self {
            position: Vec2::new(at(&state.motion.x), at(&state.motion.y)),
            heading,
            steps: at(&state.progress.steps) + f64::from(u8::from(state.plans.is_stepping(slot))),
            foot: present_foot(state, slot),
        }
    }
}

/// The places of a leg from its moments, with so many steps in the end and on the leg.
fn places(moments: &[Moment], made: f64, on_leg: f64) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::with_capacity(moments.len());
    for moment in moments {
        let number = moment.steps - (made - on_leg);
        let last = places.last().and_then(|place| place.step);
        // The state after the last step may already know the next one, of another leg.
        let is_known = number >= 1.0 && number <= on_leg;
        let step = moment.foot.filter(|_| is_known).map(|foot| (foot, number as u32)).or(last);
        places.push(Place { position: moment.position, heading: moment.heading, step });
    }
    places
}

impl Task<'_> {
    /// All trials, in order.
    pub(super) fn run(&self, threads: &Threads) -> Vec<Outcome> {
        let (next, done) = (AtomicU64::new(0), Mutex::new(Vec::new()));
        threads.everywhere(&|| {
            let mut run = Run::new(self.program);
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= self.trials {
                    break;
                }
                let outcome = self.one(&mut run, index);
                done.lock().unwrap_or_else(PoisonError::into_inner).push((index, outcome));
            }
        });
        let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
        done.sort_unstable_by_key(|(index, _)| *index);
        done.into_iter().map(|(_, outcome)| outcome).collect()
    }

    fn one(&self, run: &mut Run<'_>, index: u64) -> Outcome {
        let scenario = &self.program.scenario;
        let mut outcome = Outcome { walks: vec![Vec::new(); self.agents.len()], ..Outcome::default() };
        let key = TrialKey { seed: self.seed, index, branch: 0 };
        match run.start(key.into()) {
            Ok(loaded) => outcome.has_shrunk = !loaded.shrunk.is_empty(),
            Err(fault) => {
                outcome.broken = Some((format!("it cannot start: {}", no_start(scenario, fault)), false));
                return outcome;
            }
        }
        let mut moments: Vec<Vec<Moment>> = vec![Vec::new(); self.agents.len()];
        let end = loop {
            let state = run.state();
            let mut is_done = true;
            for ((&(agent, legs), walks), moments) in
                self.agents.iter().zip(&mut outcome.walks).zip(&mut moments)
            {
                if walks.len() < legs {
                    if self.keeps_places {
                        moments.push(Moment::now(state, agent, moments.last()));
                    }
                    self.collect(state, (agent, legs), walks, moments, index);
                }
                is_done &= walks.len() == legs;
            }
            if is_done {
                break None;
            }
            if let Err(end) = run.next_state() {
                break Some(end);
            }
        };
        let state = run.state();
        outcome.has_no_way = state.no_way.has(0);
        let time = scenario.clock.seconds(Tick(state.ticks[0]));
        outcome.broken = match end {
            None | Some(End::Horizon) => None,
            Some(End::Faulty(fault)) => {
                Some((format!("it ended with an error of the model: {}", fault.describe(scenario)), true))
            }
            Some(End::Full) => {
                let reason = state.queues.overrun(&scenario.sources, 0).unwrap_or_default();
                Some((format!("it is unresolved at {time} s: {reason}"), false))
            }
            Some(End::Diverged) => {
                Some((format!("it diverged at {time} s: {}", divergence(self.program, state)), false))
            }
        };
        outcome
    }

    /// Takes the legs that have ended since the state before.
    fn collect(
        &self,
        state: &State,
        (agent, legs): (usize, usize),
        walks: &mut Vec<LegWalk>,
        moments: &mut Vec<Moment>,
        trial: u64,
    ) {
        let slot = state.slot(agent, 0);
        let finished = state.progress.legs[slot.block].0[slot.lane] as usize;
        while walks.len() < finished.min(legs) {
            let leg = walks.len() as u32;
            let read = |k| state.progress.record(leg, k).map_or(f64::NAN, |of| of[slot.block].0[slot.lane]);
            let measures = [0, 1, 2].map(read);
            let states = (measures[1] / self.program.scenario.clock.step_seconds()).round() as usize;
            let since = moments.len().saturating_sub(states.saturating_add(1));
            let made = state.progress.steps[slot.block].0[slot.lane];
            let places = places(&moments[since..], made, measures[2]);
            // The next leg begins in this state at the earliest.
            moments.drain(..moments.len().saturating_sub(1));
            walks.push(LegWalk { trial, measures, places });
        }
    }
}
