//! T25: cumulative sums.

use super::tally::{Tally, uniform};
use smc::stats::Cusum;

fn first_alarm(seed: u64, p: f64, runs: u32) -> Tally {
    Tally::over(runs, |k| {
        let mut cusum = Cusum::new(0.95, 0.85, 1000f64.ln()).unwrap();
        let mut index = 0;
        while !cusum.observe(uniform(seed, k, 0, index) < p) {
            index += 1;
        }
        (false, (index + 1) as f64)
    })
}

#[test]
fn t25_delay() {
    let delay = first_alarm(60, 0.85, 2_000);
    assert!((delay.mean() / 90.8 - 1.0).abs() < 0.05, "{}", delay.mean());
    assert!(first_alarm(61, 0.95, 50).mean() > 1000.0);
    assert!(Cusum::new(0.9, 0.9, 5.0).is_err());
    assert!(
        (Cusum::new(0.9, 0.8, 5.0).unwrap().mean_to_false_alarm_at_least() / 5f64.exp() - 1.0).abs() < 1e-12
    );
}

#[test]
#[ignore = "full number of replications"]
fn full_drift() {
    let delay = first_alarm(60, 0.85, 20_000);
    assert!((delay.mean() / 90.8 - 1.0).abs() < 0.03, "{}", delay.mean());
    let quiet = first_alarm(61, 0.95, 2_000);
    assert!((quiet.mean() / 29_089.0 - 1.0).abs() < 0.08, "{}", quiet.mean());
    assert!(quiet.mean() >= 1000.0);
}
