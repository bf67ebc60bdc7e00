//! Monitors of trials in continuous time: the trace is a signal that is constant between jumps.
//!
//! Formulas, nested ones too, are evaluated exactly: a truth over time is a union of intervals with open or
//! closed ends (Maler and Nickovic 2004, "Monitoring temporal properties of continuous signals"), built from
//! the jumps as they come, and a verdict falls as soon as the values seen force it, as for states. Signals are
//! continuous from the right: the state at an instant is the last one that began there.

mod average;
mod cells;
mod direct;
mod glance;
mod integral;
mod moment;
mod number;
mod plan;
mod question;
mod reading;
pub mod robustness;
mod stream;
mod track;
mod truth;
mod until;

use super::formula::{NodeId, TermId, Tree};
use super::invalid::Invalid;
use super::present::Present;
use super::reach::Part;
use crate::base::decimal::Decimal;
use crate::base::instant::Instant;
use crate::base::tick::Tick;
use direct::Stay;
pub use glance::Glance;
use moment::{Moment, Scale};
use plan::plan;
use question::{Watched, Way};
pub use reading::Reading;

/// The monitor of one formula or metric, one trial at a time.
///
/// The bounds of the tree and the horizon are in ticks of `quantum` seconds each: any length of which all of them are
/// whole multiples. Nothing is allocated per jump once a trial of the usual length has been seen.
#[derive(Clone, Debug)]
pub struct SignalMonitor {
    present: Present,
    way: Way,
    scale: Scale,
    begun: bool,
    /// Since when the present state holds.
    since: Instant,
    moment: Moment,
    horizon: Instant,
    reading: Option<Reading>,
    decided_at: f64,
    watched: Vec<Watched>,
    triggered: u64,
}

impl SignalMonitor {
    /// The monitor of the formula `root`, asked about at time 0 of trials that last up to `horizon`.
    ///
    /// # Errors
    /// When a bound looks beyond the horizon, a window is empty, the tree is malformed, too deep or too large,
    /// the quantum is not positive, or it has a sum over time, or a time or a time average that moves with a window and
    /// is not compared with a constant.
    pub fn formula(tree: &Tree, root: NodeId, horizon: Tick, quantum: Decimal) -> Result<Self, Invalid> {
        Self::of(tree, Part::Node(root), horizon, quantum)
    }

    /// The monitor of the metric `root`, with the same conditions. Times are in seconds, `mean` is the time average.
    ///
    /// # Errors
    /// As for a formula.
    pub fn metric(tree: &Tree, root: TermId, horizon: Tick, quantum: Decimal) -> Result<Self, Invalid> {
        Self::of(tree, Part::Term(root), horizon, quantum)
    }

    fn of(tree: &Tree, root: Part, horizon: Tick, quantum: Decimal) -> Result<Self, Invalid> {
        let (present, way, scale, watched) = plan(tree, root, horizon, quantum)?;
        let horizon = scale.horizon();
        let mut monitor = Self {
            present,
            way,
            scale,
            begun: false,
            since: Instant::exactly(0.0),
            moment: 0,
            horizon,
            reading: None,
            decided_at: 0.0,
            watched,
            triggered: 0,
        };
        monitor.start();
        Ok(monitor)
    }

    /// A new trial begins; what was known of the last one is forgotten.
    pub fn start(&mut self) {
        (self.begun, self.since, self.moment) = (false, Instant::exactly(0.0), 0);
        (self.reading, self.decided_at, self.triggered) = (None, 0.0, 0);
        match &mut self.way {
            Way::Direct(direct) => direct.clear(),
            Way::Cells(cells) => cells.clear(),
        }
    }

    /// From `time` (in seconds) on these values hold; before it the last ones did. The first call is about time 0.
    /// A state that lasts no time is as if it had not been: of several calls for one time the last one
    /// counts. So a state is judged when the next one comes, and what is returned may have been forced
    /// earlier: see [`Self::decided_at`]. A time before the last one is taken as that one, atoms and
    /// signals that are missing as false and as no number. Once there is a reading, the rest of the
    /// trial is ignored.
    #[inline]
    pub fn jump(&mut self, time: impl Into<Instant>, atoms: &[bool], signals: &[f64]) -> Option<Reading> {
        let at = time.into();
        if self.reading.is_some() {
            return self.reading;
        }
        if self.begun {
            if self.since.is_before(at) {
                self.close(if self.horizon.is_before(at) { Instant::from(f64::INFINITY) } else { at });
                if self.reading.is_some() {
                    return self.reading;
                }
                self.since = at;
            }
        } else {
            self.begun = true;
        }
        self.present.read(atoms, signals);
        None
    }

    /// The trial has reached its horizon, with the last values holding there.
    pub fn finish(&mut self) -> Reading {
        if !self.begun {
            self.begun = true;
            self.present.read(&[], &[]);
        }
        if self.reading.is_none() {
            self.close(Instant::from(f64::INFINITY));
        }
        self.reading.unwrap_or(Reading::Unresolved)
    }

    /// The present state lasts to before `end`.
    #[inline]
    fn close(&mut self, end: Instant) {
        for (k, watched) in self.watched.iter().enumerate() {
            let is_asked = !watched.last.is_before(self.since) && watched.first.is_before(end);
            if is_asked && self.present.truth(watched.slot) {
                self.triggered |= 1 << k.min(63);
            }
        }
        match &mut self.way {
            Way::Direct(direct) => {
                if let Some((reading, at)) = direct.step(Stay { start: self.since, end }, &self.present) {
                    (self.reading, self.decided_at) = (Some(reading), at);
                }
            }
            Way::Cells(cells) => {
                let is_over = end.seconds == f64::INFINITY;
                let to = if is_over { self.scale.end() } else { self.scale.at(end) };
                if to > self.moment {
                    if let Some((reading, at)) = cells.step(self.moment, to, &self.present) {
                        (self.reading, self.decided_at) = (Some(reading), self.scale.seconds(at));
                    }
                    self.moment = to;
                }
            }
        }
    }

    /// Number of implications whose left sides are conditions of one state.
    pub fn implications(&self) -> usize {
        self.watched.len()
    }

    /// Those of them that the present or last trial triggered, bit k for the k-th (the 64th stands for all
    /// beyond). One that no trial ever triggers holds for want of a case. Of a trial without a reading the last state may
    /// last on, and counts.
    pub fn triggered(&self) -> u64 {
        if !self.begun || self.reading.is_some() {
            return self.triggered;
        }
        let perhaps =
            |watched: &Watched| !watched.last.is_before(self.since) && self.present.truth(watched.slot);
        let last = self.watched.iter().enumerate().filter(|(_, watched)| perhaps(watched));
        last.fold(self.triggered, |all, (k, _)| all | 1 << k.min(63))
    }

    /// The reading, if there is one.
    pub fn reading(&self) -> Option<Reading> {
        self.reading
    }

    /// The earliest time in seconds up to which (or right after which) the values forced the reading.
    pub fn decided_at(&self) -> f64 {
        self.decided_at
    }
}
