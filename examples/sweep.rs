//! Estimates a probability at several values of a parameter, and writes a table for a plot.
//!
//! `cargo run --example sweep > table.csv`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program prints")]

use smc::{Diagnostics, Model, Options};

const SCENARIO: &str = "
    horizon = 20 s
    step = 0.025 s
    param width = 1.2 m
    scene {
      wall west: (0, -3) -- (0, -0.5 * width)
      wall east: (0, 0.5 * width) -- (0, 3)
      region beyond: rect (1, -3) .. (6, 3)
    }
    kind adult: sfm preset helbing2000
    agents crowd[8]: adult { at = uniform in rect (-5, -2) .. (-1, 2); route = (0.4, 0) -> (4, 0) }
";

const QUERIES: &str = "
    property passed = F<=12 s (forall a in crowd: a in beyond)
    estimate P(passed) within 0.1 confidence 95 %
";

fn main() -> Result<(), Diagnostics> {
    let model = Model::parse(SCENARIO)?;
    println!("width,estimate,low,high,trials");
    for width in ["0.8 m", "1.2 m", "1.6 m"] {
        let report = model.with("width", width)?.check(QUERIES, &Options::default())?;
        for result in report.results() {
            let estimate = result.estimate.map_or(String::new(), |estimate| format!("{estimate:.4}"));
            let trials = result.consumed.counts.trials;
            println!("{width},{estimate},{:.4},{:.4},{trials}", result.low, result.high);
        }
    }
    Ok(())
}
