//! A whole call: worlds made ready, queries put into groups that share trials, forecast, and run.

use crate::compile::study::{Ask, Query, Study, World};
use crate::engine::answer::every;
use crate::engine::answer::{Answers, Sampling, Turn};
use crate::engine::call::Call;
use crate::engine::fault::{Fault, MOST_VALUES};
use crate::engine::flaw::Flaw;
use crate::engine::outcome::{CallResult, Failure, QueryResult};
use crate::engine::sampling::compare::{CompareSampling, Sides};
use crate::engine::sampling::entry::EstimateEntry;
use crate::engine::sampling::estimate::EstimateSampling;
use crate::engine::sampling::forecast::PilotStatistics;
use crate::engine::sampling::procedure::Procedure;
use crate::engine::sampling::rank::{RankSampling, RankSetup};
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::splitting::Question;
use crate::engine::sampling::tally::Tally;
use crate::engine::sampling::watch::{CallForecast, Forecast, Watch};
use crate::engine::trials::dependence::Untrusted;
use crate::engine::trials::executor::Executor;
use crate::engine::trials::placement::all_placeable;
use crate::engine::trials::prepared::PreparedWorld;
use crate::stats::Levels;
use crate::stats::spec::Make;
use crate::stats::splitting;
use crate::trials::budget::{Budget, DEFAULT_TRIALS};
use crate::trials::cell::Series;
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};

/// A query gets no larger part of the time than one of so many for its first trial.
const FEW_PARTS: usize = 8;

/// Runs a study.
pub fn run(
    study: &Study,
    call: &Call<'_>,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<CallResult, Fault> {
    // Trials of the kernel are independent; others are watched.
    let untrusted = Untrusted::new(executor, call.repeats);
    let is_played = |world: &World| world.scenario.processes.outside.is_some();
    let is_outside = call.repeats || call.line.outcomes || study.worlds.iter().any(is_played);
    let executor: &dyn Executor = if is_outside { &untrusted } else { executor };
    let asked = asked(study, call);
    let worlds = prepare(study, &asked, call)?;
    let session = Session { call, budget, worlds: &worlds };
    let mut groups = session.groups(&asked)?;
    watch.samples();
    if !executor.is_stored()
        && let Some(total) = forecast_groups(&mut groups, executor, budget)?
    {
        watch.forecast(&total);
    }
    let mut results: Vec<Option<QueryResult>> = asked.iter().map(|_| None).collect();
    let mut failure = None;
    let levels = RefCell::new(Levels::default());
    if budget.has_deadline() {
        // A question about a rare event cannot be paused: it gets its share when the others had theirs.
        groups.sort_by_key(|group| group.is_whole());
    }
    let mut waiting: VecDeque<Group<'_>> = groups.into();
    let mut paused = VecDeque::new();
    let mut times = 1;
    while let Some(mut group) = waiting.pop_front() {
        // Those that are open share the time that is left; what one of them leaves goes to the others, in further turns.
        let parts = ((waiting.len() + 1) / times).max(1);
        let share = budget.share(parts);
        // Outcomes that are not there are missing for one group: it ends, and the others go on.
        let budget = if executor.is_stored() { &share } else { budget };
        let resources = Resources { executor, levels: &levels, budget, share: &share, watch };
        match session.turn(&mut group, resources)? {
            Turn::Over(found, broken) => {
                for (k, result) in found {
                    results[k] = Some(result);
                }
                if let Some(fault) = broken {
                    failure = Some(Failure::Model(flaw(fault)?));
                    break;
                }
            }
            // With many queries a share may be too short for one trial: then one gets more, before none gets any.
            Turn::Paused if parts > FEW_PARTS && group.is_unread() => {
                times *= 2;
                waiting.push_front(group);
                continue;
            }
            Turn::Paused => paused.push_back(group),
            Turn::Apart(slow) => {
                waiting.push_front(slow);
                waiting.push_front(group);
            }
        }
        times = 1;
        if waiting.is_empty() {
            std::mem::swap(&mut waiting, &mut paused);
        }
    }
    // What was decided before stays decided.
    for mut group in waiting.into_iter().chain(paused) {
        for (k, result) in group.decided(&Answers { call, budget })? {
            results[k] = Some(result);
        }
    }
    watch.finished();
    let trials = consumed(&asked, &results);
    let results = every::joined(&asked, results);
    let title = if study.title.is_empty() { &call.line.scenario } else { &study.title };
    Ok(CallResult {
        tracks: study.tracks.clone(),
        people: study.people.iter().copied().collect(),
        trials,
        interrupted: budget.is_interrupted(),
        failure,
        replay: again(call, budget, &results),
        results,
        elapsed_s: budget.elapsed(),
        warnings: untrusted.dependence.warnings(study),
        ..CallResult::of(title, call.seed)
    })
}

/// Consumed trials of all results. Checks and estimates of a world read the same trials, each the first so many.
fn consumed(asked: &[&Query], results: &[Option<QueryResult>]) -> u64 {
    let mut shared = BTreeMap::new();
    let mut alone = 0;
    for (query, result) in asked.iter().zip(results) {
        let trials = result.as_ref().map_or(0, |result| result.consumed.counts.trials);
        match estimated(&query.ask) {
            Some(world) => {
                let most: &mut u64 = shared.entry(world).or_default();
                *most = trials.max(*most);
            }
            None => alone += trials,
        }
    }
    alone + shared.values().sum::<u64>()
}

/// The call that gives the same results again. Where the clock ended something, each query has its own.
fn again(call: &Call<'_>, budget: &Budget, results: &[QueryResult]) -> String {
    if results.iter().any(|r| r.stopped_by.is_early()) {
        let each: Vec<&str> = results.iter().map(|r| r.replay.as_str()).collect();
        return each.join("\n");
    }
    let mut words = call.line.check();
    for index in &call.only {
        words.push_str(&format!(" --only {index}"));
    }
    if budget.max_trials != DEFAULT_TRIALS {
        words.push_str(&format!(" --max-trials {}", budget.max_trials));
    }
    if let Some(total) = budget.max_total {
        words.push_str(&format!(" --total-trials {total}"));
    }
    format!("{words} --seed {}", call.seed)
}

/// What a study is likely to take, from the first trials of each of its queries.
pub fn forecast(
    study: &Study,
    call: &Call<'_>,
    executor: &dyn Executor,
    budget: &Budget,
) -> Result<CallForecast, Fault> {
    let asked = asked(study, call);
    let worlds = prepare(study, &asked, call)?;
    let session = Session { call, budget, worlds: &worlds };
    let mut groups = session.groups(&asked)?;
    Ok(forecast_groups(&mut groups, executor, budget)?.unwrap_or_default())
}

fn asked<'s>(study: &'s Study, call: &Call<'_>) -> Vec<&'s Query> {
    study.queries.iter().filter(|q| call.only.is_empty() || call.only.contains(&q.index)).collect()
}

/// The worlds that are asked about, made ready.
fn prepare(study: &Study, asked: &[&Query], call: &Call<'_>) -> Result<Vec<Option<PreparedWorld>>, Fault> {
    all_placeable(study, asked)?;
    let mut made: Vec<Option<PreparedWorld>> = study.worlds.iter().map(|_| None).collect();
    for query in asked {
        for world in query.ask.worlds() {
            if made[world].is_none() {
                made[world] = PreparedWorld::of(study, world, call.seed, call.drivers);
            }
        }
    }
    Ok(made)
}

/// Runs the pilot of each group. With a deadline there is nothing to forecast, and no time to spend on it.
fn forecast_groups(
    groups: &mut [Group<'_>],
    executor: &dyn Executor,
    budget: &Budget,
) -> Result<Option<CallForecast>, Fault> {
    if budget.has_deadline() {
        return Ok(None);
    }
    let mut total = CallForecast::default();
    for group in groups {
        if budget.is_interrupted() {
            return Ok(None);
        }
        let forecasts = group.pilot(executor, budget)?;
        // Checks and estimates of one scenario share their trials.
        let longest = |of: &dyn Fn(&Forecast) -> f64| forecasts.iter().map(of).fold(0.0, f64::max);
        total.seconds += longest(&|f| f.seconds);
        total.between.0 += longest(&|f| f.seconds_between().0);
        total.between.1 += longest(&|f| f.seconds_between().1);
        total.queries.extend(forecasts);
    }
    Ok(Some(total))
}

/// Queries that are answered together, whatever they ask.
type Group<'q> = Box<dyn Sampling<'q> + 'q>;

fn estimated(ask: &Ask) -> Option<usize> {
    match ask {
        Ask::Estimate { level: Some(_), .. } => None,
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => Some(measure.target.world),
        Ask::Compare { .. } | Ask::Rank { .. } => None,
    }
}

/// Gives what a procedure refuses the place of its query.
fn refused(query: &Query) -> impl Fn(Fault) -> Fault {
    let place = query.span;
    move |fault| match fault {
        Fault::Statistics(reason) => Fault::Procedure { place, reason },
        other => other,
    }
}

/// What is wrong with the model, if the fault is one of it.
fn flaw(fault: Fault) -> Result<Box<Flaw>, Fault> {
    match fault {
        Fault::Model(flaw) => Ok(flaw),
        fault => Err(fault),
    }
}

struct Session<'a> {
    call: &'a Call<'a>,
    budget: &'a Budget,
    worlds: &'a [Option<PreparedWorld>],
}

impl<'a> Session<'a> {
    fn prepared(&self, world: usize) -> Result<&'a PreparedWorld, Fault> {
        self.worlds.get(world).and_then(Option::as_ref).ok_or(Fault::Unsuitable)
    }

    /// The queries in groups, in the order in which the first of each was written.
    fn groups(&self, asked: &[&'a Query]) -> Result<Vec<Group<'a>>, Fault> {
        let mut groups = Vec::new();
        let mut taken = vec![false; asked.len()];
        for (at, &query) in asked.iter().enumerate() {
            if taken[at] {
                continue;
            }
            groups.push(match &query.ask {
                Ask::Estimate { measure, estimator, level: Some(level) } => {
                    let prepared = self.prepared(measure.target.world)?;
                    let columns = [measure.target.column, *level];
                    let rule = splitting::Rule::of(estimator).ok_or(Fault::Unsuitable)?;
                    Box::new(Question::new((at, query), prepared, columns, rule, self.call.seed)) as Group<'a>
                }
                Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => {
                    // All checks and estimates of a world read the same trials.
                    let world = measure.target.world;
                    let together: Vec<usize> =
                        (at..asked.len()).filter(|&k| estimated(&asked[k].ask) == Some(world)).collect();
                    for &k in &together {
                        taken[k] = true;
                    }
                    let entries = together
                        .iter()
                        .map(|&k| self.entry(k, asked[k]).map_err(refused(asked[k])))
                        .collect::<Result<Vec<_>, _>>()?;
                    let kept = entries.iter().map(|one| one.procedure.most_values(self.budget.max_trials));
                    let values = kept.fold(0, u64::saturating_add);
                    if values > MOST_VALUES {
                        return Err(Fault::Memory { place: query.span, values });
                    }
                    Box::new(EstimateSampling::new(self.prepared(world)?, entries, self.call.seed))
                }
                Ask::Compare { .. } => Box::new(self.compare(at, query).map_err(refused(query))?),
                Ask::Rank { .. } => Box::new(self.rank(at, query).map_err(refused(query))?),
            });
        }
        Ok(groups)
    }

    fn entry(&self, place: usize, query: &'a Query) -> Result<EstimateEntry<'a>, Fault> {
        let (Ask::Check { measure, .. } | Ask::Estimate { measure, .. }) = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        Ok(EstimateEntry {
            place,
            query,
            column: measure.target.column,
            range: measure.kind.range(),
            procedure: Procedure::new(&query.ask, self.call.seed)?,
            tally: Tally::default(),
            statistics: PilotStatistics::default(),
            waits: false,
            lost: false,
            stop: None,
            evidence: self.call.shows_evidence.then(Vec::new),
            seconds: 0.0,
        })
    }

    fn compare(&self, place: usize, query: &'a Query) -> Result<CompareSampling<'a>, Fault> {
        let Ask::Compare { first, second, within, delta, .. } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let sides = Sides {
            worlds: [self.prepared(first.target.world)?, self.prepared(second.target.world)?],
            columns: [first.target.column, second.target.column],
        };
        let asked = (self.call.seed, self.call.shows_evidence);
        CompareSampling::new((place, query), &sides, &first.kind, (*within, *delta), asked)
    }

    fn rank(&self, place: usize, query: &'a Query) -> Result<RankSampling<'a>, Fault> {
        let Ask::Rank { options, measure, ranking, models, beside } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let Make::Ranking(kind) = ranking.spec.make else { return Err(Fault::Unsuitable) };
        let worlds = options.iter().map(|option| self.prepared(option.target.world));
        let setup = RankSetup {
            options,
            worlds: worlds.collect::<Result<_, _>>()?,
            kind: measure.kind.clone(),
            rule: (ranking.value("epsilon"), ranking.value("delta"), kind),
            models: *models,
            beside,
        };
        let series = Series { seed: self.call.seed, branch: self.call.branch };
        RankSampling::new((place, query), setup, series, self.call.shows_evidence)
    }

    /// Runs a group for its share of the time.
    fn turn<'q>(&self, group: &mut Group<'q>, resources: Resources<'_>) -> Result<Turn<'q>, Fault> {
        match group.run(&Answers { call: self.call, budget: resources.budget }, resources) {
            Err(fault @ Fault::Model(_)) => Ok(Turn::Over(Vec::new(), Some(fault))),
            turn => turn,
        }
    }
}
