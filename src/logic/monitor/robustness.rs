//! Robustness: by how much a trial satisfies or violates a formula.
//!
//! Space robustness after Fainekos and Pappas 2009 and Donzé and Maler 2010: an atom has a signed margin, "not" turns
//! the sign, "and" is the smaller, "or" the larger. Its sign is the verdict; zero may be either. Online, with
//! a lower and an upper bound: margins that are still to come lie between minus and plus infinity
//! (Deshmukh et al. 2017). Each bound alone is a positive lattice formula of the margins, so the plan of
//! the Boolean monitor serves as it is.

use super::FIRST_STEP;
use super::calendar::Calendar;
use super::cell::{Cell, Context, Machine};
use super::margins::{Bounds, Margin, step};
use super::plan::{Answer, Plan};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::tick::{Clock, Tick};
use crate::logic::formula::{NodeId, Tree};
use crate::logic::invalid::Invalid;
use crate::logic::reach::Part;

/// The robustness monitor of one formula over eight lanes.
#[derive(Clone, Debug)]
pub struct Robustness {
    cells: Vec<Cell>,
    margins: Vec<Margin>,
    scratch: Vec<u64>,
    calendar: Calendar,
    answer: Answer,
    clock: Clock,
    now: u64,
    starting: u8,
    running: u8,
    settled: u8,
    bounds: Bounds,
}

impl Robustness {
    /// The robustness of the formula `root` at the first state of trials whose last state is the one at
    /// `horizon`.
    ///
    /// # Errors
    /// As for a monitor, and where a comparison has no margin.
    pub fn new(tree: &Tree, root: NodeId, horizon: Tick, clock: Clock) -> Result<Self, Invalid> {
        let plan = Plan::new(tree, Part::Node(root), horizon, clock, true)?;
        let mut margins = Vec::with_capacity(plan.cells.len());
        for (cell, &(latency, kept)) in plan.cells.iter().zip(&plan.spans) {
            match cell.machine {
                Machine::CompareHeld(..) | Machine::CompareLate(..) => return Err(Invalid::NoMargin),
                _ => {}
            }
            let states = if cell.track.is_kept() { (kept + 1).next_power_of_two() as usize } else { 1 };
            margins.push(Margin::new(latency, kept, states));
        }
        Ok(Self {
            cells: plan.cells,
            margins,
            scratch: Vec::new(),
            calendar: Calendar::new(plan.turns),
            answer: plan.answer,
            clock,
            now: FIRST_STEP,
            starting: 0,
            running: 0,
            settled: 0,
            bounds: Bounds::OPEN,
        })
    }

    /// A new trial begins in this lane; the next `observe` with this lane shows its first state.
    pub fn start(&mut self, lane: usize) {
        if lane < LANES {
            let bit = 1 << lane;
            self.starting |= bit;
            self.running &= !bit;
            self.settled &= !bit;
            self.bounds = Bounds::OPEN.within(bit, self.bounds);
        }
    }

    /// The next state of these lanes: the signed margin of each atom (positive where it is true), and
    /// the signals. A margin that is missing or no number counts as minus infinity. The trial of a lane
    /// that is left out is over.
    pub fn observe(&mut self, lanes: Mask, margins: &[Lanes], signals: &[Lanes]) {
        self.now += 1;
        self.exchange(lanes);
        let work = self.running & !self.settled;
        if work == 0 {
            return;
        }
        let ending = self.calendar.advance(self.now, &mut self.cells);
        let (clock, now) = (self.clock, self.now);
        let context =
            Context { now, work, ending, starts: &self.calendar.starts, atoms: &[], signals, clock };
        for k in 0..self.cells.len() {
            step(&mut self.cells, &mut self.margins, k, margins, &context, &mut self.scratch);
        }
        self.bounds = match self.answer {
            Answer::Truth(true) => Bounds::TRUE,
            Answer::Truth(false) => Bounds::FALSE,
            Answer::Formula(child) => self.margins[child.cell].now.negated(child.negated),
            // Only formulas are planned here.
            Answer::Value(_) | Answer::Metric(_) => Bounds::OPEN,
        }
        .within(work, self.bounds);
        let fresh = work & self.bounds.lower.compare(self.bounds.upper, |lower, upper| lower == upper).0;
        if fresh != 0 {
            self.settled |= fresh;
            self.calendar.stop(Mask(fresh));
        }
    }

    fn exchange(&mut self, lanes: Mask) {
        let ended = self.running & !lanes.0;
        self.running &= lanes.0;
        self.calendar.stop(Mask(ended));
        let fresh = self.starting & lanes.0;
        if fresh == 0 {
            return;
        }
        self.starting &= !fresh;
        self.running |= fresh;
        for (cell, margin) in self.cells.iter_mut().zip(&mut self.margins) {
            cell.start(fresh);
            margin.start(&cell.machine, fresh);
        }
        for lane in Mask(fresh).iter() {
            self.calendar.start(lane, self.now);
        }
    }

    /// The least that the robustness can be, after the states seen.
    pub fn lower(&self) -> Lanes {
        self.bounds.lower
    }

    /// The most that it can be.
    pub fn upper(&self) -> Lanes {
        self.bounds.upper
    }

    /// The lanes in which it is known.
    pub fn settled(&self) -> Mask {
        Mask(self.settled)
    }
}
