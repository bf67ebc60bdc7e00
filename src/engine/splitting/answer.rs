//! What splitting found, in words: the estimate is labelled for what it is, the sound bound stands beside it,
//! and where plain trials contradict it there is no estimate.

use super::{Found, Question, run};
use crate::engine::answer::Answers;
use crate::engine::executor::Executor;
use crate::engine::fault::Fault;
use crate::engine::outcome::{Kind, QueryResult, Rare, Stop};
use crate::engine::procedure;
use crate::engine::watch::Watch;
use crate::engine::witness;
use crate::engine::words;

/// Code of a disagreement, for `smc explain`.
const DISAGREES: &str = "E0802";

impl Answers<'_> {
    /// Estimates a probability by splitting.
    pub(in crate::engine) fn split(
        &self,
        question: &Question<'_>,
        executor: &dyn Executor,
        watch: &dyn Watch,
    ) -> Result<QueryResult, Fault> {
        let started = self.budget.elapsed();
        let Question { query, subject, column, rule, .. } = *question;
        let found = run(question, executor, self.budget, watch)?;
        let mut result = self.blank(query, Kind::Estimate);
        result.method = procedure::method(&query.ask, None);
        result.stopped_by = found.stop;
        let counts = found.plain.counts;
        result.replay = self.replay(query, "--max-trials", counts.trials + found.paths);
        self.tell(&mut result, subject, &found.plain, column);
        let name = words::measured(&query.text, 'P');
        // From above the only statement that holds without a condition is that of the plain trials.
        result.certifies = format!(
            "{name} <= {}, error at most {} (from the plain trials alone)",
            words::number(words::at_most(found.bound)),
            words::number(rule.delta)
        );
        if counts.trials == 0 {
            result.certifies = String::new();
        }
        if let Some(spread) = found.spread.filter(|spread| spread.floor > 0.0) {
            result.certifies = format!(
                "{}; {name} >= {}, error at most {} (from the runs, which are unbiased)",
                result.certifies,
                words::number(words::at_least(spread.floor)),
                words::number(rule.delta)
            );
        }
        state(&mut result, &found, rule.delta);
        let picks = witness::sides(&found.plain);
        result.witnesses = self.witnesses(&result, subject, column, None, &picks);
        result.elapsed_s = self.budget.elapsed() - started;
        Ok(result)
    }
}

/// Estimate, interval and warnings.
fn state(result: &mut QueryResult, found: &Found, delta: f64) {
    let plain = found.interval;
    let agrees = found.spread.is_none_or(|s| plain.low <= s.mean && s.mean <= plain.high);
    let sampled = found.plain.counts.trials > 0;
    result.rare = Some(Rare {
        runs: found.spread.map_or(0, |s| s.runs),
        extinct: found.spread.map_or(0, |s| s.extinct),
        deviation: found.spread.map_or(0.0, |s| s.deviation),
        levels: found.levels,
        paths: found.paths,
        steps: found.steps,
        estimate: found.spread.map(|s| s.mean),
        low: found.spread.map_or(0.0, |s| s.low),
        high: found.spread.map_or(1.0, |s| s.high),
        plain_low: if sampled { plain.low } else { 0.0 },
        plain_high: if sampled { plain.high } else { 1.0 },
        plain_bound: if sampled { found.bound } else { 1.0 },
        floor: found.spread.map_or(0.0, |s| s.floor),
        agrees,
    });
    match found.spread {
        Some(spread) if agrees && spread.mean > 0.0 => {
            result.estimate = Some(spread.mean);
            result.low = spread.low;
            result.high = spread.high;
            result.interval =
                format!("asymptotic, {}, {} runs: not certified", words::percent(1.0 - delta), spread.runs);
            if spread.extinct > 0 {
                result.warnings.push(format!(
                    "{} of {} runs never reached the event; with more replicas the estimate scatters less",
                    spread.extinct, spread.runs
                ));
            }
            result.warnings.push(
                "the interval supposes that the robustness sees the way on which the event mostly comes; its misses are mostly low"
                    .to_owned(),
            );
        }
        _ => {
            let counts = found.plain.counts;
            result.estimate = (counts.trials > 0).then(|| procedure::share(counts));
            result.low = if sampled { plain.low } else { 0.0 };
            result.high = if sampled { plain.high } else { 1.0 };
            "fixed size, 99 %, of the plain trials".clone_into(&mut result.interval);
            let stopped = matches!(found.stop, Stop::Cap | Stop::Deadline | Stop::Interrupt);
            result.warnings.push(match found.spread {
                Some(spread) if !agrees => format!(
                    "{DISAGREES}: splitting says {}, which the plain trials exclude at 99 %: refused; the robustness does not see the way on which the event comes",
                    words::number(spread.mean)
                ),
                Some(_) if found.blind => format!(
                    "{DISAGREES}: no run reached the event, and the robustness rose in none of them before it; ask for the opposite, or for an event that comes by and by"
                ),
                Some(_) => "no run of splitting reached the event: more replicas, or a later horizon".to_owned(),
                None if stopped => "sampling ended before the runs of splitting did: this is what the plain trials say".to_owned(),
                None => "splitting came to no estimate".to_owned(),
            });
        }
    }
    if found.lost > 0 {
        result
            .warnings
            .push(format!("{} paths of splitting diverged and count as not reaching the event", found.lost));
    }
}
