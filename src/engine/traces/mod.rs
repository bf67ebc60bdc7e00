//! Traces for pages: trials that stand behind results, run again after the verdict and kept with thinned positions, the
//! truth of the atoms, and what decided. While sampling goes on, nothing of a trial is kept.

mod bar;
mod behind;
mod motion;
mod recorded;

pub use bar::Bar;
pub use behind::FIRST;
pub use motion::{Membership, Millimetres, Motion, PlannedWay, SPACING, Track};
pub use recorded::{Walk, recorded};

use crate::base::lanes::Mask;
use crate::base::tick::{Clock, Tick};
use crate::compile::Study;
use crate::engine::call::Call;
use crate::engine::outcome::{CallResult, Shows, Witness};
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::{self, Inspected};
use crate::kernel::process::ViewReadings;
use crate::kernel::{Address, End, Program, Run, State, start};
use crate::logic;
use crate::model::Scenario;
use crate::trials::budget::Budget;
use crate::trials::cell::{Item, Reading};
use crate::trials::group::ColumnGroup;
use bar::Bars;
use behind::{Pick, Reason};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How long a trial is followed after it was decided, s.
const AFTERWARDS: f64 = 3.0;
/// Jumps between two looks at the clock, and the most jumps that are followed.
const LOOK: u64 = 1 << 12;
const MOST_JUMPS: u64 = 1 << 16;
/// Frames may lie so much farther apart before a trace is left out, s.
const COARSE: f64 = 0.8;

/// A trial that was run again.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Its scenario.
    pub scenario: Arc<Scenario>,
    /// Index of the trial.
    pub trial: u64,
    /// What it is called where it is no trial but a recording.
    pub recording: Option<String>,
    /// The move or path that was followed, if one was.
    pub option: Option<String>,
    /// Where the agents were.
    pub motion: Motion,
    /// Time of the last state, s; steps where steps have no length.
    pub end: f64,
    /// What it shows.
    pub shows: Vec<Shown>,
}

impl Trace {
    /// How many numbers there are when it is thinned.
    pub fn least(&self) -> usize {
        (self.motion.numbers() as f64 * (self.motion.spacing / COARSE).min(1.0)) as usize
    }

    /// Unit of the times: `s`, or `steps` where steps have no length.
    pub fn unit(&self) -> &'static str {
        if self.scenario.clock == Clock::Steps { "steps" } else { "s" }
    }
}

/// What a trace shows of a result.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Place of the result in the run.
    pub result: usize,
    /// The option or side that was run; empty where there is one.
    pub label: String,
    /// What the trial is an example of; `None` of a metric of which it is no extreme, and where it is unresolved.
    pub shows: Option<Shows>,
    /// What decided the trial; `None` where it is unresolved.
    pub witness: Option<Witness>,
    /// The atoms of the formula.
    pub bars: Vec<Bar>,
}

/// The traces of a run.
#[derive(Clone, Debug, Default)]
pub struct Traces {
    /// The most important first.
    pub list: Vec<Trace>,
    /// How many more there would be, had there been room and time.
    pub left_out: usize,
}

/// Runs the trials that stand behind the results of a run again, as long as there is time, and as their positions are at
/// most `room` numbers when thinned.
pub fn traces(study: &Study, run: &CallResult, call: &Call<'_>, budget: &Budget, room: usize) -> Traces {
    let mut worlds: BTreeMap<usize, Option<PreparedWorld>> = BTreeMap::new();
    let mut found = Traces::default();
    let mut numbers = 0;
    for pick in behind::picks(study, run) {
        if numbers > room || budget.is_late() {
            found.left_out += 1;
            continue;
        }
        let make = || PreparedWorld::of(study, pick.world, call.seed, call.drivers);
        let Some(prepared) = worlds.entry(pick.world).or_insert_with(make) else { continue };
        let Some(trace) = trace(prepared, &pick, (run, call, budget)) else {
            found.left_out += 1;
            continue;
        };
        numbers += trace.least();
        found.list.push(trace);
    }
    found
}

/// Runs a trial again until it is decided for all its reasons, and a little longer. `None` where it cannot start, and where
/// the time is over.
fn trace(
    prepared: &PreparedWorld,
    pick: &Pick,
    (result, call, budget): (&CallResult, &Call<'_>, &Budget),
) -> Option<Trace> {
    let scenario = &prepared.program.scenario;
    let item = Item { advice: pick.advice, index: pick.trial };
    let (run, _) = Run::of(&prepared.program, item.address(call.seed)).ok()?;
    let (motion, end, seen) = if scenario.clock.is_jumps() {
        let (end, seen) = follow_jumps(prepared, run, &pick.reasons, budget);
        (Motion::new(scenario), end, seen)
    } else {
        follow_steps(prepared, run, &pick.reasons, budget)?
    };
    let one = |(reason, Seen { bars, reading }): (&Reason, Seen)| {
        let truth = reading.and_then(|reading| reading.truth());
        let truth = truth.map(|truth| if truth { Shows::Holds } else { Shows::Fails });
        let is_resolved = matches!(reading, Some(Reading::Truth(_) | Reading::Value(_)));
        let known = reason.witness.clone();
        let shows = known.as_ref().map(|witness| witness.shows).or(truth);
        let find = || {
            let (column, advice, settings) = (reason.column, pick.advice, &reason.settings[..]);
            let unit = &result.results[reason.result].unit;
            let of = Inspected { prepared, column, advice, settings, unit };
            witness::witness(of, (truth.unwrap_or(Shows::Lowest), pick.trial), (call, budget))
        };
        let witness = known.or_else(|| if is_resolved { find() } else { None });
        Shown { result: reason.result, label: reason.label.clone(), shows, witness, bars }
    };
    let shows = pick.reasons.iter().zip(seen).map(one).collect();
    let option = witness::label(prepared, pick.advice);
    Some(Trace { scenario: scenario.clone(), trial: pick.trial, recording: None, option, motion, end, shows })
}

/// What was seen of a trial for a reason.
struct Seen {
    bars: Vec<Bar>,
    /// What the column came to; `None` where the trial ended before.
    reading: Option<Reading>,
}

/// A column that is watched.
struct Watched<'p> {
    group: ColumnGroup,
    bars: Bars<'p>,
    reading: Option<Reading>,
}

fn follow_steps(
    prepared: &PreparedWorld,
    mut run: Run<'_>,
    reasons: &[Reason],
    budget: &Budget,
) -> Option<(Motion, f64, Vec<Seen>)> {
    let scenario = &prepared.program.scenario;
    let mut motion = Motion::new(scenario);
    let mut watched = Vec::new();
    for reason in reasons {
        let mut group = ColumnGroup::of(prepared, &[reason.column]).ok()?;
        group.start(0);
        watched.push(Watched { group, bars: Bars::of(prepared, reason.column), reading: None });
    }
    let afterwards = match scenario.clock {
        Clock::Stepped(step) => (AFTERWARDS / step.to_f64()).ceil() as u64,
        Clock::Steps | Clock::Jumps(_) => AFTERWARDS as u64,
    };
    let mut last = u64::MAX;
    loop {
        let tick = run.state().ticks[0];
        let time = scenario.clock.seconds(Tick(tick));
        motion.see(scenario, run.state());
        for Watched { group, bars, reading } in &mut watched {
            let lost = group.read(&run).has(0) || (group.follows[0] && run.state().queues.reused.has(0));
            let readings = &group.readings;
            bars.see(time, |atom| readings.atoms[atom].has(0), |signal| readings.signals[signal].0[0]);
            if reading.is_none() && lost {
                *reading = Some(Reading::Unresolved);
            } else if reading.is_none() {
                group.observers[0].observe(Mask::lane(0), readings);
                let decided = group.observers[0].decided().has(0);
                *reading = decided.then(|| group.observers[0].reading(0));
            }
        }
        if last == u64::MAX && watched.iter().all(|one| one.reading.is_some()) {
            last = tick.saturating_add(afterwards);
        }
        if budget.is_late() {
            return None;
        }
        if tick >= last || run.next_state().is_err() {
            motion.finish();
            let seen = watched.into_iter().map(|one| Seen { bars: one.bars.list, reading: one.reading });
            return Some((motion, time, seen.collect()));
        }
    }
}

fn follow_jumps(
    prepared: &PreparedWorld,
    mut run: Run<'_>,
    reasons: &[Reason],
    budget: &Budget,
) -> (f64, Vec<Seen>) {
    let mut watched = Vec::new();
    for reason in reasons {
        let monitor = prepared.signal_monitor(reason.column).ok();
        let view = prepared.view(&[reason.column]);
        watched.push((view, monitor, Bars::of(prepared, reason.column), None));
    }
    let mut seen = ViewReadings::default();
    let horizon = prepared.program.scenario.clock.seconds(prepared.horizon);
    let mut end = 0.0;
    for jump in 0..MOST_JUMPS {
        let state = run.state();
        let now = state.clocks.instant(0);
        end = now.seconds;
        let mut is_over = true;
        for (view, monitor, bars, reading) in &mut watched {
            view.look(state, &mut seen);
            let (atoms, signals) = view.of(state, &mut seen, 0);
            bars.see(now.seconds, |atom| atoms[atom], |signal| signals[signal]);
            if let (Some(monitor), None) = (monitor, &reading) {
                *reading = monitor.jump(now, atoms, signals);
                is_over &= reading.is_some();
            }
        }
        if is_over || (jump % LOOK == LOOK - 1 && budget.is_late()) {
            break;
        }
        if run.next_state().is_err() {
            end = horizon;
            for (_, monitor, _, reading) in &mut watched {
                if let (Some(monitor), None) = (monitor, &reading) {
                    monitor.finish();
                    *reading = monitor.reading();
                }
            }
            break;
        }
    }
    let told = |reading: logic::Reading| match reading {
        logic::Reading::Truth(truth) => Reading::Truth(truth),
        logic::Reading::Value(value) => Reading::Value(value),
        logic::Reading::Unresolved => Reading::Unresolved,
    };
    let seen = watched.into_iter();
    let seen = seen.map(|(.., bars, reading)| Seen { bars: bars.list, reading: reading.map(told) });
    (end, seen.collect())
}

/// A trial of a program up to a tick or to where it ends, without results. `ended` learns why it ended, and in which state.
///
/// # Errors
/// When the trial cannot start.
pub fn simulated(
    program: &Program,
    address: Address<'_>,
    last: Tick,
    ended: impl FnOnce(&State, End),
) -> Result<Trace, start::Fault> {
    let scenario = &program.scenario;
    let (run, _) = Run::of(program, address)?;
    let mut run = run.until(last);
    let mut motion = Motion::new(scenario);
    let is_jumps = scenario.clock.is_jumps();
    loop {
        if !is_jumps {
            motion.see(scenario, run.state());
        }
        if let Err(end) = run.next_state() {
            ended(run.state(), end);
            break;
        }
    }
    motion.finish();
    let end = scenario.clock.seconds(if is_jumps { last } else { Tick(run.state().ticks[0]) });
    let option = address.advice.and_then(|advice| scenario.move_name(advice));
    let (scenario, trial) = (scenario.clone(), address.key.index);
    Ok(Trace { scenario, trial, recording: None, option, motion, end, shows: Vec::new() })
}
