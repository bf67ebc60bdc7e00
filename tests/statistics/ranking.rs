//! T14, T15 and the ranking part of T19.

use super::tally::{Tally, uniform};
use smc::stats::Outcome;
use smc::stats::ranking::{Allocation, Booleans, Contest as _, Each, Race, Scores, Table};

fn workloads() -> [(Vec<f64>, f64); 6] {
    let spaced = (0..36).map(|k| 0.2 + 0.75 * f64::from(k) / 35.0).collect();
    let second = [vec![0.99], vec![0.90; 15]].concat();
    let fourth = [vec![0.90], vec![0.879; 8]].concat();
    [
        (vec![0.95, 0.93, 0.90, 0.85, 0.7, 0.6, 0.5, 0.3, 0.1], 3300.0),
        (second, 3000.0),
        (spaced, 7000.0),
        (fourth, 17_000.0),
        // Who hardly ever fails is certified alone; who might be mistaken for one who does not fail is not.
        (vec![0.997; 9], 2600.0),
        ([vec![0.975; 8], vec![1.0]].concat(), 3000.0),
    ]
}

/// Runs a race up to `budget` trials.
fn race(means: &[f64], seed: u64, run: u32, common: bool, how: Allocation, budget: u64) -> Race<Booleans> {
    let mut race = Race::<Booleans>::new(means.len(), 0.02, 0.05, 64, how).unwrap();
    while !race.finished() && race.trials() < budget {
        for share in race.next_round().to_vec() {
            let arm = if common { 0 } else { share.arm as u16 };
            let outcomes: Vec<Outcome> = (share.from..share.to)
                .map(|index| Outcome::from(uniform(seed, run, arm, index) < means[share.arm]))
                .collect();
            race.feed(share.arm, &outcomes).unwrap();
        }
    }
    race
}

fn best(means: &[f64]) -> f64 {
    means.iter().copied().fold(0.0, f64::max)
}

fn races(runs: u32) {
    for (means, most) in workloads() {
        let tally = |common: bool| {
            Tally::over(runs, |k| {
                let mut race = race(&means, 40, k, common, Allocation::AllFailing, u64::MAX);
                let choice = race.choice();
                assert!(choice.gap <= 0.02 && choice.certified.contains(&choice.arm));
                (means[choice.arm] < best(&means) - 0.02, race.trials() as f64)
            })
        };
        let (independent, common) = (tally(false), tally(true));
        independent.guarantees(0.05);
        common.guarantees(0.05);
        assert!(independent.mean() <= most, "{}", independent.mean());
        // Where one is certified alone, nothing is paired.
        let is_alone = means.iter().all(|mean| *mean > 0.97);
        let bound = if is_alone { most } else { independent.mean() };
        assert!(common.mean() < bound, "{} {}", common.mean(), independent.mean());
    }
}

/// T15: at the boundary of the null hypothesis, checked after every trial.
fn null_boundary(runs: u32) {
    for (common, seed) in [(false, 41), (true, 42)] {
        let threshold = 20f64.ln();
        let tally = Tally::over(runs, |k| {
            let mut table = Booleans::new(2, 0.02);
            for index in 0..10_000 {
                let u = uniform(seed, k, 0, index);
                let v = if common { u } else { uniform(seed, k, 1, index) };
                table.push(0, &[Outcome::from(u < 0.88)]);
                table.push(1, &[Outcome::from(v < 0.90)]);
                if table.evidence(1, 0, threshold).1 >= threshold {
                    return (true, 0.0);
                }
            }
            (false, 0.0)
        });
        tally.guarantees(0.05);
        // Measured 0.031 and 0.023: the test is close to its level, not vacuous.
        assert!(tally.share() > 0.008, "{}", tally.share());
    }
}

/// T19: the certified gap at a deadline, in both ways of sampling.
fn gap_at_a_deadline(runs: u32) {
    for (means, _) in workloads() {
        for how in [Allocation::AllFailing, Allocation::OneChallenger] {
            for budget in [800, 2500] {
                let tally = Tally::over(runs, |k| {
                    let mut race = race(&means, 43, k, false, how, budget);
                    let choice = race.choice();
                    (means[choice.arm] < best(&means) - choice.gap, 0.0)
                });
                tally.guarantees(0.05);
            }
        }
    }
}

/// The same race over scores that are 0 or 1 is the Boolean one; with real scores it needs fewer trials.
fn scores(runs: u32) {
    let means = [0.6, 0.55, 0.5, 0.3];
    let tally = Tally::over(runs, |k| {
        let mut reals = Race::<Scores>::new(4, 0.02, 0.05, 64, Allocation::AllFailing).unwrap();
        while !reals.finished() {
            for share in reals.next_round().to_vec() {
                let outcomes: Vec<Option<f64>> = (share.from..share.to)
                    .map(|index| {
                        let u = uniform(44, k, share.arm as u16, index);
                        Some(means[share.arm] + 0.3 * (u - 0.5))
                    })
                    .collect();
                reals.feed(share.arm, &outcomes).unwrap();
            }
        }
        (means[reals.choice().arm] < 0.58, reals.trials() as f64)
    });
    tally.guarantees(0.05);
    assert!(tally.mean() < 1500.0, "{}", tally.mean());
}

#[test]
fn scores_of_zero_and_one_race_like_booleans() {
    let means = [0.9, 0.88, 0.5];
    for k in 0..5 {
        let mut booleans = race(&means, 45, k, true, Allocation::AllFailing, u64::MAX);
        let mut reals = Race::<Scores>::new(3, 0.02, 0.05, 64, Allocation::AllFailing).unwrap();
        while !reals.finished() {
            for share in reals.next_round().to_vec() {
                let outcomes: Vec<Option<f64>> = (share.from..share.to)
                    .map(|index| Some(f64::from(u8::from(uniform(45, k, 0, index) < means[share.arm]))))
                    .collect();
                reals.feed(share.arm, &outcomes).unwrap();
            }
        }
        assert_eq!(reals.trials(), booleans.trials());
        let (one, other) = (reals.choice(), booleans.choice());
        assert_eq!((one.arm, one.open, one.certified), (other.arm, other.open, other.certified));
        assert!((one.gap - other.gap).abs() < 1e-6);
    }
}

#[test]
fn a_leader_that_never_fails_is_certified_by_its_own_trials() {
    // Nine arms that always succeed: within 0.02 after 394 trials, in words of 64 after 448. The others have a word.
    let deviations = [3.0, 2.0, 1.0, 0.5, 0.0, 0.5, 1.0, 2.0, 3.0];
    let new = |epsilon| Race::<Booleans>::new(9, epsilon, 0.05, 64, Allocation::AllFailing).unwrap();
    let mut race = new(0.02).preferring(deviations.to_vec());
    while !race.finished() {
        for share in race.next_round().to_vec() {
            race.feed(share.arm, &[Outcome::True; 64]).unwrap();
        }
    }
    assert_eq!(race.trials(), 8 * 64 + 448);
    let choice = race.choice();
    assert_eq!((choice.arm, choice.certified, choice.open.len()), (4, vec![4], 8));
    assert!(choice.gap <= 0.02 && choice.gap > 0.015, "{}", choice.gap);
    // Arms with the same trials are certified equal, and the least deviation decides among them.
    let mut race = new(0.2).preferring(deviations.to_vec());
    for arm in 0..9 {
        race.feed(arm, &[Outcome::True; 64]).unwrap();
    }
    let choice = race.choice();
    assert_eq!((race.finished(), choice.arm, choice.certified.len()), (true, 4, 9));
}

/// Trials that a rival lacks are counted as the best there are, by a plain product over all trials of the leader.
#[test]
fn the_evidence_over_trials_that_a_rival_lacks() {
    let bets: Vec<f64> = (0..12).map(|k| 0.02 * (0.95f64 / 0.02).powf(f64::from(k) / 11.0)).collect();
    let holds = |arm: u64, index: u64| uniform(50, 0, arm as u16, index) < 0.97;
    for (of_rival, of_leader) in [(0, 70), (40, 41), (64, 300), (100, 700), (130, 130), (200, 90)] {
        let (mut booleans, mut scores) = (Booleans::new(2, 0.05), Scores::new(2, 0.05));
        for (arm, trials) in [(1, of_rival), (0, of_leader)] {
            let all: Vec<bool> = (0..trials).map(|index| holds(arm, index)).collect();
            booleans.push(arm as usize, &all.iter().map(|held| Outcome::from(*held)).collect::<Vec<_>>());
            let scored: Vec<_> = all.iter().map(|held| Some(f64::from(u8::from(*held)))).collect();
            scores.push(arm as usize, &scored);
        }
        let product = |trials: u64| -> f64 {
            let of = |bet: &f64| -> f64 {
                let factor = |index: u64| {
                    let rival = index >= of_rival || holds(1, index);
                    1.0 + bet * (0.05 - f64::from(u8::from(rival)) + f64::from(u8::from(holds(0, index))))
                };
                (0..trials).map(factor).product()
            };
            bets.iter().map(of).sum::<f64>() / 12.0
        };
        let wanted = product(of_rival.min(of_leader)).max(product(of_leader)).ln();
        for found in [booleans.least_evidence(&[1], 0, 0.05), scores.least_evidence(&[1], 0, 0.05)] {
            assert!((found - wanted).abs() < 1e-9, "{of_rival} {of_leader}: {found} {wanted}");
        }
        for threshold in [wanted - 0.01, wanted + 0.01] {
            assert_eq!(booleans.is_close(1, 0, threshold), threshold < wanted);
            assert_eq!(scores.is_close(1, 0, threshold), threshold < wanted);
        }
    }
}

/// Before anything is certified, too: of arms that came out alike none has more to say for itself than the others.
#[test]
fn of_arms_that_came_out_alike_the_least_deviation_is_chosen_at_any_time() {
    let deviations = [2.0, 1.0, 0.0, 1.0, 2.0];
    let half = |index: u64, arm: usize| Outcome::from(index.is_multiple_of(2) || arm == 4 && index == 1);
    for (behind, alike) in [(false, 2), (true, 4)] {
        let new = || Race::<Booleans>::new(5, 0.02, 0.05, 32, Allocation::AllFailing).unwrap();
        let (mut plain, mut race) = (new(), new().preferring(deviations.to_vec()));
        let scores = Race::<Scores>::new(5, 0.02, 0.05, 32, Allocation::AllFailing).unwrap();
        let mut scores = scores.preferring(deviations.to_vec());
        let mut each = Each::new(5, 0.02, 0.05, 32).unwrap().preferring(deviations.to_vec());
        for arm in 0..5 {
            // One success more puts the last one ahead.
            let outcome = |index| half(index, if behind { arm } else { 0 });
            let outcomes: Vec<Outcome> = (0..32).map(outcome).collect();
            plain.feed(arm, &outcomes).unwrap();
            race.feed(arm, &outcomes).unwrap();
            each.feed(arm, &outcomes).unwrap();
            let values: Vec<Option<f64>> =
                outcomes.iter().map(|one| Some(f64::from(u8::from(*one == Outcome::True)))).collect();
            scores.feed(arm, &values).unwrap();
        }
        for choice in [race.choice(), scores.choice(), each.choice()] {
            assert_eq!((choice.arm, choice.certified.len(), choice.open.len()), (alike, 0, 4));
        }
        assert_eq!(plain.choice().arm, if behind { 4 } else { 0 });
        if !behind {
            // One more trial of some is no reason, of the next round neither.
            race.next_round();
            each.next_round();
            for arm in [0, 1] {
                race.feed(arm, &[Outcome::True; 1]).unwrap();
                each.feed(arm, &[Outcome::True; 1]).unwrap();
            }
            assert_eq!(race.choice().arm, 2);
        }
    }
}

/// One that stopped early beside the leader is alike on what both have, and carries no certificate.
#[test]
fn a_decided_race_keeps_its_promise() {
    for run in 0..40 {
        let race = Race::<Booleans>::new(3, 0.1, 0.05, 32, Allocation::AllFailing).unwrap();
        let mut race = race.preferring(vec![1.0, 0.0, 1.0]);
        // The first two differ late; the third differs from both in many trials, and is about as good.
        let outcome = |arm: usize, index: u64| {
            let u = uniform(49, run, if arm == 2 { 2 } else { 0 }, index);
            Outcome::from(if arm == 1 && index >= 150 { u < 0.4 } else { u < 0.5 })
        };
        while !race.finished() && race.trials() < 100_000 {
            for share in race.next_round().to_vec() {
                let outcomes: Vec<Outcome> = (share.from..share.to).map(|k| outcome(share.arm, k)).collect();
                race.feed(share.arm, &outcomes).unwrap();
            }
        }
        assert!(race.finished());
        let choice = race.choice();
        assert!(choice.gap <= 0.1 + 1e-12 && choice.certified.contains(&choice.arm), "{run}: {choice:?}");
    }
}

#[test]
fn unresolved_trials_count_against_the_leader_and_for_the_rival() {
    // The second arm succeeds in 0.75 to 0.95 of its trials, depending on the unresolved ones; the first, in
    // 0.9, leads, but no certificate within 0.02 can come.
    let mut race = Race::<Booleans>::new(2, 0.02, 0.05, 64, Allocation::AllFailing).unwrap();
    while !race.finished() && race.trials() < 200_000 {
        for share in race.next_round().to_vec() {
            let outcomes: Vec<Outcome> = (share.from..share.to)
                .map(|index| match (share.arm, index % 20) {
                    (0, 0 | 10) | (1, 0) => Outcome::False,
                    (1, 5 | 7 | 10 | 15) => Outcome::Unresolved,
                    _ => Outcome::True,
                })
                .collect();
            race.feed(share.arm, &outcomes).unwrap();
        }
    }
    assert!(!race.finished());
    let choice = race.choice();
    assert!(choice.arm == 0 && choice.certified.is_empty());
    assert!(choice.gap >= 0.05 && choice.gap < 0.06, "{}", choice.gap);
    let (_, _, unresolved) = race.table().counts(1);
    assert!(unresolved > 0);
}

#[test]
fn rounds_are_asked_for_and_checked() {
    let mut race = Race::<Booleans>::new(2, 0.02, 0.05, 32, Allocation::AllFailing).unwrap();
    assert_eq!(race.next_round().len(), 2);
    assert!(race.feed(0, &[Outcome::True; 33]).is_err());
    race.feed(0, &[Outcome::True; 20]).unwrap();
    assert_eq!((race.next_round()[0].from, race.next_round()[0].to), (20, 32));
    race.feed(0, &[Outcome::True; 12]).unwrap();
    assert!(race.feed(0, &[Outcome::True]).is_err());
    race.feed(1, &[Outcome::False; 32]).unwrap();
    assert!(race.next_round().is_empty() || race.next_round()[0].from == 32);
    let alone = Race::<Booleans>::new(1, 0.02, 0.05, 32, Allocation::AllFailing).unwrap();
    assert!(alone.finished() && alone.next_round().is_empty());
    assert!(Race::<Booleans>::new(0, 0.02, 0.05, 32, Allocation::AllFailing).is_err());
    assert!(Race::<Booleans>::new(2, 0.02, 1.05, 32, Allocation::AllFailing).is_err());
}

#[test]
fn okamoto_on_each_arm() {
    let mut each = Each::new(9, 0.1, 0.05, 64).unwrap();
    assert_eq!(each.size(), 1178);
    let means = [0.9, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.88];
    assert_eq!((each.choice().gap, each.choice().open.len()), (1.0, 8));
    let mut at_some_time = false;
    while !each.finished() {
        for share in each.next_round().to_vec() {
            let outcomes: Vec<Outcome> = (share.from..share.to)
                .map(|index| Outcome::from(uniform(46, 0, share.arm as u16, index) < means[share.arm]))
                .collect();
            each.feed(share.arm, &outcomes).unwrap();
        }
        // At any time there is a gap, and who is surely worse is known.
        let choice = each.choice();
        assert!(choice.gap >= 0.9 - means[choice.arm] && (choice.arm == 0 || choice.arm == 8));
        at_some_time |= !each.finished() && choice.gap < 0.25 && !choice.open.contains(&7);
    }
    assert!(at_some_time);
    let choice = each.choice();
    assert!(choice.arm == 0 || choice.arm == 8);
    assert!(choice.gap <= 0.1 + 1e-12);
    // 2.1 of the reference: 264 879 trials for nine arms, and so on.
    assert_eq!(9 * smc::stats::ranking::size(9, 0.02, 0.05), 264_879);
    assert_eq!(16 * smc::stats::ranking::size(16, 0.02, 0.05), 516_928);
}

#[test]
fn t14_races() {
    races(60);
}

#[test]
fn t15_null_boundary() {
    null_boundary(300);
}

#[test]
fn t19_gap_at_a_deadline() {
    gap_at_a_deadline(40);
}

#[test]
fn races_of_scores() {
    scores(20);
}

#[test]
#[ignore = "full number of replications"]
fn full_ranking() {
    races(1_000);
    null_boundary(10_000);
    gap_at_a_deadline(400);
    scores(300);
}

/// Where all arms are the best, none is beaten; with a threshold for the pairs with one best arm, 28 of 100 calls had one.
#[test]
fn no_arm_of_a_tie_is_beaten() {
    for (arms, runs) in [(2, 200), (5, 100), (40, 40), (120, 20)] {
        let with_beaten = |run: &u32| {
            let race = Race::<Booleans>::new(arms, 0.1, 0.2, 32, Allocation::AllFailing);
            let mut race = race.unwrap();
            while !race.finished() {
                for share in race.next_round().to_vec() {
                    let outcome = |index| Outcome::from(uniform(61, *run, share.arm as u16, index) < 0.5);
                    race.feed(share.arm, &(share.from..share.to).map(outcome).collect::<Vec<_>>()).unwrap();
                }
            }
            !race.choice().beaten.is_empty()
        };
        let count = (0..runs).filter(with_beaten).count();
        assert!(count * 10 <= runs as usize, "{count} of {runs} with {arms} arms, nominal 20 %");
    }
    // One that is clearly worse is.
    let mut race = race(&[0.9, 0.89, 0.2], 62, 0, true, Allocation::AllFailing, u64::MAX);
    assert_eq!(race.choice().beaten, [2]);
}

/// The gap before the end, where little happened: of trials that never failed, and of some that did.
#[test]
fn the_gap_of_a_few_trials_is_about_that_of_intervals() {
    let held = |count: u64, trials: u64| -> Vec<Outcome> {
        (0..trials).map(|k| Outcome::from(k * count / trials != (k + 1) * count / trials)).collect()
    };
    let values = |outcomes: &[Outcome]| -> Vec<Option<f64>> {
        outcomes.iter().map(|one| Some(f64::from(u8::from(*one == Outcome::True)))).collect()
    };
    for (trials, counts, most) in [
        (10, vec![10, 10], 0.48),
        (10, vec![10, 10, 0, 0], 0.56),
        (5, vec![5, 0, 0], 0.51),
        (5, vec![5, 5], 0.71),
        (20, vec![20, 18, 10], 0.28),
    ] {
        let mut race = Race::<Booleans>::new(counts.len(), 0.1, 0.05, 32, Allocation::AllFailing).unwrap();
        let mut scores = Race::<Scores>::new(counts.len(), 0.1, 0.05, 32, Allocation::AllFailing).unwrap();
        for (arm, count) in counts.iter().enumerate() {
            race.feed(arm, &held(*count, trials)).unwrap();
            scores.feed(arm, &values(&held(*count, trials))).unwrap();
        }
        let (gap, other) = (race.choice().gap, scores.choice().gap);
        assert!(gap <= most, "{gap} of {counts:?} in {trials}");
        assert!((gap - other).abs() < 2e-6, "{gap} {other}");
    }
}
