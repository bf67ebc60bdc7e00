//! How options and sides stand: the tables of rankings and comparisons.

use super::compare::Gap;
use super::outcome::{Comparison, Counts, RankedOption, Ranking, Side, Status};
use super::procedure::{around, of_mean, sequence, share};
use super::rank::RankOutcome;
use crate::compile::study::RankOption;

/// Both sides of a comparison and their difference, with intervals.
pub(super) fn sides(compare: &Gap, labels: &[String; 2], delta: f64) -> Comparison {
    let side = |at: usize| {
        let counts = compare.sides[at].counts;
        let known = counts.trials > counts.unresolved;
        let (estimate, interval) = match compare.means.get(at) {
            Some(mean) => of_mean(mean),
            None => (share(counts), sequence(counts, delta)),
        };
        let value = around(if known { estimate } else { f64::NAN }, interval);
        Side { label: labels[at].clone(), value, counts }
    };
    let both_known = compare.sides.iter().all(|side| side.counts.trials > side.counts.unresolved);
    let difference = Side {
        label: "first - second".to_owned(),
        // Of nothing resolved on a side there is no difference.
        value: around(if both_known { compare.estimate } else { f64::NAN }, compare.interval),
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
    let best = ranked.values.iter().fold(f64::NEG_INFINITY, |best, (_, interval)| best.max(interval.low));
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
            } else if choice.beaten.contains(&arm) || interval.high < best {
                Status::Beaten
            } else {
                Status::Open
            };
            RankedOption {
                label: options[arm].label.clone(),
                settings: options[arm].settings.clone(),
                value: around(estimate, interval),
                counts: ranked.tallies[arm].counts,
                status,
            }
        })
        .collect();
    let gap = if chosen { choice.gap * ranked.scale } else { f64::INFINITY };
    let tied = listed.iter().any(|option| option.status == Status::Tied);
    Ranking { choice: chosen.then(|| options[choice.arm].label.clone()), gap, tied, options: listed }
}
