//! T1 to T6 and T20: tests of a probability.

use super::tally::{Tally, uniform};
use smc::stats::{Decision, Evidence, Hypothesis, Sequential, Sprt, Test, ThreeWay, TwoSprt};

/// Runs a fresh test at `p` up to `cap` trials.
fn run(mut test: Sequential<impl Test>, seed: u64, run: u32, p: f64, cap: u64) -> (Option<Decision>, f64) {
    for index in 0..cap {
        if let Some(decision) = test.observe(uniform(seed, run, 0, index) < p) {
            return (Some(decision), (index + 1) as f64);
        }
    }
    (None, cap as f64)
}

fn tally(test: &Sequential<impl Test + Clone>, seed: u64, p: f64, wrong: Decision, runs: u32) -> Tally {
    Tally::over(runs, |k| {
        let (decision, n) = run(test.clone(), seed, k, p, u64::MAX);
        (decision == Some(wrong), n)
    })
}

fn sprt(runs: u32) {
    let test = Sprt::new(0.9, 0.01, 0.01, 0.01).unwrap();
    let t1 = tally(&test, 1, 0.91, Decision::Below, runs);
    t1.guarantees(0.01);
    t1.equals(0.009_23);
    t1.takes(2094.8);
    let t2 = tally(&test, 2, 0.89, Decision::Above, runs);
    t2.guarantees(0.01);
    t2.equals(0.009_80);
    t2.takes(1998.0);
    let t3 = tally(&test, 3, 0.90, Decision::Above, runs);
    t3.equals(0.468_77);
    t3.takes(4829.6);
    tally(&test, 4, 0.95, Decision::Below, runs).takes(416.5);
}

fn gamblers_ruin(runs: u32) {
    let test = Sprt::new(0.5, 0.1, 0.05, 0.05).unwrap();
    let above = tally(&test, 5, 0.6, Decision::Below, runs);
    above.equals(1.0 / (1.0 + 25.628_906_25));
    above.takes(37.00);
    let below = tally(&test, 6, 0.4, Decision::Above, runs);
    below.equals(1.0 / (1.0 + 25.628_906_25));
    below.takes(37.00);
    tally(&test, 7, 0.5, Decision::Above, runs).takes(64.00);
}

fn two_sprt(runs: u32) {
    let test = TwoSprt::new(0.9, 0.01, 0.01, 0.01).unwrap();
    for (p, wrong, error, mean) in [
        (0.91, Decision::Below, Some(0.005_17), 2886.6),
        (0.89, Decision::Above, Some(0.004_61), 2634.0),
        (0.90, Decision::Above, None, 4522.1),
    ] {
        let mut longest = 0.0;
        let tally = Tally::over(runs, |k| {
            let (decision, n) = run(test.clone(), 8, k, p, u64::MAX);
            longest = f64::max(longest, n);
            (decision == Some(wrong), n)
        });
        assert!(longest <= 8189.0);
        tally.takes(mean);
        if let Some(error) = error {
            tally.guarantees(0.01);
            tally.equals(error);
        }
    }
}

fn evidence(runs: u32) {
    let test = Evidence::new(Hypothesis::AtLeast, 0.9, 0.01, 0.01).unwrap();
    let decisions: Vec<_> = (0..runs).map(|k| run(test.clone(), 9, k, 0.9, 10_000).0).collect();
    let share = |wanted| Tally::over(runs, |k| (decisions[k as usize] == wanted, 0.0));
    let (high, low) = (share(Some(Decision::Above)), share(Some(Decision::Below)));
    high.guarantees(0.01);
    low.guarantees(0.01);
    high.equals(0.007_56);
    low.equals(0.006_78);
    share(None).equals(0.985_66);
    tally(&test, 10, 0.95, Decision::Below, runs).takes(354.3);
    tally(&test, 11, 0.85, Decision::Above, runs).takes(464.1);
}

fn three_way(runs: u32) {
    let test = ThreeWay::new(Hypothesis::AtLeast, 0.5, 0.1, 0.05).unwrap();
    for p in [0.5, 0.55, 0.6, 0.4, 0.8] {
        let wrong = |decision| match decision {
            Decision::Above => p <= 0.5,
            Decision::Below => p >= 0.5,
            Decision::Within => !(p > 0.4 && p < 0.6),
        };
        Tally::over(runs, |k| {
            let (decision, n) = run(test.clone(), 12, k, p, 1_000_000);
            (wrong(decision.expect("it stops")), n)
        })
        .guarantees(0.05);
    }
}

#[test]
fn t1_t2_t3_sprt() {
    sprt(700);
}

#[test]
fn t4_gamblers_ruin() {
    gamblers_ruin(10_000);
}

#[test]
fn t5_two_sprt() {
    two_sprt(500);
}

#[test]
fn t6_evidence() {
    evidence(400);
}

#[test]
fn three_answers_keep_their_error() {
    three_way(200);
}

/// T20: however many outcomes were computed ahead, the same trial decides.
#[test]
fn t20_batches_do_not_matter() {
    for k in 0..50 {
        let fresh = Sprt::new(0.9, 0.01, 0.01, 0.01).unwrap();
        let (decision, n) = run(fresh.clone(), 13, k, 0.91, u64::MAX);
        for batch in [1, 64, 1000] {
            let mut test = fresh.clone();
            let mut index = 0;
            while test.decision().is_none() {
                for _ in 0..batch {
                    test.observe(uniform(13, k, 0, index) < 0.91);
                    index += 1;
                }
            }
            assert_eq!((test.decision(), test.counts().trials() as f64), (decision, n));
        }
    }
}

#[test]
#[ignore = "full number of replications"]
fn full_tests_of_p() {
    sprt(10_000);
    gamblers_ruin(100_000);
    two_sprt(5_000);
    evidence(4_000);
    three_way(2_000);
}
