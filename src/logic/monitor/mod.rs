//! Online monitors: true, false or open, for eight trials at once.
//!
//! A monitor reads the states of eight lanes one by one and settles its formula, or its metric, at the
//! first state at which the values of the operands force it (Kleene's strong three-valued connectives
//! over the bounded operators unfolded; Given-Wilson et al. 2017, equation (7), gives the operators). It
//! asks each part only about the positions that the windows above it can reach, and it keeps no more
//! states than bounds and horizon make necessary. Nothing is allocated after construction.

mod boolean;
mod calendar;
mod cell;
mod margins;
mod numbers;
mod plan;
pub mod robustness;
mod step;
mod track;

use super::formula::{NodeId, TermId, Tree};
use super::invalid::Invalid;
use super::reach::Part;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::tick::{Clock, Tick};
use calendar::Calendar;
use cell::{Cell, Context, Machine, Place};
use plan::{Answer, Plan, Watch, Watched};

/// Steps are counted from here, so that positions before the first one are numbers too.
const FIRST_STEP: u64 = 1 << 40;

/// An implication `a => b` inside a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Antecedent {
    /// The implication: the `Or` whose first operand is a `Not`.
    pub implication: NodeId,
    /// Lanes in whose trial `a` was true at a position that the formula asks about, up to the state at
    /// which the lane was decided or the last one it was shown, or, if it looks ahead, was left open at one.
    pub triggered: Mask,
}

/// The monitor of one formula or metric over eight lanes.
#[derive(Clone, Debug)]
pub struct Monitor {
    cells: Vec<Cell>,
    calendar: Calendar,
    answer: Answer,
    watches: Vec<Watched>,
    clock: Clock,
    now: u64,
    starting: u8,
    running: u8,
    decided: u8,
    truth: u8,
    value: Lanes,
    /// Own position of the last state that counts: the one at which the lane was decided, or after which it was left out.
    shown: [Option<u64>; LANES],
}

impl Monitor {
    /// The monitor of the formula `root`, asked about at the first state of trials whose last state is
    /// the one at `horizon`.
    ///
    /// # Errors
    /// When a bound looks beyond the horizon, a window is empty, the tree is malformed, too deep or too
    /// large, or the clock has no steps.
    pub fn formula(tree: &Tree, root: NodeId, horizon: Tick, clock: Clock) -> Result<Self, Invalid> {
        Plan::new(tree, Part::Node(root), horizon, clock, false).map(|plan| Self::of(plan, clock))
    }

    /// The monitor of the metric `root`, with the same conditions. Times are in seconds of the clock.
    ///
    /// # Errors
    /// As for a formula.
    pub fn metric(tree: &Tree, root: TermId, horizon: Tick, clock: Clock) -> Result<Self, Invalid> {
        Plan::new(tree, Part::Term(root), horizon, clock, false).map(|plan| Self::of(plan, clock))
    }

    fn of(plan: Plan, clock: Clock) -> Self {
        Self {
            cells: plan.cells,
            calendar: Calendar::new(plan.turns),
            answer: plan.answer,
            watches: plan.watches,
            clock,
            now: FIRST_STEP,
            starting: 0,
            running: 0,
            decided: 0,
            truth: 0,
            value: Lanes::ZERO,
            shown: [None; LANES],
        }
    }

    /// A new trial begins in this lane; the next `observe` with this lane shows its first state. What was
    /// known of the lane's last trial is forgotten. Lanes beyond the eighth are ignored.
    pub fn start(&mut self, lane: usize) {
        if lane < LANES {
            let bit = 1 << lane;
            self.starting |= bit;
            self.running &= !bit;
            self.decided &= !bit;
            self.truth &= !bit;
            self.shown[lane] = None;
        }
    }

    /// The next state of these lanes. Atoms and signals that are missing count as false and as no number.
    /// A lane that goes on is in every call until it is decided: the trial of a lane that is left out is
    /// over, and the lane stays open until it is started again.
    #[inline]
    pub fn observe(&mut self, lanes: Mask, atoms: &[Mask], signals: &[Lanes]) {
        self.now += 1;
        if (self.starting & lanes.0) | (self.running & !lanes.0) != 0 {
            self.exchange(lanes);
        }
        let work = self.running & !self.decided;
        if work == 0 {
            return;
        }
        let ending = self.calendar.advance(self.now, &mut self.cells);
        let context = Context {
            now: self.now,
            work,
            ending,
            starts: &self.calendar.starts,
            atoms,
            signals,
            clock: self.clock,
        };
        for k in 0..self.cells.len() {
            let (before, rest) = self.cells.split_at_mut(k);
            rest[0].step(before, &context);
        }
        self.conclude(work);
    }

    /// Starts and ends trials.
    #[cold]
    fn exchange(&mut self, lanes: Mask) {
        let ended = self.running & !lanes.0;
        self.running &= lanes.0;
        for lane in Mask(ended & !self.decided).iter() {
            self.shown[lane] = Some(self.now - 1 - self.calendar.starts[lane]);
        }
        self.calendar.stop(Mask(ended));
        let fresh = self.starting & lanes.0;
        if fresh != 0 {
            self.starting &= !fresh;
            self.running |= fresh;
            for cell in &mut self.cells {
                cell.start(fresh);
            }
            for lane in Mask(fresh).iter() {
                self.calendar.start(lane, self.now);
            }
        }
    }

    #[inline(always)]
    fn conclude(&mut self, work: u8) {
        let (t, f) = match self.answer {
            Answer::Truth(constant) => (if constant { 0xff } else { 0 }, if constant { 0 } else { 0xff }),
            Answer::Value(_) => (0xff, 0),
            Answer::Formula(child) => cell::truth(&self.cells, child),
            Answer::Metric(child) => {
                (if child.place == Place::Fixed { 0xff } else { self.cells[child.cell].t }, 0)
            }
        };
        let fresh = work & (t | f);
        if fresh == 0 {
            return;
        }
        self.decided |= fresh;
        self.truth |= fresh & t;
        let value = match self.answer {
            Answer::Value(constant) => Lanes::splat(constant),
            Answer::Metric(child) => self.cells[child.cell].value,
            Answer::Truth(_) | Answer::Formula(_) => Lanes::ZERO,
        };
        for lane in Mask(fresh).iter() {
            self.value.0[lane] = value.0[lane];
            self.shown[lane] = Some(self.now - self.calendar.starts[lane]);
        }
        self.calendar.stop(Mask(fresh));
    }

    /// The lanes whose trial is decided.
    pub fn decided(&self) -> Mask {
        Mask(self.decided)
    }

    /// The decided lanes in which the formula is true.
    pub fn truth(&self) -> Mask {
        Mask(self.truth & self.decided)
    }

    /// The metric in the decided lanes.
    pub fn value(&self) -> Lanes {
        self.value
    }

    /// The own position of each decided lane's state at which it was decided, the first state being 0.
    pub fn decided_at(&self) -> [u64; LANES] {
        self.shown.map(|at| at.unwrap_or(0))
    }

    /// The formula's truth if it does not depend on any state.
    pub fn constant(&self) -> Option<bool> {
        match self.answer {
            Answer::Truth(constant) => Some(constant),
            _ => None,
        }
    }

    /// The implications of the formula, and the lanes whose present or last trial triggered them. An
    /// implication that no trial ever triggered holds for want of a case.
    pub fn antecedents(&self) -> impl Iterator<Item = Antecedent> {
        self.watches.iter().map(|watched| {
            let always = if watched.always { 0xff } else { 0 };
            let triggered = |all, watch: &Watch| all | self.cells[watch.cell].t | self.left_open(*watch);
            let triggered = watched.watches.iter().fold(always, triggered);
            // A trial that was shown no state has no case, whatever the one before it in its lane had.
            Antecedent { implication: watched.implication, triggered: Mask(triggered & !self.starting) }
        })
    }

    /// Lanes in which nobody knows whether an antecedent was true at each state that it was asked about: it looks ahead, and
    /// the trial was decided, or was shown no more, before all were settled.
    fn left_open(&self, watch: Watch) -> u8 {
        let Machine::Watch { child, settled } = &self.cells[watch.cell].machine else { return 0 };
        let is_open = |lane: usize| {
            let Some(last) = self.last_shown(lane).filter(|last| *last >= watch.first) else { return false };
            match child.place {
                Place::Held => settled[lane] == 0,
                // What is of one state is known where it is asked about.
                Place::Now => child.ahead > 0 && last < watch.last + child.ahead,
                _ => settled[lane] <= last.min(watch.last) - watch.first,
            }
        };
        (0..LANES).filter(|lane| is_open(*lane)).fold(0, |open, lane| open | 1 << lane)
    }

    /// Own position of the last state that counts in a lane, if there was one.
    fn last_shown(&self, lane: usize) -> Option<u64> {
        let is_watched = self.running & !self.decided & 1 << lane != 0;
        if is_watched { Some(self.now - self.calendar.starts[lane]) } else { self.shown[lane] }
    }

    /// Bytes that the monitor holds. The number never changes.
    pub fn bytes(&self) -> usize {
        let cells: usize = self.cells.iter().map(Cell::bytes).sum();
        size_of::<Self>()
            + cells
            + self.calendar.bytes()
            + self.watches.iter().map(|watched| size_of_val(&*watched.watches)).sum::<usize>()
    }
}
