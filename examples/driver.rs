//! An agent with a driver of its own: it waits before a crossing until nobody is near, and then goes on.
//!
//! `cargo run --example driver`
#![allow(clippy::print_stdout, reason = "a program prints")]

use smc::kernel::driver::{Driver, Drivers, Memory, Occasion, Plan, Situation};
use smc::{Diagnostics, Model, Options};
use std::sync::Arc;

const SCENARIO: &str = "
    horizon = 30 s
    step = 0.05 s
    kind adult: sfm preset helbing2000
    kind slow: adult { speed = 1 m/s }
    agent robot: adult { at = (-6, 0); route = (-2, 0) -> (6, 0) }
    agents crowd[6]: slow { at = uniform in rect (-1, -12) .. (1, -4); route = (0, 15) }
";

/// Stands at the end of the first leg while anybody is within 2.5 m of the crossing.
#[derive(Debug)]
struct Careful;

impl Driver for Careful {
    fn plan(&self, situation: &Situation<'_>, _: &mut Memory) -> Plan {
        let is_waiting = matches!(situation.plan, Plan::Stand(_));
        if situation.occasion != Occasion::Leg && !is_waiting {
            return Plan::Straight;
        }
        let near = |distance: f64| situation.others().any(|other| other.position.norm() < distance);
        // Asked again after 0.2 s.
        if near(2.5) { Plan::Stand(0.2) } else { Plan::Straight }
    }
}

fn main() -> Result<(), Diagnostics> {
    let plain = Model::parse(SCENARIO)?;
    let careful = plain.clone().driven(|scenario, seed| {
        let named = scenario.agents.iter().position(|agent| agent.name == "robot");
        let robot = named.map(|index| smc::model::AgentId(index as u32));
        Drivers::new(seed).with(robot, Arc::new(Careful))
    });
    let query = "check P(G<=30 s (clearance(robot) > 0.3 m)) >= 0.8";
    for (name, model) in [("straight", plain), ("careful", careful)] {
        let report = model.check(query, &Options::default().max_trials(2_000))?;
        let result = &report.results()[0];
        println!(
            "{name:<9} {:<10} {}",
            result.verdict.map_or("-", |verdict| verdict.name()),
            result.certifies
        );
    }
    Ok(())
}
