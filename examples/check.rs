//! Checks a scenario against a property file, and reads the results.
//!
//! `cargo run --example check`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program prints")]

use smc::engine::outcome::Certified;
use smc::{Diagnostics, Model, Options};

fn main() -> Result<(), Diagnostics> {
    let model = Model::parse(include_str!("../models/corridor.scn"))?;
    let queries = include_str!("../properties/corridor.bltl");
    let report = model.check(queries, &Options::default().seed(1).max_trials(200))?;
    for result in report.results() {
        let name = result.asked.name.as_deref().unwrap_or(&result.asked.text);
        let verdict = result.verdict.map_or("-", |verdict| verdict.name());
        println!(
            "{name:<14} {:<8} {verdict:<10} {:>5} trials",
            result.asked.kind.name(),
            result.consumed.counts.trials
        );
        if let Some(certificate) = &result.certificate {
            let claim = match &certificate.claim {
                Certified::Decided(claim) => format!("{claim:?}"),
                Certified::Between { low, high } => format!("between {low:.4} and {high:.4} {}", result.unit),
                Certified::Best { choice, gap } => {
                    format!("{choice} is at most {gap:.4} worse than the best")
                }
                Certified::Nothing => "no option satisfies the constraints".to_owned(),
                Certified::Front { options } => format!("none dominates {}", options.join(", ")),
            };
            println!("    {claim}, error at most {}", certificate.error);
        }
        for witness in &result.witnesses {
            println!("    trial {} {}: {}", witness.trial, witness.shows.name(), witness.what);
        }
    }
    Ok(())
}
