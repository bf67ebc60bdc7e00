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

    /// Computes the margins of everything for a new state: a truth has its margin as its number. One that is no number
    /// counts as false.
    pub(super) fn measure(&mut self, atoms: &[bool], signals: &[f64]) {
        for k in 0..self.code.len() {
            let of = |x: &usize| self.numbers[*x];
            self.numbers[k] = match &self.code[k] {
                Code::Atom(a) if atoms.get(*a).copied().unwrap_or(false) => f64::INFINITY,
                Code::Atom(_) => f64::NEG_INFINITY,
                Code::Compare(relation, x, y) => {
                    let margin = relation.margin(of(x), of(y));
                    if margin.is_nan() { f64::NEG_INFINITY } else { margin }
                }
                Code::Not(x) => -of(x),
                Code::All(all) => all.iter().map(of).fold(f64::INFINITY, |x, y| if y < x { y } else { x }),
                Code::Any(all) => {
                    all.iter().map(of).fold(f64::NEG_INFINITY, |x, y| if y > x { y } else { x })
                }
                Code::Signal(s) => signals.get(*s).copied().unwrap_or(f64::NAN),
                Code::Number(value) => *value,
                Code::Combine(operation, x, y) => operation.apply(of(x), of(y)),
                Code::Abs(x) => of(x).abs(),
            };
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
