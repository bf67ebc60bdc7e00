//! Splitting in continuous time against uniformisation: exponential waits begin anew, delays keep what is left.

use super::chain::Chain;
use super::{answered, compiled};
use smc::engine::outcome::{QueryResult, Rare};

const OVERFLOW: &str = include_str!("../../models/overflow.scn");

/// The probability that so many wait in two queues together within 30 s.
fn crowded(room: u32) -> f64 {
    let (chain, states) = Chain::explored((0u32, 0u32), |&(first, second)| {
        let mut moves = Vec::new();
        if first + second < room {
            moves.push((0.5, (first + 1, second)));
            if first > 0 {
                moves.push((2.0, (first - 1, second + 1)));
            }
            if second > 0 {
                moves.push((2.0, (first, second - 1)));
            }
        }
        moves
    });
    chain.until(|_| true, |s| states[s].0 + states[s].1 == room, (0.0, 30.0))[0]
}

fn result(model: &str, query: &str, seed: u64) -> (QueryResult, Rare) {
    let study = compiled(model, query).unwrap_or_else(|error| panic!("{error}"));
    let run = answered(&study, seed, 2);
    assert_eq!(run.failure, None);
    let result = run.results[0].clone();
    let rare = result.rare.unwrap();
    (result, rare)
}

/// Whether the mean of the runs is near the truth by their own scatter, and that scatter is small.
fn near(rare: &Rare, exact: f64) {
    let error = rare.deviation / (rare.runs as f64).sqrt();
    let found = rare.estimate.unwrap();
    assert!((found - exact).abs() < 4.0 * error, "{found} +- {error} instead of {exact}");
    assert!(error < 0.3 * exact, "{error} of {exact}: it is worth it");
    assert!(rare.floor <= exact && rare.floor > 0.2 * exact, "{} {exact}", rare.floor);
}

#[test]
fn a_queue_overflows_as_seldom_as_it_must() {
    let exact = crowded(14);
    assert!(
        (exact / 9.238_729_434e-7 - 1.0).abs() < 1e-6 && (crowded(6) - 0.031_353_66).abs() < 1e-7,
        "{exact}"
    );
    for (method, runs) in [("splitting", 60), ("fixed_effort", 40)] {
        let query = format!(
            "estimate P(F<=30 s (counters.waiting >= 14)) by {method}(replicas = 100, runs = {runs}, plain = 2000)"
        );
        let (result, rare) = result(OVERFLOW, &query, 1);
        near(&rare, exact);
        assert!(rare.agrees && result.consumed.counts.successes == 0, "{result:?}");
        assert_eq!(result.estimate, rare.estimate);
        assert!(result.certifies.contains("from the plain trials alone"), "{}", result.certifies);
        assert!(
            result.certifies.contains(">= ") && result.certifies.contains("unbiased"),
            "{}",
            result.certifies
        );
    }
}

/// Everybody leaves at each full second: only a delay that keeps what is left of it makes seconds out of the time.
const BINS: &str = "horizon = 5 s
process bin {
  var n: 0 .. 9 = 0
  when n < 9 at 1 /s -> n = n + 1
  when n < 9 after 1 s -> n = 0
}
";

#[test]
fn delays_keep_what_is_left_of_them() {
    let below = |k: i32| {
        let mut term = f64::exp(-1.0);
        (0..k).fold(0.0, |sum, j| {
            let so_far = sum + term;
            term /= f64::from(j + 1);
            so_far
        })
    };
    let exact = 1.0 - below(8).powi(5);
    assert!((exact / 5.1e-5 - 1.0).abs() < 0.01, "{exact}");
    let query =
        "estimate P(F<=5 s (bin.n >= 8)) by splitting(replicas = 200, kill = 60, runs = 30, plain = 1000)";
    near(&result(BINS, query, 2).1, exact);
}

#[test]
fn a_level_that_rises_while_a_state_lasts_is_fair_too() {
    // Six or more for half a second: the window ends between jumps.
    let model = BINS.replace("when n < 9 after 1 s -> n = 0", "when n > 0 at 1 /s * n -> n = n - 1");
    let formula = "F<=4 s G<=0.5 s (bin.n >= 5)";
    let plain = format!("estimate P({formula}) by fixed(trials = 40000)");
    let run = answered(&compiled(&model, &plain).unwrap(), 9, 2);
    let (share, trials) = (run.results[0].estimate.unwrap(), 40_000.0);
    let query =
        format!("estimate P({formula}) by splitting(replicas = 200, kill = 60, runs = 40, plain = 1000)");
    let rare = result(&model, &query, 3).1;
    let error = (rare.deviation * rare.deviation / rare.runs as f64 + share * (1.0 - share) / trials).sqrt();
    let found = rare.estimate.unwrap();
    assert!((found - share).abs() < 4.0 * error, "{found} {share} +- {error}");
    assert!(error < 0.2 * share, "{error} of {share}");
    assert!(rare.levels > 2.0, "there are levels: {}", rare.levels);
}

#[test]
fn threads_change_no_byte() {
    let query =
        "estimate P(F<=30 s (counters.waiting >= 6)) by splitting(replicas = 50, runs = 4, plain = 200)";
    let study = compiled(OVERFLOW, query).unwrap();
    let one = answered(&study, 1, 1).results[0].rare.unwrap();
    for threads in [2, 5] {
        assert_eq!(answered(&study, 1, threads).results[0].rare.unwrap(), one);
    }
    assert_ne!(answered(&study, 2, 1).results[0].rare.unwrap(), one);
}
