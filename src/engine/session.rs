//! A whole call: worlds made ready, queries run, results put into words.

use super::budget::Budget;
use super::contrast::{self, Sides};
use super::executor::Executor;
use super::fault::Fault;
use super::outcome::{Failure, Kind, QueryResult, Run, Stop, Verdict};
use super::procedure::{self, Procedure};
use super::race::{self, Field};
use super::standing;
use super::subject::Subject;
use super::survey::{self, Inquiry};
use super::tally::Tally;
use super::trial;
use super::watch::Watch;
use super::witness;
use super::words;
use crate::compile::study::{Ask, Measure, MeasureKind, Query, Study};
use crate::kernel::start;
use crate::stats::{Coverage, Decision};

/// What the command line adds to a study.
pub struct Call<'c> {
    /// Seed of all random numbers.
    pub seed: u64,
    /// The call up to its options, for replay lines: `smc check a.scn b.bltl --set density=0.8`.
    pub command: String,
    /// The call that shows a trial: `smc simulate a.scn --set density=0.8`.
    pub simulate: String,
    /// Indices of the queries to ask; all of them if empty.
    pub only: Vec<usize>,
    /// File and line of a span, for reports.
    pub place: &'c (dyn Fn(crate::syntax::source::Span) -> (String, usize) + Sync),
    /// Name for reports where the scenario has no title.
    pub file: String,
}

/// Runs a study.
pub fn run(
    study: &Study,
    call: &Call<'_>,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<Run, Fault> {
    let asked: Vec<&Query> =
        study.queries.iter().filter(|q| call.only.is_empty() || call.only.contains(&q.index)).collect();
    let mut subjects: Vec<Option<Subject>> = study.worlds.iter().map(|_| None).collect();
    for query in &asked {
        for world in worlds(&query.ask) {
            if subjects[world].is_none() {
                let subject = Subject::new(&study.worlds[world]);
                let crowding = start::check_area(&subject.program.scenario);
                if let Some(first) = crowding.first() {
                    return Err(Fault::Placement(crowded(&subject.program.scenario, first)));
                }
                subjects[world] = Some(subject);
            }
        }
    }
    let session = Session { call, executor, budget, watch, subjects: &subjects };
    let mut results: Vec<Option<QueryResult>> = asked.iter().map(|_| None).collect();
    let mut failure = None;
    for at in 0..asked.len() {
        if results[at].is_some() {
            continue;
        }
        let answered = session.answer(&asked, at, &results);
        match answered {
            Ok(found) => {
                for (k, result) in found {
                    results[k] = Some(result);
                }
            }
            // What was decided before stays decided.
            Err(Fault::Model(reason)) => {
                failure = Some(Failure::Input(reason));
                break;
            }
            Err(fault) => return Err(fault),
        }
    }
    watch.finished();
    Ok(Run {
        scenario: if study.title.is_empty() { call.file.clone() } else { study.title.clone() },
        seed: call.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        results: results.into_iter().flatten().collect(),
        warnings: Vec::new(),
        interrupted: budget.is_interrupted(),
        failure,
        replay: format!("{} --seed {}", call.command, call.seed),
        elapsed_s: budget.elapsed(),
    })
}

/// More people than fit, in words.
pub fn crowded(scenario: &crate::model::Scenario, crowding: &start::Crowding) -> String {
    let names: Vec<&str> = crowding
        .agents
        .iter()
        .filter_map(|id| scenario.agents.get(id.0 as usize))
        .map(|a| a.name.as_str())
        .collect();
    let who = match names.as_slice() {
        [] => "nobody".to_owned(),
        [one] => (*one).to_owned(),
        [first, .., last] => format!("{first} to {last} ({} people)", names.len()),
    };
    format!(
        "{who} cannot be placed: their bodies take {:.1} m^2, and there is room for {:.1} m^2 where they start",
        crowding.bodies, crowding.free
    )
}

fn worlds(ask: &Ask) -> Vec<usize> {
    match ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } | Ask::Rank { measure, .. } => {
            vec![measure.target.world]
        }
        Ask::Compare { first, second, .. } => vec![first.target.world, second.target.world],
    }
}

fn surveyed(ask: &Ask) -> Option<usize> {
    match ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => Some(measure.target.world),
        Ask::Compare { .. } | Ask::Rank { .. } => None,
    }
}

fn range(measure: &Measure) -> Option<(f64, f64)> {
    match measure.kind {
        MeasureKind::Expectation { range, .. } => Some(range),
        _ => None,
    }
}

fn unit(measure: &Measure) -> String {
    match measure.kind {
        MeasureKind::Probability => String::new(),
        MeasureKind::Expectation { dimension, .. } | MeasureKind::Quantile { dimension, .. } => {
            dimension.to_string()
        }
    }
}

struct Session<'a> {
    call: &'a Call<'a>,
    executor: &'a dyn Executor,
    budget: &'a Budget,
    watch: &'a dyn Watch,
    subjects: &'a [Option<Subject>],
}

impl Session<'_> {
    fn subject(&self, world: usize) -> Result<&Subject, Fault> {
        self.subjects.get(world).and_then(Option::as_ref).ok_or(Fault::Unsuitable)
    }

    /// The results of a query, and of those that are answered together with it.
    fn answer(
        &self,
        asked: &[&Query],
        at: usize,
        results: &[Option<QueryResult>],
    ) -> Result<Vec<(usize, QueryResult)>, Fault> {
        match &asked[at].ask {
            Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => {
                // All checks and estimates of a world read the same trials.
                let world = measure.target.world;
                let together: Vec<usize> = (at..asked.len())
                    .filter(|&k| results[k].is_none() && surveyed(&asked[k].ask) == Some(world))
                    .collect();
                let queries: Vec<&Query> = together.iter().map(|&k| asked[k]).collect();
                Ok(together.into_iter().zip(self.survey(&queries, world)?).collect())
            }
            Ask::Compare { .. } => Ok(vec![(at, self.compare(asked[at])?)]),
            Ask::Rank { .. } => Ok(vec![(at, self.rank(asked[at])?)]),
        }
    }

    /// What is known of a query before its first trial.
    fn blank(&self, query: &Query, kind: Kind) -> QueryResult {
        let (file, line) = (self.call.place)(query.span);
        QueryResult {
            name: query.name.clone(),
            file,
            line,
            settings: query.settings.clone(),
            within: query.within.clone(),
            ..QueryResult::new(query.index, kind, query.text.clone())
        }
    }

    fn replay(&self, query: &Query, trials: u64) -> String {
        format!(
            "{} --only {} --seed {} --max-trials {trials}",
            self.call.command, query.index, self.call.seed
        )
    }

    fn survey(&self, queries: &[&Query], world: usize) -> Result<Vec<QueryResult>, Fault> {
        let subject = self.subject(world)?;
        let mut inquiries = Vec::with_capacity(queries.len());
        for query in queries {
            let (Ask::Check { measure, .. } | Ask::Estimate { measure, .. }) = &query.ask else {
                return Err(Fault::Unsuitable);
            };
            inquiries.push(Inquiry {
                query,
                column: measure.target.column,
                range: range(measure),
                procedure: Procedure::new(&query.ask, self.call.seed)?,
                tally: Tally::default(),
                stop: None,
                seconds: 0.0,
            });
        }
        survey::run(subject, &mut inquiries, self.call.seed, self.executor, self.budget, self.watch)?;
        inquiries.into_iter().map(|inquiry| self.result(subject, inquiry)).collect()
    }

    fn result(&self, subject: &Subject, mut inquiry: Inquiry<'_>) -> Result<QueryResult, Fault> {
        let query = inquiry.query;
        let counts = inquiry.tally.counts;
        let (measure, kind) = match &query.ask {
            Ask::Check { measure, .. } => (measure, Kind::Check),
            Ask::Estimate { measure, .. } => (measure, Kind::Estimate),
            Ask::Compare { .. } | Ask::Rank { .. } => return Err(Fault::Unsuitable),
        };
        let mut result = self.blank(query, kind);
        let stop = inquiry.stop.unwrap_or(Stop::Cap);
        result.method = procedure::method(&query.ask, Some(&inquiry.procedure));
        result.unit = unit(measure);
        result.stopped_by = stop;
        result.replay = self.replay(query, counts.trials);
        result.elapsed_s = inquiry.seconds;
        let subject_words = measured_words(query, measure);
        if let Some((interval, coverage, error)) = inquiry.procedure.interval(counts) {
            result.estimate = Some(interval.estimate);
            result.low = interval.low;
            result.high = interval.high;
            result.interval = words::interval(coverage, error);
            if matches!(measure.kind, MeasureKind::Quantile { .. }) && interval.high.is_infinite() {
                result.censored = Some(subject.program.scenario.clock.seconds(subject.horizon));
            }
            if kind == Kind::Estimate {
                let claim = match (result.censored, interval.low.is_infinite(), interval.high.is_infinite()) {
                    (Some(horizon), true, true) if interval.low > 0.0 => {
                        format!("> {}", words::quantity(horizon, &result.unit))
                    }
                    (Some(_), false, true) => format!(">= {}", words::quantity(interval.low, &result.unit)),
                    _ => format!("in {}", words::ends(interval.low, interval.high, &result.unit)),
                };
                result.certifies = format!("{subject_words} {claim}, error at most {}", words::number(error));
                let fixed = coverage == Coverage::FixedSize;
                if fixed && matches!(stop, Stop::Deadline | Stop::Interrupt) {
                    result.warnings.push(
                        "the interval is for a number of trials fixed in advance, but sampling was cut short"
                            .to_owned(),
                    );
                }
            }
        }
        if let Ask::Check { at_least, .. } = &query.ask {
            let decision = inquiry.procedure.decision();
            result.verdict = Some(match decision {
                Some(Decision::Above) if *at_least => Verdict::Satisfied,
                Some(Decision::Below) if !*at_least => Verdict::Satisfied,
                Some(Decision::Above | Decision::Below) => Verdict::Violated,
                Some(Decision::Within) | None => Verdict::Undecided,
            });
            result.certifies = match inquiry.procedure.statement() {
                Some(statement) => words::statement(&subject_words, &statement, &result.unit),
                None => format!(
                    "{subject_words} in {}, error at most {}",
                    words::ends(result.low, result.high, &result.unit),
                    words::number(procedure::BESIDE)
                ),
            };
            if inquiry.procedure.split() {
                result.warnings.push(
                    "unresolved trials decide: read as failures and as successes they give opposite verdicts"
                        .to_owned(),
                );
            }
        }
        result.distribution = inquiry.procedure.distribution();
        self.tell(&mut result, subject, &inquiry.tally, measure.target.column);
        if matches!(measure.kind, MeasureKind::Probability) {
            let first = [inquiry.tally.first[1], inquiry.tally.first[0]];
            result.witnesses =
                witness::find(subject, measure.target.column, None, first, self.call, &query.settings);
        }
        Ok(result)
    }

    /// Counts, and what they warn of.
    fn tell(&self, result: &mut QueryResult, subject: &Subject, tally: &Tally, column: usize) {
        result.counts = tally.counts;
        result.steps = tally.steps;
        result.clipped = tally.clipped;
        result.shrunk = tally.shrunk;
        if tally.counts.trials > 0
            && let Ok(monitor) = subject.monitor(column)
        {
            let implications = monitor.antecedents().count();
            let idle = (0..implications.min(64)).filter(|k| tally.triggered >> k & 1 == 0).count();
            if idle > 0 {
                let which = if implications == 1 {
                    "the implication in it was".to_owned()
                } else {
                    format!("{idle} of its {implications} implications were")
                };
                result.warnings.push(format!(
                    "{which} never triggered: the left side was true in none of {} trials",
                    tally.counts.trials
                ));
            }
        }
        if tally.counts.unresolved > 0 {
            let first = tally.first[2].map_or(String::new(), |index| {
                format!(
                    "; see trial {index}: {} --trial {index} --seed {}",
                    self.call.simulate, self.call.seed
                )
            });
            let full = tally.first[2].and_then(|index| trial::overrun(subject, index, self.call.seed));
            let why = full.unwrap_or_else(|| {
                "somebody left every human speed, or a mean was over nobody; a smaller step may help"
                    .to_owned()
            });
            result.warnings.push(format!("{} trials are unresolved: {why}{first}", tally.counts.unresolved));
        }
    }

    fn compare(&self, query: &Query) -> Result<QueryResult, Fault> {
        let Ask::Compare { first, second, settings, within, delta } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let started = self.budget.elapsed();
        let sides = Sides {
            subjects: [self.subject(first.target.world)?, self.subject(second.target.world)?],
            columns: [first.target.column, second.target.column],
        };
        let contrast = contrast::run(
            &sides,
            &first.kind,
            (*within, *delta),
            &query.text,
            self.call.seed,
            self.executor,
            self.budget,
            self.watch,
        )?;
        let mut result = self.blank(query, Kind::Compare);
        let unit = unit(first);
        result.method = procedure::method(&query.ask, None);
        result.estimate = (contrast.pairs > 0).then_some(contrast.estimate);
        result.low = contrast.interval.low;
        result.high = contrast.interval.high;
        result.interval = words::interval(contrast.interval.coverage, contrast.interval.error);
        result.stopped_by = contrast.stop;
        result.replay = self.replay(query, contrast.pairs);
        let joined = total(&contrast.sides);
        self.tell(&mut result, sides.subjects[0], &joined, sides.columns[0]);
        let label = |settings: &[(String, String)]| {
            settings.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
        };
        let labels = [label(&settings[0]), label(&settings[1])];
        let name = measured_words(query, first);
        result.certifies = format!(
            "{name} under {} less that under {} in {}, error at most {}",
            labels[0],
            labels[1],
            words::ends(result.low, result.high, &unit),
            words::number(*delta)
        );
        result.unit = unit;
        result.compare = Some(standing::sides(&contrast, &labels, *delta));
        result.elapsed_s = self.budget.elapsed() - started;
        Ok(result)
    }

    fn rank(&self, query: &Query) -> Result<QueryResult, Fault> {
        let Ask::Rank { moves, measure, epsilon, delta, ranking } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let started = self.budget.elapsed();
        let subject = self.subject(measure.target.world)?;
        let declared = &subject.program.scenario.moves[*moves];
        let field = Field {
            subject,
            moves: *moves,
            deviations: declared.options.iter().map(|(_, m)| m.deviation()).collect(),
            column: measure.target.column,
            kind: measure.kind.clone(),
            rule: (*epsilon, *delta, *ranking),
        };
        let podium = race::run(&field, &query.text, self.call.seed, self.executor, self.budget, self.watch)?;
        let mut result = self.blank(query, Kind::Rank);
        result.method = procedure::method(&query.ask, None);
        result.unit = unit(measure);
        result.stopped_by = podium.stop;
        let most = podium.tallies.iter().map(|t| t.counts.trials).max().unwrap_or(0);
        result.replay = self.replay(query, most);
        let joined = total(&podium.tallies);
        self.tell(&mut result, subject, &joined, measure.target.column);
        result.clipped = joined.clipped;
        let labels: Vec<&str> = declared.options.iter().map(|(label, _)| label.as_str()).collect();
        let ranked = standing::ranked(&podium, &labels);
        let gap = ranked.gap;
        let score = measured_words(query, measure);
        result.certifies = if gap < podium.scale {
            format!(
                "{score} of `{}` is within {} of the best, error at most {}",
                ranked.choice,
                words::quantity(words::at_most(gap), &result.unit),
                words::number(*delta)
            )
        } else {
            format!("nothing: `{}` has the best score so far", ranked.choice)
        };
        let chosen = &ranked.options[0].value;
        result.estimate = Some(chosen.estimate);
        result.low = chosen.low;
        result.high = chosen.high;
        result.interval = format!("{}, all options jointly", words::interval(Coverage::TimeUniform, *delta));
        if matches!(measure.kind, MeasureKind::Probability) {
            let arm = podium.choice.arm;
            let first = [podium.tallies[arm].first[1], podium.tallies[arm].first[0]];
            result.witnesses =
                witness::find(subject, field.column, Some((*moves, arm)), first, self.call, &query.settings);
        }
        result.rank = Some(ranked);
        result.elapsed_s = self.budget.elapsed() - started;
        Ok(result)
    }
}

/// The measure as one would say it: `P(safe)`.
fn measured_words(query: &Query, measure: &Measure) -> String {
    words::measured(
        &query.text,
        match measure.kind {
            MeasureKind::Probability => 'P',
            MeasureKind::Expectation { .. } => 'E',
            MeasureKind::Quantile { .. } => 'Q',
        },
    )
}

fn total(tallies: &[Tally]) -> Tally {
    let mut sum = Tally::default();
    for tally in tallies {
        sum.counts.trials += tally.counts.trials;
        sum.counts.successes += tally.counts.successes;
        sum.counts.failures += tally.counts.failures;
        sum.counts.unresolved += tally.counts.unresolved;
        sum.steps += tally.steps;
        sum.clipped += tally.clipped;
        sum.shrunk += tally.shrunk;
        sum.triggered |= tally.triggered;
    }
    sum
}
