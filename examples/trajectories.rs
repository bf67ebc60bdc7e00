//! Writes the trajectories of a trial that shows why a property fails.
//!
//! `cargo run --example trajectories > trial.csv`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program prints")]

use smc::engine::outcome::Shows;
use smc::{Diagnostics, Model, Options};

const SCENARIO: &str = "
    horizon = 10 s
    step = 0.02 s
    kind adult: sfm preset helbing2000 { noise = 0.2 m/s }
    agent user: adult { at = (0, 0); route = (8, 0) }
    agents oncoming[3]: adult { at = uniform in rect (6, -1) .. (9, 1); route = (-2, 0) }
";

fn main() -> Result<(), Diagnostics> {
    let model = Model::parse(SCENARIO)?;
    let seed = 3;
    let options = Options::default().seed(seed).max_trials(400);
    let report = model.check("estimate P(G<=10 s (!contact(user)))", &options)?;
    let mut witnesses = report.results().iter().flat_map(|result| &result.witnesses);
    let Some(witness) = witnesses.find(|witness| witness.shows == Shows::Fails) else {
        println!("nobody touched the user in any trial");
        return Ok(());
    };
    eprintln!("trial {} at {} {}: {}", witness.trial, witness.time, witness.unit, witness.what);
    println!("t,agent,x,y,vx,vy");
    for snapshot in model.trial(seed, witness.trial)?.step_by(10) {
        for agent in &snapshot.agents {
            let (at, v) = (agent.position, agent.velocity);
            println!("{:.2},{},{:.4},{:.4},{:.4},{:.4}", snapshot.time, agent.name, at.x, at.y, v.x, v.y);
        }
    }
    Ok(())
}
