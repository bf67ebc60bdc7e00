//! Which arms of a decided race carry the full certificate: each is compared with all that are live.
//!
//! Of k arms that are k (k - 1) comparisons over all trials. Arms with the same outcomes are compared once for all of
//! them (moves that change nothing, or differ too little to matter), the best rivals come first, because who fails
//! mostly fails against them, and the work in all is bounded.

use super::Table;
use std::cmp::Ordering;

/// Most trials that are gone through. Fifty options of ten thousand trials need half of it; the rest of more than that
/// stays open. It is counted and not timed, so that a replay comes to the same.
const MOST_WORK: u64 = 50_000_000;

/// Arms with the same outcomes.
struct Class {
    /// The arms, ascending.
    arms: Vec<usize>,
    /// Their mean.
    mean: f64,
    /// The least of their deviations.
    deviation: f64,
}

/// The live arms, ascending, that pass against all other live ones. The leader's class comes first, then those that
/// deviate least: one of them is chosen.
pub(super) fn among(
    table: &mut impl Table,
    live: &[usize],
    leader: usize,
    threshold: f64,
    deviation: &dyn Fn(usize) -> f64,
) -> Vec<usize> {
    within(MOST_WORK, table, (live, leader), threshold, deviation)
}

fn within(
    most: u64,
    table: &mut impl Table,
    (live, leader): (&[usize], usize),
    threshold: f64,
    deviation: &dyn Fn(usize) -> f64,
) -> Vec<usize> {
    let mut classes = classes(table, live, deviation);
    classes.sort_by(|a, b| b.mean.total_cmp(&a.mean).then(a.arms[0].cmp(&b.arms[0])));
    let mut order: Vec<usize> = (0..classes.len()).collect();
    order.sort_by(|&a, &b| {
        let (one, other) = (&classes[a], &classes[b]);
        let behind = |class: &Class| !class.arms.contains(&leader);
        (behind(one).cmp(&behind(other)))
            .then(one.deviation.total_cmp(&other.deviation))
            .then(one.arms[0].cmp(&other.arms[0]))
    });
    let (mut found, mut work) = (Vec::new(), 0u64);
    'candidates: for place in order {
        let class = &classes[place];
        let arm = if class.arms.contains(&leader) { leader } else { class.arms[0] };
        let mut passes = true;
        for rivals in &classes {
            // Against one of the same outcomes, or of others.
            let Some(&rival) = rivals.arms.iter().find(|rival| **rival != arm) else { continue };
            work = work.saturating_add(table.work(rival, arm));
            // Of the leader it is known: the race has compared it with each of them.
            if work > most && arm != leader {
                break 'candidates;
            }
            if !table.is_close(rival, arm, threshold) {
                passes = false;
                break;
            }
        }
        if passes {
            found.extend(&class.arms);
        }
    }
    found.sort_unstable();
    found
}

/// The arms by their outcomes.
fn classes(table: &impl Table, live: &[usize], deviation: &dyn Fn(usize) -> f64) -> Vec<Class> {
    let mut sorted = live.to_vec();
    sorted.sort_by(|a, b| table.order(*a, *b).then(a.cmp(b)));
    let mut classes: Vec<Class> = Vec::new();
    for arm in sorted {
        let least = deviation(arm);
        match classes.last_mut() {
            Some(class) if table.order(class.arms[0], arm) == Ordering::Equal => {
                class.arms.push(arm);
                if least < class.deviation {
                    class.deviation = least;
                }
            }
            _ => classes.push(Class { arms: vec![arm], mean: table.mean(arm), deviation: least }),
        }
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::stats::ranking::Scores;

    const THRESHOLD: f64 = 6.0;

    /// Scores around 0.5 and a little more, in groups of three with the same; some have fewer trials.
    fn scores(arms: usize, rise: f64) -> Scores {
        let mut table = Scores::new(arms, 0.05);
        for arm in 0..arms {
            let trials = if arm % 7 == 3 { 400 } else { 403 };
            let outcomes: Vec<Option<f64>> = (0..trials)
                .map(|index| {
                    let stream =
                        Stream::of(TrialKey { seed: 5, index, branch: 0 }, (arm / 3) as u32, Purpose::Test);
                    let value = 0.4 + 0.2 * stream.uniform(0) + rise * (arm / 3) as f64;
                    (index % 200 != 7).then_some(value)
                })
                .collect();
            table.push(arm, &outcomes);
        }
        table
    }

    #[test]
    fn classes_leave_no_trace() {
        let mut table = scores(24, 0.005);
        let live: Vec<usize> = (0..24).filter(|arm| arm % 5 != 4).collect();
        let plain: Vec<usize> = live
            .iter()
            .copied()
            .filter(|arm| live.iter().all(|rival| rival == arm || table.passes(*rival, *arm, THRESHOLD).1))
            .collect();
        assert!(plain.len() > 3 && plain.len() < live.len() - 3, "{plain:?}");
        for fresh in [true, false] {
            let mut table = if fresh { scores(24, 0.005) } else { table.clone() };
            assert_eq!(among(&mut table, &live, live[2], THRESHOLD, &|arm| arm as f64), plain);
        }
    }

    #[test]
    fn the_same_outcomes_are_compared_once() {
        let mut table = Scores::new(4096, 0.05);
        for arm in 0..4096 {
            table.push(arm, &[Some(0.375); 512]);
        }
        let live: Vec<usize> = (0..4096).collect();
        assert_eq!(within(600, &mut table, (&live, 9), THRESHOLD, &|_| 0.0), live);
    }

    #[test]
    fn little_work_is_for_the_leader_and_those_who_deviate_least() {
        let mut table = scores(24, 0.002);
        let live: Vec<usize> = (0..24).collect();
        let all = among(&mut table.clone(), &live, 23, THRESHOLD, &|_| 0.0);
        let best = *all.iter().min().unwrap();
        let deviation = |arm: usize| if arm == best { 0.0 } else { 1.0 };
        let mut lengths = Vec::new();
        for work in [500, 1_000, 2_000, 3_000, 4_000, 6_000, 10_000, 1_000_000] {
            let few = within(work, &mut table.clone(), (&live, 23), THRESHOLD, &deviation);
            assert!(few.contains(&23) && few.iter().all(|arm| all.contains(arm)), "{few:?} of {all:?}");
            // Of several the one that deviates least comes first.
            assert!(few.len() <= 3 || few.contains(&best), "{work}: {few:?}");
            lengths.push(few.len());
        }
        assert!(lengths.is_sorted() && lengths[7] == all.len(), "{lengths:?}");
        assert_eq!(within(5, &mut table, (&live, 23), THRESHOLD, &deviation), [21, 22, 23]);
    }
}
