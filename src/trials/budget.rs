//! Budgets: how many trials, until when, and whether somebody interrupted.
//!
//! The clock never decides what a trial yields, only how many trials are consumed; with a deadline a result
//! is a function of input, seed and the number of trials.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Default number of trials of one query.
pub const DEFAULT_TRIALS: u64 = 1_000_000;

/// Most steps of a batch between two looks at the clock.
const STEPS_BETWEEN_LOOKS: u32 = 32;

/// Steps times agents between two looks at the clock: about a millisecond.
const WORK_BETWEEN_LOOKS: usize = 2048;

/// Steps of a batch between two looks at the clock: few where each takes long.
pub fn steps_between_looks(agents: usize) -> u32 {
    ((WORK_BETWEEN_LOOKS / agents.max(1)) as u32).clamp(1, STEPS_BETWEEN_LOOKS)
}

/// Why sampling stopped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stop {
    /// A test crossed its boundary.
    Boundary,
    /// The interval, or the gap of a ranking, became as narrow as asked for.
    Width,
    /// More trials of this kind would not help: how the unresolved ones are read decides the verdict, or keeps
    /// the interval wide.
    Unresolved,
    /// The number of trials was planned beforehand.
    #[default]
    Plan,
    /// The largest number of trials was reached.
    Cap,
    /// Time was up.
    Deadline,
    /// Somebody interrupted it.
    Interrupt,
    /// Outcomes of further trials were not there to be merged.
    Missing,
}

impl Stop {
    /// Its word in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Boundary => "boundary",
            Self::Width => "width",
            Self::Unresolved => "unresolved",
            Self::Plan => "plan",
            Self::Cap => "cap",
            Self::Deadline => "deadline",
            Self::Interrupt => "interrupt",
            Self::Missing => "missing",
        }
    }

    /// Whether how many trials were read is no function of the query.
    pub const fn is_early(self) -> bool {
        matches!(self, Self::Deadline | Self::Interrupt | Self::Missing)
    }
}

/// How much may be spent.
#[derive(Debug)]
pub struct Budget {
    /// Most trials of one query (of a ranking or comparison: of one option or side).
    pub max_trials: u64,
    /// Most trials of a ranking, over all options: where a deadline found it, a replay finds it again.
    pub max_total: Option<u64>,
    /// Whether outcomes are not all there.
    lacks: AtomicBool,
    deadline: Option<Instant>,
    started: Instant,
    interrupted: Arc<AtomicBool>,
    /// Since when it is known that no more should be started.
    stopped: OnceLock<Instant>,
}

/// Seconds after the end that explanations may still take: after an interruption, at least, at most, and as a share of the time
/// that was given.
const PROMPT_GRACE: f64 = 0.1;
const LEAST_GRACE: f64 = 0.02;
const MOST_GRACE: f64 = 1.0;
const SHARE_OF_GRACE: f64 = 0.25;

impl Budget {
    /// A budget that starts now; `timeout` is for the whole call.
    #[allow(clippy::disallowed_methods, reason = "the engine keeps deadlines; trials never see the clock")]
    pub fn new(max_trials: u64, timeout: Option<Duration>) -> Self {
        let started = Instant::now();
        Self {
            max_trials,
            max_total: None,
            lacks: AtomicBool::new(false),
            deadline: timeout.and_then(|t| started.checked_add(t)),
            started,
            interrupted: Arc::default(),
            stopped: OnceLock::new(),
        }
    }

    /// A part of it that starts now and ends after so many seconds, for trials that are run ahead.
    #[allow(clippy::disallowed_methods, reason = "the engine keeps deadlines; trials never see the clock")]
    pub fn ahead(&self, seconds: f64) -> Self {
        self.until(Instant::now().checked_add(Duration::from_secs_f64(seconds)))
    }

    /// A part of the time that is left: one of so many equal ones. Without a deadline, or as the last, all of it.
    #[allow(clippy::disallowed_methods, reason = "the engine keeps deadlines; trials never see the clock")]
    pub fn share(&self, of: usize) -> Self {
        let parts = u32::try_from(of.max(1)).unwrap_or(u32::MAX);
        self.until(match self.deadline {
            Some(end) if parts > 1 => {
                let now = Instant::now();
                Some(now + end.saturating_duration_since(now) / parts)
            }
            end => end,
        })
    }

    fn until(&self, deadline: Option<Instant>) -> Self {
        let (started, interrupted) = (self.started, self.interrupted.clone());
        let own = Self::new(self.max_trials, None);
        Self { max_total: self.max_total, deadline, started, interrupted, ..own }
    }

    /// Seconds since the call began.
    pub fn elapsed(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Whether a deadline was set.
    pub fn has_deadline(&self) -> bool {
        self.deadline.is_some()
    }

    /// Seconds left, if there is a deadline.
    #[allow(clippy::disallowed_methods, reason = "the engine keeps deadlines; trials never see the clock")]
    pub fn seconds_left(&self) -> Option<f64> {
        self.deadline.map(|end| end.saturating_duration_since(Instant::now()).as_secs_f64())
    }

    /// Whether time is up.
    #[allow(clippy::disallowed_methods, reason = "the engine keeps deadlines; trials never see the clock")]
    pub fn is_over(&self) -> bool {
        self.deadline.is_some_and(|end| Instant::now() >= end)
    }

    /// Somebody wants it to stop.
    pub fn interrupt(&self) {
        self.interrupted.store(true, Ordering::Relaxed);
    }

    /// Whether somebody wanted it to stop.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    /// The next outcome is not there: nothing that follows it is read in this part of the budget.
    pub fn lack(&self) {
        self.lacks.store(true, Ordering::Relaxed);
    }

    /// Whether no more should be started, for any of these reasons.
    pub fn must_stop(&self) -> bool {
        self.is_interrupted() || self.lacks.load(Ordering::Relaxed) || self.is_over()
    }

    /// Why no more is started, once none should be.
    pub fn stopped_by(&self) -> Stop {
        match (self.is_interrupted(), self.lacks.load(Ordering::Relaxed)) {
            (true, _) => Stop::Interrupt,
            (false, true) => Stop::Missing,
            (false, false) => Stop::Deadline,
        }
    }

    /// Why no more should be started, if that is so.
    pub fn reason_to_stop(&self) -> Option<Stop> {
        self.must_stop().then(|| self.stopped_by())
    }

    /// Whether what was begun should be left too: some time has passed since no more should be started.
    #[allow(clippy::disallowed_methods, reason = "the engine keeps deadlines; trials never see the clock")]
    pub fn is_late(&self) -> bool {
        self.must_stop() && self.stopped.get_or_init(Instant::now).elapsed().as_secs_f64() > self.grace()
    }

    /// Seconds that explanations may still take after the end.
    pub fn grace(&self) -> f64 {
        let most = if self.is_interrupted() { PROMPT_GRACE } else { MOST_GRACE };
        self.deadline.map_or(most, |deadline| {
            let given = deadline.saturating_duration_since(self.started).as_secs_f64();
            (SHARE_OF_GRACE * given).clamp(LEAST_GRACE, most)
        })
    }
}
