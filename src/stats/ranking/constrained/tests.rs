//! Exact laws: scores and constraints of known probability, common random numbers, ties among them.

use super::*;
use crate::base::random::{Purpose, Stream, TrialKey};

/// Runs a ranking of arms of which score and constraint hold with the given probabilities; the choice, if there is one, and
/// how many trials it took.
fn run(seed: u64, arms: &[(f64, f64)], at_least: bool, delta: f64) -> (Option<usize>, u64) {
    let bound = Bound { goal: Goal::Probability, at_least, threshold: 0.8 };
    let deviations = (0..arms.len()).map(|arm| arm as f64).collect();
    let mut ranking = Constrained::new(Goal::Probability, vec![bound], (0.1, delta), 32, deviations).unwrap();
    let mut trials = 0;
    while !ranking.finished() {
        for share in ranking.next_round().to_vec() {
            let mut columns = vec![Vec::new(), Vec::new()];
            for index in share.from..share.to {
                // All arms share the draws of a trial.
                let stream = Stream::of(TrialKey { seed, index, branch: 0 }, 1, Purpose::Procedure);
                let (score, constraint) = arms[share.arm];
                columns[0].push(Some(f64::from(u8::from(stream.uniform(0) < score))));
                columns[1].push(Some(f64::from(u8::from(stream.uniform(1) < constraint))));
            }
            trials += share.to - share.from;
            ranking.feed(share.arm, &columns).unwrap();
        }
        assert!(trials < 400_000, "seed {seed}");
    }
    let choice = ranking.choice();
    (choice.certified.contains(&choice.arm).then_some(choice.arm), trials)
}

#[test]
fn the_best_that_satisfies_the_constraint_is_chosen() {
    let arms = [(0.6, 0.95), (0.9, 0.6), (0.75, 0.9), (0.3, 0.99), (0.74, 0.95)];
    let mut wrong = 0;
    for seed in 0..300 {
        let (choice, _) = run(seed, &arms, true, 0.1);
        // Within 0.1 of 0.75, and the constraint holds: the third or the fifth.
        wrong += u32::from(!matches!(choice, Some(2 | 4)));
    }
    assert!(wrong <= 30 + 15, "{wrong} of 300");
}

#[test]
fn none_is_an_answer_and_the_side_counts() {
    for seed in 0..20 {
        assert_eq!(run(seed, &[(0.9, 0.5), (0.5, 0.6)], true, 0.05).0, None);
        assert_eq!(run(seed, &[(0.9, 0.5), (0.5, 0.6)], false, 0.05).0, Some(0));
        assert_eq!(run(seed, &[(0.9, 0.5), (0.5, 0.95)], true, 0.05).0, Some(1));
    }
}

#[test]
fn options_that_are_alike_end_it_too() {
    let (choice, trials) = run(3, &[(0.5, 0.95); 4], true, 0.05);
    assert_eq!(choice, Some(0));
    assert!(trials < 20_000, "{trials}");
}

#[test]
fn a_tail_may_be_bounded_and_a_mean_be_the_score() {
    let bound = Bound { goal: Goal::Tail((0.0, 1.0), 0.2), at_least: false, threshold: 0.8 };
    let mut ranking =
        Constrained::new(Goal::Mean((0.0, 10.0)), vec![bound], (1.0, 0.05), 32, vec![0.0, 1.0]).unwrap();
    while !ranking.finished() {
        for share in ranking.next_round().to_vec() {
            let mut columns = vec![Vec::new(), Vec::new()];
            for index in share.from..share.to {
                let stream = Stream::of(TrialKey { seed: 9, index, branch: 0 }, 1, Purpose::Procedure);
                let u = stream.uniform(0);
                // The first is better and its largest fifth is 0.9 on average, the other's 0.45.
                columns[0].push(Some(if share.arm == 0 { 6.0 + u } else { 3.0 + u }));
                columns[1].push(Some(if share.arm == 0 { u } else { 0.5 * u }));
            }
            ranking.feed(share.arm, &columns).unwrap();
        }
    }
    let choice = ranking.choice();
    assert_eq!((choice.arm, choice.excluded), (1, vec![0]));
}

/// The largest half of a coin that shows 1 with probability p has the mean 2 p, up to 1.
#[test]
fn tails_are_ranked_with_ties() {
    let heads = [0.05, 0.45, 0.45, 0.15];
    let mut wrong = 0;
    for seed in 0..300 {
        let goal = Goal::Tail((0.0, 1.0), 0.5);
        let mut ranking = Constrained::new(goal, Vec::new(), (0.4, 0.1), 64, vec![0.0; 4]).unwrap();
        while !ranking.finished() {
            for share in ranking.next_round().to_vec() {
                let score = |index| {
                    // Each arm has draws of its own.
                    let key = TrialKey { seed, index, branch: share.arm as u16 };
                    let draw = Stream::of(key, 1, Purpose::Procedure).uniform(0);
                    Some(f64::from(u8::from(draw < heads[share.arm])))
                };
                let column = (share.from..share.to).map(score).collect();
                ranking.feed(share.arm, &[column]).unwrap();
            }
        }
        wrong += u32::from(!matches!(ranking.choice().arm, 1 | 2));
    }
    assert!(wrong <= 30 + 15, "{wrong} of 300");
}
