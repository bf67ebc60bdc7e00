//! The cells of a robustness: those of the Boolean monitor, with two bounds over time instead of a truth.

use super::fold::{self, Way, larger};
use super::reader::Reader;
use crate::logic::invalid::Invalid;
use crate::logic::present::Present;
use crate::logic::signal::moment::{FOREVER, Moment};
use crate::logic::signal::stream::Stream;
use crate::logic::signal::truth::{Machine, Ref, Seen, Truth};

/// Most pieces that are stored; a trial that needs more is unresolved.
const MOST_PIECES: usize = 1 << 20;

/// Pieces up to which everything is worked out at every jump. Beyond, it is done only once so many jumps are
/// new that the work stays in proportion to them.
const FEW_PIECES: usize = 1024;

/// Pieces that are stored without a look at what can go.
const ENOUGH: usize = 256;

/// A cell.
#[derive(Clone, Debug)]
struct Margin {
    machine: Machine,
    /// Lower and upper.
    bounds: [Stream; 2],
    first: Moment,
    end: Moment,
    /// Before this moment both bounds are the same.
    settled: Moment,
    /// Asked about at one moment only: how far it has come.
    way: Way,
}

/// All cells; operands before their parents.
#[derive(Clone, Debug)]
#[allow(clippy::struct_field_names, reason = "they are the cells")]
pub(super) struct Cells {
    cells: Vec<Margin>,
    root: Ref,
    needed: Vec<Moment>,
    bounds: (f64, f64),
    /// Jumps since everything was worked out.
    waited: usize,
    /// Pieces when it was.
    pieces: usize,
    /// Look again for what can go when there are so many.
    limit: usize,
}

fn reader(cells: &[Margin], of: Ref, side: usize) -> Reader<'_> {
    // Turning the sign exchanges the bounds.
    let side = if of.negated { 1 - side } else { side };
    Reader { curve: &cells[of.cell].bounds[side], negated: of.negated }
}

/// Before which moment an operand is settled; one that is so everywhere has no end.
fn settled(cells: &[Margin], of: Ref) -> Moment {
    let cell = &cells[of.cell];
    if cell.settled >= cell.end { Moment::MAX } else { cell.settled }
}

impl Margin {
    fn new(truth: Truth) -> Result<Self, Invalid> {
        let Truth { machine, track, .. } = truth;
        if matches!(machine, Machine::Compare(..) | Machine::Average(_)) {
            return Err(Invalid::NoMargin);
        }
        let (first, end) = (track.first, track.end);
        let curve = Stream::new(first, end);
        Ok(Self { machine, bounds: [curve.clone(), curve], first, end, settled: first, way: Way::new(first) })
    }

    fn clear(&mut self) {
        self.bounds.iter_mut().for_each(Stream::clear);
        self.settled = self.first;
        self.way = Way::new(self.first);
    }

    fn is_single(&self) -> bool {
        self.end == self.first + 1
    }

    /// Of a cell that is asked about at one moment only: what must be so until the goal, and the goal.
    fn way_to(&self) -> Option<(Option<Ref>, Ref)> {
        match &self.machine {
            Machine::Reach(_, goal) if self.is_single() => Some((None, *goal)),
            Machine::Until { first, second, .. } if self.is_single() => Some((Some(*first), *second)),
            _ => None,
        }
    }

    /// The moments that a question asked at the only moment is about: the first, and the last.
    fn window(&self) -> (Moment, Moment) {
        let at = self.first;
        match &self.machine {
            Machine::Reach(Seen::Within { from, to }, _) | Machine::Until { from, to, .. } => {
                (at + from, if *to == FOREVER { Moment::MAX - 1 } else { at + to })
            }
            Machine::Reach(Seen::Soon { within, strictly }, _) => {
                (at, at + within + 1 - 2 * Moment::from(*strictly))
            }
            _ => (at, at),
        }
    }

    /// Notes the present margin up to before `to`.
    fn note(&mut self, to: Moment, present: &Present) {
        let Machine::Present(slot) = self.machine else { return };
        let to = to.min(self.end);
        if to <= self.settled {
            return;
        }
        for bound in &mut self.bounds {
            bound.cut(self.settled);
            bound.extend(to, present.number(slot));
        }
        self.settled = to;
    }

    /// Works out what is not settled.
    fn learn(&mut self, cells: &[Margin]) {
        let from = self.settled;
        if from >= self.end {
            return;
        }
        self.advance(cells);
        for side in 0..2 {
            let unknown = if side == 0 { f64::NEG_INFINITY } else { f64::INFINITY };
            let read = |of: &Ref| reader(cells, *of, side);
            let (window, way_to) = (self.window(), self.way_to());
            let own = &mut self.bounds[side];
            own.cut(from);
            if let Some((hold, goal)) = way_to {
                let (hold, goal, mut way) = (hold.map(|hold| read(&hold)), read(&goal), self.way);
                way.go((hold, goal), self.first, window, goal.curve.end);
                own.extend(self.end, way.best);
                continue;
            }
            match &self.machine {
                Machine::Present(_) => own.extend(self.end, unknown),
                Machine::Fixed(truth) => {
                    own.extend(self.end, if *truth { f64::INFINITY } else { f64::NEG_INFINITY });
                }
                Machine::Alike(relation, x, y) => {
                    let margin = relation.margin(*x, *y);
                    own.extend(self.end, if margin.is_nan() { f64::NEG_INFINITY } else { margin });
                }
                Machine::Any(operands) => {
                    let operands: Vec<Reader<'_>> = operands.iter().map(read).collect();
                    fold::any(own, &operands, from);
                }
                Machine::Reach(seen, x) => fold::slide(own, read(x), from, *seen),
                Machine::Until { from: a, to: b, first: p, second: q } => {
                    fold::until(own, (read(p), read(q)), from, (*a, *b));
                }
                Machine::Spread(x) => {
                    let x = read(x);
                    own.extend(self.end, x.around(x.curve.end - 1).1);
                }
                // Refused when it was made.
                Machine::Compare(..) | Machine::Average(_) => own.extend(self.end, unknown),
            }
        }
        self.settle();
    }

    /// Goes along with operands that are settled, where one moment only is asked about.
    fn advance(&mut self, cells: &[Margin]) {
        let Some((hold, goal)) = self.way_to() else { return };
        let hold_settled = hold.map_or(Moment::MAX, |hold| settled(cells, hold));
        let end = cells[goal.cell].end.min(settled(cells, goal)).min(hold_settled);
        let operands = (hold.map(|hold| reader(cells, hold, 0)), reader(cells, goal, 0));
        self.way.go(operands, self.first, self.window(), end);
    }

    /// Finds how far both bounds are the same.
    fn settle(&mut self) {
        let [lower, upper] = &self.bounds;
        let (lower, upper) =
            (Reader { curve: lower, negated: false }, Reader { curve: upper, negated: false });
        while self.settled < self.end {
            let ((x_end, x), (y_end, y)) = (lower.around(self.settled), upper.around(self.settled));
            if x != y {
                return;
            }
            self.settled = x_end.min(y_end).min(self.end);
        }
    }

    /// Tells from which moment on operands are still needed.
    fn needs(&self, mut need: impl FnMut(usize, Moment)) {
        let open = self.settled;
        if open >= self.end {
            return;
        }
        if let Some((hold, goal)) = self.way_to() {
            for operand in hold.into_iter().chain([goal]) {
                need(operand.cell, self.way.next);
            }
            return;
        }
        self.machine.needs(open, need, |_, _| {});
    }
}

impl Cells {
    pub(super) fn new(truths: Vec<Truth>, root: Ref) -> Result<Self, Invalid> {
        let cells = truths.into_iter().map(Margin::new).collect::<Result<Vec<_>, _>>()?;
        let needed = vec![0; cells.len()];
        let bounds = (f64::NEG_INFINITY, f64::INFINITY);
        Ok(Self { cells, root, needed, bounds, waited: 0, pieces: 0, limit: ENOUGH })
    }

    pub(super) fn clear(&mut self) {
        self.cells.iter_mut().for_each(Margin::clear);
        self.bounds = (f64::NEG_INFINITY, f64::INFINITY);
        (self.waited, self.pieces, self.limit) = (0, 0, ENOUGH);
    }

    /// The present state lasts to before `to`; `last` if nothing comes after it. Bounds of the robustness, or nothing if
    /// there are too many pieces.
    pub(super) fn step(&mut self, to: Moment, last: bool, present: &Present) -> Option<(f64, f64)> {
        for cell in &mut self.cells {
            cell.note(to, present);
        }
        self.waited += 1;
        if !last && self.pieces > FEW_PIECES && self.waited * FEW_PIECES < self.pieces {
            return Some(self.bounds);
        }
        self.waited = 0;
        for k in 0..self.cells.len() {
            let (before, rest) = self.cells.split_at_mut(k);
            rest[0].learn(before);
        }
        let at = self.cells[self.root.cell].first;
        let [lower, upper] = [0, 1].map(|side| reader(&self.cells, self.root, side).around(at).1);
        // Bounds only ever close in.
        self.bounds = (larger(self.bounds.0, lower), fold::smaller(self.bounds.1, upper));
        self.pieces = self.stored();
        if self.pieces > self.limit {
            self.forget();
            self.pieces = self.stored();
            if self.pieces > MOST_PIECES {
                return None;
            }
            self.limit = (2 * self.pieces).max(ENOUGH);
        }
        Some(self.bounds)
    }

    fn stored(&self) -> usize {
        self.cells.iter().map(|cell| cell.bounds[0].len() + cell.bounds[1].len()).sum()
    }

    /// Drops values that are never read again.
    fn forget(&mut self) {
        self.needed.fill(Moment::MAX);
        let needed = &mut self.needed;
        for cell in self.cells.iter().rev() {
            cell.needs(|k, at| needed[k] = needed[k].min(at));
        }
        needed[self.root.cell] = 0;
        for (cell, needed) in self.cells.iter_mut().zip(&self.needed) {
            let before = (*needed).min(cell.settled);
            cell.bounds.iter_mut().for_each(|bound| bound.forget(before));
        }
    }
}
