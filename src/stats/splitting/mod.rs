//! Importance splitting: probabilities far below one over the number of trials.
//!
//! A path has a level that never falls, and reaches the event at its highest. Where few paths get far, those that do
//! are continued several times from where they were, each with fresh random numbers. Estimates are
//! unbiased whatever the level is; how much they scatter depends on it. So the runs together certify a lower bound, and
//! no upper one: intervals are asymptotic, and where the level does not see the way on which the event mostly comes,
//! they are far too low.

mod adaptive;
mod effort;
mod floor;
mod spread;

pub use adaptive::Adaptive;
pub use effort::Effort;
pub use floor::floor;
pub use spread::{Spread, student};

use super::invalid::Invalid;
use super::spec::{Chosen, DELTA, Make};
use crate::base::random::{Purpose, Stream, TrialKey};
use serde::{Deserialize, Serialize};

/// How a rare event is split into less rare ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    /// Whether levels are found on the way (else by a pilot run, with as many paths at each).
    pub adaptive: bool,
    /// Paths of a run.
    pub replicas: u64,
    /// Independent runs.
    pub runs: u64,
    /// Paths given up at each level, at least.
    pub kill: u64,
    /// Plain trials that are made first.
    pub plain: u64,
    /// Error of the interval and of the bound.
    pub delta: f64,
}

impl Rule {
    /// That of a procedure, if it is one of splitting.
    pub fn of(chosen: &Chosen) -> Option<Self> {
        let Make::Splitting { adaptive } = chosen.spec.make else { return None };
        let whole = |name| chosen.value(name) as u64;
        Some(Self {
            adaptive,
            replicas: whole("replicas"),
            runs: whole("runs"),
            kill: whole("kill"),
            plain: whole("plain"),
            delta: chosen.value(DELTA.name),
        })
    }

    /// Its numbers for reports.
    pub fn numbers(self) -> Vec<(&'static str, f64)> {
        let kill = self.adaptive.then_some(("kill", self.kill as f64));
        let mut numbers = vec![("replicas", self.replicas as f64), ("runs", self.runs as f64)];
        numbers.extend(kill);
        numbers.extend([("plain", self.plain as f64), (DELTA.name, self.delta)]);
        numbers
    }
}

/// What one path came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flight {
    /// Times at which the level rose, and to what; both ascend. Infinite where the event was reached.
    rises: Vec<(u64, f64)>,
}

impl Flight {
    /// At `time` the path is at `level`; what is no rise is ignored.
    pub fn rise(&mut self, time: u64, level: f64) {
        if level > self.level() {
            self.rises.push((time, level));
        }
    }

    /// The highest level.
    pub fn level(&self) -> f64 {
        self.rises.last().map_or(f64::NEG_INFINITY, |rise| rise.1)
    }

    /// Whether it reached the event.
    pub fn reached(&self) -> bool {
        self.level() == f64::INFINITY
    }

    /// When its level first was above another.
    pub fn first_above(&self, level: f64) -> Option<u64> {
        let at = self.rises.partition_point(|rise| rise.1 <= level);
        self.rises.get(at).map(|rise| rise.0)
    }
}

/// A path that is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// From the beginning.
    Anew,
    /// From where another one was.
    From {
        /// Its number: paths are counted in the order in which they were wanted.
        path: usize,
        /// The time up to which, that state included, it is the same.
        time: u64,
    },
}

/// One run of a scheme of splitting.
pub trait Scheme {
    /// The paths that are wanted now, in order; none once finished.
    fn wanted(&self) -> &[Start];

    /// Takes what the wanted paths came to, in their order.
    fn feed(&mut self, flights: Vec<Flight>);

    /// The estimate, unbiased once finished: 0 where no path reached the event.
    fn estimate(&self) -> f64;

    /// The levels at which paths were split.
    fn levels(&self) -> &[f64];
}

/// Choices that a run makes for itself, by address.
#[derive(Clone, Debug)]
struct Picks {
    stream: Stream,
    made: u32,
}

impl Picks {
    /// Those of run `run`.
    fn new(seed: u64, run: u16) -> Self {
        let key = TrialKey { seed, index: 0, branch: run };
        // Entity 0 belongs to procedures of trials.
        Self { stream: Stream::of(key, 1, Purpose::Procedure), made: 0 }
    }

    /// One of `count` things, all alike.
    fn pick(&mut self, count: usize) -> usize {
        let u = self.stream.uniform(self.made);
        self.made = self.made.wrapping_add(1);
        let at = (u * count as f64) as usize;
        if at < count { at } else { count - 1 }
    }
}

/// Numbers of paths that make sense.
fn replicas(count: usize) -> Result<usize, Invalid> {
    super::invalid::range("replicas", count as f64, 2.0, 1e6)?;
    Ok(count)
}
