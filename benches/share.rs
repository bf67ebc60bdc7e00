//! Share of a trial's time that is spent in watching it: reading atoms and signals, and the monitors.
//!
//! `cargo bench --bench share`. The corridor with all its properties, and with each of its columns alone; one
//! core; best of several rounds; what reading the clock itself takes is taken off.

#![allow(
    missing_docs,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a bench reads the clock and prints"
)]

use smc::base::lanes::Mask;
use smc::base::random::TrialKey;
use smc::compile::{Files, Input, compile};
use smc::engine::Subject;
use smc::kernel::{Readings, Scratch, State, dynamics, start};
use smc::logic::Monitor;
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::source::{Source, SourceId};
use std::time::Instant;

const STEPS: usize = 500;
const ROUNDS: u64 = 40;

fn main() {
    let scenario = Source::new(SourceId(0), "corridor.scn", include_str!("../models/corridor.scn"));
    let property = Source::new(SourceId(1), "corridor.bltl", include_str!("../properties/corridor.bltl"));
    let (model, _) = parse_scenario(&scenario);
    let (questions, _) = parse_properties(&property);
    let sources = [scenario, property];
    let files = Files::default();
    let input =
        Input { sources: &sources, scenario: &model, properties: &[questions], files: &files, settings: &[] };
    let Some(study) = compile(&input).0 else { return println!("the corridor does not compile") };
    let subject = Subject::new(&study.worlds[0]);
    let all: Vec<usize> = (0..subject.columns.len()).collect();
    let clock = clock();
    println!("per step of eight lanes, 18 agents; reading the clock takes {:.0} ns:", clock * 1e9);
    measure(&subject, &all, clock);
    for &column in &all {
        measure(&subject, &[column], clock);
    }
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

fn measure(subject: &Subject, columns: &[usize], clock: f64) {
    let code = subject.code(columns);
    let (mut moving, mut watching, mut deciding) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
    for round in 0..ROUNDS {
        let program = &subject.program;
        let mut state = State::new(program.layout, program.scenario.agents.len());
        let mut scratch = Scratch::new();
        let mut readings = Readings::default();
        let mut monitors: Vec<Monitor> = columns.iter().filter_map(|c| subject.monitor(*c).ok()).collect();
        for lane in 0..8 {
            let key = TrialKey { seed: 1, index: round * 8 + lane as u64, branch: 0 };
            if start::load(program, &mut state, lane, key, None).is_err() {
                return println!("a trial cannot start");
            }
            for m in &mut monitors {
                m.start(lane);
            }
        }
        dynamics::refresh(program, &mut state, &mut scratch, Mask::ALL);
        let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
        for _ in 0..STEPS {
            let begin = Instant::now();
            code.run(program, &state, &mut readings);
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
    let each = |seconds: f64| (seconds / STEPS as f64 - clock) * 1e9;
    let (moving, watching, deciding) = (each(moving), each(watching), each(deciding));
    let share = 100.0 * (watching + deciding) / (moving + watching + deciding);
    println!(
        "columns {columns:?}: moving {moving:.0} ns, reading {watching:.0} ns, deciding {deciding:.0} ns, \
         share of watching {share:.1} %"
    );
}
