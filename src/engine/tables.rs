//! How options and sides stand: the tables of rankings and comparisons.

use super::compare::Gap;
use super::outcome::{Comparison, Counts, Interval, RankedOption, Ranking, Side, Status};
use super::procedure;
use super::rank::RankOutcome;
use crate::compile::study::RankOption;

/// Both sides of a comparison and their difference, with intervals.
pub(super) fn sides(compare: &Gap, labels: &[String; 2], delta: f64) -> Comparison {
    let side = |at: usize| {
        let counts = compare.sides[at].counts;
        let known = counts.trials > counts.unresolved;
        let value = if let Some(mean) = compare.means.get(at) {
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
    let both_known = compare.sides.iter().all(|side| side.counts.trials > side.counts.unresolved);
    let difference = Side {
        label: "first - second".to_owned(),
        value: Interval {
            // Of nothing resolved on a side there is no difference.
            estimate: if both_known { compare.estimate } else { f64::NAN },
            low: compare.interval.low,
            high: compare.interval.high,
        },
        counts: Counts {
            trials: compare.pairs,
            successes: compare.alone.0,
            failures: compare.alone.1,
            unresolved: compare.unresolved,
        },
    };
    Comparison { first: side(0), second: side(1), difference }
}

/// The options of a ranking, the choice first, then by score.
pub(super) fn ranked(ranked: &RankOutcome, options: &[RankOption]) -> Ranking {
    let choice = &ranked.choice;
    // One of several is chosen for what it did in trials; the only one there is needs none.
    let told = |tally: &super::tally::Tally| tally.counts.trials > tally.counts.unresolved;
    let chosen = ranked.finished || ranked.tallies.iter().any(told);
    let mut order: Vec<usize> = (0..options.len()).collect();
    // Those without trials have no value, and come last.
    let key = |arm: usize| (arm != choice.arm, ranked.tallies[arm].counts.trials == 0);
    let value = |arm: usize| if key(arm).1 { 0.0 } else { -ranked.values[arm].0 };
    order.sort_by(|&a, &b| key(a).cmp(&key(b)).then(value(a).total_cmp(&value(b))).then(a.cmp(&b)));
    let listed: Vec<RankedOption> = order
        .iter()
        .map(|&arm| {
            let (estimate, interval) = ranked.values[arm];
            let estimate = if ranked.tallies[arm].counts.trials == 0 { f64::NAN } else { estimate };
            let status = if !chosen {
                Status::Open
            } else if arm == choice.arm {
                Status::Chosen
            } else if ranked.finished && choice.certified.contains(&arm) {
                Status::Tied
            } else if choice.open.contains(&arm) {
                Status::Open
            } else {
                Status::Beaten
            };
            RankedOption {
                label: options[arm].label.clone(),
                settings: options[arm].settings.clone(),
                value: Interval { estimate, low: interval.low, high: interval.high },
                counts: ranked.tallies[arm].counts,
                status,
            }
        })
        .collect();
    let gap = if chosen { choice.gap * ranked.scale } else { f64::INFINITY };
    let tied = listed.iter().any(|option| option.status == Status::Tied);
    Ranking { choice: chosen.then(|| options[choice.arm].label.clone()), gap, tied, options: listed }
}
