//! The models in the repository and their exact values.

use crate::{answered, compiled};

#[test]
fn the_die_has_its_exact_values() {
    let study =
        compiled(include_str!("../../models/die.scn"), include_str!("../../properties/die.bltl")).unwrap();
    let exact = [5.0 / 32.0, 7.0 / 8.0, 3.0 / 16.0];
    let mut runs = Vec::new();
    for threads in [1, 3] {
        let run = answered(&study, 0, threads);
        assert_eq!(run.failure, None);
        for (result, exact) in run.results.iter().zip(exact) {
            assert!(
                result.low <= exact && exact <= result.high,
                "{}: {} .. {}",
                result.query,
                result.low,
                result.high
            );
        }
        assert!(run.results[3..].iter().all(|r| r.verdict == Some(smc::engine::outcome::Verdict::Satisfied)));
        runs.push(run);
    }
    for (a, b) in runs[0].results.iter().zip(&runs[1].results) {
        assert_eq!(
            (a.estimate, a.low, a.high, a.counts, a.steps),
            (b.estimate, b.low, b.high, b.counts, b.steps)
        );
    }
}
