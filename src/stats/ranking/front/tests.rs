//! Planted fronts with known probabilities and means.

use super::*;
use crate::base::random::{Purpose, Stream, TrialKey};

/// Runs a front of arms with a probability and a mean in 0 to 10; the front, and how many trials it took.
fn run(seed: u64, arms: &[(f64, f64)], epsilon: (f64, f64), delta: f64) -> (Vec<usize>, u64) {
    let aims = [(Goal::Probability, epsilon.0), (Goal::Mean((0.0, 10.0)), epsilon.1)];
    let mut front = Front::new(arms.len(), &aims, delta, 32).unwrap();
    let mut trials = 0;
    while !front.finished() {
        for share in front.next_round().to_vec() {
            let mut columns = vec![Vec::new(), Vec::new()];
            for index in share.from..share.to {
                let stream = Stream::of(TrialKey { seed, index, branch: 0 }, 1, Purpose::Procedure);
                let (p, mean) = arms[share.arm];
                columns[0].push(Some(f64::from(u8::from(stream.uniform(0) < p))));
                columns[1].push(Some(mean + 2.0 * (stream.uniform(1) - 0.5)));
            }
            trials += share.to - share.from;
            front.feed(share.arm, &columns).unwrap();
        }
        assert!(trials < 2_000_000, "seed {seed}");
    }
    (front.choice().certified, trials)
}

/// Whether a front is right: no arm of it is matched by another that is epsilon better somewhere and nowhere worse, and each
/// arm left out is epsilon better than some arm of it in no aim.
fn is_right(front: &[usize], arms: &[(f64, f64)], epsilon: (f64, f64)) -> bool {
    let exceeds =
        |b: usize, a: usize, by: (f64, f64)| arms[b].0 > arms[a].0 + by.0 || arms[b].1 > arms[a].1 + by.1;
    let kept = |a: usize| front.iter().all(|b| exceeds(a, *b, (0.0, 0.0)) || !exceeds(*b, a, epsilon));
    let covered = |a: usize| front.iter().any(|b| !exceeds(a, *b, epsilon));
    (0..arms.len()).all(|arm| if front.contains(&arm) { kept(arm) } else { covered(arm) })
}

#[test]
fn a_planted_front_of_sixteen_is_found() {
    // Six on the front, eight behind it, and two that tie with others of the front.
    let mut arms: Vec<(f64, f64)> = (0..6).map(|k| (0.2 + 0.12 * f64::from(k), 8.0 - f64::from(k))).collect();
    arms.extend((0..10).map(|k| (0.1 + 0.05 * f64::from(k), 6.0 - 0.5 * f64::from(k))));
    (arms[14], arms[15]) = (arms[2], arms[4]);
    let mut wrong = 0;
    for seed in 0..300 {
        let (front, _) = run(seed, &arms, (0.05, 0.5), 0.1);
        wrong += u32::from(!is_right(&front, &arms, (0.05, 0.5)));
    }
    // 300 at 0.1 and three standard deviations.
    assert!(wrong <= 30 + 15, "{wrong} of 300");
}

/// Chains of arms, each covered by the next: whoever is left out is near one of the front.
#[test]
fn what_is_left_out_is_near_the_front() {
    let arms: Vec<(f64, f64)> =
        (0..12).map(|k| (0.3 + 0.03 * f64::from(k), 6.0 - 0.06 * f64::from(k))).collect();
    for seed in 0..20 {
        let (front, _) = run(200 + seed, &arms, (0.05, 0.1), 0.05);
        assert!(is_right(&front, &arms, (0.05, 0.1)), "{front:?}");
    }
}

#[test]
fn equals_and_near_ones_stay_and_it_ends() {
    let (front, trials) = run(1, &[(0.5, 5.0), (0.5, 5.0), (0.49, 4.9)], (0.1, 1.0), 0.05);
    assert_eq!(front, [0, 1, 2]);
    assert!(trials < 20_000, "{trials}");
    // One that is as good in one aim and worse in the other is left out.
    assert_eq!(run(4, &[(0.5, 5.0), (0.5, 7.0), (0.51, 5.0)], (0.1, 0.5), 0.05).0, [1]);
    // One that is better in one aim and worse in the other.
    assert_eq!(run(2, &[(0.8, 2.0), (0.2, 8.0), (0.1, 1.0)], (0.05, 0.5), 0.05).0, [0, 1]);
    assert!(Front::new(2, &[(Goal::Probability, 0.1)], 0.05, 32).is_err());
}
