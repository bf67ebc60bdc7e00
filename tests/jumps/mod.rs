//! Processes in continuous time against exact answers: uniformisation and a slow reference, written here, that
//! share nothing with the program.

mod chain;
mod delays;
mod errors;
mod exact;
mod means;
mod random;
mod rare;
mod robust;
mod rows;
mod traces;

pub(crate) use crate::texts::compiled;
use smc::compile::Study;
use smc::engine::outcome::CallResult;

/// Runs a study with a seed.
pub(crate) fn answered(study: &Study, seed: u64, threads: usize) -> CallResult {
    crate::texts::answered(study, seed, threads, 1_000_000)
}

/// So many of a number of trials fulfil a formula.
pub(crate) fn count(scenario: &str, formula: &str, trials: u64) -> u64 {
    let query = format!("estimate P({formula}) by fixed(trials = {trials})");
    let study = compiled(scenario, &query).unwrap_or_else(|error| panic!("{error}"));
    let run = answered(&study, 5, 1);
    assert_eq!(run.failure, None, "{formula}");
    let counts = run.results[0].consumed.counts;
    assert_eq!((counts.trials, counts.unresolved), (trials, 0), "{formula}");
    counts.successes
}

/// Whether a share of trials fits a probability: five standard deviations and a bit.
pub(crate) fn fits(successes: u64, trials: u64, p: f64) -> bool {
    let n = trials as f64;
    (successes as f64 - n * p).abs() <= 5.0 * (n * p * (1.0 - p)).max(0.0).sqrt() + 1e-9 * n
}
