//! Processes against exact answers: chains are enumerated here, path by path or state by state, by code that
//! shares nothing with the program.

mod chains;
mod errors;
mod examples;
mod rows;
mod tallies;

pub(crate) use crate::texts::compiled;
use smc::base::lanes::{LANES, Mask};
use smc::base::random::TrialKey;
use smc::compile::Study;
use smc::compile::study::World;
use smc::engine::PreparedWorld;
use smc::engine::outcome::CallResult;
use smc::kernel::{Readings, Scratch, State, dynamics, start};

/// Runs a study with a seed.
pub(crate) fn answered(study: &Study, seed: u64, threads: usize) -> CallResult {
    crate::texts::answered(study, seed, threads, 1_000_000)
}

/// What trials show: the values of all variables at each tick, and the verdict of each column.
pub(crate) struct Shown {
    pub(crate) traces: Vec<Vec<f64>>,
    pub(crate) verdicts: Vec<bool>,
}

/// Runs trials to the horizon, with monitors of all columns.
pub(crate) fn shown(world: &World, seed: u64, trials: u64) -> Vec<Shown> {
    let prepared = PreparedWorld::new(world);
    let columns: Vec<usize> = (0..world.columns.len()).collect();
    let code = prepared.code(&columns);
    let mut out = Vec::new();
    let mut monitors: Vec<_> = columns.iter().map(|&c| prepared.monitor(c).unwrap()).collect();
    for first in (0..trials).step_by(LANES) {
        let mut state = State::new(prepared.program.layout, 0);
        let (mut scratch, mut readings) = (Scratch::default(), Readings::default());
        for lane in 0..LANES {
            let key = TrialKey { seed, index: first + lane as u64, branch: 0 };
            start::load(&prepared.program, &mut state, lane, key, None).unwrap();
            for monitor in &mut monitors {
                monitor.start(lane);
            }
        }
        let mut traces = vec![Vec::new(); LANES];
        for tick in 0..=prepared.horizon.0 {
            if tick > 0 {
                dynamics::step(&prepared.program, &mut state, &mut scratch);
            }
            assert!(state.faulty.is_empty());
            code.run(&prepared.program, &state, &mut readings);
            for monitor in &mut monitors {
                monitor.observe(Mask::ALL, &readings.atoms, &readings.signals);
            }
            for (lane, trace) in traces.iter_mut().enumerate() {
                trace.push(state.variables.iter().map(|lanes| lanes.0[lane]).collect());
            }
        }
        for (lane, traces) in traces.into_iter().enumerate() {
            let verdict = |monitor: &smc::logic::Monitor| {
                assert!(monitor.decided().has(lane));
                monitor.truth().has(lane)
            };
            out.push(Shown { traces, verdicts: monitors.iter().map(verdict).collect() });
        }
    }
    out
}

/// Whether a share of trials fits a probability: five and a half standard deviations and a bit.
pub(crate) fn fits(successes: usize, trials: usize, p: f64) -> bool {
    let n = trials as f64;
    (successes as f64 - n * p).abs() <= 5.5 * (n * p * (1.0 - p)).sqrt() + 1e-9 * n
}
