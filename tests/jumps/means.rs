//! Means: jumps of a process that the number does not read change no outcome, and a mean lies between the values that it
//! averages.

use super::random::{rates, scenario};
use super::{answered, compiled, count, fits};
use proptest::prelude::*;

/// Means from the start, in windows that move, compared with decimals and with what the number may never leave.
const QUERIES: &str = "\
estimate P(mean<=2.5 s (0.1 * c.s) >= 0.1) by fixed(trials = 60)
estimate P(mean<=2 s (c.s) >= 3) by fixed(trials = 60)
estimate P(mean<=2 s (c.s / 3) <= 0) by fixed(trials = 60)
estimate P(G<=2 s (mean<=1 s (0.1 * c.s) <= 0.2)) by fixed(trials = 60)
estimate P(F<=1.5 s (mean[0.5 s, 2 s] (0.7 * c.s) > 0.3)) by fixed(trials = 60)
estimate P((mean<=1 s (c.s) < 1.3) U<=2 s (mean<=2 s (0.3 * c.s) >= 0.7)) by fixed(trials = 60)
estimate E(mean<=3 s (0.1 * c.s)) in 0 .. 0.3 by fixed(trials = 60)
estimate Q(0.5, mean[1 s, 3 s] (c.s / 7)) by fixed(trials = 60)
estimate E(max<=3 s (0.1 * c.s) - mean<=3 s (0.1 * c.s)) in 0 .. 0.3 by fixed(trials = 60)
";

/// What was found, to the last bit.
fn found(scenario: &str, seed: u64) -> Vec<String> {
    let study = compiled(scenario, QUERIES).unwrap_or_else(|error| panic!("{error}"));
    let run = answered(&study, seed, 1);
    let result = |r: &smc::engine::outcome::QueryResult| {
        let bits = [r.low, r.high].map(f64::to_bits);
        format!("{:?} {:?} {bits:?} {}", r.consumed.counts, r.estimate.map(f64::to_bits), r.consumed.clipped)
    };
    run.results.iter().map(result).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn another_process_changes_no_outcome(rates in rates(), seed in 0u64..1_000_000, fast in 1u32..40) {
        let alone = scenario(&rates);
        let clock = format!("process d {{ var n: 0 .. 1 = 0\nwhen true at {fast} /s -> n = 1 - n }}\n");
        prop_assert_eq!(found(&alone, seed), found(&(alone.clone() + &clock), seed), "{}", alone);
        // Seen at the steps of a clock.
        let step = |text: &str| text.replacen('\n', "\nstep = 0.1 s\n", 1);
        let more = step(&alone) + &clock;
        prop_assert_eq!(found(&step(&alone), seed), found(&more, seed), "{}", alone);
    }
}

#[test]
fn a_mean_of_equal_values_is_that_value_whatever_else_jumps() {
    const TRIALS: u64 = 2000;
    let scenario = "horizon = 10 s
process sensor[3] { var works = true
  when works at 0.01 /s -> works = false }
process clock { var n: 0 .. 1 = 0
  when true at 1 /s -> n = 1 - n }
";
    let works = "count(x in sensor: x.works) >= 3";
    let held = count(scenario, &format!("G<=10 s ({works})"), TRIALS);
    assert!(fits(held, TRIALS, f64::exp(-0.3)), "{held}");
    for mean in [
        "mean<=10 s (count(x in sensor: x.works)) >= 3",
        "mean<=10 s (0.1 * count(x in sensor: x.works)) >= 0.1 * 3",
    ] {
        assert_eq!(count(scenario, mean, TRIALS), held, "{mean}");
        assert_eq!(count(scenario, &format!("G<=0 s ({mean})"), TRIALS), held, "{mean}");
    }
}

#[test]
fn a_mean_in_steps_lies_between_its_values() {
    let scenario =
        "horizon = 12 steps\nprocess w { var x: 0 .. 1 = 0\nwhen x < 1 -> 0.5: x = 1 | 0.5: x = x }\n";
    for formula in [
        "mean<=9 (w.x - w.x + 0.1) == 0.1",
        "G<=2 (mean<=9 (w.x - w.x + 0.1) == 0.1)",
        "G<=2 (mean<=9 (min(w.x + 0.1, 0.1)) >= 0.1)",
        "mean<=9 (0.7 + 0 * w.x) <= 0.7",
    ] {
        assert_eq!(count(scenario, formula, 20), 20, "{formula}");
    }
    let clipped =
        compiled(scenario, "estimate E(mean<=9 (0.1 + 0 * w.x)) in 0.1 .. 0.2 by fixed(trials = 20)");
    assert_eq!(answered(&clipped.unwrap(), 1, 1).results[0].consumed.clipped, 0);
}
