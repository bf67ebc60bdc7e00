//! How options and sides stand: the tables of rankings and comparisons.

use super::unit_of;
use crate::base::math::at_most;
use crate::compile::study::{Beside, Every, RankOption, Role};
use crate::engine::outcome::{Also, Comparison, Counts, RankedOption, Ranking, Side, Status};
use crate::engine::sampling::compare::Gap;
use crate::engine::sampling::procedure::{around, of_mean, sequence, share};
use crate::engine::sampling::rank::RankOutcome;
use crate::stats;

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

/// What was asked of an option besides its score.
fn also(ranked: &RankOutcome, option: usize, beside: &[Beside]) -> Vec<Also> {
    let known = ranked.also.get(option).map_or(&[][..], Vec::as_slice);
    let each = beside.iter().zip(known).map(|(one, (estimate, interval, holds))| {
        let (what, holds) = match &one.role {
            Role::Constraint { text, .. } => (format!("{} {text}", one.said), *holds),
            Role::Aim { .. } => (one.said.clone(), None),
        };
        let nothing = ranked.tallies[option].counts.trials == 0;
        let value = around(if nothing { f64::NAN } else { *estimate }, *interval);
        Also { what, unit: unit_of(&one.kind), value, holds }
    });
    each.collect()
}

/// The options of a ranking, the choice first, then by score; of a front its options first, then those that are open.
pub(super) fn ranked(
    ranked: &RankOutcome,
    options: &[RankOption],
    (models, every): (usize, Option<&Every>),
    beside: &[Beside],
) -> Ranking {
    let values = every.map_or(&[][..], |every| &every.values);
    let choice = &ranked.choice;
    let all: Vec<_> = (0..options.len() / models).map(|option| of_option(ranked, models, option)).collect();
    // One of several is chosen for what it did in trials; the only one there is needs none.
    let told = |(.., counts): &(f64, stats::Interval, Counts)| counts.trials > counts.unresolved;
    let chosen = ranked.finished || all.iter().any(told);
    let mut order: Vec<usize> = (0..all.len()).collect();
    // Those without trials have no value, and come last.
    let is_front = beside.iter().any(|one| matches!(one.role, Role::Aim { .. }));
    let class = |option: usize| match option {
        _ if is_front && choice.certified.contains(&option) => 0,
        _ if is_front && choice.open.contains(&option) => 1,
        _ if choice.excluded.contains(&option) => 3,
        _ if !is_front && option == choice.arm => 0,
        _ => 2,
    };
    let key = |option: usize| (class(option), all[option].2.trials == 0);
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
            } else if choice.excluded.contains(&option) {
                Status::Excluded
            } else if is_front {
                match class(option) {
                    0 => Status::Front,
                    1 => Status::Open,
                    _ => Status::Beaten,
                }
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
                also: also(ranked, option, beside),
            }
        })
        .collect();
    let gap = if chosen { choice.gap * ranked.scale } else { f64::INFINITY };
    let tied = listed.iter().any(|option| option.status == Status::Tied);
    let is_empty = choice.excluded.len() == all.len();
    let label = chosen && !is_empty && !is_front;
    let choice = label.then(|| options[choice.arm * models].label.clone());
    Ranking { choice, means: None, gap, tied, aim: String::new(), is_empty, options: listed }
}
