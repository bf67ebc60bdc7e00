//! Trials as arrays.

use super::attend::{Halt, Ledger, attend};
use super::{ended, raised};
use numpy::{PyArray1, PyArrayMethods, ToPyArray as _};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use smc::base::lanes::Mask;
use smc::base::random::TrialKey;
use smc::base::tick::{Clock, Tick};
use smc::engine::Threads;
use smc::kernel::{End, Program, Run, State};
use smc::model::{Parameter, Scenario};
use smc::{Diagnostics, Model};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;

/// Room for no more states is made before they come.
const MOST_AHEAD: usize = 1 << 20;

/// The states of a trial, one after the other, for each agent of the scenario.
struct Rows {
    times: Vec<f64>,
    /// Coordinates, m.
    positions: Vec<f64>,
    /// Components, m/s.
    velocities: Vec<f64>,
    /// Radii, m.
    radii: Vec<f64>,
    present: Vec<bool>,
    /// Numbers of the levels and stairs, −1 of nobody; empty where the plane has none.
    levels: Vec<i32>,
    variables: Vec<f64>,
    /// Why it ended before the horizon, if it did.
    ended: Option<String>,
}

impl Rows {
    /// Room for a trial.
    fn new(scenario: &Scenario) -> Self {
        let agents = scenario.agents.len();
        let states =
            if scenario.clock.is_jumps() { 0 } else { (scenario.horizon.0 as usize + 1).min(MOST_AHEAD) };
        Self {
            times: Vec::with_capacity(states),
            positions: Vec::with_capacity(2 * agents * states),
            velocities: Vec::with_capacity(2 * agents * states),
            radii: Vec::with_capacity(agents * states),
            present: Vec::with_capacity(agents * states),
            levels: Vec::new(),
            variables: Vec::new(),
            ended: None,
        }
    }

    /// Adds the state of a lane.
    fn add(&mut self, scenario: &Scenario, state: &State, lane: usize) {
        self.times.push(match scenario.clock {
            Clock::Jumps(_) => state.clocks.now[lane],
            clock => clock.seconds(Tick(state.ticks[lane])),
        });
        let storeys = &scenario.scene.storeys;
        for agent in 0..scenario.agents.len() {
            let slot = state.slot(agent, lane);
            let is_here = state.is_present(slot);
            // Nobody is anywhere who is not there.
            let shown = |value: f64| if is_here { value } else { f64::NAN };
            let (mut at, velocity) = (state.position(slot), state.velocity(slot));
            if let Some(island) = storeys.islands.get(storeys.island_at(at)) {
                self.levels.push(if is_here { storeys.island_at(at) as i32 } else { -1 });
                at -= island.origin;
            }
            self.positions.extend([shown(at.x), shown(at.y)]);
            self.velocities.extend([shown(velocity.x), shown(velocity.y)]);
            self.radii.push(shown(slot.of(&state.bodies[Parameter::Radius])));
            self.present.push(is_here);
        }
        self.variables.extend(state.variables.iter().map(|lanes| lanes.0[lane]));
    }

    /// Runs some trials side by side; they end when somebody interrupts.
    fn of(
        (model, program): (&Model, &Program),
        (seed, indices): (u64, &[u64]),
        is_halted: &AtomicBool,
    ) -> Result<Vec<Self>, Diagnostics> {
        let scenario = model.scenario();
        let mut rows: Vec<Self> = indices.iter().map(|_| Self::new(scenario)).collect();
        let mut run = Run::new(program);
        for (lane, index) in indices.iter().enumerate() {
            let key = TrialKey { seed, index: *index, branch: 0 };
            run.load(lane, key.into()).map_err(|fault| model.no_trial(*index, fault))?;
        }
        let mut moved = run.occupied();
        run.begin(moved);
        while !run.occupied().is_empty() && !is_halted.load(Ordering::Relaxed) {
            for lane in run.occupied().iter() {
                // A step in which the model is wrong leads to no state, and in continuous time nothing more happens at the end.
                let end = run.end(lane).or_else(|| (!moved.has(lane)).then_some(End::Horizon));
                let is_state = moved.has(lane) && !matches!(end, Some(End::Faulty(_)));
                if is_state {
                    rows[lane].add(scenario, run.state(), lane);
                }
                if let Some(end) = end {
                    rows[lane].ended = ended(scenario, end, (run.state(), lane));
                    run.clear(Mask::lane(lane));
                }
            }
            moved = if run.occupied().is_empty() { Mask::NONE } else { run.advance() };
        }
        Ok(rows)
    }

    /// The same as arrays, which take the memory over.
    fn arrays<'py>(self, py: Python<'py>, scenario: &Scenario, index: u64) -> PyResult<Bound<'py, PyDict>> {
        let (states, agents) = (self.times.len(), scenario.agents.len());
        let dict = PyDict::new(py);
        dict.set_item("index", index)?;
        dict.set_item("times", PyArray1::from_vec(py, self.times))?;
        dict.set_item("positions", PyArray1::from_vec(py, self.positions).reshape([states, agents, 2])?)?;
        dict.set_item("velocities", PyArray1::from_vec(py, self.velocities).reshape([states, agents, 2])?)?;
        dict.set_item("radii", PyArray1::from_vec(py, self.radii).reshape([states, agents])?)?;
        dict.set_item("present", PyArray1::from_vec(py, self.present).reshape([states, agents])?)?;
        if !scenario.scene.storeys.are_none() {
            dict.set_item("levels", PyArray1::from_vec(py, self.levels).reshape([states, agents])?)?;
        }
        let named = &scenario.processes.variables;
        let variables = PyDict::new(py);
        for (k, variable) in named.iter().enumerate() {
            let values: Vec<f64> = self.variables.iter().copied().skip(k).step_by(named.len()).collect();
            variables.set_item(&variable.name, values.to_pyarray(py))?;
        }
        dict.set_item("variables", variables)?;
        dict.set_item("ended", self.ended)?;
        Ok(dict)
    }
}

/// Trials of a seed, in parallel.
pub(super) fn trials<'py>(
    py: Python<'py>,
    (model, ledger): (&Model, &Ledger),
    (seed, indices): (u64, Vec<u64>),
    threads: Option<usize>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let is_halted = Arc::new(AtomicBool::new(false));
    let run =
        move |model: &Model, indices: &[u64], is_halted: &AtomicBool| -> Result<Vec<Rows>, Diagnostics> {
            let program = model.program(seed);
            let width = Run::new(&program).width();
            let batches: Vec<&[u64]> = indices.chunks(width).collect();
            let of = |batch: &&[u64]| Rows::of((model, &program), (seed, batch), is_halted);
            let found: Result<Vec<Vec<Rows>>, Diagnostics> = match batches.as_slice() {
                [one] => of(one).map(|rows| vec![rows]),
                all => match Threads::new(threads) {
                    Ok(threads) => threads.map(all, of).into_iter().collect(),
                    Err(_) => all.iter().map(of).collect(),
                },
            };
            found.map(|batches| batches.into_iter().flatten().collect())
        };
    let work = {
        let (model, indices, is_halted) = (model.clone(), indices.clone(), Arc::clone(&is_halted));
        move |sender: &Sender<_>| drop(sender.send(run(&model, &indices, &is_halted)))
    };
    let halted = |is_interrupted| {
        is_halted.fetch_or(is_interrupted, Ordering::Relaxed);
        is_halted.load(Ordering::Relaxed).then_some(Halt::Interrupted)
    };
    let found = attend(py, ledger, work, Some, halted)?;
    if is_halted.load(Ordering::Relaxed) {
        return Err(PyKeyboardInterrupt::new_err(()));
    }
    let found = found.map_err(|found| raised(py, &found))?;
    let scenario = model.scenario();
    found.into_iter().zip(indices).map(|(rows, index)| rows.arrays(py, scenario, index)).collect()
}
