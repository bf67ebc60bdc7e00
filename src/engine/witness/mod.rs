//! Witnesses: the first trial that fails and the first that passes, or those with the smallest and the largest
//! value of a metric; when that was decided, and by what.

mod blame;
pub(in crate::engine) mod cause;
mod checkpoints;
mod culprits;
pub(in crate::engine) mod decider;
mod grounds;
mod recall;

use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::base::tick::{Clock, Tick};
use crate::engine::call::Call;
use crate::engine::outcome::{Shows, Witness};
use crate::engine::sampling::tally::Tally;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::blame::{Explained, Said};
use crate::engine::witness::checkpoints::Checkpoints;
use crate::kernel::{Address, Run};
use crate::logic::{Root, Sought};
use crate::trials::budget::Budget;
use crate::trials::cell::Item;
use crate::trials::group::ColumnGroup;
use crate::trials::observer::Observer;

/// The trials that show why a measure of truth values came out as it did.
pub(in crate::engine) fn sides(tally: &Tally) -> Vec<(Shows, u64)> {
    named([(Shows::Fails, tally.first[1]), (Shows::Holds, tally.first[0])])
}

/// The trials that show how far a metric ranges.
pub(in crate::engine) fn extremes(tally: &Tally) -> Vec<(Shows, u64)> {
    let [lowest, highest] = tally.extremes.map(|extreme| extreme.map(|(index, _)| index));
    named([(Shows::Lowest, lowest), (Shows::Highest, highest)])
}

fn named(picks: [(Shows, Option<u64>); 2]) -> Vec<(Shows, u64)> {
    picks.into_iter().filter_map(|(shows, index)| Some((shows, index?))).collect()
}

/// What is asked of the trials that are shown.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Inspected<'s> {
    pub(in crate::engine) prepared: &'s PreparedWorld,
    pub(in crate::engine) column: usize,
    /// The option of moves that is followed, if one is.
    pub(in crate::engine) advice: Option<(usize, usize)>,
    /// Values of swept and `under` parameters.
    pub(in crate::engine) settings: &'s [(String, String)],
    /// The unit of a metric.
    pub(in crate::engine) unit: &'s str,
}

/// The command that shows a trial.
pub(in crate::engine) fn command(
    call: &Call<'_>,
    prepared: &PreparedWorld,
    settings: &[(String, String)],
    item: Item,
) -> String {
    let command = call.line.simulate(settings, call.seed, item.index);
    match label(prepared, item.advice) {
        Some(label) => format!("{command} --move '{label}'"),
        None => command,
    }
}

/// The name of a suggested move, as `smc simulate` takes it.
pub(in crate::engine) fn label(prepared: &PreparedWorld, advice: Option<(usize, usize)>) -> Option<String> {
    prepared.program.scenario.move_name(advice?)
}

/// Runs a trial again and says what decided it. `None` where the time is over.
pub(in crate::engine) fn witness(
    inspected: Inspected<'_>,
    (shows, trial): (Shows, u64),
    (call, budget): (&Call<'_>, &Budget),
) -> Option<Witness> {
    let Inspected { prepared, column, advice, settings, unit: dimension } = inspected;
    let program = &prepared.program;
    let unit = if program.scenario.clock == Clock::Steps { "steps" } else { "s" };
    let command = command(call, prepared, settings, Item { advice, index: trial });
    let (what, decider, agents) = Default::default();
    let blank = Witness { shows, trial, value: None, time: 0.0, unit, what, decider, agents, command };
    if program.scenario.clock.is_jumps() {
        let (time, value, what) = recall::decision(prepared, column, (trial, call.seed), dimension, budget)?;
        return Some(Witness { value, time, what, ..blank });
    }
    let mut group = ColumnGroup::of(prepared, &[column]).ok()?;
    // Where a robustness leaves its range a trial ends; here it is shown what it is, if the trial goes on so long.
    let mut clipped = None;
    if let Observer::Robustness(_, sought @ Sought::Clipped(..)) = &mut group.observers[0] {
        *sought = Sought::Value;
        clipped = Observer::of(prepared, column).ok();
    }
    // When it left its range.
    let mut left = None;
    let key = TrialKey { seed: call.seed, index: trial, branch: 0 };
    let (mut run, _) = Run::of(program, Address { advice, ..key.into() }).ok()?;
    let lane = Mask::lane(0);
    group.start(0);
    if let Some(clipped) = &mut clipped {
        clipped.start(0);
    }
    let mut record = blame::Record::default();
    let most = MOST_KEPT.min(MOST_AGENTS_KEPT / program.scenario.agents.len().max(1));
    let mut kept = Checkpoints::new(most);
    loop {
        let state = run.state();
        let lost = group.read(&run).has(0) || (group.follows[0] && state.queues.reused.has(0));
        if clipped.is_some() && (lost || run.ended().has(0)) {
            let seconds = |tick: u64| program.scenario.clock.seconds(Tick(tick));
            let end = seconds(state.ticks[0]);
            let what = format!("outside its range by an unknown amount: the trial ends at {end} {unit}");
            return Some(Witness { time: left.map_or(end, seconds), what, ..blank });
        }
        let readings = &group.readings;
        group.observers[0].observe(lane, readings);
        if let Some(clipped) = clipped.as_mut().filter(|_| left.is_none()) {
            clipped.observe(lane, readings);
            left = clipped.decided().has(0).then(|| state.ticks[0]);
        }
        record.push(readings);
        kept.offer(state.ticks[0], || state.clone());
        if group.observers[0].decided().has(0) {
            break;
        }
        if budget.is_late() {
            return None;
        }
        if run.next_state().is_err() {
            break;
        }
    }
    let observer = &group.observers[0];
    let state_at = |tick: Tick| {
        let (_, state) = kept.last(|number, _| number <= tick.0)?;
        let mut run = Run::from_state(program, state);
        while run.state().ticks[0] < tick.0 {
            run.next_state().ok()?;
        }
        Some(run.state().clone())
    };
    let now = Tick(run.state().ticks[0]);
    let explain = |look: &dyn Fn(&Explained<'_>) -> (Option<Tick>, Said)| {
        record.explain(prepared, budget, &state_at, look).unwrap_or_default()
    };
    let (value, at, said) = match (prepared.columns[column], observer) {
        (Root::Formula(root), Observer::Formula(monitor)) => {
            let (_, said) = explain(&|trial| (None, trial.truth(root)));
            (None, Tick(monitor.decided_at()[0]), said)
        }
        (Root::Robustness(root, _), _) => {
            let value = observer.reading(0).value();
            let (at, said) = explain(&|trial| trial.margin(root, value, dimension));
            (value, at.unwrap_or(now), said)
        }
        (Root::Metric(root), Observer::Metric(monitor)) => {
            // The monitor may know the value before the last state of a window.
            let value = monitor.value().0[0];
            let (at, said) = explain(&|trial| trial.number(root, value, dimension));
            let said = Said { decider: None, ..said };
            (Some(value), at.unwrap_or(Tick(monitor.decided_at()[0])), said)
        }
        _ => return None,
    };
    let time = program.scenario.clock.seconds(at);
    let Said { words: what, decider, agents } = said;
    Some(Witness { value, time, what, decider, agents, ..blank })
}

/// Most states that are kept of a trial, and that number times that of agents.
const MOST_KEPT: usize = 64;
const MOST_AGENTS_KEPT: usize = 1 << 17;
