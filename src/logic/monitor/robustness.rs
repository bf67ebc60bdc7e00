//! Robustness: by how much a trial satisfies or violates a formula.
//!
//! Space robustness after Fainekos and Pappas 2009 and Donzé and Maler 2010: an atom has a signed margin, "not" turns
//! the sign, "and" is the smaller, "or" the larger. Its sign is the verdict; zero may be either. Online, with
//! a lower and an upper bound: margins that are still to come lie between minus and plus infinity
//! (Deshmukh et al. 2017). Each bound alone is a positive lattice formula of the margins, so the plan of
//! the Boolean monitor serves as it is.

use super::FIRST_STEP;
use super::calendar::Calendar;
use super::cell::{Cell, Context, Machine, Ref};
use super::plan::{Answer, Plan};
use super::track::select;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::tick::{Clock, Tick};
use crate::logic::formula::{NodeId, Tree};
use crate::logic::invalid::Invalid;
use crate::logic::reach::Part;

/// What is known of a margin in eight lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bounds {
    lower: Lanes,
    upper: Lanes,
}

impl Bounds {
    const OPEN: Self = Self { lower: Lanes::splat(f64::NEG_INFINITY), upper: Lanes::splat(f64::INFINITY) };
    const FALSE: Self =
        Self { lower: Lanes::splat(f64::NEG_INFINITY), upper: Lanes::splat(f64::NEG_INFINITY) };
    const TRUE: Self = Self { lower: Lanes::splat(f64::INFINITY), upper: Lanes::splat(f64::INFINITY) };

    /// A margin that is known. One that is no number counts as false.
    fn known(margin: Lanes) -> Self {
        let margin = margin.map(|m| if m.is_nan() { f64::NEG_INFINITY } else { m });
        Self { lower: margin, upper: margin }
    }

    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self { lower: self.lower.zip(other.lower, &f), upper: self.upper.zip(other.upper, &f) }
    }

    fn or(self, other: Self) -> Self {
        self.zip(other, |x, y| if y > x { y } else { x })
    }

    fn and(self, other: Self) -> Self {
        self.zip(other, |x, y| if y < x { y } else { x })
    }

    fn negated(self, negated: bool) -> Self {
        if negated { Self { lower: self.upper.map(|m| -m), upper: self.lower.map(|m| -m) } } else { self }
    }

    /// This in the lanes of the set, the other elsewhere.
    fn within(self, lanes: u8, other: Self) -> Self {
        Self { lower: select(lanes, self.lower, other.lower), upper: select(lanes, self.upper, other.upper) }
    }
}

/// What the monitor knows of one cell.
#[derive(Clone, Debug)]
struct Margin {
    /// Of the present state, or the answer at the only position.
    now: Bounds,
    /// Of the last positions.
    ring: Box<[Bounds]>,
    /// Positions so far back may still change.
    latency: u64,
    /// Positions so far back are still looked at.
    kept: u64,
    /// Of a scan: what the first operand was at all states so far. Of a count: the settled part.
    so_far: Bounds,
    /// Of a count: lanes in which the last position has come.
    complete: u8,
}

impl Margin {
    fn at(&self, at: u64) -> Bounds {
        self.ring[at as usize & (self.ring.len() - 1)]
    }

    fn store(&mut self, at: u64, bounds: Bounds) {
        let k = at as usize & (self.ring.len() - 1);
        self.ring[k] = bounds;
    }
}

/// The robustness monitor of one formula over eight lanes.
#[derive(Clone, Debug)]
pub struct Robustness {
    cells: Vec<Cell>,
    margins: Vec<Margin>,
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
        let plan = Plan::new(tree, Part::Node(root), horizon, clock, false)?;
        let mut margins = Vec::with_capacity(plan.cells.len());
        for (cell, &(latency, kept)) in plan.cells.iter().zip(&plan.spans) {
            match cell.machine {
                Machine::CompareHeld(..) | Machine::CompareLate(..) => return Err(Invalid::NoMargin),
                _ => {}
            }
            let states = if cell.track.is_kept() { (kept + 1).next_power_of_two() as usize } else { 1 };
            margins.push(Margin {
                now: Bounds::OPEN,
                ring: vec![Bounds::OPEN; states].into_boxed_slice(),
                latency,
                kept,
                so_far: Bounds::OPEN,
                complete: 0,
            });
        }
        Ok(Self {
            cells: plan.cells,
            margins,
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
            step(&mut self.cells, &mut self.margins, k, margins, &context);
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
            margin.now = Bounds::OPEN.within(fresh, margin.now);
            let empty =
                if matches!(cell.machine, Machine::Count { .. }) { Bounds::FALSE } else { Bounds::TRUE };
            margin.so_far = empty.within(fresh, margin.so_far);
            margin.complete &= !fresh;
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

/// A child at a position of its parent.
fn bounds(margins: &[Margin], child: Ref, at: u64, now: u64) -> Bounds {
    let at = at + child.ahead;
    if at > now { Bounds::OPEN } else { margins[child.cell].at(at).negated(child.negated) }
}

fn present(margins: &[Margin], child: Ref) -> Bounds {
    margins[child.cell].now.negated(child.negated)
}

fn step(cells: &mut [Cell], margins: &mut [Margin], k: usize, atoms: &[Lanes], cx: &Context) {
    let (before, rest) = cells.split_at_mut(k);
    let (below, own) = margins.split_at_mut(k);
    let (cell, own) = (&mut rest[0], &mut own[0]);
    let now = cx.now;
    match &cell.machine {
        Machine::Atom(atom) => {
            own.now = Bounds::known(atoms.get(*atom).copied().unwrap_or(Lanes::splat(f64::NAN)));
        }
        Machine::CompareNow(relation, x, y) => {
            own.now = Bounds::known(before[*x].value.zip(before[*y].value, |x, y| relation.margin(x, y)));
        }
        Machine::AnyNow(children) | Machine::AnyHeld(children) => {
            own.now = children.iter().fold(Bounds::FALSE, |all, child| all.or(present(below, *child)));
        }
        Machine::Capture(child) => {
            own.now = present(below, *child).within(cell.need & cx.work, own.now);
        }
        Machine::Scan { first, second } => {
            let open = cell.need & cx.work;
            // The lower bound of what was reached is what counts once the window is over.
            let reached = Bounds { upper: own.now.lower, ..own.now };
            let reached = reached.or(present(below, *second).and(own.so_far));
            let goes_on = first.map_or(own.so_far, |first| own.so_far.and(present(below, first)));
            let upper = reached.or(goes_on).upper;
            let upper = select(cell.last, reached.upper, upper);
            own.now = Bounds { lower: reached.lower, upper }.within(open, own.now);
            own.so_far = goes_on.within(open, own.so_far);
        }
        Machine::Count { child, .. } => {
            own.complete |= cell.last;
            let span = &below[child.cell];
            let oldest = now - span.kept;
            let mut all = own.so_far;
            for at in oldest..=now {
                let needed = before[child.cell].track.needed(at);
                all = all.or(span.at(at).negated(child.negated)).within(needed, all);
                if at == oldest {
                    own.so_far = all;
                }
            }
            let upper = select(own.complete, all.upper, Bounds::OPEN.upper);
            own.now = Bounds { lower: all.lower, upper }.within(cx.work & cell.live, own.now);
        }
        Machine::AnyLate { children, cut } => {
            for at in now - own.latency..=now {
                let mut all = Bounds::FALSE;
                for child in children {
                    let mut one = bounds(below, *child, at, now);
                    if *cut && at + child.ahead > now {
                        one = Bounds::FALSE.within(cx.ending, one);
                    }
                    all = all.or(one);
                }
                own.store(at, all);
            }
        }
        Machine::Chain { first, second } => {
            let mut next = Bounds::FALSE.within(cx.ending, Bounds::OPEN);
            for at in (now - own.latency..=now).rev() {
                let goes_on = first.map_or(next, |first| next.and(bounds(below, first, at, now)));
                next = bounds(below, *second, at, now).or(goes_on);
                own.store(at, next);
            }
        }
        Machine::Watch(_) => {}
        // Numbers of the present state are those of the Boolean monitor.
        _ => cell.step(before, cx),
    }
    late(cell, own, cx);
}

/// What is the same for all cells with a track.
fn late(cell: &mut Cell, own: &mut Margin, cx: &Context) {
    if !cell.track.is_kept() {
        return;
    }
    cell.track.begin(cx.now, 0, cell.need);
    if !matches!(cell.machine, Machine::AnyLate { .. } | Machine::Chain { .. }) {
        let present = own.now;
        own.store(cx.now, present);
    } else if cell.single {
        for at in cx.now - own.latency..=cx.now {
            own.now = own.at(at).within(cell.track.needed(at) & cx.work, own.now);
        }
    }
}
