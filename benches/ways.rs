//! Ways in a building of 500 walls: what the network of shortest ways costs once, what one look-up costs, and what finding
//! ways adds to a step of ten thousand agents. `cargo bench --bench ways`; `-- straight`: the last without ways alone.

#![allow(clippy::disallowed_methods, reason = "this measures time")]

use smc::base::geometry::Vec2;
use smc::base::random::{Purpose, Stream, TrialKey};
use smc::kernel::driver::Drivers;
use smc::kernel::{Program, Run};
use smc::model::{Goal, RegionId};
use smc::route::{Atlas, Ways};
use smc::{Draft, Model};
use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Instant;

/// Rooms of 10 m by 10 m in rows along corridors of 4 m, each room with a door of 1.2 m; both ends of the corridors are open,
/// and a passage leads along both sides.
fn building(rows: usize, columns: usize) -> (String, usize) {
    let mut walls = String::new();
    let mut count = 0;
    let mut wall = |a: (f64, f64), b: (f64, f64)| {
        let _ = writeln!(walls, "; wall ({}, {}) -- ({}, {})", a.0, a.1, b.0, b.1);
        count += 1;
    };
    for row in 0..rows {
        let y = row as f64 * 14.0;
        let width = columns as f64 * 10.0;
        wall((0.0, y), (width, y));
        for column in 0..=columns {
            wall((column as f64 * 10.0, y), (column as f64 * 10.0, y + 10.0));
        }
        for column in 0..columns {
            let x = column as f64 * 10.0;
            wall((x, y + 10.0), (x + 4.4, y + 10.0));
            wall((x + 5.6, y + 10.0), (x + 10.0, y + 10.0));
        }
    }
    (walls, count)
}

fn model(agents: usize, wayfinding: &str) -> (Model, usize) {
    let (rows, columns) = (10, 16);
    let (walls, count) = building(rows, columns);
    let text = format!(
        "horizon = 60 s\nstep = 0.04 s\nscene {{\n{walls}; region exit: rect (-9, 60) .. (-4, 80)\n
        region all: rect (0, 0) .. (160, 140) }}
        kind person: sfm preset helbing2000 {{ radius = uniform(0.2 m, 0.3 m); noise = 0.05 m/s {wayfinding} }}
        agents people[{agents}]: person {{ at = uniform in all; route = exit }}"
    );
    (Draft::new("building.scn", text).parse().unwrap_or_else(|errors| panic!("{errors}")), count)
}

/// Million agent-steps per second over some seconds of a trial, from its start, and once more without the start.
fn rate(model: &Model, drivers: Drivers, agents: usize, steps: usize) -> f64 {
    let program = Program::driven(model.scenario().clone(), drivers);
    let key = TrialKey { seed: 1, index: 0, branch: 0 };
    let (mut run, _) = Run::of(&program, key.into()).unwrap_or_else(|_| panic!("no start"));
    let started = Instant::now();
    for _ in 0..steps {
        let _ = run.next_state();
    }
    (agents * steps) as f64 / started.elapsed().as_secs_f64() / 1e6
}

fn main() {
    let mut out = std::io::stdout().lock();
    if std::env::args().any(|word| word == "straight") {
        let (straight, _) = model(10_000, "; wayfinding = straight");
        for _ in 0..3 {
            let rate = rate(&straight, Drivers::new(1), 10_000, 250);
            let _ = writeln!(out, "10000 agents going straight: {rate:.2} M agent-steps/s");
        }
        return;
    }
    let (found, walls) = model(10, "");
    let scene = found.scenario().scene.clone();
    let goal = Goal::Region(RegionId(0));
    let started = Instant::now();
    let atlas = Atlas::new(scene);
    let first = atlas.way(Vec2::new(155.0, 135.0), &goal, 0.3).map_or(f64::NAN, |way| way.length);
    let once = started.elapsed().as_secs_f64() * 1e3;
    let _ = writeln!(out, "{walls} walls: network and field of a goal {once:.0} ms, a way of {first:.1} m");
    let stream = Stream::of(TrialKey { seed: 1, index: 0, branch: 0 }, 1, Purpose::Placement);
    let place = |k: u32| Vec2::new(160.0 * stream.uniform(2 * k), 140.0 * stream.uniform(2 * k + 1));
    let places: Vec<Vec2> = (0..20_000).map(place).collect();
    for round in ["first", "second"] {
        let started = Instant::now();
        let found = places.iter().filter(|p| atlas.way(**p, &goal, 0.3).is_some()).count();
        let each = started.elapsed().as_secs_f64() * 1e6 / places.len() as f64;
        let _ = writeln!(
            out,
            "look-ups, {round} time: {each:.2} us each, {found} of {} with a way",
            places.len()
        );
    }
    let agents = 10_000;
    let (finding, _) = model(agents, "");
    let (straight, _) = model(agents, "; wayfinding = straight");
    // The lists of corners in sight are made as agents first come by, once a run: the first trial pays for them.
    let ways = Ways::default();
    for trial in ["first", "second", "third"] {
        let with = rate(&finding, ways.drivers(finding.scenario(), 1), agents, 250);
        let without = rate(&straight, Drivers::new(1), agents, 250);
        let _ = writeln!(
            out,
            "{agents} agents, {trial} trial: {with:.2} M agent-steps/s finding ways, {without:.2} straight"
        );
    }
}
