//! Rare events: plain trials first, then independent runs of splitting with robustness as the level, and
//! whether the two agree.

mod batches;
mod path;
mod paths;
mod record;

pub use record::{RunRecord, SplitRun};

use crate::base::random::TrialKey;
use crate::compile::study::Query;
use crate::engine::fault::Fault;
use crate::engine::outcome::Stop;
use crate::engine::sampling::pilot::{Pilot, Piloted};
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::tally::Tally;
use crate::engine::sampling::watch::{Forecast, Likely, Nobody};
use crate::engine::trials::executor::{Executor, Job};
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::trials::trial::fault;
use crate::stats::splitting::{Rule, Scheme, Spread, Start};
use crate::stats::{self, Counts, clopper_pearson, sequence};
use crate::trials::budget::Budget;
use crate::trials::cell::{Item, Reading};
use batches::Batches;
use path::Path;
use std::cell::RefCell;

/// Error of the interval of plain trials that an estimate must lie in: small, for the comparison is made once
/// in every call.
pub(in crate::engine) const DISAGREEMENT: f64 = 0.01;
/// Paths in units of those that start, for forecasts.
const DECADES: u64 = 5;
/// The same, at most.
const MOST_DECADES: u64 = 20;
/// Plain trials of a round.
const ROUND: u64 = 4096;

/// What was found.
pub(in crate::engine) struct Found {
    /// The plain trials.
    pub(in crate::engine) plain: Tally,
    /// Upper bound of the probability from them, one-sided.
    pub(in crate::engine) bound: f64,
    /// Two-sided interval of them, wide enough for the comparison.
    pub(in crate::engine) interval: stats::Interval,
    /// The runs with lost paths read as not reaching the event, and with them read as reaching it; if all are finished.
    pub(in crate::engine) spreads: Option<[Spread; 2]>,
    /// Levels of the runs, on average.
    pub(in crate::engine) levels: f64,
    /// Paths of all runs.
    pub(in crate::engine) paths: u64,
    /// Steps of all paths.
    pub(in crate::engine) steps: u64,
    /// Paths that diverged, in the reading in which they do not reach the event.
    pub(in crate::engine) lost: u64,
    /// Whether any level below the event was ever found.
    pub(in crate::engine) blind: bool,
    /// Why it stopped.
    pub(in crate::engine) stop: Stop,
}

impl Found {
    /// The upper bound that is certified: that of the wider interval where the estimate is between the two, so that no
    /// estimate is above it. A bound that is higher is wrong less often.
    pub(in crate::engine) fn above(&self) -> f64 {
        let is_over = |spread: &Spread| spread.mean > self.bound && spread.mean <= self.interval.high;
        let over = self.spreads.is_some_and(|both| both.iter().any(is_over));
        if over { self.interval.high } else { self.bound }
    }
}

/// What is asked.
pub(in crate::engine) struct Question<'s> {
    /// Its place among the queries that are asked.
    pub(in crate::engine) place: usize,
    pub(in crate::engine) query: &'s Query,
    pub(in crate::engine) prepared: &'s PreparedWorld,
    pub(in crate::engine) column: usize,
    /// Column of the level.
    pub(in crate::engine) level: usize,
    pub(in crate::engine) rule: Rule,
    pub(in crate::engine) seed: u64,
}

impl<'s> Question<'s> {
    /// About the probability of a column of a prepared world, with the column of its level.
    pub(in crate::engine) const fn new(
        (place, query): (usize, &'s Query),
        prepared: &'s PreparedWorld,
        [column, level]: [usize; 2],
        rule: Rule,
        seed: u64,
    ) -> Self {
        Self { place, query, prepared, column, level, rule, seed }
    }
}

impl Piloted for Question<'_> {
    fn pilot(&mut self, executor: &dyn Executor, budget: &Budget) -> Result<Vec<Forecast>, Fault> {
        let job = Job::new(self.prepared, vec![self.column], self.seed);
        let width = executor.width(&job) as u64;
        let few = width.min(self.rule.plain).min(budget.max_trials);
        let pilot = Pilot::run(&job, Item::run(0, few), executor, budget)?;
        let seconds = pilot.seconds_per_trial(self.prepared.most_steps());
        // How many levels there will be is not known: from none to those of eight decades, and likely those of two.
        let started = self.rule.runs.saturating_mul(self.rule.replicas);
        let paths = Likely { least: 1, likely: DECADES, most: MOST_DECADES };
        let trials = paths.map(|times| {
            self.rule.plain.saturating_add(started.saturating_mul(times)).min(budget.max_trials)
        });
        Ok(vec![Forecast::of(self.query, trials, seconds)])
    }

    fn is_unread(&self) -> bool {
        true
    }

    fn is_whole(&self) -> bool {
        true
    }
}

/// One run on its way.
struct Running {
    scheme: Box<dyn Scheme>,
    branch: u16,
    paths: Vec<Path>,
    steps: u64,
    lost: u64,
}

impl Running {
    fn new(run: &SplitRun, seed: u64) -> Result<Self, Fault> {
        Ok(Self { scheme: run.scheme(seed)?, branch: run.branch, paths: Vec::new(), steps: 0, lost: 0 })
    }

    fn record(self) -> RunRecord {
        let Self { scheme, paths, steps, lost, .. } = self;
        let (estimate, levels) = (scheme.estimate(), scheme.levels().to_vec());
        RunRecord { paths: paths.len() as u64, steps, lost, estimate, levels }
    }

    /// The paths that it wants.
    fn wanted(&mut self, seed: u64) -> Vec<Path> {
        let mut wanted = Vec::with_capacity(self.scheme.wanted().len());
        for start in self.scheme.wanted() {
            let key = TrialKey { seed, index: (self.paths.len() + wanted.len()) as u64, branch: self.branch };
            wanted.push(match *start {
                Start::Anew => Path::anew(key),
                Start::From { path, time } => self.paths[path].branch(time, key),
            });
        }
        self.paths.extend_from_slice(&wanted);
        wanted
    }
}

/// Answers a question.
pub(in crate::engine) fn run(question: &Question<'_>, resources: Resources<'_>) -> Result<Found, Fault> {
    let rule = question.rule;
    let (plain, stop) = plainly(question, resources)?;
    // Unresolved trials count as the event where that is the worse reading.
    let counts = plain.counts;
    let read = |successes| Counts { successes, failures: counts.trials - successes };
    let (least, most) = (read(counts.successes), read(counts.successes + counts.unresolved));
    // Where the clock chose their number, only what holds at all times holds.
    let of = if counts.trials < rule.plain { sequence::interval } else { clopper_pearson::interval };
    let interval = of(least, DISAGREEMENT).hull(of(most, DISAGREEMENT));
    let bound = if counts.trials < rule.plain {
        sequence::interval(most, rule.delta).high
    } else {
        clopper_pearson::upper(most, rule.delta)
    };
    let mut found = Found { stop: stop.unwrap_or(Stop::Plan), ..Found::new(plain, bound, interval) };
    if stop.is_some() {
        return Ok(found);
    }
    let batches = Batches::new(question.prepared, [question.column, question.level]);
    let reading = |lost_reaches: bool, found: &mut Found| -> Result<Option<Spread>, Fault> {
        runs(question, lost_reaches, found, &mut |runs, found| {
            advance(&batches, runs, (question.query, question.seed), found, resources)
        })
    };
    if let Some(low) = reading(false, &mut found)? {
        // Paths that are lost are in neither reading: where there are any, all runs are made in both.
        let high = if found.lost == 0 { Some(low) } else { reading(true, &mut found)? };
        found.spreads = high.map(|high| [low, high]);
    }
    Ok(found)
}

/// What some runs came to; `None` where they did not come to an end.
type MakeRuns<'f> = &'f mut dyn FnMut(&[SplitRun], &mut Found) -> Result<Option<Vec<RunRecord>>, Fault>;

/// All runs under one reading of lost paths; `None` where they did not come to an end.
fn runs(
    question: &Question<'_>,
    lost_reaches: bool,
    found: &mut Found,
    make: MakeRuns<'_>,
) -> Result<Option<Spread>, Fault> {
    let rule = question.rule;
    let run = |branch: u64, levels: &[f64]| SplitRun {
        world: question.prepared.number.unwrap_or_default(),
        columns: [question.column, question.level],
        rule,
        branch: branch as u16,
        lost_reaches,
        levels: levels.to_vec(),
    };
    let mut levels = Vec::new();
    if !rule.adaptive {
        let Some(pilot) = make(&[run(rule.runs + 1, &[])], found)? else { return Ok(None) };
        levels.extend(pilot[0].levels.iter().copied().filter(|level| level.is_finite()));
    }
    let all: Vec<SplitRun> = (1..=rule.runs).map(|branch| run(branch, &levels)).collect();
    let Some(runs) = make(&all, found)? else { return Ok(None) };
    let estimates: Vec<f64> = runs.iter().map(|run| run.estimate).collect();
    let sum: usize = runs.iter().map(|run| run.levels.len()).sum();
    found.levels = sum as f64 / runs.len() as f64;
    found.blind &= runs.iter().all(|run| run.levels.iter().all(|level| !level.is_finite()));
    Ok(Some(Spread::of(&estimates, rule.delta)?))
}

/// The plain trials; why they ended early, if they did.
fn plainly(question: &Question<'_>, resources: Resources<'_>) -> Result<(Tally, Option<Stop>), Fault> {
    let Resources { executor, share: budget, watch, .. } = resources;
    let job = Job::new(question.prepared, vec![question.column], question.seed);
    let mut tally = Tally::default();
    let planned = question.rule.plain;
    let most = planned.min(budget.max_trials);
    while tally.counts.trials < most {
        if let Some(stop) = budget.reason_to_stop() {
            return Ok((tally, Some(stop)));
        }
        let from = tally.counts.trials;
        let items = Item::run(from, ROUND.min(most - from));
        let cells = executor.run(&job, &items, budget)?;
        for (item, row) in items.iter().zip(cells.rows()) {
            let Some(row) = row else {
                if executor.is_stored() {
                    executor.request(&job, None, item.index..most);
                    budget.lack();
                }
                return Ok((tally, Some(budget.stopped_by())));
            };
            if row[0].reading == Reading::Faulty {
                return Err(fault(question.prepared, *item, question.seed.into()));
            }
            tally.add(item.index, &row[0], None);
        }
        watch.consumed(&question.query.text, tally.counts.trials, None);
    }
    Ok((tally, (most < planned).then_some(Stop::Cap)))
}

impl Found {
    const fn new(plain: Tally, bound: f64, interval: stats::Interval) -> Self {
        Self {
            plain,
            bound,
            interval,
            spreads: None,
            levels: 0.0,
            paths: 0,
            steps: 0,
            lost: 0,
            blind: true,
            stop: Stop::Plan,
        }
    }

    /// Whether so many more paths may be run; else why not is noted.
    fn admits(&mut self, paths: u64, budget: &Budget) -> bool {
        let capped = self.plain.counts.trials + self.paths + paths > budget.max_trials;
        let stop = budget.reason_to_stop().or(capped.then_some(Stop::Cap));
        self.stop = stop.unwrap_or(self.stop);
        stop.is_none()
    }

    fn count(&mut self, (paths, steps, lost): (u64, u64, u64), lost_reaches: bool) {
        self.paths += paths;
        self.steps += steps;
        self.lost += if lost_reaches { 0 } else { lost };
    }
}

/// Runs go on side by side until all are finished; `None` if they are not. Runs that are stored are not made again.
fn advance(
    batches: &Batches<'_>,
    runs: &[SplitRun],
    (query, seed): (&Query, u64),
    found: &mut Found,
    resources: Resources<'_>,
) -> Result<Option<Vec<RunRecord>>, Fault> {
    let Resources { executor, share: budget, .. } = resources;
    // All of them are requested before one that is not there ends the question.
    let stored: Vec<_> = runs.iter().map(|run| executor.record(run)).collect();
    let stored: Option<Vec<_>> = stored.into_iter().collect();
    if stored.is_none() && executor.is_stored() {
        budget.lack();
        found.stop = budget.stopped_by();
        return Ok(None);
    }
    // Where the model is wrong in a run, or the budget ends runs on their way, they are made here.
    if let Some(records) = stored.and_then(|all| all.into_iter().collect::<Option<Vec<RunRecord>>>())
        && found.admits(records.iter().map(|one| one.paths).sum(), budget)
    {
        let count = |one: &RunRecord| found.count((one.paths, one.steps, one.lost), runs[0].lost_reaches);
        records.iter().for_each(count);
        return Ok(Some(records));
    }
    let made = make(batches, runs, (&query.text, seed), found, resources)?;
    runs.iter().zip(made.iter().flatten()).for_each(|(run, record)| executor.made(run, record));
    Ok(made)
}

/// Makes runs side by side; `None` if not all of them came to an end.
fn make(
    batches: &Batches<'_>,
    runs: &[SplitRun],
    (query, seed): (&str, u64),
    found: &mut Found,
    Resources { executor, share: budget, watch, .. }: Resources<'_>,
) -> Result<Option<Vec<RunRecord>>, Fault> {
    let mut running = runs.iter().map(|run| Running::new(run, seed)).collect::<Result<Vec<_>, _>>()?;
    loop {
        let paths: Vec<Vec<Path>> = running.iter_mut().map(|run| run.wanted(seed)).collect();
        let together: Vec<Path> = paths.iter().flatten().cloned().collect();
        if together.is_empty() {
            return Ok(Some(running.into_iter().map(Running::record).collect()));
        }
        if !found.admits(together.len() as u64, budget) {
            return Ok(None);
        }
        let Some(ended) = batches.run(&together, executor, budget)? else {
            found.stop = budget.stopped_by();
            return Ok(None);
        };
        let mut ended = ended.into_iter();
        for ((run, of), wanted) in running.iter_mut().zip(runs).zip(&paths) {
            let own: Vec<_> = ended.by_ref().take(wanted.len()).collect();
            if own.is_empty() {
                continue;
            }
            let steps = own.iter().map(|one| one.steps).sum();
            let lost = own.iter().filter(|one| one.lost).count() as u64;
            found.count((own.len() as u64, steps, lost), of.lost_reaches);
            run.steps += steps;
            run.lost += lost;
            run.scheme.feed(own.into_iter().map(|one| one.read(of.lost_reaches)).collect());
        }
        watch.consumed(query, found.plain.counts.trials + found.paths, None);
    }
}

/// Makes one run on its own; `None` where the model is wrong in it, or the budget ends it.
///
/// # Errors
/// For columns that no monitor can watch, and rules that no procedure accepts.
pub(in crate::engine) fn record(
    run: &SplitRun,
    (prepared, seed): (&PreparedWorld, u64),
    executor: &dyn Executor,
    budget: &Budget,
) -> Result<Option<RunRecord>, Fault> {
    let batches = Batches::new(prepared, run.columns);
    let interval = clopper_pearson::interval(Counts::default(), DISAGREEMENT);
    let mut found = Found::new(Tally::default(), 1.0, interval);
    let levels = RefCell::default();
    let resources = Resources { executor, levels: &levels, budget, share: budget, watch: &Nobody };
    match make(&batches, std::slice::from_ref(run), ("", seed), &mut found, resources) {
        Err(Fault::Model(_)) => Ok(None),
        made => Ok(made?.and_then(|mut records| records.pop())),
    }
}
