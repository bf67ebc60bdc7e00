//! How options and sides stand: the tables of rankings and comparisons.

use crate::base::math::at_most;
use crate::compile::study::{Every, RankOption};
use crate::engine::outcome::{Comparison, Counts, RankedOption, Ranking, Side, Status};
use crate::engine::sampling::compare::Gap;
use crate::engine::sampling::procedure::{around, of_mean, sequence, share};
use crate::engine::sampling::rank::RankOutcome;
use crate::stats;

/// Both sides of a comparison and their difference, with intervals.
pub(in crate::engine) fn sides(compare: &Gap, labels: &[String; 2], delta: f64) -> Comparison {
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

/// The value of an option and its counts: of several models that under which its score is least, with the least ends.
fn of_option(ranked: &RankOutcome, models: usize, option: usize) -> (f64, stats::Interval, Counts) {
    let columns = option * models..(option + 1) * models;
    let start = (f64::INFINITY, ranked.values[option * models].1, Counts::default());
    columns.fold(start, |(estimate, mut interval, mut counts), column| {
        let (own, ends) = ranked.values[column];
        interval.low = at_most(interval.low, ends.low);
        interval.high = at_most(interval.high, ends.high);
        let own_counts = ranked.tallies[column].counts;
        counts = counts.and(own_counts);
        (if own_counts.trials > 0 { at_most(estimate, own) } else { estimate }, interval, counts)
    })
}

/// The options of a ranking, the choice first, then by score.
pub(in crate::engine) fn ranked(
    ranked: &RankOutcome,
    options: &[RankOption],
    models: usize,
    every: Option<&Every>,
) -> Ranking {
    let values = every.map_or(&[][..], |every| &every.values);
    let choice = &ranked.choice;
    let all: Vec<_> = (0..options.len() / models).map(|option| of_option(ranked, models, option)).collect();
    // One of several is chosen for what it did in trials; the only one there is needs none.
    let told = |(.., counts): &(f64, stats::Interval, Counts)| counts.trials > counts.unresolved;
    let chosen = ranked.finished || all.iter().any(told);
    let mut order: Vec<usize> = (0..all.len()).collect();
    // Those without trials have no value, and come last.
    let key = |option: usize| (option != choice.arm, all[option].2.trials == 0);
    let value = |option: usize| if key(option).1 { 0.0 } else { -all[option].0 };
    order.sort_by(|&a, &b| key(a).cmp(&key(b)).then(value(a).total_cmp(&value(b))).then(a.cmp(&b)));
    let best = all.iter().fold(f64::NEG_INFINITY, |best, (_, interval, _)| best.max(interval.low));
    let listed: Vec<RankedOption> = order
        .iter()
        .map(|&option| {
            let (estimate, interval, counts) = all[option];
            let estimate = if counts.trials == 0 { f64::NAN } else { estimate };
            let status = if !chosen {
                Status::Open
            } else if option == choice.arm {
                Status::Chosen
            } else if ranked.finished && choice.certified.contains(&option) {
                Status::Tied
            } else if choice.beaten.contains(&option) || interval.high < best {
                Status::Beaten
            } else {
                Status::Open
            };
            let columns = option * models..(option + 1) * models;
            let under = columns.filter(|_| models > 1).map(|column| {
                let (estimate, interval) = ranked.values[column];
                let counts = ranked.tallies[column].counts;
                let value = around(if counts.trials == 0 { f64::NAN } else { estimate }, interval);
                Side { label: values.get(column % models).cloned().unwrap_or_default(), value, counts }
            });
            RankedOption {
                label: options[option * models].label.clone(),
                settings: if models > 1 { Vec::new() } else { options[option].settings.clone() },
                value: around(estimate, interval),
                counts,
                status,
                under: under.collect(),
            }
        })
        .collect();
    let gap = if chosen { choice.gap * ranked.scale } else { f64::INFINITY };
    let tied = listed.iter().any(|option| option.status == Status::Tied);
    let choice = chosen.then(|| options[choice.arm * models].label.clone());
    Ranking { choice, means: None, gap, tied, options: listed }
}
