//! Cells of numbers.

use super::super::number::Source;
use super::{Builder, Range};
use crate::logic::formula::{Aggregation, Operation, Term, TermId};
use crate::logic::invalid::Invalid;
use crate::logic::present::Code;

impl Builder<'_> {
    /// A number that is the same everywhere.
    pub(super) fn fixed(&mut self, value: f64, range: Range) -> Result<usize, Invalid> {
        self.add_number(Source::Fixed(value), range)
    }

    /// How much more a number is than a constant. The mean of that has the sign of the comparison where all values lie on one
    /// side of the constant, which the rounded mean need not have.
    pub(super) fn excess(&mut self, x: TermId, constant: f64, range: Range) -> Result<usize, Invalid> {
        // A constant is known in states to come, too.
        if let (Some(slot), None) =
            (self.parts.term_slots[x.0 as usize], self.parts.term_constants[x.0 as usize])
        {
            let constant = self.parts.present.add(Code::Number(constant));
            let slot = self.parts.present.add(Code::Combine(Operation::Subtract, slot, constant));
            return self.add_number(Source::Present(slot), range);
        }
        let (x, constant) = (self.number(x, range)?, self.fixed(constant, range)?);
        self.add_number(Source::Combine(Operation::Subtract, x, constant), range)
    }

    /// The mean of a number from one moment to another, asked about at one moment.
    pub(super) fn average(&mut self, of: usize, (from, to): Range, at: Range) -> Result<usize, Invalid> {
        self.add_number(Source::Fold { aggregation: Aggregation::Mean, from, to, of }, at)
    }

    /// A number at some moments.
    pub(super) fn number(&mut self, id: TermId, range: Range) -> Result<usize, Invalid> {
        if let Some(&known) = self.known_numbers.get(&(id.0, range)) {
            return Ok(known);
        }
        let k = id.0 as usize;
        let tree = self.tree;
        let source = if let Some(value) = self.parts.term_constants[k] {
            Source::Fixed(value)
        } else if let Some(slot) = self.parts.term_slots[k] {
            Source::Present(slot)
        } else {
            match &tree.terms[k] {
                Term::Constant(value) => Source::Fixed(*value),
                Term::Signal(_) => return Err(Invalid::Malformed),
                Term::Combine(operation, x, y) => {
                    Source::Combine(*operation, self.number(*x, range)?, self.number(*y, range)?)
                }
                Term::Abs(x) => Source::Abs(self.number(*x, range)?),
                Term::Later(by, x) => {
                    let by = self.scale.shift(*by);
                    Source::Shift(by, self.number(*x, (range.0 + by, range.1 + by))?)
                }
                Term::AtEnd(x) => {
                    let last = self.last();
                    Source::Spread(self.number(*x, (last, last))?)
                }
                Term::Window(Aggregation::Sum, ..) => return Err(Invalid::SumOverTime),
                Term::Window(aggregation, w, x) => {
                    let (from, to) = self.shifts(*w);
                    let asked = self.through((from, to), range);
                    let single = range.0 == range.1;
                    if *aggregation == Aggregation::Mean && !single && from != to {
                        return Err(Invalid::MovingNumber);
                    }
                    let of = self.number(*x, asked)?;
                    match aggregation {
                        _ if from == to => Source::Shift(from, of),
                        _ if single => {
                            Source::Fold { aggregation: *aggregation, from: asked.0, to: asked.1, of }
                        }
                        Aggregation::Max => Source::Slide { operation: Operation::Max, from, to, of },
                        _ => Source::Slide { operation: Operation::Min, from, to, of },
                    }
                }
                Term::TimeUntil(goal) => {
                    if range.0 < range.1 {
                        return Err(Invalid::MovingNumber);
                    }
                    let goal = self.truth(*goal, (range.0, self.last()))?;
                    Source::Time { goal, scale: self.scale }
                }
            }
        };
        let made = self.add_number(source, range)?;
        self.known_numbers.insert((id.0, range), made);
        Ok(made)
    }
}
