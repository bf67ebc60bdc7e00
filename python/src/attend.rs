//! Work on a thread of its own, while this one looks for signals of Python, such as the stop button of a notebook.

use pyo3::exceptions::{PyRuntimeError, PyTimeoutError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Stack of a thread that works: deep formulas are walked recursively.
const STACK: usize = 256 << 20;
/// Between two looks for signals, and how long a driver may still take after the end.
const LOOK: Duration = Duration::from_millis(20);

/// Why work has to end.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Halt {
    /// Somebody interrupts.
    Interrupted,
    /// Its time is over.
    Late,
}

/// What drivers in Python do, of all threads that ask them.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    /// The first trial in which one failed, and the words about it.
    pub(super) failure: Mutex<Option<(u64, String)>>,
    /// Threads of Python that are inside a driver, and since when.
    inside: Mutex<BTreeMap<u64, Instant>>,
}

impl Ledger {
    /// Calls a function, so that it can be ended from outside.
    #[allow(
        clippy::disallowed_methods,
        reason = "how long a call lasts decides whether it is stuck, and no result"
    )]
    pub(super) fn call<T>(&self, py: Python<'_>, function: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
        static IDENT: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let find = || Ok::<_, PyErr>(py.import("threading")?.getattr("get_ident")?.unbind());
        let thread: u64 = IDENT.get_or_try_init(py, find)?.call0(py)?.extract(py)?;
        let inside = || self.inside.lock().unwrap_or_else(PoisonError::into_inner);
        inside().insert(thread, Instant::now());
        let answer = function();
        inside().remove(&thread);
        answer
    }

    /// Raises an exception in drivers that do not come to an end.
    fn end(&self, py: Python<'_>, why: Halt) -> PyResult<()> {
        let stuck: Vec<u64> = {
            let inside = self.inside.lock().unwrap_or_else(PoisonError::into_inner);
            inside.iter().filter(|(_, since)| since.elapsed() > LOOK).map(|(thread, _)| *thread).collect()
        };
        if stuck.is_empty() {
            return Ok(());
        }
        let class = match why {
            Halt::Interrupted => py.get_type::<pyo3::exceptions::PyKeyboardInterrupt>(),
            Halt::Late => py.get_type::<PyTimeoutError>(),
        };
        py.import("smc.errors")?.getattr("raise_in")?.call1((stuck, class)).map(drop)
    }
}

/// Runs `work` on a thread of its own and calls `each` with all that it tells, until that gives something. `halted` is told
/// whether somebody interrupts, and says why the work has to end, if it has to.
pub(super) fn attend<T: Send + 'static, R>(
    py: Python<'_>,
    ledger: &Ledger,
    work: impl FnOnce(&Sender<T>) + Send + 'static,
    mut each: impl FnMut(T) -> Option<R>,
    mut halted: impl FnMut(bool) -> Option<Halt>,
) -> PyResult<R> {
    let (sender, told) = channel();
    std::thread::Builder::new().stack_size(STACK).spawn(move || work(&sender))?;
    let told: Mutex<Receiver<T>> = Mutex::new(told);
    let next = || told.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK);
    loop {
        match py.detach(next) {
            Ok(one) => {
                if let Some(result) = each(one) {
                    return Ok(result);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("this is a bug in smc; please report it"));
            }
        }
        if let Some(why) = halted(py.check_signals().is_err()) {
            ledger.end(py, why)?;
        }
    }
}
