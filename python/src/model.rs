//! A model that was parsed, with the files that it reads.

use super::attend::Ledger;
use super::check::{self, Report, Settings};
use super::driver;
use super::stage::Stage;
use super::{raised, trial};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use smc::{Draft, Model as Parsed};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, PoisonError};

/// Reads a file that a scenario names, from the first folder that has it.
#[allow(clippy::disallowed_methods, reason = "a program of Python opens files, as the command line does")]
fn read(path: &str, folders: &[PathBuf]) -> Result<Vec<u8>, String> {
    let found = folders.iter().map(|folder| folder.join(path)).find(|place| place.is_file());
    let Some(found) = found else {
        let folders: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
        return Err(format!("the file `{path}` does not exist in {}", folders.join(", ")));
    };
    std::fs::read(&found).map_err(|error| format!("`{path}` cannot be read: {error}"))
}

/// A scenario that was understood. `smc.Model` is what Python sees.
#[pyclass(frozen, module = "smc._smc")]
pub struct Model {
    pub(super) parsed: Parsed,
    /// What its drivers do.
    ledger: Arc<Ledger>,
}

#[pymethods]
impl Model {
    /// Parses a scenario. Its own folder and those of `data` are searched for the files that it names and `files` does not hold;
    /// `runs_in` allows its program to run there.
    #[new]
    #[allow(clippy::too_many_arguments, reason = "Python gives them by one call of its own")]
    fn new(
        py: Python<'_>,
        name: &str,
        text: &str,
        settings: Vec<(String, String)>,
        files: BTreeMap<String, Vec<u8>>,
        folder: Option<PathBuf>,
        data: Vec<String>,
        runs_in: Option<PathBuf>,
    ) -> PyResult<Self> {
        let folders: Vec<PathBuf> = folder.into_iter().chain(data.iter().map(PathBuf::from)).collect();
        let mut draft = Draft::new(name, text).reading(data, move |path| read(path, &folders));
        for (name, value) in settings {
            draft = draft.set(name, value);
        }
        for (path, bytes) in files {
            draft = draft.file(path, bytes);
        }
        if let Some(folder) = runs_in {
            draft = draft.allow_run(folder);
        }
        let parsed = py.detach(|| draft.parse());
        Ok(Self { parsed: parsed.map_err(|found| raised(py, &found))?, ledger: Arc::default() })
    }

    /// The same model in which functions drive agents of a name, or without a name all.
    fn driven(&self, py: Python<'_>, drivers: Vec<(Option<String>, Py<PyAny>)>) -> PyResult<Self> {
        driver::driven(py, &self.parsed, drivers).map(|(parsed, ledger)| Self { parsed, ledger })
    }

    /// How a driver failed in the first trial in which one did; told once.
    fn failure(&self) -> Option<String> {
        self.ledger.failure.lock().unwrap_or_else(PoisonError::into_inner).take().map(|(_, said)| said)
    }

    /// Its title; empty without one.
    #[getter]
    fn title(&self) -> String {
        self.parsed.scenario().title.clone()
    }

    /// The names of its agents, in the order of the second axis of arrays.
    #[getter]
    fn agents(&self) -> Vec<String> {
        self.parsed.scenario().agents.iter().map(|agent| agent.name.clone()).collect()
    }

    /// The names of its levels by height, and then of its stairs.
    #[getter]
    fn levels(&self) -> Vec<String> {
        self.parsed.scenario().scene.storeys.islands.iter().map(|island| island.name.clone()).collect()
    }

    /// Warnings, as the program prints them.
    #[getter]
    fn warnings(&self) -> String {
        self.parsed.warnings().to_string()
    }

    /// Answers the queries of property files, each a name and a text. `progress` is called with a query, the trials so far and
    /// those that are expected.
    fn check(
        &self,
        py: Python<'_>,
        properties: Vec<(String, String)>,
        settings: Settings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Report> {
        check::check(py, (&self.parsed, &self.ledger), properties, &settings, progress)
    }

    /// A stage on which an agent is driven, and a query is asked of each episode.
    fn stage(&self, py: Python<'_>, agent: &str, query: Option<&str>, neighbours: usize) -> PyResult<Stage> {
        Stage::new(py, &self.parsed, (agent, query), neighbours)
    }

    /// Trials of a seed as a page with a player.
    fn play(&self, py: Python<'_>, seed: u64, indices: Vec<u64>) -> PyResult<String> {
        py.detach(|| self.parsed.play(seed, &indices)).map_err(|found| raised(py, &found))
    }

    /// Trials of a seed as dictionaries of arrays, in parallel.
    fn trials<'py>(
        &self,
        py: Python<'py>,
        seed: u64,
        indices: Vec<u64>,
        threads: Option<usize>,
    ) -> PyResult<Vec<Bound<'py, PyDict>>> {
        if threads == Some(0) {
            return Err(PyValueError::new_err("threads must be at least 1"));
        }
        trial::trials(py, (&self.parsed, &self.ledger), (seed, indices), threads)
    }
}
