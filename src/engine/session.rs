//! A whole call: worlds made ready, queries put into groups that share trials, forecast, and run.

use super::answer::Answers;
use super::call::Call;
use super::compare::{CompareSampling, Sides};
use super::entry::EstimateEntry;
use super::estimate::{Advance, EstimateSampling};
use super::every;
use super::executor::Executor;
use super::fault::{Fault, MOST_VALUES};
use super::flaw::Flaw;
use super::forecast::PilotStatistics;
use super::outcome::{CallResult, Failure, QueryResult};
use super::placement::all_placeable;
use super::prepared::PreparedWorld;
use super::procedure::Procedure;
use super::rank::{RankSampling, RankSetup};
use super::splitting::Question;
use super::tally::Tally;
use super::watch::{CallForecast, Forecast, Watch};
use crate::compile::study::{Ask, Query, Study};
use crate::stats::Levels;
use crate::stats::spec::Make;
use crate::stats::splitting;
use crate::trials::budget::{Budget, DEFAULT_TRIALS};
use crate::trials::cell::Series;
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
    let mut levels = Levels::default();
    if budget.has_deadline() {
        // A question about a rare event cannot be paused: it gets its share when the others had theirs.
        groups.sort_by_key(|group| matches!(group.sampling, Sampling::Split(_)));
    }
    let mut waiting: VecDeque<Group<'_>> = groups.into();
    let mut paused = VecDeque::new();
    let mut times = 1;
    while let Some(group) = waiting.pop_front() {
        // Those that are open share the time that is left; what one of them leaves goes to the others, in further turns.
        let parts = ((waiting.len() + 1) / times).max(1);
        let share = budget.share(parts);
        match session.turn(group, (executor, &mut levels), &share, watch)? {
            Turn::Over(found, broken) => {
                for (k, result) in found {
                    results[k] = Some(result);
                }
                if let Some(flaw) = broken {
                    failure = Some(Failure::Model(flaw));
                    break;
                }
            }
            // With many queries a share may be too short for one trial: then one gets more, before none gets any.
            Turn::Paused(group) if parts > FEW_PARTS && group.is_unread() => {
                times *= 2;
                waiting.push_front(*group);
                continue;
            }
            Turn::Paused(group) => paused.push_back(*group),
            Turn::Apart(both) => {
                let [fast, slow] = *both;
                waiting.push_front(slow);
                waiting.push_front(fast);
            }
        }
        times = 1;
        if waiting.is_empty() {
            std::mem::swap(&mut waiting, &mut paused);
        }
    }
    // What was decided before stays decided.
    for group in waiting.into_iter().chain(paused) {
        for (k, result) in session.decided(group)? {
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
        let forecasts = match &mut group.sampling {
            Sampling::Estimate(estimate) => estimate.run_pilot(executor, budget)?,
            Sampling::Compare(compare) => vec![compare.run_pilot(executor, budget)?],
            Sampling::Rank(rank) => vec![rank.run_pilot(executor, budget)?],
            Sampling::Split(question) => vec![question.run_pilot(executor, budget)?],
        };
        // Checks and estimates of one scenario share their trials.
        let longest = |of: &dyn Fn(&Forecast) -> f64| forecasts.iter().map(of).fold(0.0, f64::max);
        total.seconds += longest(&|f| f.seconds);
        total.between.0 += longest(&|f| f.seconds_between().0);
        total.between.1 += longest(&|f| f.seconds_between().1);
        total.queries.extend(forecasts);
    }
    Ok(Some(total))
}

/// Queries that are answered together, by their places among those asked.
struct Group<'q> {
    places: Vec<usize>,
    sampling: Sampling<'q>,
}

impl Group<'_> {
    /// Whether no trial was read for it yet.
    fn is_unread(&self) -> bool {
        match &self.sampling {
            Sampling::Estimate(estimate) => estimate.entries.iter().all(|i| i.tally.counts.trials == 0),
            Sampling::Compare(compare) => compare.is_unread(),
            Sampling::Rank(rank) => rank.is_unread(),
            Sampling::Split(_) => true,
        }
    }
}

/// How they are answered.
#[allow(clippy::large_enum_variant, reason = "there are as many as queries")]
enum Sampling<'q> {
    Estimate(EstimateSampling<'q>),
    Compare(CompareSampling<'q>),
    Rank(RankSampling<'q>),
    Split(Question<'q>),
}

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

/// Results by the places of their queries.
type Answered = Vec<(usize, QueryResult)>;

/// What came of a turn of a group.
enum Turn<'q> {
    /// Its results, and what was wrong with the model, if a trial showed that it is.
    Over(Answered, Option<Box<Flaw>>),
    /// It goes on when the others had their turn.
    Paused(Box<Group<'q>>),
    /// It goes on in two groups, because the queries of the second hold the others up.
    Apart(Box<[Group<'q>; 2]>),
}

fn paused(places: Vec<usize>, sampling: Sampling<'_>) -> Turn<'_> {
    Turn::Paused(Box::new(Group { places, sampling }))
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
    fn groups<'q>(&self, asked: &[&'q Query]) -> Result<Vec<Group<'q>>, Fault>
    where
        'a: 'q,
    {
        let mut groups = Vec::new();
        let mut taken = vec![false; asked.len()];
        for (at, &query) in asked.iter().enumerate() {
            if taken[at] {
                continue;
            }
            let (places, sampling) = match &query.ask {
                Ask::Estimate { measure, estimator, level: Some(level) } => {
                    let prepared = self.prepared(measure.target.world)?;
                    let columns = [measure.target.column, *level];
                    let rule = splitting::Rule::of(estimator).ok_or(Fault::Unsuitable)?;
                    let question = Question::new(query, prepared, columns, rule, self.call.seed);
                    (vec![at], Sampling::Split(question))
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
                        .map(|&k| self.entry(asked[k]).map_err(refused(asked[k])))
                        .collect::<Result<Vec<_>, _>>()?;
                    let kept = entries.iter().map(|one| one.procedure.most_values(self.budget.max_trials));
                    let values = kept.fold(0, u64::saturating_add);
                    if values > MOST_VALUES {
                        return Err(Fault::Memory { place: query.span, values });
                    }
                    let sampling = EstimateSampling::new(self.prepared(world)?, entries, self.call.seed);
                    (together, Sampling::Estimate(sampling))
                }
                Ask::Compare { .. } => {
                    (vec![at], Sampling::Compare(self.compare(query).map_err(refused(query))?))
                }
                Ask::Rank { .. } => (vec![at], Sampling::Rank(self.rank(query).map_err(refused(query))?)),
            };
            groups.push(Group { places, sampling });
        }
        Ok(groups)
    }

    fn entry<'q>(&self, query: &'q Query) -> Result<EstimateEntry<'q>, Fault> {
        let (Ask::Check { measure, .. } | Ask::Estimate { measure, .. }) = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        Ok(EstimateEntry {
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

    fn compare<'q>(&self, query: &'q Query) -> Result<CompareSampling<'q>, Fault>
    where
        'a: 'q,
    {
        let Ask::Compare { first, second, within, delta, .. } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let sides = Sides {
            worlds: [self.prepared(first.target.world)?, self.prepared(second.target.world)?],
            columns: [first.target.column, second.target.column],
        };
        let asked = (self.call.seed, self.call.shows_evidence);
        CompareSampling::new(query, &sides, &first.kind, (*within, *delta), asked)
    }

    fn rank<'q>(&self, query: &'q Query) -> Result<RankSampling<'q>, Fault>
    where
        'a: 'q,
    {
        let Ask::Rank { options, measure, ranking, models } = &query.ask else {
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
        };
        let series = Series { seed: self.call.seed, branch: self.call.branch };
        RankSampling::new(query, setup, series, self.call.shows_evidence)
    }

    /// Runs a group for its share of the time.
    fn turn<'q>(
        &self,
        group: Group<'q>,
        (executor, levels): (&dyn Executor, &mut Levels),
        share: &Budget,
        watch: &dyn Watch,
    ) -> Result<Turn<'q>, Fault> {
        let Group { mut places, sampling } = group;
        // Outcomes that are not there are missing for one group: it ends, and the others go on.
        let budget = if executor.is_stored() { share } else { self.budget };
        let answers = Answers { call: self.call, budget };
        let budgets = (budget, share);
        let mut broken = None;
        let results = match sampling {
            Sampling::Estimate(mut estimate) => {
                match estimate.run((executor, levels), budgets, watch)? {
                    Advance::Stopped => {}
                    Advance::Paused => return Ok(paused(places, Sampling::Estimate(estimate))),
                    Advance::Faulty(found) => {
                        broken = Some(flaw(found.fault)?);
                        // Those that had stopped before that trial do not know of it.
                        estimate.keep(&mut places, |entry| entry.stopped_before(found.index));
                    }
                    Advance::Apart(columns) => {
                        let (slow, fast) = places
                            .into_iter()
                            .zip(&estimate.entries)
                            .partition::<Vec<_>, _>(|(_, entry)| columns.contains(&entry.column));
                        let of = |list: Vec<(usize, &EstimateEntry<'_>)>| {
                            list.into_iter().map(|(k, _)| k).collect()
                        };
                        let (slow, fast) = (of(slow), of(fast));
                        let apart = estimate.part(&columns);
                        return Ok(Turn::Apart(Box::new([
                            Group { places: fast, sampling: Sampling::Estimate(estimate) },
                            Group { places: slow, sampling: Sampling::Estimate(apart) },
                        ])));
                    }
                }
                answers.estimate(estimate)
            }
            Sampling::Compare(mut compare) => match answers.compare(&mut compare, executor, share, watch) {
                Ok(None) => return Ok(paused(places, Sampling::Compare(compare))),
                result => result.map(Vec::from_iter),
            },
            Sampling::Rank(mut rank) => match answers.rank(&mut rank, executor, share, watch) {
                Ok(None) => return Ok(paused(places, Sampling::Rank(rank))),
                result => result.map(Vec::from_iter),
            },
            Sampling::Split(question) => {
                answers.split(&question, executor, share, watch).map(|one| vec![one])
            }
        };
        Ok(match results {
            Ok(results) => Turn::Over(places.into_iter().zip(results).collect(), broken),
            Err(fault) => Turn::Over(Vec::new(), Some(flaw(fault)?)),
        })
    }

    /// The results of the queries of a group that have stopped; the others are left out.
    fn decided(&self, group: Group<'_>) -> Result<Answered, Fault> {
        let Group { mut places, sampling: Sampling::Estimate(mut estimate) } = group else {
            return Ok(Vec::new());
        };
        estimate.keep(&mut places, |entry| entry.stop.is_some());
        let answers = Answers { call: self.call, budget: self.budget };
        Ok(places.into_iter().zip(answers.estimate(estimate)?).collect())
    }
}
