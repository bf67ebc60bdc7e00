//! Answers: what a procedure has found, put into words and numbers.

use super::call::Call;
use super::cause;
use super::compare::CompareSampling;
use super::entry::EstimateEntry;
use super::estimate::EstimateSampling;
use super::every;
use super::executor::Executor;
use super::fault::Fault;
use super::method;
use super::outcome::{
    AskedQuery, Certificate, Certified, Counts, Evidence, Kind, QueryResult, Shows, Stop, Verdict, Witness,
};
use super::prepared::PreparedWorld;
use super::rank::RankSampling;
use super::tables;
use super::tally::Tally;
use super::watch::Watch;
use super::witness;
use super::words;
use crate::base::random::TrialKey;
use crate::compile::study::{Ask, Measure, MeasureKind, Query, RankOption};
use crate::logic::{Root, Sought};
use crate::stats::{Coverage, Decision, Statement};
use crate::trials::budget::{Budget, DEFAULT_TRIALS};
use crate::trials::cell::Item;

/// The option that ends queries after so many trials.
const MAX_TRIALS: &str = "--max-trials";

fn unit(measure: &Measure) -> String {
    match measure.kind {
        MeasureKind::Probability => String::new(),
        MeasureKind::Expectation { dimension, .. } | MeasureKind::Quantile { dimension, .. } => {
            dimension.to_string()
        }
    }
}

/// The interval of a result as what it certifies.
fn between(result: &QueryResult, error: f64) -> Certificate {
    Certificate { claim: Certified::Between { low: result.low, high: result.high }, error }
}

/// The first of the unresolved trials of a result.
pub(super) struct First<'s> {
    /// Where it was run.
    pub(super) prepared: &'s PreparedWorld,
    /// What was asked of it.
    pub(super) column: usize,
    /// The trial.
    pub(super) item: Item,
    /// Values of swept and `under` parameters.
    pub(super) settings: Vec<(String, String)>,
}

/// Puts what was found into results.
pub(super) struct Answers<'a> {
    /// What the command line said.
    pub(super) call: &'a Call<'a>,
    /// The budget, for its clock.
    pub(super) budget: &'a Budget,
}

impl Answers<'_> {
    /// What is known of a query before its first trial.
    pub(super) fn blank(&self, query: &Query, kind: Kind) -> QueryResult {
        let (file, line) = (self.call.place)(query.span);
        let (low, high) = legal(&query.ask);
        let asked = AskedQuery {
            name: query.name.clone(),
            file,
            line,
            settings: query.settings.clone(),
            horizon: query.horizon.clone(),
            given: query.given.clone(),
            ..AskedQuery::new(query.index, kind, query.text.clone())
        };
        QueryResult { low, high, ..QueryResult::new(asked) }
    }

    /// The call that stops at the same trial; `limit` is the option that counts them.
    pub(super) fn replay(&self, query: &Query, limit: &str, trials: u64) -> String {
        let line = &self.call.line;
        let mut words = if query.point.is_empty() { line.check() } else { line.check_at(&query.point) };
        // In a ranking of which a round was cut, how many trials there are in all does not tell which.
        if limit != MAX_TRIALS && self.budget.max_trials != DEFAULT_TRIALS {
            words.push_str(&format!(" {MAX_TRIALS} {}", self.budget.max_trials));
        }
        format!("{words} --only {} --seed {} {limit} {trials}", query.index, self.call.seed)
    }

    /// The results of an estimate that has stopped.
    pub(super) fn estimate(&self, estimate: EstimateSampling<'_>) -> Result<Vec<QueryResult>, Fault> {
        let prepared = estimate.prepared();
        estimate.entries.into_iter().map(|entry| self.entry(prepared, entry)).collect()
    }

    fn entry(&self, prepared: &PreparedWorld, mut entry: EstimateEntry<'_>) -> Result<QueryResult, Fault> {
        let query = entry.query;
        let counts = entry.tally.counts;
        let (measure, kind) = match &query.ask {
            Ask::Check { measure, .. } => (measure, Kind::Check),
            Ask::Estimate { measure, .. } => (measure, Kind::Estimate),
            Ask::Compare { .. } | Ask::Rank { .. } => return Err(Fault::Unsuitable),
        };
        let mut result = self.blank(query, kind);
        let stop = entry.stop.unwrap_or(Stop::Cap);
        result.method = method::of(&query.ask, Some(&entry.procedure));
        result.unit = unit(measure);
        result.stopped_by = stop;
        result.replay = self.replay(query, MAX_TRIALS, counts.trials);
        result.elapsed_s = entry.seconds;
        let measured = words::measured(query, measure, entry.tally.clipped);
        let mut beside = match query.ask {
            Ask::Check { beside, .. } => beside,
            _ => 0.0,
        };
        let least = match prepared.columns[measure.target.column] {
            Root::Metric(term) if prepared.is_never_early(term) => 0.0,
            _ => f64::NEG_INFINITY,
        };
        if let Some((mut interval, coverage, error)) = entry.procedure.interval(counts, beside) {
            beside = error;
            interval.low = interval.low.max(least);
            // Where no trial is resolved the middle of what is legal is no estimate.
            result.estimate = Some(interval.estimate)
                .filter(|middle| counts.unresolved < counts.trials && !middle.is_nan());
            result.low = interval.low;
            result.high = interval.high;
            result.interval = words::interval(coverage, error);
            // Only a time that does not come lies beyond the horizon; a distance to nobody is infinite.
            let time = match prepared.columns[measure.target.column] {
                Root::Metric(term) => prepared.tree.is_time_until(term),
                Root::Formula(_) | Root::Robustness(..) => false,
            };
            if matches!(measure.kind, MeasureKind::Quantile { .. }) && interval.high == f64::INFINITY && time
            {
                result.censored = Some(prepared.program.scenario.clock.seconds(prepared.horizon));
            }
            if kind == Kind::Estimate {
                let claim = match (result.censored, interval.low.is_infinite(), interval.high.is_infinite()) {
                    (Some(horizon), true, true) if interval.low > 0.0 => {
                        format!("> {}", words::quantity(horizon, &result.unit))
                    }
                    (Some(_), false, true) => format!(">= {}", words::quantity(interval.low, &result.unit)),
                    (None, true, false) => {
                        format!("<= {}", words::rounded(interval.high, true, &result.unit))
                    }
                    (None, false, true) => {
                        format!(">= {}", words::rounded(interval.low, false, &result.unit))
                    }
                    _ => format!("in {}", words::ends(interval.low, interval.high, &result.unit)),
                };
                if says_something(&query.ask, least, (interval.low, interval.high)) {
                    result.certifies = format!("{measured} {claim}, error at most {}", words::error(error));
                    result.certificate = Some(between(&result, error));
                }
                let fixed = coverage == Coverage::FixedSize;
                if fixed && result.estimate.is_some() && stop.is_early() {
                    result.warnings.push(
                        "the interval is for a number of trials fixed in advance, but sampling ended earlier"
                            .to_owned(),
                    );
                }
            }
        }
        if let Ask::Check { at_least, threshold, .. } = &query.ask {
            result.of = query.said.event.as_ref().map(|event| format!("P({event})"));
            result.against = result.of.is_some() && !*at_least;
            let decision = entry.procedure.decision();
            result.verdict = Some(match decision {
                Some(Decision::Above) if *at_least => Verdict::Satisfied,
                Some(Decision::Below) if !*at_least => Verdict::Satisfied,
                Some(Decision::Above | Decision::Below) => Verdict::Violated,
                Some(Decision::Within) | None => Verdict::Undecided,
            });
            result.certificate = match entry.procedure.statement() {
                Some(Statement { claim, error }) => {
                    Some(Certificate { claim: Certified::Decided(claim), error })
                }
                None if !says_something(&query.ask, least, (result.low, result.high)) => None,
                None => Some(between(&result, beside)),
            };
            result.certifies = match entry.procedure.statement() {
                Some(statement) => words::quantile(&query.said, *threshold, &statement)
                    .unwrap_or_else(|| words::statement(&measured, &statement, &result.unit)),
                None if !says_something(&query.ask, least, (result.low, result.high)) => String::new(),
                None => format!(
                    "{measured} in {}, error at most {}",
                    words::ends(result.low, result.high, &result.unit),
                    words::error(beside)
                ),
            };
            if entry.procedure.split() && counts.unresolved < counts.trials {
                result.warnings.push(
                    "the verdict depends on the unresolved trials: as failures and as successes they give opposite verdicts"
                        .to_owned(),
                );
            }
        }
        result.evidence = entry.evidence();
        let cut = was_cut(prepared, measure.target.column, &entry.tally);
        let known = counts.unresolved < counts.trials && !cut;
        result.distribution = entry.procedure.distribution().filter(|_| known);
        let quantiles = result.distribution.iter_mut().flat_map(|found| &mut found.quantiles);
        quantiles.for_each(|one| one.value.low = one.value.low.max(least));
        Self::tell(&mut result, prepared, &entry.tally, measure.target.column);
        self.note_odd(&mut result, &[(prepared, &entry.tally)]);
        self.lament_one(&mut result, prepared, &entry.tally, measure.target.column);
        let picks = match (&measure.kind, kind) {
            (MeasureKind::Probability, _) | (_, Kind::Check) => witness::sides(&entry.tally),
            _ if cut => Vec::new(),
            _ => witness::extremes(&entry.tally),
        };
        let settings = &result.asked.settings;
        result.witnesses = self.witnesses(&result, prepared, (measure.target.column, None), &picks, settings);
        Ok(result)
    }

    /// The witnesses of a column of a world, in which perhaps somebody was advised.
    pub(super) fn witnesses(
        &self,
        result: &QueryResult,
        prepared: &PreparedWorld,
        (column, advice): (usize, Option<(usize, usize)>),
        picks: &[(Shows, u64)],
        settings: &[(String, String)],
    ) -> Vec<Witness> {
        let calls = (self.call, self.budget);
        let picks = if self.call.explains { picks } else { &[] };
        witness::find(prepared, column, advice, picks, calls, settings, &result.unit)
    }

    /// Counts, and what they warn of.
    pub(super) fn tell(result: &mut QueryResult, prepared: &PreparedWorld, tally: &Tally, column: usize) {
        result.consumed = tally.consumed();
        let Ok(implications) = prepared.implications(column) else { return };
        // Of a trial that is not resolved nobody knows what the rest of it would have been.
        let resolved = tally.counts.trials - tally.counts.unresolved;
        let trials = match (resolved, tally.counts.unresolved) {
            (0, _) => return,
            (_, 0) => format!("{resolved} trials"),
            _ => format!("{resolved} resolved trials"),
        };
        // The 64th stands for all beyond: of those none was triggered, or perhaps all were.
        let idle = |implied: bool| {
            let some = implications.iter().enumerate().filter(|(_, one)| **one == implied);
            let all: Vec<usize> = some.map(|(k, _)| k.min(63)).collect();
            (all.iter().filter(|k| tally.triggered >> **k & 1 == 0).count(), all.len())
        };
        match idle(false) {
            (0, _) => {}
            (1, 1) => result.warnings.push(format!(
                "the implication was never triggered: its left side was true in none of {trials}"
            )),
            (idle, all) => result.warnings.push(format!(
                "{idle} of {all} implications were never triggered: their left sides were true in none of {trials}"
            )),
        }
        if let (idle, all @ 1..) = idle(true)
            && idle == all
        {
            result.warnings.push(format!(
                "no agent was present in any state that the formula reads, in all of {trials}"
            ));
        }
    }

    /// Says which bodies were made smaller in the first trial in which any was, and who had no way in the first in which
    /// anybody had none.
    pub(super) fn note_odd(&self, result: &mut QueryResult, tallies: &[(&PreparedWorld, &Tally)]) {
        let first = |of: &dyn Fn(&Tally) -> Option<u64>| {
            let mut found = tallies.iter().filter_map(|(prepared, tally)| Some((*prepared, of(tally)?)));
            found
                .next()
                .map(|(prepared, index)| (prepared, TrialKey { seed: self.call.seed, index, branch: 0 }))
        };
        if let Some((prepared, key)) = first(&|tally| tally.shrunk.first) {
            result.warnings.push(cause::smaller(&prepared.program, key, result.consumed.shrunk));
        }
        if let Some((prepared, key)) = first(&|tally| tally.no_way.first) {
            result.warnings.push(cause::stranded(&prepared.program, key, result.consumed.no_way));
        }
    }

    /// The same of a result of one world, in which nobody was advised.
    pub(super) fn lament_one(
        &self,
        result: &mut QueryResult,
        prepared: &PreparedWorld,
        tally: &Tally,
        column: usize,
    ) {
        let settings = result.asked.settings.clone();
        let item = |index| Item { advice: None, index };
        let first = tally.first[2].map(|index| First { prepared, column, item: item(index), settings });
        self.lament(result, tally.counts.unresolved, first.as_ref());
    }

    /// Says how many trials are unresolved, why the first of them is, and how to look at it.
    pub(super) fn lament(&self, result: &mut QueryResult, unresolved: u64, first: Option<&First<'_>>) {
        let counts = Counts { unresolved, ..result.consumed.counts };
        if unresolved == 0 {
            return;
        }
        let how_many = match (counts.trials, unresolved) {
            (1, _) => "the only trial is unresolved".to_owned(),
            (all, some) if all == some => {
                format!("all {all} trials are unresolved, so there is no result")
            }
            (all, 1) => format!("1 of {all} trials is unresolved"),
            (all, some) => format!("{some} of {all} trials are unresolved"),
        };
        let shown = first.map_or(String::new(), |first| {
            let why =
                cause::unresolved(first.prepared, first.column, first.item, (self.call.seed, self.budget));
            let index = first.item.index;
            let mut command = self.call.line.simulate(&first.settings, self.call.seed, index);
            if let Some(label) = witness::label(first.prepared, first.item.advice) {
                command.push_str(&format!(" --move '{label}'"));
            }
            let why = if why.is_empty() { why } else { format!("{why}; ") };
            format!("; trial {index}: {why}see {command}")
        });
        result.warnings.push(format!("{how_many}{shown}"));
    }

    /// Runs a comparison for its share of the time, and its result.
    pub(super) fn compare(
        &self,
        compare: &mut CompareSampling<'_>,
        executor: &dyn Executor,
        share: &Budget,
        watch: &dyn Watch,
    ) -> Result<Option<QueryResult>, Fault> {
        let query = compare.query();
        let Ask::Compare { first, second, settings, delta, .. } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let worlds = [compare.prepared(0), compare.prepared(1)];
        let prepared = worlds[0];
        let Some(gap) = compare.run(executor, (self.budget, share), watch)? else { return Ok(None) };
        let mut result = self.blank(query, Kind::Compare);
        let unit = unit(first);
        result.method = method::of(&query.ask, None);
        if gap.pairs > 0 {
            let known = |side: &Tally| side.counts.trials > side.counts.unresolved;
            result.estimate = gap.sides.iter().all(known).then_some(gap.estimate);
            result.low = gap.interval.low;
            result.high = gap.interval.high;
            result.interval = words::interval(gap.interval.coverage, gap.interval.error);
        }
        result.stopped_by = gap.stop;
        result.replay = self.replay(query, MAX_TRIALS, gap.pairs);
        let joined = Tally::total(&gap.sides);
        Self::tell(&mut result, prepared, &joined, first.target.column);
        self.note_odd(&mut result, &[(worlds[0], &gap.sides[0]), (worlds[1], &gap.sides[1])]);
        let lost = (0..2).find_map(|side| {
            let index = gap.sides[side].first[2]?;
            let settings = result.asked.settings.iter().chain(&settings[side]).cloned().collect();
            let (prepared, column) = (worlds[side], [first, second][side].target.column);
            Some(First { prepared, column, item: Item { advice: None, index }, settings })
        });
        self.lament(&mut result, joined.counts.unresolved, lost.as_ref());
        let label = |settings: &[(String, String)]| {
            settings.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
        };
        let labels = [label(&settings[0]), label(&settings[1])];
        let name = words::measured(query, first, joined.clipped);
        if says_something(&query.ask, f64::NEG_INFINITY, (result.low, result.high)) {
            result.certifies = format!(
                "{name} under {} less that under {} in {}, error at most {}",
                labels[0],
                labels[1],
                words::ends(result.low, result.high, &unit),
                words::error(*delta)
            );
            result.certificate = Some(between(&result, *delta));
        }
        result.unit = unit;
        result.compare = Some(tables::sides(&gap, &labels, *delta));
        result.evidence = gap.evidence;
        result.elapsed_s = compare.spent;
        Ok(Some(result))
    }

    /// Runs a ranking for its share of the time, and its result.
    pub(super) fn rank(
        &self,
        rank: &mut RankSampling<'_>,
        executor: &dyn Executor,
        share: &Budget,
        watch: &dyn Watch,
    ) -> Result<Option<QueryResult>, Fault> {
        let query = rank.query();
        let Ask::Rank { options, measure, ranking, models } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let delta = ranking.value("delta");
        let Some(ranked) = rank.run(executor, (self.budget, share), watch)? else { return Ok(None) };
        let setup = rank.setup();
        let mut result = self.blank(query, Kind::Rank);
        result.method = method::of(&query.ask, None);
        result.unit = unit(measure);
        result.stopped_by = ranked.stop;
        let joined = Tally::total(&ranked.tallies);
        result.replay = self.replay(query, "--total-trials", joined.counts.trials);
        Self::tell(&mut result, setup.worlds[0], &joined, measure.target.column);
        let tallies: Vec<_> = setup.worlds.iter().copied().zip(&ranked.tallies).collect();
        self.note_odd(&mut result, &tallies);
        // Of several values of a parameter the last one holds: that of the option.
        let settings = |arm: usize| [result.asked.settings.as_slice(), &options[arm].settings].concat();
        let lost = ranked.tallies.iter().enumerate().find_map(|(arm, tally)| {
            let item = setup.item(arm, tally.first[2]?);
            let column = options[arm].target.column;
            Some(First { prepared: setup.worlds[arm], column, item, settings: settings(arm) })
        });
        let models = *models;
        // Of several models that under which the choice did worst.
        let columns = ranked.choice.arm * models..(ranked.choice.arm + 1) * models;
        let value = |arm: &usize| ranked.values[*arm].0;
        let arm = columns.min_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default();
        let (own, prepared, column) = (settings(arm), setup.worlds[arm], options[arm].target.column);
        self.lament(&mut result, joined.counts.unresolved, lost.as_ref());
        let listed = tables::ranked(&ranked, options, models, query.every.as_ref());
        let score = words::measured(query, measure, joined.clipped);
        if let Some(choice) = &listed.choice {
            if listed.gap < ranked.scale {
                result.certifies = format!(
                    "{score} of `{choice}` is within {} of the best, error at most {}",
                    words::quantity(words::at_most(listed.gap), &result.unit),
                    words::error(delta)
                );
                let claim = Certified::Best { choice: choice.clone(), gap: listed.gap };
                result.certificate = Some(Certificate { claim, error: delta });
            }
            let chosen = &listed.options[0].value;
            result.estimate = Some(chosen.estimate);
            result.low = chosen.low;
            result.high = chosen.high;
            result.interval =
                format!("{}, all options jointly", words::interval(Coverage::TimeUniform, delta));
            let tally = &ranked.tallies[arm];
            let picks = match measure.kind {
                MeasureKind::Probability => witness::sides(tally),
                _ if was_cut(prepared, column, tally) => Vec::new(),
                _ => witness::extremes(tally),
            };
            let of = (column, options[arm].advice);
            result.witnesses = self.witnesses(&result, prepared, of, &picks, &own);
        }
        if let Some(every) = &query.every {
            result.every = every::of_ranking(every, &ranked, options, &listed);
        }
        result.rank = Some(listed);
        result.evidence = ranked.evidence.map(|snapshots| {
            let label = |option: &RankOption| match &query.every {
                Some(every) => {
                    let own = option.settings.iter().find(|(name, _)| *name == every.name);
                    format!("{}, {}", option.label, own.map_or("", |(_, value)| value))
                }
                None => option.label.clone(),
            };
            let labels = options.iter().map(label).collect();
            Evidence::Options { labels, snapshots }
        });
        result.elapsed_s = rank.spent;
        Ok(Some(result))
    }
}

/// Whether trials ended where a robustness left its range: of those no more is known than that.
fn was_cut(prepared: &PreparedWorld, column: usize, tally: &Tally) -> bool {
    tally.clipped > 0 && matches!(prepared.columns[column], Root::Robustness(_, Sought::Clipped(..)))
}

/// What a number can be: between 0 and 1, or in the declared range.
fn legal(ask: &Ask) -> (f64, f64) {
    let of = |measure: &Measure| match measure.kind {
        MeasureKind::Probability => (0.0, 1.0),
        MeasureKind::Expectation { range, .. } => range,
        MeasureKind::Quantile { .. } => (f64::NEG_INFINITY, f64::INFINITY),
    };
    match ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } | Ask::Rank { measure, .. } => of(measure),
        Ask::Compare { first, .. } => {
            let (low, high) = of(first);
            (low - high, high - low)
        }
    }
}

/// Whether an interval excludes anything that can be; nothing is below `least`.
fn says_something(ask: &Ask, least: f64, (low, high): (f64, f64)) -> bool {
    let (lowest, most) = legal(ask);
    low > lowest.max(least) || high < most
}
