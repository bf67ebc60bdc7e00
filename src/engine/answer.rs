//! Answers: what a procedure has found, put into words and numbers.

use super::budget::Budget;
use super::contrast::Contrast;
use super::executor::Executor;
use super::fault::Fault;
use super::outcome::{Kind, QueryResult, Shows, Stop, Verdict, Witness};
use super::procedure;
use super::race::Contest;
use super::session::Call;
use super::standing;
use super::subject::Subject;
use super::survey::{Inquiry, Survey};
use super::tally::Tally;
use super::trial;
use super::watch::Watch;
use super::witness;
use super::words;
use crate::compile::study::{Ask, Measure, MeasureKind, Query, Root};
use crate::logic::{Term, TermId, Tree};
use crate::stats::{Coverage, Decision};

fn unit(measure: &Measure) -> String {
    match measure.kind {
        MeasureKind::Probability => String::new(),
        MeasureKind::Expectation { dimension, .. } | MeasureKind::Quantile { dimension, .. } => {
            dimension.to_string()
        }
    }
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
        QueryResult {
            name: query.name.clone(),
            file,
            line,
            settings: query.settings.clone(),
            within: query.within.clone(),
            ..QueryResult::new(query.index, kind, query.text.clone())
        }
    }

    /// The call that stops at the same trial; `limit` is the option that counts them.
    pub(super) fn replay(&self, query: &Query, limit: &str, trials: u64) -> String {
        let call = format!("{} --only {} --seed {}", self.call.command, query.index, self.call.seed);
        // Where there was no time for a trial there is nothing to be replayed.
        if trials == 0 { call } else { format!("{call} {limit} {trials}") }
    }

    /// The results of a survey that has stopped.
    pub(super) fn survey(&self, survey: Survey<'_>) -> Result<Vec<QueryResult>, Fault> {
        let subject = survey.subject();
        survey.inquiries.into_iter().map(|inquiry| self.inquiry(subject, inquiry)).collect()
    }

    fn inquiry(&self, subject: &Subject, mut inquiry: Inquiry<'_>) -> Result<QueryResult, Fault> {
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
        result.replay = self.replay(query, "--max-trials", counts.trials);
        result.elapsed_s = inquiry.seconds;
        let subject_words = measured_words(query, measure);
        let mut beside = procedure::BESIDE;
        if let Some((interval, coverage, error)) = inquiry.procedure.interval(counts) {
            beside = error;
            result.estimate = Some(interval.estimate);
            result.low = interval.low;
            result.high = interval.high;
            result.interval = words::interval(coverage, error);
            // Only a time that does not come lies beyond the horizon; a distance to nobody is infinite.
            let time = match subject.columns[measure.target.column] {
                Root::Metric(term) => waits(&subject.tree, term),
                Root::Formula(_) | Root::Robustness(..) => false,
            };
            if matches!(measure.kind, MeasureKind::Quantile { .. }) && interval.high.is_infinite() && time {
                result.censored = Some(subject.program.scenario.clock.seconds(subject.horizon));
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
                    words::number(beside)
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
        let picks = match (&measure.kind, kind) {
            (MeasureKind::Probability, _) | (_, Kind::Check) => witness::sides(&inquiry.tally),
            _ => witness::extremes(&inquiry.tally),
        };
        result.witnesses = self.witnesses(&result, subject, measure.target.column, None, &picks);
        Ok(result)
    }

    /// The witnesses of a result.
    pub(super) fn witnesses(
        &self,
        result: &QueryResult,
        subject: &Subject,
        column: usize,
        advice: Option<(usize, usize)>,
        picks: &[(Shows, u64)],
    ) -> Vec<Witness> {
        witness::find(subject, column, advice, picks, self.call, &result.settings, &result.unit)
    }

    /// Counts, and what they warn of.
    pub(super) fn tell(&self, result: &mut QueryResult, subject: &Subject, tally: &Tally, column: usize) {
        result.counts = tally.counts;
        result.steps = tally.steps;
        result.clipped = tally.clipped;
        result.shrunk = tally.shrunk;
        if tally.counts.trials > 0
            && let Ok(implications) = subject.implications(column)
        {
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
            let full = tally.first[2].and_then(|index| trial::reason(subject, index, self.call.seed));
            let why = full.unwrap_or_else(|| {
                "somebody left every human speed, or a mean was over nobody; a smaller step may help"
                    .to_owned()
            });
            result.warnings.push(format!("{} trials are unresolved: {why}{first}", tally.counts.unresolved));
        }
    }

    /// Runs a comparison, and its result.
    pub(super) fn contrast(
        &self,
        contrast: Contrast<'_>,
        executor: &dyn Executor,
        watch: &dyn Watch,
    ) -> Result<QueryResult, Fault> {
        let started = self.budget.elapsed();
        let query = contrast.query();
        let Ask::Compare { first, settings, delta, .. } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let subject = contrast.subject(0);
        let gap = contrast.run(executor, self.budget, watch)?;
        let mut result = self.blank(query, Kind::Compare);
        let unit = unit(first);
        result.method = procedure::method(&query.ask, None);
        result.estimate = (gap.pairs > 0).then_some(gap.estimate);
        result.low = gap.interval.low;
        result.high = gap.interval.high;
        result.interval = words::interval(gap.interval.coverage, gap.interval.error);
        result.stopped_by = gap.stop;
        result.replay = self.replay(query, "--max-trials", gap.pairs);
        let joined = total(&gap.sides);
        self.tell(&mut result, subject, &joined, first.target.column);
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
        result.compare = Some(standing::sides(&gap, &labels, *delta));
        result.elapsed_s = self.budget.elapsed() - started;
        Ok(result)
    }

    /// Runs a ranking, and its result.
    pub(super) fn race(
        &self,
        mut contest: Contest<'_>,
        executor: &dyn Executor,
        watch: &dyn Watch,
    ) -> Result<QueryResult, Fault> {
        let started = self.budget.elapsed();
        let query = contest.query();
        let Ask::Rank { moves, measure, delta, .. } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let podium = contest.run(executor, self.budget, watch)?;
        let field = contest.field();
        let subject = field.subject;
        let declared = &subject.program.scenario.moves[*moves];
        let mut result = self.blank(query, Kind::Rank);
        result.method = procedure::method(&query.ask, None);
        result.unit = unit(measure);
        result.stopped_by = podium.stop;
        let joined = total(&podium.tallies);
        result.replay = self.replay(query, "--total-trials", joined.counts.trials);
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
        let arm = podium.choice.arm;
        let picks = match measure.kind {
            MeasureKind::Probability => witness::sides(&podium.tallies[arm]),
            _ => witness::extremes(&podium.tallies[arm]),
        };
        result.witnesses = self.witnesses(&result, subject, field.column, Some((*moves, arm)), &picks);
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

/// Whether a number is a time until something, or made of one.
fn waits(tree: &Tree, term: TermId) -> bool {
    match &tree.terms[term.0 as usize] {
        Term::TimeUntil(_) => true,
        Term::Constant(_) | Term::Signal(_) => false,
        Term::Combine(_, a, b) => waits(tree, *a) || waits(tree, *b),
        Term::Abs(a) | Term::Window(_, _, a) | Term::Later(_, a) | Term::AtEnd(a) => waits(tree, *a),
    }
}
