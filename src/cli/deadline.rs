//! Time and signals of a call while it does not sample: while it compiles, prepares scenes and stopping rules, and prints.
//! The engine keeps both while it samples. Before that there is no result to lose, so the process simply ends.

use super::complaint;
use super::output;
use super::terminal::Colors;
use super::values::Limit;
use crate::engine::Budget;
use crate::library::program;
use crate::report::ExitCode as Exit;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

/// Least time that preparation may still take after the deadline: what is nearly ready should sample.
const LEAST_GRACE: Duration = Duration::from_millis(250);

/// The phase of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// Files are read and compiled, scenes and stopping rules are prepared.
    Preparing,
    /// Trials run.
    Sampling,
    /// Something is printed.
    Printing,
}

/// Why a call ended before its first trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ended {
    /// Time was up.
    Late,
    /// By a signal.
    Interrupted,
}

/// Ends a call without results when its time is up.
pub(super) fn limit(limit: Limit, colors: Colors) {
    let Some(time) = limit.timeout else { return };
    let _ = std::thread::Builder::new().spawn(move || {
        std::thread::sleep(time);
        complaint::tell(&complaint::late(""), &[], colors);
        output::leave_nothing();
        leave(Exit::Undecided);
    });
}

/// Ends the process, and the programs that it runs.
pub(super) fn leave(exit: Exit) -> ! {
    program::end_all();
    std::process::exit(i32::from(exit.code()))
}

/// The phase of a call, for the threads that can end it. The thread that holds the lock while the call prepares ends it.
#[derive(Clone)]
pub(super) struct Deadline(Arc<Mutex<Phase>>);

impl Deadline {
    /// Watches the time of a budget and the signals. `end` reports why the call ended before its first trial; the
    /// process exits with what it returns.
    pub(super) fn watch(budget: &Arc<Budget>, end: impl Fn(Ended) -> Exit + Clone + Send + 'static) -> Self {
        let deadline = Self(Arc::new(Mutex::new(Phase::Preparing)));
        let (own, signalled, on_signal) = (deadline.clone(), Arc::clone(budget), end.clone());
        // Only the first interruption is gentle, and only while trials run.
        let _ = ctrlc::set_handler(move || {
            let phase = match own.0.try_lock() {
                Ok(phase) => phase,
                Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
                Err(TryLockError::WouldBlock) => leave(Exit::Interrupted),
            };
            match *phase {
                Phase::Preparing => leave(on_signal(Ended::Interrupted)),
                Phase::Sampling if !signalled.is_interrupted() => signalled.interrupt(),
                Phase::Sampling | Phase::Printing => {
                    leave(Exit::Interrupted);
                }
            }
        });
        if let Some(left) = budget.seconds_left() {
            let own = deadline.clone();
            let grace = Duration::from_secs_f64(budget.grace()).max(LEAST_GRACE);
            // Without this thread the call is late, and nothing else is lost.
            let _ = std::thread::Builder::new().spawn(move || {
                std::thread::sleep(Duration::from_secs_f64(left).saturating_add(grace));
                let phase = own.lock();
                if *phase == Phase::Preparing {
                    leave(end(Ended::Late));
                }
            });
        }
        deadline
    }

    /// The call goes on to something else. It does not return where the call is ended.
    pub(super) fn enter(&self, next: Phase) {
        *self.lock() = next;
    }

    fn lock(&self) -> MutexGuard<'_, Phase> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
