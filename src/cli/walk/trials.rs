//! The trials of `smc walk`: each is run until all legs that are asked for have ended. The order of results is that of the
//! trials, whatever the number of threads.

use crate::base::geometry::Vec2;
use crate::base::math;
use crate::base::random::TrialKey;
use crate::cli::end::early_end;
use crate::engine::{Executor, Threads, no_start};
use crate::gait::{Foot, present_foot};
use crate::kernel::{End, Program, Run, Slot, State};
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
    /// Why it did not start or ended early.
    pub(super) broken: Option<String>,
    pub(super) is_wrong: bool,
    pub(super) has_no_way: bool,
    pub(super) has_shrunk: bool,
}

/// An agent in a state: steps that are made or begun since the start, and the foot of the last one.
#[derive(Clone, Copy)]
struct Moment {
    position: Vec2,
    heading: f64,
    steps: f64,
    foot: Option<Foot>,
}

impl Moment {
    fn now(state: &State, slot: Slot, before: Option<&Self>) -> Self {
        let angle = |along: Vec2| math::atan2(along.y, along.x).to_degrees();
        let along = state.velocity(slot);
        let heading = match before {
            _ if along.norm() >= STANDS => angle(along),
            Some(before) => before.heading,
            None => angle(slot.vector(&state.driving.ex, &state.driving.ey)),
        };
        Self {
            position: state.position(slot),
            heading,
            steps: slot.of(&state.progress.steps) + f64::from(u8::from(state.plans.is_stepping(slot))),
            foot: present_foot(state, slot),
        }
    }
}

/// The places of a leg from its moments, with so many steps before it and on it.
fn places(moments: &[Moment], before: f64, on_leg: f64) -> Vec<Place> {
    let mut step = None;
    let place = |moment: &Moment| {
        let number = moment.steps - before;
        // The state after the last step may already know the next one, of another leg.
        if let Some(foot) = moment.foot.filter(|_| number >= 1.0 && number <= on_leg) {
            step = Some((foot, number as u32));
        }
        Place { position: moment.position, heading: moment.heading, step }
    };
    moments.iter().map(place).collect()
}

impl Task<'_> {
    /// All trials, in order.
    pub(super) fn run(&self, threads: &Threads) -> Vec<Outcome> {
        let (next, done) = (AtomicU64::new(0), Mutex::new(Vec::new()));
        threads.everywhere(&|| {
            let mut run = Run::new(self.program);
            let index = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < self.trials);
            while let Some(index) = index() {
                let outcome = self.one(&mut run, index);
                done.lock().unwrap_or_else(PoisonError::into_inner).push((index, outcome));
            }
        });
        let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
        done.sort_unstable_by_key(|(index, _)| *index);
        done.into_iter().map(|(_, outcome)| outcome).collect()
    }

    fn one(&self, run: &mut Run<'_>, trial: u64) -> Outcome {
        let mut outcome = Outcome { walks: vec![Vec::new(); self.agents.len()], ..Outcome::default() };
        match run.start(TrialKey { seed: self.seed, index: trial, branch: 0 }.into()) {
            Ok(loaded) => outcome.has_shrunk = !loaded.shrunk.is_empty(),
            Err(fault) => {
                let why = no_start(&self.program.scenario, fault);
                return Outcome { broken: Some(format!("cannot start: {why}")), ..outcome };
            }
        }
        let mut moments: Vec<Vec<Moment>> = vec![Vec::new(); self.agents.len()];
        let end = loop {
            let state = run.state();
            let mut is_done = true;
            for (k, &(agent, legs)) in self.agents.iter().enumerate() {
                let slot = state.slot(agent, 0);
                let (walks, moments) = (&mut outcome.walks[k], &mut moments[k]);
                if self.keeps_places {
                    moments.push(Moment::now(state, slot, moments.last()));
                }
                while walks.len() < (slot.of(&state.progress.legs) as usize).min(legs) {
                    walks.push(self.ended(state, slot, walks.len(), (moments, trial)));
                }
                is_done &= walks.len() == legs;
            }
            if is_done {
                break End::Horizon;
            }
            if let Err(end) = run.next_state() {
                break end;
            }
        };
        outcome.has_no_way = run.state().no_way.has(0);
        outcome.is_wrong = matches!(end, End::Faulty(_));
        outcome.broken = early_end(self.program, run.state(), end);
        outcome
    }

    /// The walk on a leg that has ended since the state before.
    fn ended(
        &self,
        state: &State,
        slot: Slot,
        leg: usize,
        (moments, trial): (&mut Vec<Moment>, u64),
    ) -> LegWalk {
        let read = |k| state.progress.record(leg as u32, k).map_or(f64::NAN, |field| slot.of(field));
        let measures = [0, 1, 2].map(read);
        let states = (measures[1] / self.program.scenario.clock.step_seconds()).round() as usize;
        let first = moments.len().saturating_sub(states.saturating_add(1));
        let before = slot.of(&state.progress.steps) - measures[2];
        let places = places(&moments[first..], before, measures[2]);
        // The next leg begins in this state at the earliest.
        moments.drain(..moments.len().saturating_sub(1));
        LegWalk { trial, measures, places }
    }
}
