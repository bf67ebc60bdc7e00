//! How options and sides stand: the tables of rankings and comparisons.

use super::contrast::Gap;
use super::outcome::{Comparison, Counts, Interval, RankedOption, Ranking, Side, Status};
use super::procedure;
use super::race::Podium;

/// Both sides of a comparison and their difference, with intervals.
pub(super) fn sides(contrast: &Gap, labels: &[String; 2], delta: f64) -> Comparison {
    let side = |at: usize| {
        let counts = contrast.sides[at].counts;
        let known = counts.trials > counts.unresolved;
        let value = if let Some(mean) = contrast.means.get(at) {
            let ((low, high), interval) = (mean.estimate(), mean.interval());
            let estimate = if known { 0.5 * (low + high) } else { f64::NAN };
            Interval { estimate, low: interval.low, high: interval.high }
        } else {
            let reading = |successes: u64| {
                let read = crate::stats::Counts { successes, failures: counts.trials - successes };
                crate::stats::sequence::interval(read, delta)
            };
            let hull = reading(counts.successes).hull(reading(counts.successes + counts.unresolved));
            let estimate = if known { procedure::share(counts) } else { f64::NAN };
            Interval { estimate, low: hull.low, high: hull.high }
        };
        Side { label: labels[at].clone(), value, counts }
    };
    let both_known = contrast.sides.iter().all(|side| side.counts.trials > side.counts.unresolved);
    let difference = Side {
        label: "first - second".to_owned(),
        value: Interval {
            // Of nothing resolved on a side there is no difference.
            estimate: if both_known { contrast.estimate } else { f64::NAN },
            low: contrast.interval.low,
            high: contrast.interval.high,
        },
        counts: Counts {
            trials: contrast.pairs,
            successes: contrast.alone.0,
            failures: contrast.alone.1,
            unresolved: contrast.unresolved,
        },
    };
    Comparison { first: side(0), second: side(1), difference }
}

/// The options of a ranking, the choice first, then by score.
pub(super) fn ranked(podium: &Podium, labels: &[&str]) -> Ranking {
    let choice = &podium.choice;
    // One of several is chosen for what it did in trials; the only one there is needs none.
    let told = |tally: &super::tally::Tally| tally.counts.trials > tally.counts.unresolved;
    let chosen = podium.finished || podium.tallies.iter().any(told);
    let mut order: Vec<usize> = (0..labels.len()).collect();
    // Those without trials have no value, and come last.
    let key = |arm: usize| (arm != choice.arm, podium.tallies[arm].counts.trials == 0);
    let value = |arm: usize| if key(arm).1 { 0.0 } else { -podium.values[arm].0 };
    order.sort_by(|&a, &b| key(a).cmp(&key(b)).then(value(a).total_cmp(&value(b))).then(a.cmp(&b)));
    let options: Vec<RankedOption> = order
        .iter()
        .map(|&arm| {
            let (estimate, interval) = podium.values[arm];
            let estimate = if podium.tallies[arm].counts.trials == 0 { f64::NAN } else { estimate };
            let status = if !chosen {
                Status::Open
            } else if arm == choice.arm {
                Status::Chosen
            } else if podium.finished && choice.certified.contains(&arm) {
                Status::Tied
            } else if choice.open.contains(&arm) {
                Status::Open
            } else {
                Status::Beaten
            };
            RankedOption {
                label: labels[arm].to_owned(),
                value: Interval { estimate, low: interval.low, high: interval.high },
                counts: podium.tallies[arm].counts,
                status,
            }
        })
        .collect();
    let gap = if chosen { choice.gap * podium.scale } else { f64::INFINITY };
    let tied = options.iter().any(|option| option.status == Status::Tied);
    Ranking { choice: chosen.then(|| labels[choice.arm].to_owned()), gap, tied, options }
}
