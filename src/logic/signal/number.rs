//! Cells that hold a number over time, and how they learn it from their operands, in order.

use super::integral::Integral;
use super::moment::{FOREVER, Moment, Scale, instant};
use super::stream::Stream;
use super::track::Known;
use super::truth::{Ref, Step, Truth, look};
use crate::logic::formula::{Aggregation, Operation};

/// How a number follows from its operands.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// The same everywhere.
    Fixed(f64),
    /// A number of the present state.
    Present(usize),
    /// Arithmetic.
    Combine(Operation, usize, usize),
    /// Magnitude.
    Abs(usize),
    /// The operand so much later.
    Shift(Moment, usize),
    /// The operand's only moment, for all.
    Spread(usize),
    /// Smallest or largest in a window that moves.
    Slide { operation: Operation, from: Moment, to: Moment, of: usize },
    /// An aggregate from `from` to `to` for the only moment asked about.
    Fold { aggregation: Aggregation, from: Moment, to: Moment, of: usize },
    /// Seconds until the operand holds, for the only moment asked about.
    Time { goal: Ref, scale: Scale },
}

/// How far an aggregate has come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Folded {
    next: Moment,
    /// Smallest or largest.
    value: f64,
    /// Of a mean.
    integral: Integral,
    last: f64,
}

impl Folded {
    /// Nothing yet, of a window from `from` on.
    pub(super) fn new(from: Moment) -> Self {
        Self { next: from, value: f64::NAN, integral: Integral::EMPTY, last: f64::NAN }
    }
}

/// A number over time.
#[derive(Clone, Debug)]
pub(super) struct Number {
    pub(super) source: Source,
    pub(super) stream: Stream,
    folded: (Folded, Folded),
    first: Moment,
}

impl Number {
    pub(super) fn new(source: Source, first: Moment, end: Moment) -> Self {
        let folded = Folded::new(first);
        let mut number = Self { source, stream: Stream::new(first, end), folded: (folded, folded), first };
        number.clear();
        number
    }

    pub(super) fn clear(&mut self) {
        self.stream.clear();
        let from = if let Source::Fold { from, .. } = self.source { from } else { self.first };
        self.folded = (Folded::new(from), Folded::new(from));
        if let Source::Fixed(value) = self.source {
            self.stream.extend(Moment::MAX, value);
        }
    }

    /// Keeps what the present step found.
    pub(super) fn keep(&mut self) {
        self.stream.mark();
        self.folded.1 = self.folded.0;
    }

    /// Forgets what the present step found.
    pub(super) fn take_back(&mut self) {
        self.stream.take_back();
        self.folded.0 = self.folded.1;
    }

    /// Learns from operands that have learnt.
    pub(super) fn step(&mut self, truths: &[Truth], numbers: &[Number], step: &Step) {
        self.keep();
        let own = &mut self.stream;
        match &self.source {
            Source::Fixed(_) => {}
            Source::Present(slot) => own.extend(step.to, step.present.number(*slot)),
            Source::Combine(operation, x, y) => {
                let (x, y) = (&numbers[*x].stream, &numbers[*y].stream);
                let known = x.known.min(y.known).min(own.end);
                while own.known < known {
                    let ((x_end, x), (y_end, y)) = (x.around(own.known), y.around(own.known));
                    own.extend(x_end.min(y_end).min(known), operation.apply(x, y));
                }
            }
            Source::Abs(x) => copy(own, &numbers[*x].stream, 0, f64::abs),
            Source::Shift(by, x) => copy(own, &numbers[*x].stream, *by, |x| x),
            Source::Spread(x) => {
                let x = &numbers[*x].stream;
                if x.first_open().is_none() {
                    own.extend(Moment::MAX, x.around(x.end - 1).1);
                }
            }
            Source::Slide { operation, from, to, of } => {
                slide(own, &numbers[*of].stream, *operation, (*from, *to));
            }
            Source::Fold { aggregation, from, to, of } => {
                let value = fold(&mut self.folded.0, &numbers[*of].stream, *aggregation, (*from, *to));
                if let Some(value) = value {
                    own.extend(Moment::MAX, value);
                }
            }
            Source::Time { goal, scale } => {
                let (_, end, known) = look(truths, *goal, self.first);
                let (at, known) = match known {
                    Known::False if end >= truths[goal.cell].track.end => (end, Known::False),
                    Known::False => (end, look(truths, *goal, end).2),
                    _ => (self.first, known),
                };
                match known {
                    Known::True => {
                        own.extend(Moment::MAX, scale.seconds(instant(at) - instant(self.first)));
                    }
                    Known::False => own.extend(Moment::MAX, f64::INFINITY),
                    Known::Open => {}
                }
            }
        }
    }

    /// Tells from which moment on the operands are still needed.
    pub(super) fn needs(&self, mut truth: impl FnMut(usize, Moment), mut number: impl FnMut(usize, Moment)) {
        let Some(open) = self.stream.first_open() else { return };
        match &self.source {
            Source::Fixed(_) | Source::Present(_) => {}
            Source::Combine(_, x, y) => {
                number(*x, open);
                number(*y, open);
            }
            Source::Abs(x) => number(*x, open),
            Source::Shift(by, x) => number(*x, open + by),
            Source::Spread(x) => number(*x, 0),
            Source::Slide { from, of, .. } => number(*of, open + from),
            Source::Fold { of, .. } => number(*of, self.folded.0.next),
            Source::Time { goal, .. } => truth(goal.cell, open),
        }
    }
}

fn copy(own: &mut Stream, x: &Stream, by: Moment, apply: impl Fn(f64) -> f64) {
    let known = (x.known - by).min(own.end);
    while own.known < known {
        let (end, value) = x.around(own.known + by);
        own.extend((end - by).min(known), apply(value));
    }
}

fn slide(own: &mut Stream, x: &Stream, operation: Operation, (from, to): (Moment, Moment)) {
    while own.known < own.end {
        let at = own.known;
        let last = if to == FOREVER { x.end - 1 } else { at + to };
        if x.known <= last {
            return;
        }
        let (mut next, mut value) = x.around(at + from);
        let mut until = next - from;
        while next <= last {
            let (end, more) = x.around(next);
            value = operation.apply(value, more);
            next = end;
        }
        if to != FOREVER {
            until = until.min(next - to);
        }
        own.extend(until, value);
    }
}

fn fold(
    folded: &mut Folded,
    x: &Stream,
    aggregation: Aggregation,
    (from, to): (Moment, Moment),
) -> Option<f64> {
    while folded.next <= to && folded.next < x.known {
        let (end, value) = x.around(folded.next);
        let end = end.min(to + 1);
        let first = folded.next == from;
        folded.value = match aggregation {
            Aggregation::Min | Aggregation::First if !first => Operation::Min.apply(folded.value, value),
            Aggregation::Max if !first => Operation::Max.apply(folded.value, value),
            _ => value,
        };
        if aggregation == Aggregation::Mean {
            folded.integral.add(value, folded.next, end);
        }
        (folded.next, folded.last) = (end, value);
    }
    if folded.next <= to {
        return None;
    }
    Some(match aggregation {
        Aggregation::Mean if from == to => folded.last,
        Aggregation::Mean => folded.integral.mean(),
        _ => folded.value,
    })
}
