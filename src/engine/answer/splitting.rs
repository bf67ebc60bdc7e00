//! What splitting found, in words: the estimate is labelled for what it is, the sound bound stands beside it,
//! and where plain trials contradict it there is no estimate.

use super::{Answers, Sampling, Turn, method, words};
use crate::base::math;
use crate::engine::fault::Fault;
use crate::engine::outcome::{Certificate, Certified, Kind, QueryResult, Rare, Stop};
use crate::engine::sampling::procedure;
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::splitting::{DISAGREEMENT, Found, Question, run};
use crate::engine::witness;
use crate::stats::splitting::Spread;
use crate::syntax::codes::Code;

/// Code of a disagreement, for `smc explain`.
const DISAGREES: Code = Code::E0802;

impl<'q> Sampling<'q> for Question<'q> {
    fn run(&mut self, answers: &Answers<'_>, resources: Resources<'_>) -> Result<Turn<'q>, Fault> {
        Ok(Turn::Over(vec![(self.place, answers.split(self, resources)?)], None))
    }
}

impl Answers<'_> {
    /// Estimates a probability by splitting.
    fn split(&self, question: &Question<'_>, resources: Resources<'_>) -> Result<QueryResult, Fault> {
        let started = self.budget.elapsed();
        let Question { query, prepared, column, rule, .. } = *question;
        let found = run(question, resources)?;
        let mut result = self.blank(query, Kind::Estimate);
        result.method = method::of(&query.ask, None);
        result.stopped_by = found.stop;
        let counts = found.plain.counts;
        result.replay = self.replay(query, "--max-trials", counts.trials + found.paths);
        Self::tell(&mut result, prepared, &found.plain, column);
        self.note_odd(&mut result, &[(prepared, &found.plain)]);
        self.lament_one(&mut result, prepared, &found.plain, column);
        let name = words::decided(&query.said);
        // From above the only statement that holds without a condition is that of the plain trials.
        let above = found.above();
        let floor = found.spreads.map_or(0.0, |[low, _]| low.floor);
        // One of two bounds that contradict each other is wrong, and nothing says which.
        let is_clear = floor <= above;
        let bound = (counts.trials > 0 && above < 1.0 && is_clear).then_some(above);
        let floor = (0.0 < floor && is_clear).then_some(floor);
        let said = |sign: &str, value: f64, from: &str| {
            let (number, error) = (words::number(value), words::error(rule.delta));
            format!("{name} {sign} {number}, error at most {error} ({from})")
        };
        let parts = [
            bound.map(|bound| said("<=", words::at_most(bound), "from the plain trials alone")),
            floor.map(|floor| said(">=", words::at_least(floor), "from the runs, which are unbiased")),
        ];
        result.certifies = parts.into_iter().flatten().collect::<Vec<_>>().join("; ");
        if !is_clear {
            result.warnings.push(
                "the bound of the plain trials is below the bound of the runs: one of them is wrong, so neither is certified"
                    .to_owned(),
            );
        }
        // Each end may be wrong with its own error.
        let ends = u8::from(floor.is_some()) + u8::from(bound.is_some());
        result.certificate = (ends > 0).then(|| Certificate {
            claim: Certified::Between { low: floor.unwrap_or(0.0), high: bound.unwrap_or(1.0) },
            error: f64::from(ends) * rule.delta,
        });
        state(&mut result, &found, rule.delta);
        let picks = witness::sides(&found.plain);
        let (settings, unit) = (&result.asked.settings[..], &result.unit[..]);
        result.witnesses =
            self.witnesses(witness::Inspected { prepared, column, advice: None, settings, unit }, &picks);
        result.elapsed_s = self.budget.elapsed() - started;
        Ok(result)
    }
}

/// Estimate, interval and warnings.
fn state(result: &mut QueryResult, found: &Found, delta: f64) {
    let plain = found.interval;
    // Both readings of lost paths, each with its own interval.
    let spread = found.spreads.map(|[low, high]| Spread {
        mean: 0.5 * (low.mean + high.mean),
        low: math::at_most(low.low, high.low),
        high: math::at_least(low.high, high.high),
        deviation: math::at_least(low.deviation, high.deviation),
        ..low
    });
    let agrees = found.spreads.is_none_or(|both| both.iter().all(|s| plain.holds(s.mean)));
    let sampled = found.plain.counts.trials > 0;
    result.rare = Some(Rare {
        runs: spread.map_or(0, |s| s.runs),
        extinct: spread.map_or(0, |s| s.extinct),
        deviation: spread.map_or(0.0, |s| s.deviation),
        levels: found.levels,
        paths: found.paths,
        steps: found.steps,
        estimate: spread.map(|s| s.mean),
        low: spread.map_or(0.0, |s| s.low),
        high: spread.map_or(1.0, |s| s.high),
        plain_low: if sampled { plain.low } else { 0.0 },
        plain_high: if sampled { plain.high } else { 1.0 },
        plain_bound: if sampled { found.bound } else { 1.0 },
        floor: spread.map_or(0.0, |s| s.floor),
        agrees,
    });
    match spread {
        Some(spread) if agrees && spread.mean > 0.0 => {
            result.estimate = Some(spread.mean);
            result.low = spread.low;
            result.high = spread.high;
            result.interval =
                format!("asymptotic, {}, {} runs: not certified", words::level(delta), spread.runs);
            if spread.extinct > 0 {
                result.warnings.push(format!(
                    "{} of {} runs never reached the event; more replicas reduce the scatter",
                    spread.extinct, spread.runs
                ));
            }
            result.warnings.push(
                "the interval assumes that the robustness rises on most paths to the event; if not, it is too low"
                    .to_owned(),
            );
        }
        _ => {
            let counts = found.plain.counts;
            let is_refused = !agrees || spread.is_some() && found.blind;
            // The share of the plain trials in place of refused estimates would bias their mean over seeds.
            result.estimate = (counts.trials > 0 && !is_refused).then(|| procedure::share(counts));
            if is_refused {
                result.method = method::plain(plain.coverage, counts.trials, DISAGREEMENT);
            }
            result.low = if sampled { plain.low } else { 0.0 };
            result.high = if sampled { plain.high } else { 1.0 };
            result.interval =
                format!("{}, of the plain trials", words::interval(plain.coverage, DISAGREEMENT));
            let stopped = found.stop == Stop::Cap || found.stop.is_early();
            result.warnings.push(match spread {
                Some(spread) if !agrees => format!(
                    "{DISAGREES}: splitting estimates {}, which the plain trials exclude at {}: refused; the robustness does not rise on most paths to the event",
                    words::number(spread.mean),
                    words::level(DISAGREEMENT)
                ),
                Some(_) if found.blind => format!(
                    "{DISAGREES}: no run reached the event, and the robustness rose in none of them; use the complement, or an event that is approached gradually"
                ),
                Some(_) => "no run of splitting reached the event; use more replicas or a later horizon".to_owned(),
                None if stopped => "sampling ended before the runs of splitting were complete; this is the result of the plain trials".to_owned(),
                None => "splitting gave no estimate".to_owned(),
            });
        }
    }
    if found.lost > 0 {
        result
            .warnings
            .push(format!("{} paths of splitting are unresolved; the interval covers both cases, that they reach the event and that they do not", found.lost));
    }
}
