//! Cells that hold a truth over time, and how they learn it from their operands.
//!
//! Every cell settles a moment as soon as what is known of its operands forces it (Kleene's strong
//! connectives over the operators unfolded); what an operand newly knows is all that a cell looks at.

use super::average::Average;
use super::moment::{Moment, instant};
use super::number::Number;
use super::track::{Fresh, Known, Track};
use crate::logic::formula::Relation;
use crate::logic::present::Present;

/// An operand, perhaps negated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ref {
    pub(super) cell: usize,
    pub(super) negated: bool,
}

impl std::ops::Not for Ref {
    type Output = Self;
    fn not(self) -> Self {
        Self { negated: !self.negated, ..self }
    }
}

/// Which moments see that something holds somewhere in a piece.
#[derive(Clone, Copy, Debug)]
pub(super) enum Seen {
    /// Those that have it in the window `from ..= to` ahead.
    Within { from: Moment, to: Moment },
    /// Those from which the time until then is at most `within`, or less than that.
    Soon { within: Moment, strictly: bool },
}

impl Seen {
    /// The moments that see the piece `start .. end`.
    pub(super) fn of(self, start: Moment, end: Moment) -> (Moment, Moment) {
        match self {
            Self::Within { from, to } => (start - to, end - from),
            Self::Soon { within, strictly } => (instant(start) - within + Moment::from(strictly), end),
        }
    }
}

/// How a truth follows from its operands.
#[derive(Clone, Debug)]
pub(super) enum Machine {
    /// The same everywhere.
    Fixed(bool),
    /// A comparison of constants.
    Alike(Relation, f64, f64),
    /// A truth of the present state.
    Present(usize),
    /// Any of them.
    Any(Box<[Ref]>),
    /// Somewhere ahead.
    Reach(Seen, Ref),
    /// The second in the window, the first until then.
    Until { from: Moment, to: Moment, first: Ref, second: Ref },
    /// The operand's only moment, for all.
    Spread(Ref),
    /// Comparison of two numbers.
    Compare(Relation, usize, usize),
    /// Comparison of a time average with a constant.
    Average(Average),
}

impl Machine {
    /// Tells from which moment on the operands are still needed, if what follows from them is open from one on.
    pub(super) fn needs(
        &self,
        open: Moment,
        mut truth: impl FnMut(usize, Moment),
        mut number: impl FnMut(usize, Moment),
    ) {
        match self {
            Self::Fixed(_) | Self::Alike(..) | Self::Present(_) => {}
            Self::Any(operands) => operands.iter().for_each(|x| truth(x.cell, open)),
            Self::Reach(Seen::Within { from, .. }, x) => truth(x.cell, open + from),
            Self::Reach(Seen::Soon { .. }, x) => truth(x.cell, open),
            Self::Until { from, first, second, .. } => {
                truth(second.cell, open + from);
                truth(first.cell, open);
            }
            Self::Spread(x) => truth(x.cell, 0),
            Self::Compare(_, x, y) => {
                number(*x, open);
                number(*y, open);
            }
            Self::Average(average) => number(average.of, instant(open) + average.from),
        }
    }
}

/// A truth over time.
#[derive(Clone, Debug)]
pub(super) struct Truth {
    pub(super) machine: Machine,
    pub(super) track: Track,
    /// Where a comparison goes on, and where the present step began.
    pub(super) cursor: (Moment, Moment),
}

/// The piece of time that a step adds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<'a> {
    pub(super) from: Moment,
    pub(super) to: Moment,
    pub(super) present: &'a Present,
}

/// The known truth of an operand around a moment.
pub(super) fn look(cells: &[Truth], of: Ref, at: Moment) -> (Moment, Moment, Known) {
    let (from, to, known) = cells[of.cell].track.around(at);
    (from, to, known.not_if(of.negated))
}

/// The new knowledge of an operand.
pub(super) fn fresh(cells: &[Truth], of: Ref) -> impl Iterator<Item = Fresh> {
    cells[of.cell].track.fresh.iter().map(move |fresh| Fresh { truth: fresh.truth != of.negated, ..*fresh })
}

impl Truth {
    pub(super) fn new(machine: Machine, first: Moment, end: Moment) -> Self {
        Self { machine, track: Track::new(first, end), cursor: (first, first) }
    }

    pub(super) fn clear(&mut self) {
        self.track.clear();
        self.cursor = (self.track.first, self.track.first);
    }

    /// Keeps what the present step found.
    pub(super) fn keep(&mut self) {
        self.track.fresh.clear();
        self.cursor.1 = self.cursor.0;
    }

    /// Learns from operands that have learnt.
    pub(super) fn step(&mut self, cells: &[Truth], numbers: &[Number], step: &Step) {
        self.keep();
        let track = &mut self.track;
        match &self.machine {
            Machine::Fixed(truth) => track.settle(Moment::MIN, Moment::MAX, *truth),
            Machine::Alike(relation, x, y) => {
                track.settle(Moment::MIN, Moment::MAX, relation.holds(*x, *y));
            }
            Machine::Present(slot) => track.settle(step.from, step.to, step.present.truth(*slot)),
            Machine::Any(operands) => any(track, cells, operands),
            Machine::Reach(seen, operand) => {
                for piece in fresh(cells, *operand) {
                    if piece.truth {
                        let (from, to) = seen.of(piece.from, piece.to);
                        track.settle(from, to, true);
                    } else {
                        never(track, cells, *operand, piece.from, *seen);
                    }
                }
            }
            Machine::Until { from, to, first, second } => {
                super::until::learn(track, cells, (*from, *to), *first, *second);
            }
            Machine::Spread(operand) => {
                if let Some(piece) = fresh(cells, *operand).next() {
                    track.settle(Moment::MIN, Moment::MAX, piece.truth);
                }
            }
            Machine::Compare(relation, x, y) => {
                let (x, y) = (&numbers[*x].stream, &numbers[*y].stream);
                let known = x.known.min(y.known).min(track.end);
                while self.cursor.0 < known {
                    let at = self.cursor.0;
                    let ((x_end, x), (y_end, y)) = (x.around(at), y.around(at));
                    let end = x_end.min(y_end).min(known);
                    track.settle(at, end, relation.holds(x, y));
                    self.cursor.0 = end;
                }
            }
            Machine::Average(average) => {
                average.learn(track, &mut self.cursor.0, &numbers[average.of].stream);
            }
        }
    }

    /// Forgets what the present step found.
    pub(super) fn take_back(&mut self) {
        self.track.take_back();
        self.cursor.0 = self.cursor.1;
    }
}

/// Moments that see nothing but the run of false around `at`.
pub(super) fn never(track: &mut Track, cells: &[Truth], operand: Ref, at: Moment, seen: Seen) {
    let (start, end, _) = look(cells, operand, at);
    let lower = match seen {
        Seen::Within { from, .. } => start - from,
        Seen::Soon { .. } => start,
    };
    // Nothing comes after the last moment that is asked about.
    let upper = if end >= cells[operand.cell].track.end { Moment::MAX } else { seen.of(end, end).0 };
    track.settle(lower, upper, false);
}

fn any(track: &mut Track, cells: &[Truth], operands: &[Ref]) {
    for operand in operands {
        for piece in fresh(cells, *operand) {
            if piece.truth {
                track.settle(piece.from, piece.to, true);
                continue;
            }
            let mut at = piece.from;
            while at < piece.to {
                let mut all = (piece.to, true);
                for other in operands {
                    let (_, end, known) = look(cells, *other, at);
                    if known == Known::False {
                        all.0 = all.0.min(end);
                    } else {
                        all = (end.min(piece.to), false);
                        break;
                    }
                }
                if all.1 {
                    track.settle(at, all.0, false);
                }
                at = all.0;
            }
        }
    }
}
