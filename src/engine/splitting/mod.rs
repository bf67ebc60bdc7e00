//! Rare events: plain trials first, then independent runs of splitting with robustness as the level, and
//! whether the two agree.

mod answer;
mod batches;
mod path;
mod paths;

use super::budget::Budget;
use super::cell::{Item, Reading};
use super::executor::{Executor, Job};
use super::fault::Fault;
use super::outcome::Stop;
use super::pilot::Pilot;
use super::prepared::PreparedWorld;
use super::tally::Tally;
use super::watch::{Forecast, Likely, Watch};
use crate::base::random::TrialKey;
use crate::compile::study::Query;
use crate::stats::splitting::{Adaptive, Effort, Rule, Scheme, Spread, Start};
use crate::stats::{self, Counts, clopper_pearson, sequence};
use batches::Batches;
use path::Path;

/// Error of the interval of plain trials that an estimate must lie in: small, for the comparison is made once
/// in every call.
const DISAGREEMENT: f64 = 0.01;
/// Paths in units of those that start, for forecasts.
const DECADES: u64 = 5;
/// The same, at most.
const MOST_DECADES: u64 = 20;
/// Plain trials of a round.
const ROUND: u64 = 4096;

/// What was found.
pub(super) struct Found {
    /// The plain trials.
    plain: Tally,
    /// Upper bound of the probability from them, one-sided.
    bound: f64,
    /// Two-sided interval of them, wide enough for the comparison.
    interval: stats::Interval,
    /// The runs with lost paths read as not reaching the event, and with them read as reaching it; if all are finished.
    spreads: Option<[Spread; 2]>,
    /// Levels of the runs, on average.
    levels: f64,
    /// Paths of all runs.
    paths: u64,
    /// Steps of all paths.
    steps: u64,
    /// Paths that diverged, in the reading in which they do not reach the event.
    lost: u64,
    /// Whether any level below the event was ever found.
    blind: bool,
    /// Why it stopped.
    stop: Stop,
}

/// What is asked.
pub(super) struct Question<'s> {
    query: &'s Query,
    prepared: &'s PreparedWorld,
    column: usize,
    /// Column of the level.
    level: usize,
    rule: Rule,
    seed: u64,
}

impl<'s> Question<'s> {
    /// About the probability of a column of a prepared world, with the column of its level.
    pub(super) const fn new(
        query: &'s Query,
        prepared: &'s PreparedWorld,
        [column, level]: [usize; 2],
        rule: Rule,
        seed: u64,
    ) -> Self {
        Self { query, prepared, column, level, rule, seed }
    }

    /// Runs a few plain trials, and forecasts from them what all is likely to take.
    pub(super) fn run_pilot(&self, executor: &dyn Executor, budget: &Budget) -> Result<Forecast, Fault> {
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
        Ok(Forecast {
            query: self.query.text.clone(),
            settings: self.query.settings.clone(),
            trials,
            seconds: trials.likely as f64 * seconds,
        })
    }
}

/// One run on its way.
struct Running {
    scheme: Box<dyn Scheme>,
    branch: u16,
    paths: Vec<Path>,
}

impl Running {
    fn new(scheme: Box<dyn Scheme>, branch: u16) -> Self {
        Self { scheme, branch, paths: Vec::new() }
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
fn run(
    question: &Question<'_>,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<Found, Fault> {
    let rule = question.rule;
    let (plain, stop) = plainly(question, executor, budget, watch)?;
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
    let mut found = Found {
        plain,
        bound,
        interval,
        spreads: None,
        levels: 0.0,
        paths: 0,
        steps: 0,
        lost: 0,
        blind: true,
        stop: stop.unwrap_or(Stop::Plan),
    };
    if stop.is_some() {
        return Ok(found);
    }
    let batches = Batches::new(question.prepared, [question.column, question.level]);
    let reading = |lost_reaches: bool, found: &mut Found| -> Result<Option<Spread>, Fault> {
        runs(question, found, &mut |runs, found| {
            advance(&batches, runs, lost_reaches, question, found, executor, budget, watch)
        })
    };
    if let Some(low) = reading(false, &mut found)? {
        // Paths that are lost are in neither reading: where there are any, all runs are made in both.
        let high = if found.lost == 0 { Some(low) } else { reading(true, &mut found)? };
        found.spreads = high.map(|high| [low, high]);
    }
    Ok(found)
}

/// Runs the paths of some runs; whether all of them came to an end.
type RunPaths<'f> = &'f mut dyn FnMut(&mut [Running], &mut Found) -> Result<bool, Fault>;

/// All runs under one reading of lost paths; `None` where they did not come to an end. `advance` finishes some of them.
fn runs(question: &Question<'_>, found: &mut Found, advance: RunPaths<'_>) -> Result<Option<Spread>, Fault> {
    let rule = question.rule;
    let (replicas, seed) = (rule.replicas as usize, question.seed);
    let mut levels = Vec::new();
    if !rule.adaptive {
        // A pilot run finds the levels; its own estimate is not used.
        let branch = 1 + rule.runs as u16;
        let pilot = Adaptive::new(replicas, (3 * replicas / 4).max(1), seed, branch)?;
        let mut runs = [Running::new(Box::new(pilot), branch)];
        if !advance(&mut runs, found)? {
            return Ok(None);
        }
        levels.extend(runs[0].scheme.levels().iter().copied().filter(|level| level.is_finite()));
    }
    let mut runs = Vec::with_capacity(rule.runs as usize);
    for run in 0..rule.runs as u16 {
        let branch = 1 + run;
        let scheme: Box<dyn Scheme> = if rule.adaptive {
            Box::new(Adaptive::new(replicas, rule.kill as usize, seed, branch)?)
        } else {
            Box::new(Effort::new(replicas, levels.clone(), seed, branch)?)
        };
        runs.push(Running::new(scheme, branch));
    }
    if !advance(&mut runs, found)? {
        return Ok(None);
    }
    let estimates: Vec<f64> = runs.iter().map(|run| run.scheme.estimate()).collect();
    let sum: usize = runs.iter().map(|run| run.scheme.levels().len()).sum();
    found.levels = sum as f64 / runs.len() as f64;
    found.blind &= runs.iter().all(|run| run.scheme.levels().iter().all(|level| !level.is_finite()));
    Ok(Some(Spread::of(&estimates, rule.delta)?))
}

/// The plain trials; why they ended early, if they did.
fn plainly(
    question: &Question<'_>,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<(Tally, Option<Stop>), Fault> {
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
            let Some(row) = row else { return Ok((tally, Some(budget.stopped_by()))) };
            if row[0].reading == Reading::Faulty {
                return Err(super::trial::fault(question.prepared, *item, question.seed.into()));
            }
            tally.add(item.index, &row[0], None);
        }
        watch.consumed(&question.query.text, tally.counts.trials, None);
    }
    Ok((tally, (most < planned).then_some(Stop::Cap)))
}

/// Runs go on side by side until all are finished; false if they are not.
fn advance(
    batches: &Batches<'_>,
    runs: &mut [Running],
    lost_reaches: bool,
    question: &Question<'_>,
    found: &mut Found,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<bool, Fault> {
    loop {
        let paths: Vec<Vec<Path>> = runs.iter_mut().map(|run| run.wanted(question.seed)).collect();
        let together: Vec<Path> = paths.iter().flatten().cloned().collect();
        if together.is_empty() {
            return Ok(true);
        }
        if let Some(stop) = budget.reason_to_stop() {
            found.stop = stop;
            return Ok(false);
        }
        let consumed = found.plain.counts.trials + found.paths;
        if consumed + together.len() as u64 > budget.max_trials {
            found.stop = Stop::Cap;
            return Ok(false);
        }
        let Some(ended) = batches.run(&together, executor, budget)? else {
            found.stop = budget.stopped_by();
            return Ok(false);
        };
        found.paths += ended.len() as u64;
        found.steps += ended.iter().map(|one| one.steps).sum::<u64>();
        if !lost_reaches {
            found.lost += ended.iter().filter(|one| one.lost).count() as u64;
        }
        let mut ended = ended.into_iter();
        for (run, wanted) in runs.iter_mut().zip(&paths) {
            if !wanted.is_empty() {
                run.scheme
                    .feed(ended.by_ref().take(wanted.len()).map(|one| one.read(lost_reaches)).collect());
            }
        }
        watch.consumed(&question.query.text, found.plain.counts.trials + found.paths, None);
    }
}
