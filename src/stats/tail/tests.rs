//! Tails of exact laws: a binomial one with ties, a uniform one, and one that is constant.

use super::*;
use crate::base::random::{Purpose, Stream, TrialKey};

fn stream(index: u64) -> Stream {
    Stream::of(TrialKey { seed: 4243, index, branch: 0 }, 1, Purpose::Procedure)
}

/// A binomial number of 60 fair coins.
fn heads(stream: &Stream, trial: u32) -> f64 {
    (0..60).filter(|coin| stream.uniform(60 * trial + coin) < 0.5).count() as f64
}

/// The mean of the largest tenth of that law, summed from its probabilities.
fn truth() -> f64 {
    let mut chance = math::exp(60.0 * math::ln(0.5));
    let mut law = vec![chance];
    for k in 1..=60_u32 {
        chance *= f64::from(61 - k) / f64::from(k);
        law.push(chance);
    }
    let (mut left, mut sum) = (0.1, 0.0);
    for (k, chance) in law.iter().enumerate().rev() {
        let part = math::at_most(left, *chance);
        sum += part * k as f64;
        left -= part;
    }
    sum / 0.1
}

/// Of 300 samples at most 5 %, and chance, miss the truth at whichever of their sizes somebody looks.
#[test]
fn the_interval_misses_no_more_often_than_it_says() {
    let truth = truth();
    assert!((truth - 36.754).abs() < 1e-3);
    let mut missed = 0;
    for run in 0..300 {
        let stream = stream(run);
        let mut tail = Tail::running((0.0, 60.0), 0.1, 0.1).unwrap();
        let mut ever = false;
        for trial in 0..300 {
            tail.observe(Some(heads(&stream, trial)));
            if trial % 50 == 49 {
                ever |= !tail.interval().holds(truth);
            }
        }
        missed += u32::from(ever);
    }
    assert!(missed <= 30 + 15, "{missed} of 300");
}

#[test]
fn a_uniform_metric_is_found_and_the_width_is_reached() {
    // The mean of the largest fifth of a uniform number is 0.9.
    for run in 0..20 {
        let stream = stream(1000 + run);
        let mut tail = Tail::within((0.0, 2.0), 0.2, 0.1, 0.05).unwrap();
        let mut trial = 0;
        while !tail.observe(Some(stream.uniform(trial))) {
            trial += 1;
        }
        let found = tail.interval();
        assert!(found.holds(0.9) && found.half_width() <= 0.1, "{found:?} after {trial}");
        assert!(trial < 2000, "{trial}");
    }
}

/// The band of Dvoretzky, Kiefer and Wolfowitz gives 35.81 to 41.50 for 5000 such trials: at least two fifths of that.
#[test]
fn it_is_narrower_than_the_band() {
    let stream = stream(77_000);
    let mut tail = Tail::fixed((0.0, 60.0), 0.1, 5000, 0.05).unwrap();
    let mut trial = 0;
    while !tail.observe(Some(heads(&stream, trial))) {
        trial += 1;
    }
    let found = tail.interval();
    assert!(found.holds(truth()), "{found:?}");
    assert!(found.high - found.low < 0.4 * 5.69, "{found:?}");
}

/// The plain rule: the least capital over very many c, each computed by itself.
#[test]
fn the_least_capital_over_all_c_is_found() {
    for run in 0..10 {
        let stream = stream(500 + run);
        let mut tail = Tail::running((0.0, 1.0), 0.25, 0.05).unwrap();
        for trial in 0..120 {
            let value = stream.uniform(trial);
            tail.observe(Some(if run % 2 == 0 { value } else { (value * 8.0).floor() / 8.0 }));
        }
        let low = tail.lower_end(|v| v.0);
        let plain = |u: f64| {
            let at = |c: f64| log_mean(&capitals(tail.values.iter().map(|v| tail.at(c, v.0) / u)));
            (0..=2000).map(|k| at(u * f64::from(k) / 2000.0)).fold(f64::INFINITY, math::at_most)
        };
        let threshold = math::ln(2.0 / 0.05);
        assert!(plain(low) >= threshold, "{run}: {low}");
        assert!(plain(low + 0.003) < threshold, "{run}: {low}");
    }
}

#[test]
fn unresolved_values_are_read_both_ways() {
    let mut tail = Tail::running((0.0, 10.0), 0.5, 0.05).unwrap();
    for trial in 0..400_u32 {
        tail.observe((trial % 10 != 0).then_some(5.0));
    }
    let ((low, high), interval) = (tail.estimate(), tail.interval());
    assert!((low - 5.0).abs() < 1e-9 && (high - 6.0).abs() < 1e-9, "{low} {high}");
    assert!(interval.low < 5.0 && interval.high > 6.0);
    assert_eq!(tail.read(), (400, 40, 0));
    assert!(tail.splits(0.5 * (low + high)) || interval.half_width() > 0.5);
}

#[test]
fn what_is_no_share_or_no_range_is_refused() {
    assert!(Tail::running((0.0, 1.0), 0.0, 0.05).is_err());
    assert!(Tail::running((0.0, 1.0), 1.0, 0.05).is_err());
    assert!(Tail::running((1.0, 1.0), 0.5, 0.05).is_err());
    let mut tail = Tail::running((0.0, 1.0), 0.5, 0.05).unwrap();
    let none = tail.interval();
    assert_eq!((none.low, none.high), (0.0, 1.0));
    tail.observe(Some(7.0));
    assert_eq!(tail.read(), (1, 0, 1));
}
