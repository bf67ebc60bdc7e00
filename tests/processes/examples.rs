//! The models in the repository and their exact values.

use super::{answered, compiled};

#[test]
fn the_leader_is_elected_as_often_as_it_must_be() {
    let scenario = include_str!("../../models/leader.scn");
    let study = compiled(scenario, include_str!("../../properties/leader.bltl")).unwrap();
    let run = answered(&study, 0, 2);
    for (result, exact) in run.results.iter().zip([42.0 / 64.0, 1.0 - (22.0f64 / 64.0).powi(4)]) {
        assert!(result.low <= exact && exact <= result.high, "{}", result.asked.text);
    }
    assert_eq!(run.results[2].verdict, Some(smc::engine::outcome::Verdict::Satisfied));
}

#[test]
fn the_crowd_hands_messages_on() {
    let scenario = include_str!("../../models/crowds.scn");
    let study = compiled(scenario, include_str!("../../properties/crowds.bltl")).unwrap();
    let run = answered(&study, 0, 2);
    assert_eq!((run.failure, run.results.len()), (None, 3));
}

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
                result.asked.text,
                result.low,
                result.high
            );
        }
        assert!(run.results[3..].iter().all(|r| r.verdict == Some(smc::engine::outcome::Verdict::Satisfied)));
        runs.push(run);
    }
    for (a, b) in runs[0].results.iter().zip(&runs[1].results) {
        assert_eq!(
            (a.estimate, a.low, a.high, a.consumed.counts, a.consumed.steps),
            (b.estimate, b.low, b.high, b.consumed.counts, b.consumed.steps)
        );
    }
}
