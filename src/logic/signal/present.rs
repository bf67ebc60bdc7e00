//! Truths and numbers of the present state alone: straight-line code.

use crate::logic::formula::{Operation, Relation};

/// One result: a truth or a number of the state that begins.
#[derive(Clone, Debug)]
pub(super) enum Code {
    Atom(usize),
    Compare(Relation, usize, usize),
    Not(usize),
    All(Box<[usize]>),
    Any(Box<[usize]>),
    Signal(usize),
    Number(f64),
    Combine(Operation, usize, usize),
    Abs(usize),
}

/// The code and its latest results.
#[derive(Clone, Debug, Default)]
pub(super) struct Present {
    code: Vec<Code>,
    truths: Vec<bool>,
    numbers: Vec<f64>,
}

impl Present {
    /// Adds a result. Operands stand before it.
    pub(super) fn add(&mut self, code: Code) -> usize {
        self.code.push(code);
        self.truths.push(false);
        self.numbers.push(0.0);
        self.code.len() - 1
    }

    /// Computes everything for a new state. What is missing counts as false and as no number.
    #[inline]
    pub(super) fn read(&mut self, atoms: &[bool], signals: &[f64]) {
        for (k, code) in self.code.iter().enumerate() {
            match code {
                Code::Atom(a) => self.truths[k] = atoms.get(*a).copied().unwrap_or(false),
                Code::Compare(relation, x, y) => {
                    self.truths[k] = relation.holds(self.numbers[*x], self.numbers[*y]);
                }
                Code::Not(x) => self.truths[k] = !self.truths[*x],
                Code::All(all) => self.truths[k] = all.iter().all(|x| self.truths[*x]),
                Code::Any(all) => self.truths[k] = all.iter().any(|x| self.truths[*x]),
                Code::Signal(s) => self.numbers[k] = signals.get(*s).copied().unwrap_or(f64::NAN),
                Code::Number(value) => self.numbers[k] = *value,
                Code::Combine(operation, x, y) => {
                    self.numbers[k] = operation.apply(self.numbers[*x], self.numbers[*y]);
                }
                Code::Abs(x) => self.numbers[k] = self.numbers[*x].abs(),
            }
        }
    }

    #[inline]
    pub(super) fn truth(&self, k: usize) -> bool {
        self.truths[k]
    }

    #[inline]
    pub(super) fn number(&self, k: usize) -> f64 {
        self.numbers[k]
    }
}
