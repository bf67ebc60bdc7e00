//! Robustness in continuous time: by how much a signal satisfies or violates a formula.
//!
//! Margins, and the smallest and largest values of windows as for states (see `monitor/robustness.rs`), over all
//! instants of closed intervals: on a signal that is constant between jumps they are values of its pieces
//! (Donzé and Maler 2010). The cells are those of the Boolean monitor; instead of a truth each holds a lower and
//! an upper bound of a margin, so that the sign is known where the verdict falls.

mod cells;
mod fold;
mod reader;

use super::moment::{Moment, Scale};
use super::plan::plan_cells;
use crate::base::decimal::Decimal;
use crate::base::instant::Instant;
use crate::base::tick::Tick;
use crate::logic::formula::{NodeId, Tree};
use crate::logic::invalid::Invalid;
use crate::logic::present::Present;
use cells::Cells;

/// Bounds of a margin: its least and its greatest possible value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least.
    pub lower: f64,
    /// The most.
    pub upper: f64,
}

impl Bounds {
    const OPEN: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// Whether the margin is known.
    pub fn is_settled(self) -> bool {
        self.lower == self.upper
    }
}

/// The robustness monitor of one formula, one trial at a time.
#[derive(Clone, Debug)]
pub struct SignalRobustness {
    present: Present,
    cells: Cells,
    scale: Scale,
    horizon: Instant,
    closely: bool,
    begun: bool,
    since: Instant,
    moment: Moment,
    bounds: Bounds,
    at_start: f64,
    overfull: bool,
}

impl SignalRobustness {
    /// The robustness of the formula `root` at time 0 of trials that last up to `horizon`, in ticks of `quantum`
    /// seconds.
    ///
    /// # Errors
    /// As for a monitor of signals, and where a comparison has no margin.
    pub fn new(tree: &Tree, root: NodeId, horizon: Tick, quantum: Decimal) -> Result<Self, Invalid> {
        let (present, truths, root, scale) = plan_cells(tree, root, horizon, quantum)?;
        let cells = Cells::new(truths, root)?;
        let horizon = scale.horizon();
        let mut made = Self {
            present,
            cells,
            scale,
            horizon,
            closely: false,
            begun: false,
            since: Instant::exactly(0.0),
            moment: 0,
            bounds: Bounds::OPEN,
            at_start: f64::NEG_INFINITY,
            overfull: false,
        };
        made.start();
        Ok(made)
    }

    /// The same, which also says what was known at the beginning of the state judged last.
    #[must_use]
    pub fn closely(self) -> Self {
        Self { closely: true, ..self }
    }

    /// A new trial begins.
    pub fn start(&mut self) {
        (self.begun, self.since, self.moment) = (false, Instant::exactly(0.0), 0);
        (self.bounds, self.at_start, self.overfull) = (Bounds::OPEN, f64::NEG_INFINITY, false);
        self.cells.clear();
    }

    /// From `time` (in seconds) on these signals hold; as for a monitor of signals the state before it is judged
    /// now. Atoms, where the formula has some, are infinitely far from the other answer.
    pub fn jump(&mut self, time: impl Into<Instant>, atoms: &[bool], signals: &[f64]) -> Bounds {
        let at = time.into();
        if self.begun && self.since.is_before(at) {
            self.close(if self.horizon.is_before(at) { Instant::from(f64::INFINITY) } else { at });
            self.since = at;
        }
        self.begun = true;
        if !self.bounds.is_settled() {
            self.present.measure(atoms, signals);
        }
        self.bounds
    }

    /// The trial has reached its horizon, with the last values holding there.
    pub fn finish(&mut self) -> Bounds {
        if !self.begun {
            self.jump(0.0, &[], &[]);
        }
        self.close(Instant::from(f64::INFINITY));
        self.bounds
    }

    /// Of one that looks [closely](Self::closely): the least that the robustness could be by what was seen up to and
    /// right after the beginning of the state judged last.
    pub fn at_start(&self) -> f64 {
        self.at_start
    }

    /// Whether the trial needs more stored pieces than are possible.
    pub fn is_overfull(&self) -> bool {
        self.overfull
    }

    fn close(&mut self, end: Instant) {
        let to = if end.seconds == f64::INFINITY { self.scale.end() } else { self.scale.at(end) };
        if to <= self.moment || self.overfull || self.bounds.is_settled() {
            self.at_start = self.bounds.lower;
            return;
        }
        let last = to >= self.scale.end();
        if self.closely {
            // The instant, and right after it.
            let soon = to.min(self.moment + 2);
            self.step(soon, last && soon == to);
            self.at_start = self.bounds.lower;
            self.moment = soon;
        }
        if to > self.moment {
            self.step(to, last);
            self.moment = to;
        }
    }

    fn step(&mut self, to: Moment, last: bool) {
        match self.cells.step(to, last, &self.present) {
            Some((lower, upper)) => self.bounds = Bounds { lower, upper },
            None => self.overfull = true,
        }
    }
}
