//! Processes in continuous time against exact answers: uniformisation and a slow reference, written here, that
//! share nothing with the program.

#![allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]

mod chain;
mod errors;
mod exact;
mod random;
mod rows;
mod traces;

use smc::compile::{Files, Input, Study, compile};
use smc::engine::outcome::Run;
use smc::engine::{Budget, Call, Nobody, Threads};
use smc::syntax::diagnostic::Severity;
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};

/// Compiles two texts; the study, or the errors as rendered.
pub(crate) fn compiled(scenario: &str, properties: &str) -> Result<Study, String> {
    let sources =
        [Source::new(SourceId(0), "model.scn", scenario), Source::new(SourceId(1), "prop.bltl", properties)];
    let (scenario, mut diagnostics) = parse_scenario(&sources[0]);
    let (properties, more) = parse_properties(&sources[1]);
    diagnostics.extend(more);
    let input = Input {
        sources: &sources,
        scenario: &scenario,
        properties: &[properties],
        files: &Files::default(),
        settings: &[],
    };
    let (study, found) = compile(&input);
    diagnostics.extend(found);
    study
        .filter(|_| diagnostics.iter().all(|d| d.severity != Severity::Error))
        .ok_or_else(|| render(&diagnostics, &sources, false))
}

/// Runs a study with a seed.
pub(crate) fn answered(study: &Study, seed: u64, threads: usize) -> Run {
    let call = Call {
        seed,
        command: String::new(),
        simulate: String::new(),
        only: Vec::new(),
        place: &|_| (String::new(), 0),
        file: String::new(),
    };
    let budget = Budget::new(1_000_000, None);
    smc::engine::run(study, &call, &Threads::new(Some(threads)).unwrap(), &budget, &Nobody).unwrap()
}

/// So many of a number of trials fulfil a formula.
pub(crate) fn count(scenario: &str, formula: &str, trials: u64) -> u64 {
    let query = format!("estimate P({formula}) by fixed(trials = {trials})");
    let study = compiled(scenario, &query).unwrap_or_else(|error| panic!("{error}"));
    let run = answered(&study, 5, 1);
    assert_eq!(run.failure, None, "{formula}");
    let counts = run.results[0].counts;
    assert_eq!((counts.trials, counts.unresolved), (trials, 0), "{formula}");
    counts.successes
}

/// Whether a share of trials fits a probability: five standard deviations and a bit.
pub(crate) fn fits(successes: u64, trials: u64, p: f64) -> bool {
    let n = trials as f64;
    (successes as f64 - n * p).abs() <= 5.0 * (n * p * (1.0 - p)).sqrt() + 1e-9 * n
}
