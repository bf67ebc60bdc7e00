//! Checks and estimates of one world: all of them read the same trials, each until it stops.
//!
//! Trials are run in rounds. A round is consumed trial by trial in index order, and every query looks after
//! each trial, so the size of rounds leaves no trace in a result. A procedure whose level takes a proof reads as far as
//! no level could stop it; the proofs come when the others have stopped.

use crate::base::math;
use crate::engine::fault::Fault;
use crate::engine::outcome::Stop;
use crate::engine::sampling::entry::EstimateEntry;
use crate::engine::sampling::forecast::{self, FIRST, PilotStatistics};
use crate::engine::sampling::pilot::{self, Pilot, Piloted};
use crate::engine::sampling::procedure::Procedure;
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::watch::{Forecast, Likely};
use crate::engine::trials::executor::{Cells, Executor, Job};
use crate::engine::trials::prepared::PreparedWorld;
use crate::stats::Levels;
use crate::stats::calibration::Patience;
use crate::trials::budget::Budget;
use crate::trials::cell::Item;
use std::collections::BTreeSet;

/// A trial that takes so many times as many steps for one column as for another holds that one up.
const MUCH_LONGER: f64 = 16.0;
/// Forecasts that are shorter are not worth a look at the time of a trial, s.
const WORTH_TIMING: f64 = 1.0;
/// Largest round.
pub(in crate::engine) const LARGEST_ROUND: u64 = 16_384;

/// Checks and estimates of one prepared world on their way.
pub(in crate::engine) struct EstimateSampling<'q> {
    pub(in crate::engine) job: Job<'q>,
    /// The queries.
    pub(in crate::engine) entries: Vec<EstimateEntry<'q>>,
    ahead: Option<Pilot>,
    /// The next trial.
    next: u64,
    /// Seconds that it has taken so far.
    spent: f64,
}

/// How far an estimate came in its share of the time.
pub(in crate::engine) enum Advance {
    /// Each entry has stopped.
    Stopped,
    /// Its share is over, and the time of the call is not.
    Paused,
    /// It came to a trial in which the model is wrong.
    Faulty(FaultyTrial),
    /// These columns hold the others up.
    Apart(Vec<usize>),
}

/// A trial in which the model is wrong, the first that was read.
pub(in crate::engine) struct FaultyTrial {
    /// Its index: an entry that had stopped before does not know of it.
    pub(in crate::engine) index: u64,
    /// What is wrong.
    pub(in crate::engine) fault: Fault,
}

impl Piloted for EstimateSampling<'_> {
    fn pilot(&mut self, executor: &dyn Executor, budget: &Budget) -> Result<Vec<Forecast>, Fault> {
        let width = executor.width(&self.job) as u64;
        // As many on every machine, whatever a round would be.
        let size = Pilot::size(width).min(most(&self.entries, 0, budget).max(1)).min(budget.max_trials);
        let pilot = Pilot::run(&self.job, Item::run(0, size), executor, budget)?;
        let mut seconds = pilot.seconds_per_trial(self.job.prepared.most_steps());
        let forecast = |entry: &EstimateEntry<'_>| {
            let mut statistics = PilotStatistics::default();
            let range = entry.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            if let Some(place) = self.job.columns.iter().position(|c| *c == entry.column) {
                pilot.seen().for_each(|row| statistics.read(&row[place], range));
            }
            let expected = forecast::entry(&entry.query.ask, &entry.procedure, &statistics);
            let trials = expected.unwrap_or(Likely::exactly(u64::MAX)).map(|n| n.min(budget.max_trials));
            Forecast::of(entry.query, trials, 0.0)
        };
        let mut forecasts: Vec<Forecast> = self.entries.iter().map(forecast).collect();
        let most = forecasts.iter().map(|forecast| forecast.trials.most).max().unwrap_or(0);
        if pilot.is_complete() && most as f64 * seconds > WORTH_TIMING {
            seconds = pilot::timed(&self.job, (size, seconds), executor, budget)?;
        }
        for forecast in &mut forecasts {
            forecast.seconds = forecast.trials.likely as f64 * seconds;
        }
        self.ahead = pilot.is_complete().then_some(pilot);
        Ok(forecasts)
    }

    fn is_unread(&self) -> bool {
        self.entries.iter().all(|entry| entry.tally.counts.trials == 0)
    }
}

impl<'q> EstimateSampling<'q> {
    /// An estimate of some entries about one prepared world.
    pub(in crate::engine) fn new(
        prepared: &'q PreparedWorld,
        entries: Vec<EstimateEntry<'q>>,
        seed: u64,
    ) -> Self {
        let job = Job::new(prepared, columns(entries.iter()), seed);
        Self { job, entries, ahead: None, next: 0, spent: 0.0 }
    }

    /// Leaves the entries about some columns to an estimate of their own, which goes on where this one is.
    pub(in crate::engine) fn part(&mut self, slow: &[usize]) -> Self {
        let (slow, rest) =
            std::mem::take(&mut self.entries).into_iter().partition(|i| slow.contains(&i.column));
        self.entries = rest;
        Self {
            next: self.next,
            spent: self.spent,
            ..Self::new(self.job.prepared, slow, self.job.series.seed)
        }
    }

    /// Runs until each entry has stopped, its share of the time is over, or up to a trial in which the model is wrong.
    pub(in crate::engine) fn advance(&mut self, resources: Resources<'_>) -> Result<Advance, Fault> {
        let budget = resources.budget;
        // The trials that were run ahead are its own.
        self.spent += self.ahead.as_ref().map_or(0.0, |ahead| ahead.seconds);
        let started = budget.elapsed() - self.spent;
        if budget.max_trials == 0 {
            self.entries.iter_mut().for_each(|entry| entry.stop = Some(Stop::Cap));
        }
        let mut advance = self.rounds(started, u64::MAX, resources)?;
        // Proofs come when nobody reads on without one, so that none of them keeps others from their trials.
        for k in 0..self.entries.len() {
            // Who stops before the trial in which the model is wrong does not know of it.
            let end = match &advance {
                Advance::Stopped => u64::MAX,
                Advance::Faulty(broken) => broken.index,
                Advance::Paused | Advance::Apart(_) => break,
            };
            if !self.entries[k].waits {
                continue;
            }
            match self.go_on(started, (k, end), resources)? {
                Advance::Stopped => {}
                Advance::Paused if matches!(advance, Advance::Faulty(_)) => {}
                other => advance = other,
            }
        }
        self.spent = budget.elapsed() - started;
        if !matches!(advance, Advance::Paused | Advance::Apart(_)) {
            for entry in self.entries.iter_mut().filter(|i| i.seconds == 0.0) {
                entry.seconds = self.spent;
            }
        }
        Ok(advance)
    }

    /// Proves the level for which an entry waits, and reads on, up to a trial.
    fn go_on(
        &mut self,
        started: f64,
        (k, end): (usize, u64),
        resources: Resources<'_>,
    ) -> Result<Advance, Fault> {
        let Resources { budget, levels, share, .. } = resources;
        let entry = &mut self.entries[k];
        let read = entry.tally.counts.trials;
        let capped = read >= budget.max_trials;
        let settled = prove(&entry.procedure, &mut levels.borrow_mut(), share)?;
        if settled.is_none() && !budget.must_stop() {
            return Ok(Advance::Paused);
        }
        entry.waits = false;
        entry.stop = match &settled {
            Some(procedure) if procedure.is_finished() => Some(Stop::Width),
            _ if capped => Some(Stop::Cap),
            _ => budget.reason_to_stop(),
        };
        let Some(procedure) = settled.filter(|one| one.is_finished() || entry.stop.is_none()) else {
            return Ok(Advance::Stopped);
        };
        let before = std::mem::replace(&mut entry.procedure, procedure);
        if entry.stop.is_some() {
            entry.stop = Some(entry.reason());
            entry.seconds = budget.elapsed() - started;
            return Ok(Advance::Stopped);
        }
        self.next = read;
        let advance = self.rounds(started, end, resources)?;
        let entry = &mut self.entries[k];
        let unread = entry.tally.counts.trials == read;
        match (&advance, entry.stop) {
            (Advance::Paused, _) | (_, Some(_)) if unread => {
                // Time was up: it says what it would have said without the proof.
                entry.procedure = before;
                entry.waits = entry.stop.is_none();
            }
            // It comes to the trial in which the model is wrong.
            (Advance::Stopped | Advance::Faulty(_), None) => entry.lost = true,
            _ => {}
        }
        Ok(advance)
    }

    /// Rounds over trials up to one, until nobody reads on.
    fn rounds(&mut self, started: f64, end: u64, resources: Resources<'_>) -> Result<Advance, Fault> {
        let Resources { executor, budget, share, watch, .. } = resources;
        let mut items = Vec::new();
        // A round that takes longer than this without a trial to its name is of trials that are too long for some column.
        let patience = share.seconds_left().map(|seconds| 0.5 * seconds);
        while self.next < end && self.entries.iter().any(EstimateEntry::is_open) {
            if share.must_stop() {
                if !budget.must_stop() {
                    return Ok(Advance::Paused);
                }
                close(&mut self.entries, budget);
                break;
            }
            let cells = match self.ahead.take() {
                Some(ahead) => {
                    items = ahead.items;
                    ahead.cells
                }
                None => {
                    self.job.narrow(columns(self.open()));
                    let width = executor.width(&self.job) as u64;
                    items.clear();
                    let size = round(&self.entries, self.next, width, share);
                    items.extend(Item::row(self.next, size.min(end - self.next)));
                    match patience.zip(share.seconds_left()) {
                        Some((most, left)) if most < left && self.job.columns.len() > 1 => {
                            executor.run(&self.job, &items, &share.ahead(most))?
                        }
                        _ => executor.run(&self.job, &items, share)?,
                    }
                }
            };
            if let Err(item) = self.read(&items, &cells, started, budget) {
                self.entries.iter_mut().filter(|i| i.is_open()).for_each(|i| i.lost = true);
                let fault = crate::engine::trials::trial::fault(self.job.prepared, item, self.job.series);
                return Ok(Advance::Faulty(FaultyTrial { index: item.index, fault }));
            }
            self.next += cells.ready().min(items.len()) as u64;
            if executor.is_stored()
                && cells.ready() < items.len()
                && self.entries.iter().any(EstimateEntry::is_open)
            {
                // What nobody reads any more may be what is lacking.
                if self.request(executor, self.foreseen(budget).min(end), budget) {
                    share.lack();
                }
                self.job.narrow(columns(self.open()));
            }
            let slow = if share.has_deadline() { self.slow(&cells) } else { Vec::new() };
            self.job.reuse(cells);
            if let Some(entry) = self.entries.iter().find(|i| i.is_open()) {
                let (next, procedure) = (self.next, &entry.procedure);
                let expected = forecast::entry(&entry.query.ask, procedure, &entry.statistics);
                watch.consumed(&entry.query.text, next, expected.map(|n| n.likely.max(next)));
            }
            if !slow.is_empty() && !budget.must_stop() {
                return Ok(Advance::Apart(slow));
            }
        }
        Ok(Advance::Stopped)
    }

    fn open(&self) -> impl Iterator<Item = &EstimateEntry<'q>> {
        self.entries.iter().filter(|entry| entry.is_open())
    }

    /// Requests trials up to one, each column up to where its readers surely stop; whether the next trial is lacking.
    fn request(&mut self, executor: &dyn Executor, last: u64, budget: &Budget) -> bool {
        let (mut from, mut lacks) = (self.next, false);
        while from < last {
            let sure = |entry: &EstimateEntry<'_>| {
                let planned = entry.procedure.limit().filter(|_| entry.procedure.is_planned());
                planned.unwrap_or(last).min(budget.max_trials)
            };
            let reading = || self.open().filter(|entry| sure(entry) > from);
            let to = reading().map(sure).min().unwrap_or(last).min(last);
            self.job.narrow(columns(reading()));
            lacks |= executor.request(&self.job, None, from..to) && from == self.next;
            from = to;
        }
        lacks
    }

    /// Up to which trial somebody will most likely read.
    fn foreseen(&self, budget: &Budget) -> u64 {
        let of = |entry: &EstimateEntry<'_>| {
            let likely = forecast::entry(&entry.query.ask, &entry.procedure, &entry.statistics);
            forecast::ahead(self.next, likely).min(entry.procedure.limit().unwrap_or(u64::MAX))
        };
        // Where little is known of one, others do not carry its column far.
        let is_known = self.next >= FIRST || self.open().all(|entry| entry.procedure.is_planned());
        let most = if is_known { budget.max_trials } else { FIRST.min(budget.max_trials) };
        self.open().map(of).max().unwrap_or(0).min(most)
    }

    /// The columns that hold the others up: in which no trial of a round was decided in its time, or trials take much longer.
    fn slow(&self, cells: &Cells) -> Vec<usize> {
        let open: Vec<&EstimateEntry<'_>> = self.entries.iter().filter(|i| i.is_open()).collect();
        let steps = |entry: &EstimateEntry<'_>| {
            let place = self.job.columns.iter().position(|c| *c == entry.column);
            match entry.tally.counts.trials {
                0 if place.is_some_and(|place| cells.decided(place) > 0) => 1.0,
                0 => f64::INFINITY,
                trials => math::at_least(entry.tally.steps as f64 / trials as f64, 1.0),
            }
        };
        let least = open.iter().map(|entry| steps(entry)).fold(f64::INFINITY, math::at_most);
        let slow = open.iter().filter(|entry| steps(entry) > MUCH_LONGER * least);
        columns(slow.copied())
    }

    /// Shows a round to the entries; the first trial in which somebody sees that the model is wrong. None of them
    /// depends on what another one finds, so each reads in one go, trial by trial, up to where it stops.
    fn read(&mut self, items: &[Item], cells: &Cells, started: f64, budget: &Budget) -> Result<(), Item> {
        let mut faulty: Option<usize> = None;
        // Where the call ends, a trial that is cut hands over what it has decided.
        let last = budget.must_stop();
        for entry in self.entries.iter_mut().filter(|i| i.is_open()) {
            if let Some(place) = self.job.columns.iter().position(|c| *c == entry.column) {
                // What follows an open trial is not looked at: outcomes count in index order.
                let ready = if last { cells.decided(place) } else { cells.ready() };
                let ready = &items[..ready.min(items.len())];
                if ready.is_empty() {
                    continue;
                }
                match entry.read(ready, cells.column(place), budget.max_trials) {
                    Ok(stop) => entry.stop = stop,
                    Err(at) => faulty = Some(faulty.map_or(at, |first| first.min(at))),
                }
                if entry.stop.is_some() {
                    entry.seconds = budget.elapsed() - started;
                }
            }
        }
        faulty.map_or(Ok(()), |at| Err(items[at]))
    }
}

/// Columns that some entries read.
fn columns<'e, 'q: 'e>(entries: impl Iterator<Item = &'e EstimateEntry<'q>>) -> Vec<usize> {
    entries.map(|entry| entry.column).collect::<BTreeSet<_>>().into_iter().collect()
}

/// Time is up, or somebody interrupted: what is known stays known.
fn close(entries: &mut [EstimateEntry<'_>], budget: &Budget) {
    let stop = budget.stopped_by();
    for entry in entries.iter_mut().filter(|i| i.is_open()) {
        entry.stop = Some(stop);
    }
}

/// The procedure with its level, proven if it was not known; `None` if there is no time for that. Which level it is
/// never depends on the time. Nor does whether it has stopped where it waits: then it is proven in any case, which is
/// soon done, for it takes few trials.
fn prove(procedure: &Procedure, levels: &mut Levels, budget: &Budget) -> Result<Option<Procedure>, Fault> {
    let Some((epsilon, delta)) = procedure.waits_for() else { return Err(Fault::Unsuitable) };
    let may_have_stopped = procedure.may_have_stopped();
    let go_on = || may_have_stopped || !budget.must_stop();
    match levels.find(epsilon, delta, Patience { go_on: &go_on }) {
        Some(level) => procedure.settled(level),
        None => Ok(None),
    }
}

/// How many trials an entry reads at most from here on.
fn left(entry: &EstimateEntry<'_>, consumed: u64, budget: &Budget) -> u64 {
    entry.procedure.limit().unwrap_or(u64::MAX).min(budget.max_trials).saturating_sub(consumed)
}

/// How many trials anybody reads at most from here on.
fn most(entries: &[EstimateEntry<'_>], consumed: u64, budget: &Budget) -> u64 {
    let open = entries.iter().filter(|entry| entry.is_open());
    open.map(|entry| left(entry, consumed, budget)).max().unwrap_or(0)
}

/// How many trials the next round has: enough to keep all lanes busy, few enough to waste little once the
/// last query has stopped.
fn round(entries: &[EstimateEntry<'_>], consumed: u64, width: u64, budget: &Budget) -> u64 {
    let planned = entries.iter().filter(|i| i.is_open() && i.procedure.is_planned());
    let sure = planned.map(|entry| left(entry, consumed, budget)).max().unwrap_or(0);
    let most = most(entries, consumed, budget);
    let size = (consumed / 8).max(2 * width).max(sure.min(consumed.max(8 * width)));
    // With a deadline rounds stay short, so that little is thrown away at its end.
    let size = if budget.has_deadline() { size.min(consumed.max(2 * width)) } else { size };
    size.min(most).clamp(1, LARGEST_ROUND)
}
