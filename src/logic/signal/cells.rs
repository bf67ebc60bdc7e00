//! All cells of one formula or metric, in order, and the search for the moment of the decision.

use super::Reading;
use super::moment::Moment;
use super::number::Number;
use super::track::Known;
use super::truth::{Ref, Step, Truth};
use crate::logic::present::Present;

/// Most pieces that are stored; a trial that needs more is unresolved.
const MOST_PIECES: usize = 1 << 20;

/// Pieces that are stored without a look at what can go.
const FEW_PIECES: usize = 256;

/// A cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cell {
    Truth(usize),
    Number(usize),
}

/// The cell that has the answer at moment 0.
#[derive(Clone, Copy, Debug)]
pub(super) enum Whole {
    Truth(Ref),
    Number(usize),
}

/// Cells; operands before their parents.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    pub(super) truths: Vec<Truth>,
    pub(super) numbers: Vec<Number>,
    pub(super) order: Vec<Cell>,
    pub(super) root: Whole,
    /// From which moment on each truth and each number is needed, found by `forget`.
    needed: (Vec<Moment>, Vec<Moment>),
    /// Look again for what can go when so many pieces are stored.
    limit: usize,
}

impl Cells {
    pub(super) fn new(truths: Vec<Truth>, numbers: Vec<Number>, order: Vec<Cell>, root: Whole) -> Self {
        let needed = (vec![0; truths.len()], vec![0; numbers.len()]);
        Self { truths, numbers, order, root, needed, limit: FEW_PIECES }
    }

    /// A new trial.
    pub(super) fn clear(&mut self) {
        self.limit = FEW_PIECES;
        self.truths.iter_mut().for_each(Truth::clear);
        self.numbers.iter_mut().for_each(Number::clear);
    }

    /// The present state lasts from `from` to before `to`. The reading, and the moment at which it was
    /// forced.
    pub(super) fn step(&mut self, from: Moment, to: Moment, present: &Present) -> Option<(Reading, Moment)> {
        self.learn(&Step { from, to, present });
        if let Some(reading) = self.reading() {
            return Some((reading, self.decision(from, to, present)));
        }
        let stored = self.stored();
        if stored > self.limit {
            self.forget();
            let kept = self.stored();
            if kept > MOST_PIECES {
                return Some((Reading::Unresolved, from));
            }
            self.limit = FEW_PIECES.max(2 * kept);
        }
        None
    }

    fn learn(&mut self, step: &Step) {
        for cell in &self.order {
            match *cell {
                Cell::Truth(k) => {
                    let (before, rest) = self.truths.split_at_mut(k);
                    rest[0].step(before, &self.numbers, step);
                }
                Cell::Number(k) => {
                    let (before, rest) = self.numbers.split_at_mut(k);
                    rest[0].step(&self.truths, before, step);
                }
            }
        }
    }

    fn reading(&self) -> Option<Reading> {
        match self.root {
            Whole::Truth(root) => match super::truth::look(&self.truths, root, 0).2 {
                Known::Open => None,
                known => Some(Reading::Truth(known == Known::True)),
            },
            Whole::Number(root) => {
                let stream = &self.numbers[root].stream;
                stream.first_open().is_none().then(|| Reading::Value(stream.around(0).1))
            }
        }
    }

    /// The last moment of the shortest part of the step `from .. to` that decides, by bisection.
    fn decision(&mut self, from: Moment, to: Moment, present: &Present) -> Moment {
        let (mut open, mut decided, mut guess) = (from, to, from + 1);
        while decided - open > 1 {
            let guessed = guess.min(decided - 1);
            self.take_back();
            self.learn(&Step { from: open, to: guessed, present });
            if self.reading().is_some() {
                decided = guessed;
            } else {
                // Most verdicts fall at the beginning.
                open = guessed;
                self.truths.iter_mut().for_each(Truth::keep);
                self.numbers.iter_mut().for_each(Number::keep);
            }
            guess = if open == from + 1 { open + 1 } else { open + (decided - open) / 2 };
        }
        decided - 1
    }

    fn take_back(&mut self) {
        self.truths.iter_mut().for_each(Truth::take_back);
        self.numbers.iter_mut().for_each(Number::take_back);
    }

    fn stored(&self) -> usize {
        let truths: usize = self.truths.iter().map(|truth| truth.track.len()).sum();
        truths + self.numbers.iter().map(|number| number.stream.len()).sum::<usize>()
    }

    /// Drops values that are never read again.
    fn forget(&mut self) {
        let (truths, numbers) = &mut self.needed;
        truths.fill(Moment::MAX);
        numbers.fill(Moment::MAX);
        for cell in self.order.iter().rev() {
            let truth = |k: usize, at: Moment| truths[k] = truths[k].min(at);
            let number = |k: usize, at: Moment| numbers[k] = numbers[k].min(at);
            match *cell {
                Cell::Truth(k) => {
                    if let Some(open) = self.truths[k].track.first_open() {
                        self.truths[k].machine.needs(open, truth, number);
                    }
                }
                Cell::Number(k) => self.numbers[k].needs(truth, number),
            }
        }
        match self.root {
            Whole::Truth(root) => truths[root.cell] = 0,
            Whole::Number(root) => numbers[root] = 0,
        }
        for (truth, needed) in self.truths.iter_mut().zip(&self.needed.0) {
            truth.track.forget(*needed);
        }
        for (number, needed) in self.numbers.iter_mut().zip(&self.needed.1) {
            number.stream.forget(*needed);
        }
    }
}
