//! T8 to T13 and T23: estimators of a probability, and the rules that must fail.

use super::tally::{Tally, uniform};
use smc::stats::calibration::{Boundary, Table};
use smc::stats::clopper_pearson;
use smc::stats::difference::{self, Pairs};
use smc::stats::{Calibrated, Counts, Estimator, Gbas, Massart, Outcome, Sequential, Spending, sequence};

fn tally(fresh: &Sequential<impl Estimator + Clone>, seed: u64, p: f64, runs: u32) -> Tally {
    Tally::over(runs, |k| {
        let mut estimator = fresh.clone();
        let mut index = 0;
        while !estimator.observe(uniform(seed, k, 0, index) < p) {
            index += 1;
        }
        (!estimator.interval().holds(p), estimator.counts().trials() as f64)
    })
}

/// T9: least coverage of an interval at n = 100 over p in [0.001, 0.5], by enumeration.
fn least_coverage(interval: impl Fn(f64) -> (f64, f64)) -> f64 {
    let n = 100;
    let intervals: Vec<(f64, f64)> = (0..=n).map(|s| interval(f64::from(s))).collect();
    let mut least = 1.0;
    for k in 0..2000 {
        let p = 0.001 + 0.499 * f64::from(k) / 1999.0;
        let (mut mass, mut covered) = ((1.0 - p).powi(n), 0.0);
        for (s, (low, high)) in intervals.iter().enumerate() {
            if *low <= p && p <= *high {
                covered += mass;
            }
            mass *= (f64::from(n) - s as f64) / (s as f64 + 1.0) * p / (1.0 - p);
        }
        least = f64::min(least, covered);
    }
    least
}

#[test]
fn t9_coverage_by_enumeration() {
    let z = 1.959_963_984_540_054;
    let n = 100.0;
    let exact = least_coverage(|s| {
        let counts = Counts { successes: s as u64, failures: 100 - s as u64 };
        let interval = clopper_pearson::interval(counts, 0.05);
        (interval.low, interval.high)
    });
    assert!((0.95..0.951).contains(&exact), "{exact}");
    // Negative controls: the same harness finds what is wrong with these.
    let wald = least_coverage(|s| {
        let p = s / n;
        let reach = z * (p * (1.0 - p) / n).sqrt();
        (p - reach, p + reach)
    });
    assert!((wald - 0.095).abs() < 0.002, "{wald}");
    let wilson = least_coverage(|s| {
        let p = s / n;
        let centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let reach = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        (centre - reach, centre + reach)
    });
    assert!((wilson - 0.839).abs() < 0.002, "{wilson}");
}

fn calibrated(runs: u32) {
    let fresh = Calibrated::at_level(0.05, 0.05, 0.035).unwrap();
    for (p, miss, mean) in [
        (0.05, 0.008_47, 93.97),
        (0.1, 0.038_26, 169.67),
        (0.107, 0.044_30, 180.21),
        (0.3, 0.030_10, 389.63),
        (0.5, 0.031_30, 461.10),
    ] {
        let tally = tally(&fresh, 20, p, runs);
        tally.guarantees(0.05);
        tally.equals(miss);
        tally.takes(mean);
    }
}

/// T11: the same at the naive level must fail.
fn naive(runs: u32) {
    let naive = Calibrated::at_level(0.05, 0.05, 0.05).unwrap();
    let tally = tally(&naive, 21, 0.107, runs);
    tally.breaks(0.05);
    tally.equals(0.064_09);
    tally.takes(157.22);
}

/// T12: stopping by the normal approximation must fail.
fn normal_stopping(runs: u32) {
    let (p, epsilon, z) = (0.050_6, 0.05, 1.959_963_984_540_054);
    let stop = |from: f64, extra: f64| {
        Tally::over(runs, |k| {
            let (mut n, mut s) = (0.0, 0.0);
            loop {
                s += f64::from(u8::from(uniform(22, k, 0, n as u64) < p));
                n += 1.0;
                let share: f64 = s / n;
                let variance = share * (1.0 - share) + extra / n;
                if n >= from && z * z * variance <= epsilon * epsilon * n {
                    return ((share - p).abs() > epsilon, n);
                }
            }
        })
    };
    let plain = stop(30.0, 0.0);
    plain.breaks(0.05);
    plain.equals(0.214_8);
    let chow_robbins = stop(1.0, 1.0);
    chow_robbins.breaks(0.05);
    chow_robbins.equals(0.128_9);
}

fn other_estimators(runs: u32) {
    for p in [0.01, 0.107, 0.5, 0.95] {
        tally(&Spending::new(0.05, 0.05).unwrap(), 23, p, runs).guarantees(0.05);
        tally(&Massart::new(0.05, 0.05, 0.005).unwrap(), 24, p, runs).guarantees(0.05);
    }
}

/// T13: the probability that the confidence sequence ever misses p within n trials, exactly, by following
/// all numbers of successes.
fn ever_missed(p: f64, n: usize) -> f64 {
    let mut mass = vec![0.0; n + 2];
    mass[0] = 1.0;
    let mut missed = 0.0;
    let (mut first, mut last) = (0, 0);
    for trial in 1..=n {
        for s in (first..=last).rev() {
            mass[s + 1] += mass[s] * p;
            mass[s] *= 1.0 - p;
        }
        last += 1;
        let out = |s: usize| {
            let counts = Counts { successes: s as u64, failures: (trial - s) as u64 };
            !sequence::holds(counts, 0.05, p)
        };
        while out(first) {
            missed += std::mem::take(&mut mass[first]);
            first += 1;
        }
        while out(last) {
            missed += std::mem::take(&mut mass[last]);
            last -= 1;
        }
    }
    missed
}

#[test]
fn t13_the_confidence_sequence_holds_at_all_times() {
    for (p, expected) in [(0.05, 0.023_9), (0.3, 0.037_8), (0.5, 0.038_6)] {
        let missed = ever_missed(p, 10_000);
        assert!((missed - expected).abs() < 1e-4, "{p}: {missed}");
    }
}

fn gbas(runs: u32) {
    let share = |p: f64| {
        Tally::over(runs, |k| {
            let mut gbas = Gbas::new(0.1, 0.05, None, 1000 + u64::from(k)).unwrap();
            assert_eq!(gbas.rule().needed(), 385);
            let mut index = 0;
            while !gbas.observe(uniform(25, k, 0, index) < p) {
                index += 1;
            }
            ((gbas.estimate() / p - 1.0).abs() > 0.1, gbas.counts().trials() as f64)
        })
    };
    // The error does not depend on p: the same four standard deviations around the same number.
    let (rare, common) = (share(0.01), share(0.3));
    rare.guarantees(0.05);
    common.guarantees(0.05);
    rare.equals(0.05);
    common.equals(0.05);
    rare.takes(38_500.0);
}

/// The difference of two probabilities: time-uniform coverage, and the width at the stop.
fn paired_difference(runs: u32) {
    for (p, q, common) in [(0.5, 0.5, false), (0.9, 0.85, true), (0.05, 0.07, false), (0.3, 0.6, true)] {
        let missed = Tally::over(runs, |k| {
            let mut pairs = Pairs::default();
            let mut missed = false;
            for index in 0..3000 {
                let u = uniform(26, k, 0, index);
                let v = if common { u } else { uniform(26, k, 1, index) };
                match (u < p, v < q) {
                    (true, false) => pairs.first += 1,
                    (false, true) => pairs.second += 1,
                    _ => pairs.alike += 1,
                }
                if index % 10 == 0 {
                    missed |= !difference::interval(pairs, 0.05).holds(p - q);
                }
            }
            (missed, 0.0)
        });
        missed.guarantees(0.05);
    }
    let mut stop = smc::stats::Difference::new(0.05, Some(0.02)).unwrap();
    let mut index = 0;
    while !stop.observe(
        Outcome::from(uniform(27, 0, 0, index) < 0.9),
        Outcome::from(uniform(27, 0, 0, index) < 0.85),
    ) {
        index += 1;
    }
    // The variance is about 0.05; Hoeffding's bound on [-1, 1] would take 18 445 pairs.
    assert!(stop.interval().half_width() <= 0.02 && index < 7_000, "{index}");
}

#[test]
fn t10_calibrated() {
    calibrated(1500);
}

#[test]
fn t11_naive_level_fails() {
    naive(6000);
}

#[test]
fn t12_normal_stopping_fails() {
    normal_stopping(5000);
}

#[test]
fn spending_and_massart_keep_their_error() {
    other_estimators(100);
}

#[test]
fn t23_relative_error() {
    gbas(60);
}

#[test]
fn differences_are_covered_at_all_times() {
    paired_difference(25);
}

/// The narrow rows of the table, each by its own proof; the wide ones are proven in every run.
#[test]
#[ignore = "takes half a minute"]
fn full_table() {
    for row in Table::ROWS.into_iter().filter(|row| (0.005..0.02).contains(&row.epsilon)) {
        assert!(Boundary::new(row.epsilon, row.gamma).unwrap().proves(row.delta), "{row:?}");
    }
    assert_eq!(Boundary::new(0.01, 0.036).unwrap().limit(), 11_090);
    assert_eq!(Boundary::new(0.01, 0.006).unwrap().limit(), 18_972);
    assert_eq!(Boundary::new(0.01, 0.076).unwrap().limit(), 7_969);
}

#[test]
#[ignore = "full number of replications"]
fn full_estimators() {
    calibrated(20_000);
    naive(20_000);
    normal_stopping(20_000);
    other_estimators(1_000);
    gbas(2_000);
    paired_difference(150);
}
