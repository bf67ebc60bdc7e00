//! Drivers written in Python. The threads that run trials ask them, each while it holds the lock of the interpreter.

use super::attend::Ledger;
use super::raised;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use smc::Model;
use smc::base::geometry::Vec2;
use smc::base::random::{Purpose, Stream};
use smc::kernel::driver::{Driver, Limits, Memory, Occasion, Plan, Sample, Situation as Seen, Trajectory};
use smc::kernel::fault::Fault;
use smc::model::{Goal, Parameter};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

/// Trials whose answers are remembered, one of so many, and most answers.
const TWICE: u64 = 100;
const MOST_ANSWERS: usize = 1 << 20;
/// Largest correction towards a trajectory as a share of the preferred speed, and how far from it its time stands still
/// and another one is asked for, m.
const CORRECTION: f64 = 0.3;
const LAG: f64 = 0.5;
const LEAVE: f64 = 1.0;
/// Most letters of an answer that are shown.
const MOST_SHOWN: usize = 200;
/// What a driver may answer.
const ANSWERS: &str =
    "`straight`, `keep`, (`way`, points), (`follow`, rows of t, x, y, vx, vy) or (`stand`, seconds)";

/// What a driver is told. Lengths are in m, times in s, velocities in m/s.
#[pyclass(module = "smc._smc")]
pub struct Situation {
    /// Why it is asked: `begins`, `enters`, `leg`, `diverted`, `left`, `ended`, `doors` or `looks`.
    #[pyo3(get)]
    occasion: &'static str,
    /// The name of the agent.
    #[pyo3(get)]
    agent: String,
    #[pyo3(get)]
    seed: u64,
    /// Index of the trial.
    #[pyo3(get)]
    trial: u64,
    #[pyo3(get)]
    time: f64,
    /// Length of a step.
    #[pyo3(get)]
    dt: f64,
    #[pyo3(get)]
    position: (f64, f64),
    #[pyo3(get)]
    velocity: (f64, f64),
    /// The goal of the present leg, of a region its middle; None in a pause, or without goals.
    #[pyo3(get)]
    goal: Option<(f64, f64)>,
    #[pyo3(get)]
    radius: f64,
    /// The preferred speed.
    #[pyo3(get)]
    speed: f64,
    /// The names of the others, in the order of the rows of `others`.
    #[pyo3(get)]
    names: Vec<String>,
    /// What the driver remembers of this agent in this trial.
    #[pyo3(get, set)]
    memory: Option<Py<PyAny>>,
    rows: Vec<f64>,
    key: [u64; 2],
    generator: PyOnceLock<Py<PyAny>>,
}

#[pymethods]
impl Situation {
    /// The others who are there: a row of x, y, vx, vy and radius for each.
    #[getter]
    fn others<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_slice(py, &self.rows).reshape([self.names.len(), 5])
    }

    /// A generator of numpy that belongs to the seed, the trial, the agent and the count of questions.
    #[getter]
    fn random(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let make = || {
            let numpy = py.import("numpy.random")?;
            let key = PyDict::new(py);
            key.set_item("key", u128::from(self.key[0]) | u128::from(self.key[1]) << 64)?;
            let bits = numpy.getattr("Philox")?.call((), Some(&key))?;
            Ok(numpy.getattr("Generator")?.call1((bits,))?.unbind())
        };
        self.generator.get_or_try_init(py, make).map(|made| made.clone_ref(py))
    }
}

impl Situation {
    fn of(seen: &Seen<'_>, memory: Option<Py<PyAny>>) -> Self {
        let agents = &seen.scenario.agents;
        let pair = |v: Vec2| (v.x, v.y);
        let (mut names, mut rows) = (Vec::new(), Vec::new());
        for other in seen.others() {
            names.push(agents[other.agent.0 as usize].name.clone());
            let (at, velocity) = (other.position, other.velocity);
            rows.extend([at.x, at.y, velocity.x, velocity.y, other.radius]);
        }
        let middle = |goal: &Goal| match goal {
            Goal::Point(point) => pair(*point),
            Goal::Region(id) => {
                let bounds = seen.scenario.scene.regions[id.0 as usize].shape.bounds();
                pair(0.5 * (bounds.low + bounds.high))
            }
        };
        Self {
            occasion: match seen.occasion {
                Occasion::Begins => "begins",
                Occasion::Enters => "enters",
                Occasion::Leg => "leg",
                Occasion::Diverted => "diverted",
                Occasion::Left => "left",
                Occasion::Ended => "ended",
                Occasion::Storey => "level",
                Occasion::Doors => "doors",
                Occasion::Looks => "looks",
            },
            agent: agents[seen.agent.0 as usize].name.clone(),
            seed: seen.key.seed,
            trial: seen.key.index,
            time: seen.time,
            dt: seen.dt,
            position: pair(seen.position),
            velocity: pair(seen.velocity),
            goal: seen.goal().map(middle),
            radius: seen.parameter(Parameter::Radius),
            speed: seen.own_speed,
            names,
            memory,
            rows,
            key: Stream::of(seen.key, seen.entity, Purpose::Plan).words(seen.asked),
            generator: PyOnceLock::new(),
        }
    }

    /// A number that stands for all that is told, and for a past.
    fn print(&self, past: u64) -> u64 {
        let mut hasher = DefaultHasher::new();
        (past, self.key, self.occasion, &self.agent, &self.names).hash(&mut hasher);
        let (at, velocity, goal) = (self.position, self.velocity, self.goal.unwrap_or((f64::NAN, 0.0)));
        let own =
            [self.time, self.dt, at.0, at.1, velocity.0, velocity.1, goal.0, goal.1, self.radius, self.speed];
        own.iter().chain(&self.rows).for_each(|number| number.to_bits().hash(&mut hasher));
        hasher.finish()
    }
}

/// What is remembered of a person: the value of the driver, and a number that stands for all questions so far.
struct Past {
    value: Option<Py<PyAny>>,
    print: u64,
}

/// A function of Python as a driver.
#[derive(Debug)]
struct Asked {
    function: Py<PyAny>,
    ledger: Arc<Ledger>,
    /// Answers in trials that run twice, by situations with their past; none where two answers differed.
    answers: Mutex<BTreeMap<u64, Option<Plan>>>,
}

impl Asked {
    /// Keeps an exception, if it is that of the first trial.
    fn failed(&self, py: Python<'_>, error: &PyErr, seen: &Seen<'_>) {
        let trial = seen.key.index;
        let first = || self.ledger.failure.lock().unwrap_or_else(PoisonError::into_inner);
        let is_known = || first().as_ref().is_some_and(|(known, _)| *known <= trial);
        if error.is_instance_of::<PyKeyboardInterrupt>(py) || is_known() {
            return;
        }
        // Without the lock: where Python formats, another thread may get the interpreter and wait for the lock with it.
        let name = &seen.scenario.agents[seen.agent.0 as usize].name;
        let trace = error.traceback(py).and_then(|trace| trace.format().ok()).unwrap_or_default();
        let time = (seen.time * 1e6).round() / 1e6;
        let said = format!(
            "the driver of `{name}` failed in trial {trial} at {time} s, which is unresolved:\n{trace}{error}"
        );
        if !is_known() {
            *first() = Some((trial, said));
        }
    }

    /// Whether an answer differs from that of the same trial before.
    fn differs(&self, print: u64, plan: &Plan) -> bool {
        let mut answers = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
        if answers.len() >= MOST_ANSWERS {
            return false;
        }
        let known = answers.entry(print).or_insert_with(|| Some(plan.clone()));
        if known.as_ref() != Some(plan) {
            *known = None;
        }
        known.is_none()
    }
}

impl Driver for Asked {
    fn plan(&self, seen: &Seen<'_>, memory: &mut Memory) -> Plan {
        Python::attach(|py| {
            let past = memory.get::<Past>();
            let value = past.and_then(|past| past.value.as_ref()).map(|value| value.clone_ref(py));
            let situation = Situation::of(seen, value);
            let is_twice = seen.key.index.is_multiple_of(TWICE) && seen.key.branch == 0;
            let print = if is_twice { situation.print(past.map_or(0, |past| past.print)) } else { 0 };
            let asked = Bound::new(py, situation).and_then(|situation| {
                let answer = self.ledger.call(py, || self.function.bind(py).call1((&situation,)))?;
                let plan = plan_of(&answer, seen.own_speed)?;
                Ok((plan, situation.borrow().memory.as_ref().map(|value| value.clone_ref(py))))
            });
            let (plan, value) = asked.unwrap_or_else(|error| {
                self.failed(py, &error, seen);
                (Plan::Failed(None), None)
            });
            if is_twice && self.differs(print, &plan) {
                return Plan::Failed(Some(Fault::Unsteady { agent: seen.agent }));
            }
            if is_twice || value.is_some() || past.is_some() {
                memory.put(Past { value, print });
            }
            plan
        })
    }
}

/// The plan of an answer.
fn plan_of(answer: &Bound<'_, PyAny>, speed: f64) -> PyResult<Plan> {
    let wrong = |value: &dyn Debug, said: &str| {
        let shown: String = format!("{value:?}").split_whitespace().collect::<Vec<_>>().join(" ");
        let shown: String = shown.chars().take(MOST_SHOWN).collect();
        PyValueError::new_err(format!("{shown} {said}; a driver answers {ANSWERS}"))
    };
    let (word, value) = match answer.extract::<String>() {
        Ok(word) => (word, None),
        Err(_) => {
            let pair: Result<(String, Bound<'_, PyAny>), _> = answer.extract();
            let (word, value) = pair.map_err(|_| wrong(answer, "is no plan"))?;
            (word, Some(value))
        }
    };
    match (word.as_str(), value) {
        ("straight", None) => Ok(Plan::Straight),
        ("keep", None) => Ok(Plan::Keep),
        ("stand", Some(value)) => match value.extract::<f64>() {
            Ok(seconds) if seconds >= 0.0 => Ok(Plan::Stand(seconds)),
            _ => Err(wrong(&value, "is no time in s")),
        },
        ("way", Some(value)) => match value.extract::<Vec<[f64; 2]>>() {
            Ok(points) if !points.is_empty() && points.as_flattened().iter().all(|v| v.is_finite()) => {
                Ok(Plan::Through(points.into_iter().map(|[x, y]| Vec2::new(x, y)).collect()))
            }
            _ => Err(wrong(&value, "are no points")),
        },
        ("follow", Some(value)) => {
            let sample = |[time, x, y, vx, vy]: [f64; 5]| Sample {
                time,
                position: Vec2::new(x, y),
                velocity: Vec2::new(vx, vy),
            };
            let rows = value.extract::<Vec<[f64; 5]>>().unwrap_or_default();
            let samples: Vec<Sample> = rows.into_iter().map(sample).collect();
            let Some(trajectory) = Trajectory::through(&samples) else {
                return Err(wrong(&value, "is no trajectory of two or more times from 0 s on"));
            };
            let limits = Limits { correction: CORRECTION * speed, lag: LAG, leave: LEAVE };
            Ok(Plan::Follow(Arc::new(trajectory), limits))
        }
        _ => Err(wrong(answer, "is no plan")),
    }
}

/// A model with drivers, each a function and the name of its agents, or without a name of all; and why one failed, once it has.
pub(super) fn driven(
    py: Python<'_>,
    model: &Model,
    drivers: Vec<(Option<String>, Py<PyAny>)>,
) -> PyResult<(Model, Arc<Ledger>)> {
    let ledger = Arc::<Ledger>::default();
    let mut driven = model.clone();
    for (name, function) in drivers {
        let driver = Asked { function, ledger: Arc::clone(&ledger), answers: Mutex::default() };
        driven = driven.with_driver(name.as_deref(), Arc::new(driver)).map_err(|found| raised(py, &found))?;
    }
    Ok((driven, ledger))
}
