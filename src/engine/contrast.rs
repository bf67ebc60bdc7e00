//! Comparisons: one measure in two worlds, over pairs of trials with the same random numbers.

use super::budget::Budget;
use super::cell::{Cell, Item, Reading};
use super::executor::{Executor, Job};
use super::fault::Fault;
use super::outcome::Stop;
use super::procedure::{outcome, value};
use super::subject::Subject;
use super::tally::Tally;
use super::watch::Watch;
use crate::compile::methods;
use crate::compile::study::MeasureKind;
use crate::stats::{self, Difference, Mean};

/// The procedure of a comparison.
enum Procedure {
    /// Of probabilities.
    Probability(Difference),
    /// Of expectations: the mean of the differences, which lie in twice the range.
    Expectation(Mean),
}

/// A comparison on its way.
pub(super) struct Contrast {
    /// What each side consumed.
    pub(super) sides: [Tally; 2],
    /// Sums of the values of each side, for expectations.
    pub(super) sums: [(f64, u64); 2],
    /// Why it stopped.
    pub(super) stop: Stop,
    /// Interval of first less second.
    pub(super) interval: stats::Interval,
    /// The estimate of first less second.
    pub(super) estimate: f64,
    /// Pairs in which only the first, only the second held.
    pub(super) alone: (u64, u64),
    /// Pairs.
    pub(super) pairs: u64,
    /// Pairs with an unresolved trial.
    pub(super) unresolved: u64,
}

/// Two sides of a comparison: subject and column of each.
pub(super) struct Sides<'s> {
    /// The subjects.
    pub(super) subjects: [&'s Subject; 2],
    /// Their columns.
    pub(super) columns: [usize; 2],
}

/// Runs a comparison.
pub(super) fn run(
    sides: &Sides<'_>,
    kind: &MeasureKind,
    (within, delta): (Option<f64>, f64),
    text: &str,
    seed: u64,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<Contrast, Fault> {
    let range = match kind {
        MeasureKind::Expectation { range, .. } => Some(*range),
        _ => None,
    };
    let planned = if within.is_none() { methods::DEFAULT_TRIALS } else { budget.max_trials };
    let most = planned.min(budget.max_trials);
    let mut procedure = match range {
        None => Procedure::Probability(Difference::new(delta, within)?),
        Some((low, high)) => {
            let width = high - low;
            Procedure::Expectation(match within {
                Some(within) => Mean::within(-width, width, within, delta)?,
                None => Mean::fixed(-width, width, methods::DEFAULT_TRIALS, delta)?,
            })
        }
    };
    let jobs = [0, 1].map(|side| Job::new(sides.subjects[side], vec![sides.columns[side]], seed));
    let mut tallies = [Tally::default(), Tally::default()];
    let mut sums = [(0.0, 0u64); 2];
    let mut next = 0u64;
    let stop = 'sampling: loop {
        if next >= most {
            break if within.is_none() && most == planned { Stop::Plan } else { Stop::Cap };
        }
        let halt = || if budget.is_interrupted() { Stop::Interrupt } else { Stop::Deadline };
        if budget.must_stop() {
            break halt();
        }
        let size = (next / 8).max(2 * executor.width(&jobs[0]) as u64).min(most - next);
        let items: Vec<Item> = (next..next + size).map(|index| Item { advice: None, index }).collect();
        let first = executor.run(&jobs[0], &items, budget)?;
        let second = executor.run(&jobs[1], &items, budget)?;
        for (item, pair) in items.iter().zip(first.rows().zip(second.rows())) {
            let (Some(a), Some(b)) = pair else { break 'sampling halt() };
            let (a, b): (&Cell, &Cell) = (&a[0], &b[0]);
            for (subject, cell) in sides.subjects.into_iter().zip([a, b]) {
                if cell.reading == Reading::Faulty {
                    return Err(super::trial::fault(subject, *item, seed));
                }
            }
            for (side, cell) in [a, b].into_iter().enumerate() {
                tallies[side].add(item.index, cell, range);
                if let Some(value) = value(cell) {
                    let (low, high) = range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                    sums[side].0 += value.clamp(low, high);
                    sums[side].1 += 1;
                }
            }
            let finished = match &mut procedure {
                Procedure::Probability(difference) => difference.observe(outcome(a), outcome(b)),
                Procedure::Expectation(mean) => {
                    let (low, high) = range.unwrap_or((0.0, 1.0));
                    let clipped = |cell: &Cell| value(cell).map(|v| v.clamp(low, high));
                    mean.observe(clipped(a).zip(clipped(b)).map(|(a, b)| a - b))
                }
            };
            if finished && within.is_some() {
                break 'sampling Stop::Width;
            }
        }
        next += size;
        watch.consumed(text, next, Some(most));
    };
    let (interval, estimate, alone, unresolved) = match &procedure {
        Procedure::Probability(difference) => {
            let (low, high) = difference.pairs();
            let estimate = 0.5 * (low.mean() + high.mean());
            (
                difference.interval(),
                estimate,
                (high.first.min(low.first), low.second.min(high.second)),
                difference.unresolved(),
            )
        }
        Procedure::Expectation(mean) => {
            let (low, high) = mean.estimate();
            (mean.interval(), 0.5 * (low + high), (0, 0), mean.read().1)
        }
    };
    let pairs = tallies[0].counts.trials;
    Ok(Contrast { sides: tallies, sums, stop, interval, estimate, alone, pairs, unresolved })
}
