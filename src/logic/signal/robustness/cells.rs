//! The cells of a robustness: those of the Boolean monitor, with two bounds over time instead of a truth.

use super::curve::{Curve, Reader};
use super::fold::{self, Way, larger};
use crate::logic::invalid::Invalid;
use crate::logic::present::Present;
use crate::logic::signal::moment::{FOREVER, Moment};
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
    bounds: [Curve; 2],
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
        let curve = Curve::new(first, end);
        Ok(Self { machine, bounds: [curve.clone(), curve], first, end, settled: first, way: Way::new(first) })
    }

    fn clear(&mut self) {
        self.bounds.iter_mut().for_each(Curve::clear);
        self.settled = self.first;
        self.way = Way::new(self.first);
    }

    fn is_single(&self) -> bool {
        self.end == self.first + 1
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
            bound.push(to, present.number(slot));
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
            let window = self.window();
            let (single, first, way) = (self.is_single(), self.first, self.way);
            let own = &mut self.bounds[side];
            own.cut(from);
            match &self.machine {
                Machine::Present(_) => own.push(self.end, unknown),
                Machine::Fixed(truth) => {
                    own.push(self.end, if *truth { f64::INFINITY } else { f64::NEG_INFINITY });
                }
                Machine::Alike(relation, x, y) => {
                    let margin = relation.margin(*x, *y);
                    own.push(self.end, if margin.is_nan() { f64::NEG_INFINITY } else { margin });
                }
                Machine::Any(operands) => {
                    let operands: Vec<Reader<'_>> = operands.iter().map(read).collect();
                    fold::any(own, &operands, from);
                }
                Machine::Reach(_, x) if single => {
                    let mut way = way;
                    way.go((None, read(x)), first, window, read(x).curve.end);
                    own.push(self.end, way.best);
                }
                Machine::Until { first: p, second: q, .. } if single => {
                    let mut way = way;
                    way.go((Some(read(p)), read(q)), first, window, read(q).curve.end);
                    own.push(self.end, way.best);
                }
                Machine::Reach(seen, x) => fold::slide(own, read(x), from, *seen),
                Machine::Until { from: a, to: b, first: p, second: q } => {
                    fold::until(own, (read(p), read(q)), from, (*a, *b));
                }
                Machine::Spread(x) => {
                    let x = read(x);
                    own.push(self.end, x.around(x.curve.end - 1).1);
                }
                // Refused when it was made.
                Machine::Compare(..) | Machine::Average(_) => own.push(self.end, unknown),
            }
        }
        self.settle();
    }

    /// Goes along with operands that are settled, where one moment only is asked about.
    fn advance(&mut self, cells: &[Margin]) {
        if !self.is_single() {
            return;
        }
        let (first, window) = (self.first, self.window());
        match &self.machine {
            Machine::Reach(_, x) => {
                let end = cells[x.cell].end.min(settled(cells, *x));
                self.way.go((None, reader(cells, *x, 0)), first, window, end);
            }
            Machine::Until { first: p, second: q, .. } => {
                let end = cells[q.cell].end.min(settled(cells, *p)).min(settled(cells, *q));
                let operands = (Some(reader(cells, *p, 0)), reader(cells, *q, 0));
                self.way.go(operands, first, window, end);
            }
            _ => {}
        }
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
        match &self.machine {
            Machine::Any(operands) => operands.iter().for_each(|x| need(x.cell, open)),
            Machine::Reach(_, x) if self.is_single() => need(x.cell, self.way.next),
            Machine::Until { first, second, .. } if self.is_single() => {
                need(first.cell, self.way.next);
                need(second.cell, self.way.next);
            }
            Machine::Reach(Seen::Within { from, .. }, x) => need(x.cell, open + from),
            Machine::Reach(Seen::Soon { .. }, x) => need(x.cell, open),
            Machine::Until { from, first, second, .. } => {
                need(first.cell, open);
                need(second.cell, open + from);
            }
            Machine::Spread(x) => need(x.cell, 0),
            _ => {}
        }
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
