//! The border between Python and `smc`: models, checks, reports and trials, with numpy arrays for what is large.
//!
//! Everything that Python can write as well stands in `python/smc/`. Errors of texts become the exception `smc.Diagnostics` with
//! the words of the program. Python may run other threads while something is computed here.

mod attend;
mod check;
mod driver;
mod model;
mod stage;
mod trial;

use pyo3::prelude::*;
use smc::Diagnostics;
use smc::kernel::{End, State};
use smc::model::Scenario;

/// Errors of texts as an exception of Python.
fn raised(py: Python<'_>, found: &Diagnostics) -> PyErr {
    let list: Vec<_> = found
        .findings()
        .into_iter()
        .filter(|one| one.error)
        .map(|one| {
            let (file, (line, column)) =
                one.spot.map_or((None, (0, 0)), |spot| (Some(spot.file), spot.start));
            (one.code, file, line, column, one.message, one.hint)
        })
        .collect();
    let text = found.to_string();
    let made = py
        .import("smc.errors")
        .and_then(|module| module.getattr("Diagnostics"))
        .and_then(|class| class.call1((text.trim_end(), list)));
    match made {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// Why a trial ended before its horizon, if it did.
fn ended(scenario: &Scenario, end: End, (state, lane): (&State, usize)) -> Option<String> {
    if let Some(agent) = state.undriven(lane) {
        return Some(format!("the driver of `{}` failed", scenario.agents[agent].name));
    }
    match end {
        End::Horizon => None,
        End::Diverged => Some("diverged".to_owned()),
        End::Full => Some("a source has more arrivals than places".to_owned()),
        End::Faulty(fault) => Some(fault.describe(scenario)),
    }
}

/// The command line of `smc`, for the command of the wheel: the exit code.
#[pyfunction]
fn command(py: Python<'_>, words: Vec<String>) -> u8 {
    py.detach(|| smc::cli::run_as(words.into_iter().map(Into::into).collect()))
}

#[pymodule]
fn _smc(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<model::Model>()?;
    module.add_class::<check::Report>()?;
    module.add_class::<stage::Stage>()?;
    module.add_class::<driver::Situation>()?;
    module.add_function(wrap_pyfunction!(command, module)?)
}
