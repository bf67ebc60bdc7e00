//! Traces of processes in continuous time: what must not change them, to the last bit.

use super::{answered, compiled};
use smc::base::lanes::LANES;
use smc::base::random::TrialKey;
use smc::kernel::process::Processes;
use smc::kernel::{Program, Scratch, State, dynamics, start};

/// Jumps up to the horizon.
const NEVER: [f64; LANES] = [f64::INFINITY; LANES];

/// Time and variables of every state of a trial, up to the horizon.
pub(crate) fn trace(program: &Program, seed: u64, index: u64) -> Vec<(f64, Vec<f64>)> {
    let (mut state, mut scratch) = (State::new(program.layout, 0), Scratch::default());
    start::load(program, &mut state, 0, TrialKey { seed, index, branch: 0 }, None).unwrap();
    let mut states = Vec::new();
    loop {
        states.push((state.clocks.now[0], state.variables.iter().map(|v| v.0[0]).collect()));
        if dynamics::jump_until(program, &mut state, &mut scratch, &NEVER).is_empty() {
            return states;
        }
        assert!(state.faulty.is_empty());
    }
}

pub(crate) fn program(scenario: &str) -> Program {
    Program::new(compiled(scenario, "").unwrap_or_else(|e| panic!("{e}")).worlds[0].scenario.clone())
}

/// The changes of the variables whose names begin so.
fn of(program: &Program, states: &[(f64, Vec<f64>)], name: &str) -> Vec<(u64, Vec<f64>)> {
    let names = &program.scenario.processes.variables;
    let mut out: Vec<(u64, Vec<f64>)> = Vec::new();
    for (time, values) in states {
        let own: Vec<f64> =
            names.iter().zip(values).filter(|(v, _)| v.name.starts_with(name)).map(|(_, x)| *x).collect();
        if out.last().is_none_or(|last| last.1 != own) {
            out.push((time.to_bits(), own));
        }
    }
    out
}

const MIXED: &str = "horizon = 30 s
process queue {
  var n: 0 .. 5 = 0
  when n < 5 at 1 /s                     -> n = n + 1
  when n > 0 at 1.2 /s                   -> 3/4: n = n - 1 | 1/4: n = 0
}
process sensor[3] {
  var up = true
  when up  at 0.3 /s                     -> up = false
  when !up after gamma(1 s, 0.4 s)       -> up = true
}
process watch {
  var k: 0 .. 90 = 0
  var wear = 0
  when k < 90 & queue.n > 2 at 0.5 /s * queue.n       -> { k = k + 1; wear = wear + 0.5 }
  when k < 90 & !sensor[2].up after uniform(0.1 s, 1 s) -> k = k + 1
}
";

#[test]
fn a_process_more_changes_nobody_elses_trace() {
    let plain = program(MIXED);
    let more =
        "process idle { var s = true\n when s at 7 /s -> s = false\n when !s after 0.05 s -> s = true }\n";
    let other =
        "process reader { var m: 0 .. 99 = 0\n when m < 99 & queue.n > 1 at 2 /s * queue.n -> m = m + 1 }\n";
    let before = MIXED.replace("horizon = 30 s\n", &format!("horizon = 30 s\n{more}"));
    let after = format!("{MIXED}{other}{more}");
    for (changed, text) in [("before", before), ("after", after)] {
        let changed_program = program(&text);
        for index in 0..40 {
            let (a, b) = (trace(&plain, 9, index), trace(&changed_program, 9, index));
            for name in ["queue", "sensor", "watch"] {
                assert_eq!(of(&plain, &a, name), of(&changed_program, &b, name), "{changed} {name} {index}");
            }
        }
    }
}

#[test]
fn variants_share_their_random_numbers() {
    // With half the rate every jump comes at twice the time.
    let birth = |rate: &str| {
        program(&format!(
            "horizon = 50 s\nprocess p {{ var n: 0 .. 9 = 0\n when n < 9 at {rate} -> n = n + 1 }}"
        ))
    };
    for index in 0..20 {
        let (slow, fast) = (trace(&birth("0.5 /s"), 1, index), trace(&birth("1 /s"), 1, index));
        for (slow, fast) in slow.iter().zip(&fast) {
            assert!((slow.0 - 2.0 * fast.0).abs() <= 1e-12 * slow.0);
        }
    }
}

#[test]
fn tables_and_code_take_the_same_way_to_the_last_bit() {
    let tables = program(MIXED);
    let mut code = program(MIXED);
    code.processes = Processes::with_tables(&code.scenario, 0);
    let mut plain = program(MIXED);
    plain.processes = plain.processes.at_baseline();
    for index in 0..60 {
        let reference = trace(&tables, 3, index);
        assert!(reference.len() > 10);
        assert_eq!(trace(&code, 3, index), reference, "{index}");
        assert_eq!(trace(&plain, 3, index), reference, "{index}");
    }
}

#[test]
fn a_lane_is_a_trial() {
    let program = program(MIXED);
    let (mut state, mut scratch) = (State::new(program.layout, 0), Scratch::default());
    for lane in 0..8 {
        let key = TrialKey { seed: 3, index: 10 + lane as u64, branch: 0 };
        start::load(&program, &mut state, lane, key, None).unwrap();
    }
    let mut seen: Vec<Vec<(f64, Vec<f64>)>> = vec![Vec::new(); 8];
    let all = |state: &State, lane: usize| {
        (state.clocks.now[lane], state.variables.iter().map(|v| v.0[lane]).collect::<Vec<f64>>())
    };
    for lane in 0..8 {
        seen[lane].push(all(&state, lane));
    }
    loop {
        let jumped = dynamics::jump_until(&program, &mut state, &mut scratch, &NEVER);
        if jumped.is_empty() {
            break;
        }
        for lane in jumped.iter() {
            seen[lane].push(all(&state, lane));
        }
    }
    for (lane, seen) in seen.iter().enumerate() {
        assert_eq!(*seen, trace(&program, 3, 10 + lane as u64), "{lane}");
    }
}

#[test]
fn threads_change_no_byte() {
    let properties = "\
estimate P(F<=20 s (watch.k >= 10 & G<=1 s (queue.n > 0))) within 0.05
estimate E(mean<=30 s (queue.n)) in 0 .. 5
estimate Q(0.5, time_until(!sensor[1].up & !sensor[2].up))
check P(F<=10 s (watch.wear > 4)) >= 0.2
";
    let study = compiled(MIXED, properties).unwrap();
    let runs = [1, 2, 8].map(|threads| {
        let mut run = answered(&study, 4, threads);
        run.elapsed_s = 0.0;
        for result in &mut run.results {
            result.elapsed_s = 0.0;
        }
        run
    });
    assert_eq!(runs[0].failure, None);
    assert_eq!(runs[0], runs[1]);
    assert_eq!(runs[0], runs[2]);
    assert!(
        runs[0].results[0].consumed.counts.successes > 0 && runs[0].results[0].consumed.counts.failures > 0
    );
}

#[test]
fn a_stepped_clock_sees_the_same_jumps() {
    // The states at the steps are those of the trace in continuous time.
    let free = program(MIXED);
    let stepped = program(&MIXED.replace("horizon = 30 s", "horizon = 30 s\nstep = 0.25 s"));
    for index in 0..20 {
        let jumps = trace(&free, 8, index);
        let (mut state, mut scratch) = (State::new(stepped.layout, 0), Scratch::default());
        start::load(&stepped, &mut state, 0, TrialKey { seed: 8, index, branch: 0 }, None).unwrap();
        for tick in 1..=120u64 {
            dynamics::step(&stepped, &mut state, &mut scratch);
            let time = tick as f64 * 0.25;
            let last = jumps.iter().rfind(|(at, _)| *at <= time).unwrap();
            let values: Vec<f64> = state.variables.iter().map(|v| v.0[0]).collect();
            assert_eq!(values, last.1, "trial {index} at {time}");
        }
    }
}
