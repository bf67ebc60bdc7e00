//! Checks: an interruption ends sampling, and the report has what was found so far.

use super::attend::{Halt, Ledger, attend};
use super::raised;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use smc::engine::Watch;
use smc::report::Format;
use smc::{Diagnostics, Model, Options, Report as Found};
use std::sync::mpsc::Sender;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Options of a check.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Settings {
    seed: u64,
    threads: Option<usize>,
    max_trials: Option<u64>,
    timeout: Option<f64>,
    only: Vec<String>,
    evidence: bool,
}

impl Settings {
    fn options(&self) -> Options {
        let mut options = Options::default().seed(self.seed).evidence(self.evidence).within(prepared);
        if let Some(threads) = self.threads {
            options = options.threads(threads);
        }
        if let Some(most) = self.max_trials {
            options = options.max_trials(most);
        }
        if let Some(time) = self.timeout.and_then(|time| Duration::try_from_secs_f64(time).ok()) {
            options = options.timeout(time);
        }
        self.only.iter().fold(options, |options, one| options.only(one))
    }
}

/// Gives a thread its state of the interpreter once, instead of for each question to a driver.
fn prepared(work: &mut (dyn FnMut() + Send)) {
    Python::attach(|py| py.detach(work));
}

/// What the thread that samples tells.
enum Told {
    /// A query, its trials so far, and those that are expected.
    Consumed(String, u64, Option<u64>),
    Done(Box<Result<Found, Diagnostics>>),
}

/// Tells how far a query is, if anybody wants to know.
struct Teller(Option<Sender<Told>>);

impl Watch for Teller {
    fn consumed(&self, query: &str, trials: u64, of: Option<u64>) {
        if let Some(sender) = &self.0 {
            let _ = sender.send(Told::Consumed(query.to_owned(), trials, of));
        }
    }
}

/// The results of a check.
#[pyclass(frozen, module = "smc._smc")]
pub struct Report {
    found: Found,
    model: Model,
    properties: Vec<(String, String)>,
    options: Options,
    page: OnceLock<Result<String, Diagnostics>>,
}

#[pymethods]
impl Report {
    /// As `--format json` writes it.
    fn json(&self) -> String {
        self.found.render(Format::Json)
    }

    /// As the program prints it.
    fn text(&self) -> String {
        self.found.to_string()
    }

    /// Warnings about the texts.
    fn warnings(&self) -> String {
        self.found.warnings().to_string()
    }

    /// Whether every check is satisfied and every other query got what it asks.
    fn is_satisfied(&self) -> bool {
        self.found.is_satisfied()
    }

    /// The page of `--report`; the trials behind the results run again.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let make = || self.model.page(&borrowed(&self.properties), &self.options, &self.found);
        let page = py.detach(|| self.page.get_or_init(make).clone());
        page.map_err(|found| raised(py, &found))
    }
}

fn borrowed(properties: &[(String, String)]) -> Vec<(&str, &str)> {
    properties.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect()
}

/// Answers the queries of property files. An interruption by Python ends sampling, and the report says what was found so far.
pub(super) fn check(
    py: Python<'_>,
    (model, ledger): (&Model, &Ledger),
    properties: Vec<(String, String)>,
    settings: &Settings,
    progress: Option<Py<PyAny>>,
) -> PyResult<Report> {
    let options = settings.options();
    let budget = Arc::new(options.budget());
    let is_told = progress.is_some();
    let work = {
        let (model, options, properties) = (model.clone(), options.clone(), properties.clone());
        let budget = Arc::clone(&budget);
        move |sender: &Sender<Told>| {
            let teller = Teller(is_told.then(|| sender.clone()));
            let found = model.check_files(&borrowed(&properties), &options, &budget, &teller);
            let _ = sender.send(Told::Done(Box::new(found)));
        }
    };
    let mut failed = None;
    let each = |told| match told {
        Told::Done(found) => Some(*found),
        Told::Consumed(query, trials, of) => {
            if let Some(progress) = &progress
                && let Err(error) = progress.call1(py, (query, trials, of))
            {
                // The stop button may find Python in this call.
                failed = Some(error).filter(|error| !error.is_instance_of::<PyKeyboardInterrupt>(py));
                budget.interrupt();
            }
            None
        }
    };
    let halted = |is_interrupted| {
        if is_interrupted {
            budget.interrupt();
        }
        let late = || budget.is_over().then_some(Halt::Late);
        if budget.is_interrupted() { Some(Halt::Interrupted) } else { late() }
    };
    let found = attend(py, ledger, work, each, halted)?;
    if let Some(error) = failed {
        return Err(error);
    }
    let found = found.map_err(|found| raised(py, &found))?;
    Ok(Report { found, model: model.clone(), properties, options, page: OnceLock::new() })
}
