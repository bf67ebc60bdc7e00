//! Results of checks and estimates.

use super::{Answered, Answers, MAX_TRIALS, Sampling, Turn, between, says_something, unit, was_cut};
use super::{method, words};
use crate::compile::study::{Ask, MeasureKind};
use crate::engine::fault::Fault;
use crate::engine::outcome::{Certificate, Certified, Kind, QueryResult, Stop, Verdict};
use crate::engine::sampling::entry::EstimateEntry;
use crate::engine::sampling::estimate::{Advance, EstimateSampling};
use crate::engine::sampling::resources::Resources;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::{self, Inspected};
use crate::logic::Root;
use crate::stats::{Coverage, Decision, Statement};
impl<'q> Sampling<'q> for EstimateSampling<'q> {
    fn run(&mut self, answers: &Answers<'_>, resources: Resources<'_>) -> Result<Turn<'q>, Fault> {
        let mut broken = None;
        match self.advance(resources)? {
            Advance::Stopped => {}
            Advance::Paused => return Ok(Turn::Paused),
            Advance::Faulty(found) => {
                broken = Some(found.fault);
                // Those that had stopped before that trial do not know of it.
                self.entries.retain(|entry| entry.stopped_before(found.index));
            }
            Advance::Apart(columns) => return Ok(Turn::Apart(Box::new(self.part(&columns)))),
        }
        Ok(Turn::Over(answers.entries(self)?, broken))
    }

    fn decided(&mut self, answers: &Answers<'_>) -> Result<Answered, Fault> {
        self.entries.retain(|entry| entry.stop.is_some());
        answers.entries(self)
    }
}

impl Answers<'_> {
    /// The results of all queries of an estimate.
    fn entries(&self, estimate: &mut EstimateSampling<'_>) -> Result<Answered, Fault> {
        let prepared = estimate.job.prepared;
        let all = std::mem::take(&mut estimate.entries).into_iter();
        all.map(|entry| Ok((entry.place, self.entry(prepared, entry)?))).collect()
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
            if let MeasureKind::Curve { last, .. } = &measure.kind {
                result.of = Some(last.clone());
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
            result.asked.against = result.of.is_some() && !*at_least;
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
        if let (Some(curve), Some(certificate)) =
            (result.distribution.as_ref().and_then(|found| found.curve.as_ref()), result.certificate.as_ref())
        {
            let reach = words::number(words::at_most(curve.reach));
            let error = words::error(certificate.error);
            result.certifies = format!(
                "{measured} within ± {reach} of the curve at all {} bounds at once, error at most {error}",
                curve.points.len()
            );
        }
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
        let unit = match &measure.kind {
            MeasureKind::Curve { dimension, .. } => &dimension.to_string(),
            _ => &result.unit,
        };
        let (column, settings) = (measure.target.column, &result.asked.settings[..]);
        let of = Inspected { prepared, column, advice: None, settings, unit };
        result.witnesses = self.witnesses(of, &picks);
        Ok(result)
    }
}
