//! Share of a trial's time that is spent in watching it: reading atoms and signals, and the monitors.
//!
//! `cargo bench --bench share`, or with words of what is wanted (`-- corridor`, `-- contacts`). The corridor with all its properties, and with each of its columns alone, eight trials at
//! once; then one trial of a large crowd, of whom everybody is asked in each state. One core; best of several rounds; what
//! reading the clock itself takes is taken off.

#![allow(
    missing_docs,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a bench reads the clock and prints"
)]

use smc::base::lanes::{LANES, Mask};
use smc::base::random::TrialKey;
use smc::compile::{Files, Input, compile};
use smc::engine::PreparedWorld;
use smc::kernel::{Layout, Readings, Scratch, State, dynamics, start};
use smc::logic::Monitor;
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::source::{Source, SourceId};
use std::time::Instant;

/// People who go one way, 0.7 a square metre.
const CROWD: &str = "
scenario \"Crowd\"
horizon = 10 s
step = 0.01 s
kind adult: sfm preset helbing2000 { noise = 0.05 m/s }
scene {
  region all: rect (0, 0) .. (SIDE, SIDE)
  region far: rect (1000, 0) .. (1001, 400)
}
agents z[PEOPLE]: adult { at = uniform in all; route = far }
";

/// What is asked of everybody; none of it ends a trial.
const EVERYBODY: [(&str, &str); 5] = [
    ("speeds", "estimate P(F<=8 s (exists a in z: speed(a) > 10 m/s))"),
    ("contacts of each", "estimate P(F<=8 s (count(a in z: contact(a)) > 1000000))"),
    ("who comes near", "estimate P(F<=8 s (count(a in z: clearance(a) < 0.3 m) > 1000000))"),
    ("least clearance", "estimate P(F<=8 s (min(clearance(a) for a in z) < -10 m))"),
    ("mean clearance", "estimate P(F<=8 s (mean(clearance(a) for a in z) < -10 m))"),
];

fn main() {
    let clock = clock();
    println!("reading the clock takes {:.0} ns", clock * 1e9);
    let (model, asked) =
        (include_str!("../models/corridor.scn"), include_str!("../properties/corridor.bltl"));
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let is_wanted = |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word.as_str()));
    if let Some(corridor) = prepared(model, asked).filter(|_| is_wanted("corridor")) {
        println!("corridor, 18 agents, per step of eight lanes:");
        let all: Vec<usize> = (0..corridor.columns.len()).collect();
        measure(&corridor, &all, (500, 40), clock);
        for &column in &all {
            measure(&corridor, &[column], (500, 40), clock);
        }
    }
    for (people, rounds) in [(2000_u32, 10), (20_000, 3)] {
        let side = (f64::from(people) / 0.7).sqrt();
        let crowd = CROWD.replace("PEOPLE", &people.to_string()).replace("SIDE", &side.to_string());
        println!("{people} people, per step of one trial:");
        for (name, question) in EVERYBODY {
            if let Some(crowd) = prepared(&crowd, question).filter(|_| is_wanted(name)) {
                print!("{name}: ");
                measure(&crowd, &[0], (100, rounds), clock);
            }
        }
    }
}

fn prepared(scenario: &str, properties: &str) -> Option<PreparedWorld> {
    let scenario = Source::new(SourceId(0), "watched.scn", scenario);
    let properties = Source::new(SourceId(1), "watched.bltl", properties);
    let (model, _) = parse_scenario(&scenario);
    let (questions, _) = parse_properties(&properties);
    let sources = [scenario, properties];
    let files = Files::default();
    let input =
        Input { sources: &sources, scenario: &model, properties: &[questions], files: &files, settings: &[] };
    let (study, diagnostics) = compile(&input);
    let Some(study) = study else {
        println!("this does not compile: {diagnostics:?}");
        return None;
    };
    Some(PreparedWorld::new(&study.worlds[0]))
}

/// Seconds that a look at the clock takes: the least of many.
fn clock() -> f64 {
    let looks = (0..1000).map(|_| {
        let begin = Instant::now();
        for _ in 0..100 {
            std::hint::black_box(Instant::now());
        }
        begin.elapsed().as_secs_f64() / 101.0
    });
    looks.fold(f64::INFINITY, f64::min)
}

fn measure(prepared: &PreparedWorld, columns: &[usize], (steps, rounds): (usize, u64), clock: f64) {
    let code = prepared.code(columns);
    let (mut moving, mut watching, mut deciding) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
    for round in 0..rounds {
        let program = &prepared.program;
        let mut state = State::new(program.layout, program.scenario.agents.len());
        let mut scratch = Scratch::default();
        let mut readings = Readings::default();
        let mut monitors: Vec<Monitor> = columns.iter().filter_map(|c| prepared.monitor(*c).ok()).collect();
        let lanes = match program.layout {
            Layout::Trials => LANES,
            Layout::Agents => 1,
        };
        for lane in 0..lanes {
            let key = TrialKey { seed: 1, index: round * LANES as u64 + lane as u64, branch: 0 };
            if start::load(program, &mut state, lane, key, None).is_err() {
                return println!("a trial cannot start");
            }
            for m in &mut monitors {
                m.start(lane);
            }
        }
        dynamics::refresh(program, &mut state, &mut scratch, Mask::ALL);
        let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
        for _ in 0..steps {
            let begin = Instant::now();
            let close = if code.asks_who_is_near() { scratch.close(&state) } else { None };
            code.run_close(program, &state, close, &mut readings);
            let read = Instant::now();
            for monitor in &mut monitors {
                let open = !monitor.decided();
                if !open.is_empty() {
                    monitor.observe(open, &readings.atoms, &readings.signals);
                }
            }
            let decided = Instant::now();
            dynamics::step(program, &mut state, &mut scratch);
            a += begin.elapsed().as_secs_f64() - (decided - begin).as_secs_f64();
            b += (read - begin).as_secs_f64();
            c += (decided - read).as_secs_f64();
        }
        moving = moving.min(a);
        watching = watching.min(b);
        deciding = deciding.min(c);
    }
    let each = |seconds: f64| (seconds / steps as f64 - clock) * 1e9;
    let (moving, watching, deciding) = (each(moving), each(watching), each(deciding));
    let share = 100.0 * (watching + deciding) / (moving + watching + deciding);
    println!(
        "columns {columns:?}: moving {moving:.0} ns, reading {watching:.0} ns, deciding {deciding:.0} ns, \
         share of watching {share:.1} %"
    );
}
