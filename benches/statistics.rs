//! Trials to decide, and what the statistics cost by themselves.
//!
//! `cargo bench --bench statistics` for all parts, `-- tests estimates ranking time` for some. Outcomes are drawn by
//! address; those of the timed rankings lie ready, so that only the statistics are timed.

#![allow(
    missing_docs,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a bench reads the clock and prints"
)]

use smc::base::random::{Purpose, Stream, TrialKey};
use smc::stats::calibration::{Boundary, Table};
use smc::stats::ranking::{Allocation, Booleans, Contest as _, Each, Race};
use smc::stats::{
    AnyEstimator, Estimator, Evidence, Hypothesis, Massart, Okamoto, Outcome, Plan, Sequential, Spending,
    Sprt, Test, TwoSprt,
};
use std::hint::black_box;
use std::time::Instant;

/// Replications of the tests and estimates, and of the rankings.
const RUNS: u32 = 1000;

fn uniform(run: u32, arm: u16, index: u64) -> f64 {
    Stream::of(TrialKey { seed: 7, index, branch: arm }, run, Purpose::Test).uniform(0)
}

/// Mean and 95th percentile.
fn summary(mut trials: Vec<u64>) -> String {
    trials.sort_unstable();
    let mean = trials.iter().sum::<u64>() as f64 / trials.len() as f64;
    format!("{mean:.0} ({})", trials[trials.len() * 95 / 100])
}

fn test(fresh: &Sequential<impl Test + Clone>, p: f64, cap: u64) -> String {
    let all = (0..RUNS).map(|run| {
        let mut test = fresh.clone();
        (0..cap)
            .find(|&index| test.observe(uniform(run, 0, index) < p).is_some())
            .map_or(cap, |index| index + 1)
    });
    let all: Vec<u64> = all.collect();
    if all.iter().filter(|n| **n == cap).count() * 2 > all.len() {
        "undecided".to_owned()
    } else {
        summary(all)
    }
}

/// Table 1.5: theta = 0.9, alpha = beta = 0.01, indifference 0.01.
fn tests() {
    println!("\ntests: P >= 0.9, errors 0.01, indifference 0.01; mean (p95) of {RUNS} runs");
    let plan = Plan::new(0.9, 0.01, 0.01, 0.01).map_or((0, 0), |plan| plan.rule().size());
    println!("exact plan: {} trials, at least {} successes; Okamoto: 23026", plan.0, plan.1);
    println!("| p | SPRT | 2-SPRT | e-process |");
    let (Ok(sprt), Ok(sprt2), Ok(evidence)) = (
        Sprt::new(0.9, 0.01, 0.01, 0.01),
        TwoSprt::new(0.9, 0.01, 0.01, 0.01),
        Evidence::new(Hypothesis::AtLeast, 0.9, 0.01, 0.01),
    ) else {
        return;
    };
    for p in [0.5, 0.8, 0.85, 0.88, 0.89, 0.9, 0.91, 0.92, 0.95, 0.99] {
        let cap = if p == 0.9 { 20_000 } else { 200_000 };
        println!(
            "| {p} | {} | {} | {} |",
            test(&sprt, p, u64::MAX),
            test(&sprt2, p, u64::MAX),
            test(&evidence, p, cap)
        );
    }
}

fn estimate(fresh: &Sequential<impl Estimator + Clone>, p: f64, runs: u32) -> String {
    let all = (0..runs).map(|run| {
        let mut estimator = fresh.clone();
        let mut index = 0;
        while !estimator.observe(uniform(run, 0, index) < p) {
            index += 1;
        }
        index + 1
    });
    summary(all.collect())
}

/// Table 1.10: epsilon = 0.01, delta = 0.05.
fn estimates() {
    println!("\nestimates to 0.01 at 95 %; mean (p95) of 100 runs");
    println!("| p | Okamoto | Massart | spending | calibrated |");
    let (Ok(okamoto), Ok(massart), Ok(spending), Ok(calibrated)) = (
        Okamoto::new(0.01, 0.05),
        Massart::new(0.01, 0.05, 0.001),
        Spending::new(0.01, 0.05),
        AnyEstimator::within(0.01, 0.05),
    ) else {
        return;
    };
    for p in [0.001, 0.01, 0.05, 0.1, 0.3, 0.5, 0.9, 0.99] {
        println!(
            "| {p} | {} | {} | {} | {} |",
            estimate(&okamoto, p, 2),
            estimate(&massart, p, 100),
            estimate(&spending, p, 100),
            estimate(&calibrated, p, 100)
        );
    }
}

fn workloads() -> [(&'static str, Vec<f64>); 5] {
    [
        ("(i) nine options", vec![0.95, 0.93, 0.90, 0.85, 0.7, 0.6, 0.5, 0.3, 0.1]),
        ("(ii) .99 and 15 of .90", [vec![0.99], vec![0.90; 15]].concat()),
        ("(iii) 36 options", (0..36).map(|k| 0.2 + 0.75 * f64::from(k) / 35.0).collect()),
        ("(iv) .90 and 8 of .879", [vec![0.90], vec![0.879; 8]].concat()),
        ("64 options", [vec![0.97], (0..63).map(|k| 0.3 + 0.64 * f64::from(k) / 62.0).collect()].concat()),
    ]
}

/// Runs a race over outcomes from `source`; trials.
fn race(arms: usize, word: u64, mut source: impl FnMut(usize, u64, u64, &mut Vec<Outcome>)) -> u64 {
    let Ok(mut race) = Race::<Booleans>::new(arms, 0.02, 0.05, word, Allocation::AllFailing) else {
        return 0;
    };
    let mut outcomes = Vec::new();
    while !race.finished() {
        for share in race.next_round().to_vec() {
            outcomes.clear();
            source(share.arm, share.from, share.to, &mut outcomes);
            if race.feed(share.arm, &outcomes).is_err() {
                return 0;
            }
        }
    }
    black_box(race.choice());
    race.trials()
}

/// Table 2.3: epsilon = 0.02, delta = 0.05.
fn ranking() {
    println!("\nrankings within 0.02 at 95 %, words of 32; mean (p95) of {RUNS} runs");
    println!("| workload | independent | common random numbers | Okamoto on each |");
    for (name, means) in workloads() {
        let runs = |common: bool| {
            let all = (0..RUNS).map(|run| {
                race(means.len(), 32, |arm, from, to, out| {
                    let stream = if common { 0 } else { arm as u16 };
                    out.extend(
                        (from..to).map(|index| Outcome::from(uniform(run, stream, index) < means[arm])),
                    );
                })
            });
            summary(all.collect())
        };
        let each = Each::new(means.len(), 0.02, 0.05, 256).map_or(0, |each| each.size() * means.len() as u64);
        println!("| {name} | {} | {} | {each} |", runs(false), runs(true));
    }
}

/// What a decision costs without the trials.
fn time() {
    println!("\ntime of the statistics, best of several repeats");
    for (name, means) in workloads() {
        let runs = 100u32;
        let tables: Vec<Vec<Vec<Outcome>>> = (0..runs)
            .map(|run| {
                let row = |(arm, p): (usize, &f64)| {
                    (0..12_000).map(|index| Outcome::from(uniform(run, arm as u16, index) < *p)).collect()
                };
                means.iter().enumerate().map(row).collect()
            })
            .collect();
        // The best of each ranking by itself: it is over before anybody takes the core away.
        let (mut best, mut trials) = (vec![f64::INFINITY; tables.len()], 0);
        for _ in 0..15 {
            trials = 0;
            for (table, best) in tables.iter().zip(&mut best) {
                let begin = Instant::now();
                trials += race(means.len(), 32, |arm, from, to, out| {
                    let to = (to as usize).min(12_000);
                    out.extend_from_slice(&table[arm][from as usize..to]);
                });
                *best = best.min(begin.elapsed().as_secs_f64());
            }
        }
        let best: f64 = best.iter().sum();
        println!(
            "{name}: {:.1} µs a ranking, {:.0} trials, {:.1} ns a trial",
            1e6 * best / f64::from(runs),
            trials as f64 / f64::from(runs),
            1e9 * best / trials as f64
        );
    }
    let outcomes: Vec<bool> = (0..1_000_000).map(|index| uniform(0, 0, index) < 0.9).collect();
    let per_trial = |name: &str, observe: &mut dyn FnMut(bool) -> bool| {
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let begin = Instant::now();
            for outcome in &outcomes {
                black_box(observe(*outcome));
            }
            best = best.min(begin.elapsed().as_secs_f64());
        }
        println!("{name}: {:.1} ns a trial", 1e9 * best / outcomes.len() as f64);
    };
    if let Ok(mut sprt) = Sprt::new(0.9, 0.000_001, 1e-9, 1e-9) {
        per_trial("SPRT", &mut |x| sprt.observe(x).is_some());
    }
    if let Ok(mut evidence) = Evidence::new(Hypothesis::AtLeast, 0.9, 1e-9, 1e-9) {
        per_trial("e-process", &mut |x| evidence.observe(x).is_some());
    }
    if let Ok(mut mean) = smc::stats::Mean::fixed(0.0, 1.0, 10_000_000, 0.05) {
        per_trial("empirical Bernstein", &mut |x| mean.observe(Some(f64::from(u8::from(x)))));
    }
}

/// Proofs of the rows of the table with small half-widths, which take from seconds to minutes each.
fn proofs() {
    println!("\nproofs of rows of the table");
    println!("| epsilon | delta | gamma | most trials | proven | seconds |");
    for row in Table::ROWS.into_iter().filter(|row| row.epsilon < 0.01) {
        let started = Instant::now();
        let boundary = Boundary::new(row.epsilon, row.gamma);
        let proven = boundary.as_ref().is_some_and(|boundary| boundary.proves(row.delta));
        println!(
            "| {} | {} | {} | {} | {proven} | {:.1} |",
            row.epsilon,
            row.delta,
            row.gamma,
            boundary.map_or(0, |boundary| boundary.limit()),
            started.elapsed().as_secs_f64()
        );
    }
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let parts: [(&str, fn()); 4] =
        [("time", time), ("tests", tests), ("ranking", ranking), ("estimates", estimates)];
    if wanted.iter().any(|w| w == "proofs") {
        proofs();
    }
    for (name, part) in parts {
        if wanted.is_empty() || wanted.iter().any(|w| w == name) {
            part();
        }
    }
}
