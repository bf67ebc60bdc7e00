//! Episodes in which Python drives an agent, step by step.

use super::{ended, raised};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use smc::base::geometry::Vec2;
use smc::kernel::{End, State};
use smc::library::{Episode, Stage as Scene};
use smc::model::{Parameter, Scenario};
use std::sync::{Arc, Mutex, PoisonError};

/// What a step came to: the observation, the time, whether the agent is there and the horizon is reached, why the trial ended
/// before it, and what the query came to, once that is decided.
type Shown<'py> = (Bound<'py, PyArray2<f64>>, f64, (bool, bool), Option<String>, Option<f64>);

/// A model on which an agent is driven. `smc.Env` is what Python sees.
#[pyclass(frozen, module = "smc._smc")]
pub struct Stage {
    scene: Scene,
    scenario: Arc<Scenario>,
    neighbours: usize,
    episode: Mutex<Option<Episode>>,
}

impl Stage {
    pub(super) fn new(
        py: Python<'_>,
        model: &smc::Model,
        (agent, query): (&str, Option<&str>),
        neighbours: usize,
    ) -> PyResult<Self> {
        let scene = py.detach(|| model.stage(agent, query, 0)).map_err(|found| raised(py, &found))?;
        Ok(Self { scene, scenario: model.scenario().clone(), neighbours, episode: Mutex::new(None) })
    }

    /// The row of an agent: x, y, vx, vy and radius; none of who is not there.
    fn row(state: &State, agent: usize) -> Option<[f64; 5]> {
        let slot = state.slot(agent, 0);
        let (at, velocity) = (state.position(slot), state.velocity(slot));
        let radius = slot.of(&state.bodies[Parameter::Radius]);
        state.is_present(slot).then_some([at.x, at.y, velocity.x, velocity.y, radius])
    }

    /// The agent that is driven, and those nearest to it with places and velocities from its own, nearest first.
    fn shown<'py>(&self, py: Python<'py>, episode: &Episode) -> PyResult<Shown<'py>> {
        let state = episode.state();
        let driven = self.scene.agent();
        let own = Self::row(state, driven);
        let [x, y, vx, vy, _] = own.unwrap_or_default();
        let others = (0..self.scenario.agents.len()).filter(|agent| *agent != driven);
        let mut others: Vec<[f64; 5]> = others
            .filter_map(|agent| Self::row(state, agent))
            .map(|[a, b, va, vb, radius]| [a - x, b - y, va - vx, vb - vy, radius])
            .collect();
        let square = |row: &[f64; 5]| row[0] * row[0] + row[1] * row[1];
        others.sort_by(|a, b| square(a).total_cmp(&square(b)));
        others.truncate(self.neighbours);
        let mut rows: Vec<f64> =
            own.unwrap_or_default().into_iter().chain(others.into_iter().flatten()).collect();
        rows.resize(5 * (1 + self.neighbours), 0.0);
        let rows = PyArray1::from_vec(py, rows).reshape([1 + self.neighbours, 5])?;
        let time = self.scenario.clock.seconds(smc::base::tick::Tick(state.ticks[0]));
        let is_over = episode.end() == Some(End::Horizon);
        let ended = episode.end().and_then(|end| ended(&self.scenario, end, (state, 0)));
        let is_here = own.is_some();
        Ok((rows, time, (is_here, is_over), ended, episode.worth()))
    }
}

#[pymethods]
impl Stage {
    /// Length of a step, s.
    #[getter]
    fn dt(&self) -> f64 {
        self.scene.dt()
    }

    /// Begins the trial of an index.
    fn reset<'py>(&self, py: Python<'py>, seed: u64, index: u64) -> PyResult<Shown<'py>> {
        let episode = self.scene.episode(seed, index).map_err(PyRuntimeError::new_err)?;
        let mut held = self.episode.lock().unwrap_or_else(PoisonError::into_inner);
        self.shown(py, held.insert(episode))
    }

    /// Drives the agent with a velocity, m/s, for one step.
    fn step<'py>(&self, py: Python<'py>, vx: f64, vy: f64) -> PyResult<Shown<'py>> {
        if !(vx.is_finite() && vy.is_finite()) {
            return Err(PyValueError::new_err(format!("the velocity must be finite (got {vx}, {vy})")));
        }
        let mut held = self.episode.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(episode) = held.as_mut() else {
            return Err(PyRuntimeError::new_err("call `reset` before the first step"));
        };
        episode.step(Vec2::new(vx, vy));
        self.shown(py, episode)
    }
}
