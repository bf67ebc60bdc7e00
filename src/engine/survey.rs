//! Checks and estimates of one world: all of them read the same trials, each until it stops.
//!
//! Trials are run in rounds. A round is consumed trial by trial in index order, and every query looks after
//! each trial, so the size of rounds leaves no trace in a result.

use super::budget::Budget;
use super::cell::{Item, Reading};
use super::executor::{Executor, Job};
use super::fault::Fault;
use super::outcome::Stop;
use super::procedure::Procedure;
use super::subject::Subject;
use super::tally::Tally;
use super::watch::{Forecast, Watch};
use crate::compile::study::Query;

/// Largest round.
const LARGEST_ROUND: u64 = 16_384;

/// One query on its way.
pub(super) struct Inquiry<'q> {
    /// The query.
    pub(super) query: &'q Query,
    /// Column of the subject.
    pub(super) column: usize,
    /// Range of an expectation.
    pub(super) range: Option<(f64, f64)>,
    /// Its procedure.
    pub(super) procedure: Procedure,
    /// What it has consumed.
    pub(super) tally: Tally,
    /// Why it stopped.
    pub(super) stop: Option<Stop>,
    /// Seconds from the start of the survey to its stop.
    pub(super) seconds: f64,
}

/// Runs the inquiries of one subject until each has stopped.
pub(super) fn run(
    subject: &Subject,
    inquiries: &mut [Inquiry<'_>],
    seed: u64,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<(), Fault> {
    let started = budget.elapsed();
    let mut job = Job::new(subject, columns(inquiries), seed);
    let mut next = 0u64;
    let mut forecast_due = true;
    while inquiries.iter().any(|i| i.stop.is_none()) {
        if budget.must_stop() {
            close(inquiries, budget);
            break;
        }
        job.narrow(columns(inquiries));
        let size = round(inquiries, next, executor.width(&job) as u64, budget);
        let items: Vec<Item> = (next..next + size).map(|index| Item { advice: None, index }).collect();
        let cells = executor.run(&job, &items, budget)?;
        let mut complete = true;
        for (item, row) in items.iter().zip(cells.rows()) {
            let Some(row) = row else {
                // What follows an unfinished trial is not looked at: outcomes count in index order.
                complete = false;
                break;
            };
            for inquiry in inquiries.iter_mut().filter(|i| i.stop.is_none()) {
                let Some(place) = job.columns.iter().position(|c| *c == inquiry.column) else { continue };
                let cell = &row[place];
                if cell.reading == Reading::Faulty {
                    return Err(super::trial::fault(subject, *item, seed));
                }
                inquiry.tally.add(item.index, cell, inquiry.range);
                if inquiry.procedure.observe(cell) {
                    inquiry.stop = Some(if inquiry.procedure.is_capped() {
                        Stop::Cap
                    } else if inquiry.procedure.is_planned() {
                        Stop::Plan
                    } else if matches!(
                        inquiry.procedure,
                        Procedure::Test(_) | Procedure::Mean { threshold: Some(_), .. }
                    ) {
                        Stop::Boundary
                    } else {
                        Stop::Width
                    });
                    inquiry.seconds = budget.elapsed() - started;
                } else if inquiry.tally.counts.trials >= budget.max_trials {
                    inquiry.stop = Some(Stop::Cap);
                    inquiry.seconds = budget.elapsed() - started;
                }
            }
        }
        next += size;
        if !complete {
            close(inquiries, budget);
            break;
        }
        if forecast_due {
            forecast_due = false;
            let rate = next as f64 / (budget.elapsed() - started).max(1e-9);
            for inquiry in inquiries.iter().filter(|i| i.stop.is_none()) {
                if let Some(trials) = expected(inquiry) {
                    let trials = trials.min(budget.max_trials);
                    let seconds = trials as f64 / rate;
                    watch.forecast(&Forecast { query: inquiry.query.text.clone(), trials, seconds });
                }
            }
        }
        if let Some(inquiry) = inquiries.iter().find(|i| i.stop.is_none()) {
            watch.consumed(&inquiry.query.text, next, expected(inquiry));
        }
    }
    let seconds = budget.elapsed() - started;
    for inquiry in inquiries.iter_mut().filter(|i| i.seconds == 0.0) {
        inquiry.seconds = seconds;
    }
    Ok(())
}

/// Columns that somebody still reads.
fn columns(inquiries: &[Inquiry<'_>]) -> Vec<usize> {
    let mut columns: Vec<usize> = inquiries.iter().filter(|i| i.stop.is_none()).map(|i| i.column).collect();
    columns.sort_unstable();
    columns.dedup();
    columns
}

/// Time is up, or somebody interrupted: what is known stays known.
fn close(inquiries: &mut [Inquiry<'_>], budget: &Budget) {
    let stop = if budget.is_interrupted() { Stop::Interrupt } else { Stop::Deadline };
    for inquiry in inquiries.iter_mut().filter(|i| i.stop.is_none()) {
        inquiry.stop = Some(stop);
    }
}

/// How many trials the next round has: enough to keep all lanes busy, few enough to waste little once the
/// last query has stopped.
fn round(inquiries: &[Inquiry<'_>], consumed: u64, width: u64, budget: &Budget) -> u64 {
    let open = || inquiries.iter().filter(|i| i.stop.is_none());
    let left = |inquiry: &Inquiry<'_>| {
        let limit = inquiry.procedure.limit().unwrap_or(u64::MAX).min(budget.max_trials);
        limit.saturating_sub(consumed)
    };
    let sure = open().filter(|i| i.procedure.is_planned()).map(left).max().unwrap_or(0);
    let most = open().map(left).max().unwrap_or(0);
    let size = (consumed / 8).max(2 * width).max(sure.min(consumed.max(8 * width)));
    // With a deadline rounds stay short, so that little is thrown away at its end.
    let size = if budget.has_deadline() { size.min(consumed.max(2 * width)) } else { size };
    size.min(most).clamp(1, LARGEST_ROUND)
}

/// A rough forecast of the trials of an inquiry from its first ones: nothing that a result depends on.
fn expected(inquiry: &Inquiry<'_>) -> Option<u64> {
    use crate::compile::study::{Ask, Estimator, MeasureKind, Test};
    let counts = inquiry.tally.counts;
    if inquiry.procedure.is_planned() {
        return inquiry.procedure.limit();
    }
    // Laplace's rule keeps the share away from 0 and 1.
    let p = (counts.successes as f64 + 1.0) / (counts.trials as f64 + 2.0);
    let variance = p * (1.0 - p);
    let trials = match &inquiry.query.ask {
        Ask::Check {
            threshold,
            test: Test::Sprt { alpha, beta, indifference } | Test::Sprt2 { alpha, beta, indifference },
            ..
        } => {
            let (p0, p1) = (threshold + indifference, threshold - indifference);
            let ln = crate::base::math::ln;
            let drift = p * ln(p1 / p0) + (1.0 - p) * ln((1.0 - p1) / (1.0 - p0));
            let goal = if drift > 0.0 { -ln(*alpha) } else { -ln(*beta) };
            goal / drift.abs().max(1e-9)
        }
        Ask::Check {
            threshold, test: Test::EProcess { alpha, .. } | Test::ThreeWay { alpha, .. }, ..
        } => {
            let ln = crate::base::math::ln;
            let kl = p * ln(p / threshold) + (1.0 - p) * ln((1.0 - p) / (1.0 - threshold));
            (5.0 - ln(*alpha)) / kl.max(1e-9)
        }
        Ask::Estimate {
            measure,
            estimator:
                Estimator::Default { epsilon, .. }
                | Estimator::Massart { epsilon, .. }
                | Estimator::Spending { epsilon, .. },
        } if measure.kind == MeasureKind::Probability => 4.4 * variance / (epsilon * epsilon) + 2.0 / epsilon,
        Ask::Estimate { estimator: Estimator::Relative { epsilon, .. }, .. } => 4.0 / (epsilon * epsilon * p),
        _ => return inquiry.procedure.limit(),
    };
    let limit = inquiry.procedure.limit().unwrap_or(u64::MAX);
    Some((trials.min(1e18) as u64).clamp(counts.trials, limit.max(counts.trials)))
}
