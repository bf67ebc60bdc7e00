//! T26: a Bayes factor is no error bound. The test of Jha et al. 2009 with T = 100 is wrong in 22.6 % of runs at
//! P = 0.89; it is not offered, and no report speaks of it.

use super::tally::{Tally, uniform};
use smc::base::special::beta_tails;

const THETA: f64 = 0.9;
const LONGEST: usize = 60_000;

/// ln of the Bayes factor of P >= theta against P < theta, with a uniform prior.
fn ln_factor(n: u64, successes: u64) -> f64 {
    let tails = beta_tails(successes as f64 + 1.0, (n - successes) as f64 + 1.0, THETA, 1.0 - THETA);
    tails.ln_upper - tails.ln_lower + (THETA / (1.0 - THETA)).ln()
}

/// After n trials: the most successes that reject, the fewest that accept.
fn boundaries(evidence: f64) -> Vec<(i64, i64)> {
    let (mut low, mut high) = (-1i64, 0i64);
    (1..=LONGEST as u64)
        .map(|n| {
            while high <= n as i64 && ln_factor(n, high as u64) < evidence {
                high += 1;
            }
            while low < n as i64 && ln_factor(n, (low + 1) as u64) <= -evidence {
                low += 1;
            }
            (low, high)
        })
        .collect()
}

fn wrong(runs: u32) -> Tally {
    let boundaries = boundaries(100f64.ln());
    Tally::over(runs, |k| {
        let mut successes = 0;
        for (index, &(low, high)) in boundaries.iter().enumerate() {
            successes += i64::from(uniform(80, k, 0, index as u64) < 0.89);
            if successes <= low {
                return (false, index as f64);
            }
            if successes >= high {
                return (true, index as f64);
            }
        }
        (false, LONGEST as f64)
    })
}

#[test]
fn t26_a_bayes_factor_bounds_no_error() {
    let tally = wrong(2_000);
    tally.equals(0.226);
    tally.breaks(0.01);
}

#[test]
fn t26_nothing_of_the_kind_is_offered() {
    for file in [
        "src/compile/query/methods.rs",
        "src/engine/answer/words.rs",
        "src/engine/sampling/procedure.rs",
        "src/stats/procedures/mod.rs",
    ] {
        let text = std::fs::read_to_string(format!("{}/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        assert!(!text.to_lowercase().contains("bayes"), "{file}");
    }
}

#[test]
#[ignore = "full number of replications"]
fn full_bayes() {
    wrong(10_000).equals(0.226);
}
