//! Runs: the next state of a trial, and why there is none.

use crate::texts::compiled;
use smc::base::random::TrialKey;
use smc::base::tick::Tick;
use smc::kernel::process::Fault;
use smc::kernel::{Address, End, Program, Run};

fn program(text: &str) -> Program {
    let study = compiled(text, "").unwrap_or_else(|errors| panic!("{errors}"));
    Program::new(study.worlds[0].scenario.clone())
}

fn key(index: u64) -> TrialKey {
    TrialKey { seed: 4, index, branch: 0 }
}

/// How many states come after the first one, and why no more do.
fn end(text: &str, trial: u64) -> (usize, End) {
    let program = program(text);
    let (mut run, _) = Run::of(&program, key(trial).into()).unwrap();
    let mut states = 0;
    loop {
        match run.next_state() {
            Ok(_) => states += 1,
            Err(end) => {
                assert_eq!(run.next_state().map(|_| ()), Err(end), "a trial that has ended stays so");
                return (states, end);
            }
        }
    }
}

#[test]
fn a_trial_ends_for_one_reason() {
    let steps = "scenario \"t\"\nhorizon = 9 steps\nprocess p { var n: 0 .. 4 = 0\n var r: real = 0\n when true -> { n = n + 1; r = r + 1 } }\n";
    // The step in which a variable leaves its range leads to no state.
    assert_eq!(end(steps, 0), (4, End::Faulty(Fault::Range { variable: 0, value: 5.0 })));
    assert_eq!(end(&steps.replace("when true", "when n < 4"), 0), (9, End::Horizon));
    let jumps = "scenario \"t\"\nhorizon = 9 s\nprocess p { var n: 0 .. 4 = 0\n var r: real = 0\n when true after 1 s -> { n = n + 1; r = r + 1 } }\n";
    assert_eq!(end(jumps, 0), (4, End::Faulty(Fault::Range { variable: 0, value: 5.0 })));
    assert_eq!(end(&jumps.replace("when true", "when n < 4"), 0), (4, End::Horizon));
    let door = "scenario \"t\"\nhorizon = 9 s\nstep = 0.05 s\nkind person: sfm preset helbing2000 { noise = 0 m/s }\n\
                source door: person { at = (0, 0); velocity = (1, 0) m/s; every = 2 s; limit = 2; route = (50, 0) }\n";
    assert!(matches!(end(door, 0), (60..=160, End::Full)), "{:?}", end(door, 0));
    let busy = "scenario \"t\"\nhorizon = 9 s\nstep = 1 s\nprocess p { var on = false\n when true at 100000000 /s -> on = !on }\n";
    assert_eq!(end(busy, 0), (1, End::Diverged));
}

#[test]
fn a_trial_continues_from_each_of_its_states() {
    let people = include_str!("small.scn");
    let queue = "scenario \"t\"\nhorizon = 20 s\nprocess q { var n: 0 .. 3 = 0\n when n < 3 at 2 /s -> n = n + 1\n\
                 when n > 0 after uniform(0.1 s, 1 s) -> n = n - 1 }\n";
    for text in [people, queue] {
        let program = program(text);
        let (mut run, _) = Run::of(&program, key(3).into()).unwrap();
        let mut states = vec![run.state().clone()];
        while states.len() < 25
            && let Ok(state) = run.next_state()
        {
            states.push(state.clone());
        }
        assert!(states.len() > 10);
        for from in [0, 7] {
            let mut run = Run::from_state(&program, states[from].clone());
            for later in &states[from + 1..] {
                assert!(run.next_state().unwrap() == later);
            }
        }
    }
}

#[test]
fn a_path_is_its_trial_up_to_where_the_key_changes() {
    let coin = "scenario \"t\"\nhorizon = 60 steps\nprocess p { var n = 0\n when true -> 1/2: n = n + 1 | 1/2: n = n - 1 }\n";
    let queue = "scenario \"t\"\nhorizon = 60 s\nprocess p { var n: 0 .. 50 = 25\n when n < 50 at 1 /s -> n = n + 1\n\
                 when n > 0 at 1 /s -> n = n - 1 }\n";
    for (text, from) in [(coin, 20), (queue, 20f64.to_bits())] {
        let program = program(text);
        let states = |address: Address<'_>| {
            let (mut run, _) = Run::of(&program, address).unwrap();
            let mut seen = Vec::new();
            while let Ok(state) = run.next_state() {
                let time = if text == queue { state.clocks.now[0] } else { state.ticks[0] as f64 };
                seen.push((time, state.variables[0].0[0]));
            }
            seen
        };
        let plain = states(key(0).into());
        let path = states(Address { changes: &[(from, key(1))], ..key(0).into() });
        let same = plain.iter().zip(&path).take_while(|(a, b)| a == b).last().unwrap();
        assert!(same.0.0 <= 24.0, "the key has changed: {same:?}");
        let before =
            |seen: &[(f64, f64)]| seen.iter().copied().filter(|(time, _)| *time <= 20.0).collect::<Vec<_>>();
        assert!(before(&plain) == before(&path) && plain != path);
        // Changes at the horizon or later never come.
        let last = if text == queue { 60f64.to_bits() } else { 60 };
        assert_eq!(states(Address { changes: &[(last, key(1))], ..key(0).into() }), plain);
    }
}

#[test]
fn an_earlier_horizon_ends_a_trial_there() {
    let queue = "scenario \"t\"\nhorizon = 60 s\nprocess p { var n = 0\n when true at 3 /s -> n = n + 1 }\n";
    let program = program(queue);
    let clock = program.scenario.clock;
    let half = Tick(program.scenario.horizon.0 / 2);
    let mut run = Run::new(&program).until(half);
    run.start(key(0).into()).unwrap();
    let mut last = 0.0;
    while let Ok(state) = run.next_state() {
        last = state.clocks.now[0];
    }
    assert!(last > 25.0 && last <= clock.seconds(half));
}
