//! What functions, operators and comparisons of expressions mean, and the value of an expression that
//! depends on variables alone.
//!
//! The kernel runs expressions as code over lanes; here they are walked, for checks before a trial.

use super::expression::{Arithmetic, Bool, Comparison, Function, Num, Place, Who};
use super::function::Field;
use super::index::VariableId;
use super::process::{Command, Process, Timing};
use super::visit::Part;
use crate::base::math;
use std::collections::BTreeSet;

impl Function {
    /// The function of a number.
    #[inline(always)]
    pub fn of(self, x: f64) -> f64 {
        match self {
            Self::Negate => -x,
            Self::Abs => x.abs(),
            Self::Sqrt => x.sqrt(),
            Self::Exp => math::exp(x),
            Self::Ln => math::ln(x),
            Self::Sin => math::sin_cos(x).0,
            Self::Cos => math::sin_cos(x).1,
            Self::Floor => x.floor(),
            Self::Ceil => x.ceil(),
            Self::Round => x.round(),
            Self::ServiceLevel => service_level(x),
        }
    }
}

impl Arithmetic {
    /// The result of two numbers.
    #[inline(always)]
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => math::pow(a, b),
            // NaN if one is, so that a diverged position never looks far away.
            Self::Min => {
                if b < a || b.is_nan() {
                    b
                } else {
                    a
                }
            }
            Self::Max => {
                if b > a || b.is_nan() {
                    b
                } else {
                    a
                }
            }
            Self::Atan2 => math::atan2(a, b),
            Self::Modulo => modulo(a, b),
            Self::Agree => Self::Max.of(Self::Min.of(a, b), Self::Min.of(-a, -b)),
        }
    }
}

/// The least area per person of the levels of service A to E of a walkway, m² (Fruin 1971: 35, 25, 15, 10 and 5 square feet).
const LEAST_AREAS: [f64; 5] = [3.24, 2.32, 1.39, 0.93, 0.46];

/// The level of service of an area per person, m²: 1 for A to 6 for F.
fn service_level(area: f64) -> f64 {
    LEAST_AREAS.iter().fold(1.0, |level, least| if area < *least { level + 1.0 } else { level })
}

/// The remainder with the sign of the divisor. The remainder of truncating division is exact.
fn modulo(a: f64, b: f64) -> f64 {
    let remainder = a % b;
    if remainder != 0.0 && (remainder < 0.0) != (b < 0.0) { remainder + b } else { remainder }
}

impl Comparison {
    /// Whether it holds; none holds of what is no number.
    pub fn of(self, a: f64, b: f64) -> bool {
        match self {
            Self::Less => a < b,
            Self::AtMost => a <= b,
            Self::Greater => a > b,
            Self::AtLeast => a >= b,
            Self::Equal => a == b,
            Self::Unequal => !(a.is_nan() || b.is_nan()) && a != b,
        }
    }
}

impl Process {
    /// Adds the variables that it reads, but for those of delays; whether it depends on nothing else.
    pub fn reads(&self, into: &mut BTreeSet<VariableId>) -> bool {
        self.commands.iter().fold(true, |so_far, command| so_far & command.reads(into))
    }
}

impl Command {
    /// Adds the variables that it reads, but for those of a delay; whether it depends on nothing else.
    pub fn reads(&self, into: &mut BTreeSet<VariableId>) -> bool {
        let mut closed = self.guard.reads(into);
        if let Timing::Rate(rate) = &self.timing {
            closed &= rate.reads(into);
        }
        for branch in &self.branches {
            closed &= branch.weight.reads(into);
            for (_, value) in &branch.updates {
                closed &= value.reads(into);
            }
        }
        closed
    }
}

impl Part<'_> {
    /// Adds the variables that it reads; whether it depends on nothing else.
    fn reads(self, into: &mut BTreeSet<VariableId>) -> bool {
        if let Self::Num(Num::Variable(id)) = self {
            into.insert(*id);
            return true;
        }
        self.is_composed() && self.all(&mut |part| part.reads(into))
    }

    /// Whether it is made of what is the same everywhere, and of some numbers.
    fn is_made_of(self, number: fn(&Num) -> bool) -> bool {
        let is_of_parts = match self {
            Self::Num(num) => matches!(num, Num::Distance(..) | Num::Coordinate(..) | Num::Depth(..)),
            Self::Place(place) => matches!(place, Place::Point(..) | Place::Region(_) | Place::Barrier(_)),
            _ => false,
        };
        if is_of_parts || self.is_composed() {
            return self.all(&mut |part| part.is_made_of(number));
        }
        matches!(self, Self::Num(num) if number(num))
    }
}

impl Num {
    /// Adds the variables that it reads; whether it depends on nothing else.
    pub fn reads(&self, into: &mut BTreeSet<VariableId>) -> bool {
        Part::Num(self).reads(into)
    }

    /// Whether it is surely the same in all states of all trials, though perhaps not known before: how far it is from a
    /// point to a wall.
    pub fn is_fixed(&self) -> bool {
        Part::Num(self).is_made_of(|_| false)
    }

    /// Whether it is surely the same in all states of a trial: bodies are drawn at the start.
    pub fn is_drawn(&self) -> bool {
        Part::Num(self).is_made_of(is_of_body)
    }

    /// Its value where variables have these values; `None` where it depends on more than variables.
    pub fn evaluate(&self, variables: &[f64]) -> Option<f64> {
        match self {
            Self::Constant(value) => Some(*value),
            Self::Variable(id) => variables.get(id.0 as usize).copied(),
            Self::Apply(function, a) => Some(function.of(a.evaluate(variables)?)),
            Self::Combine(operator, a, b) => {
                Some(operator.of(a.evaluate(variables)?, b.evaluate(variables)?))
            }
            Self::If(condition, a, b) => {
                if condition.evaluate(variables)? {
                    a.evaluate(variables)
                } else {
                    b.evaluate(variables)
                }
            }
            _ => None,
        }
    }
}

fn is_of_body(num: &Num) -> bool {
    matches!(num, Num::Of(Field::Radius | Field::Mass, Who::Agent(_)))
}

impl Bool {
    /// Adds the variables that it reads; whether it depends on nothing else.
    pub fn reads(&self, into: &mut BTreeSet<VariableId>) -> bool {
        Part::Bool(self).reads(into)
    }

    /// Whether it is surely the same in all states of all trials, though perhaps not known before.
    pub fn is_fixed(&self) -> bool {
        Part::Bool(self).is_made_of(|_| false)
    }

    /// Whether it is surely the same in all states of a trial.
    pub fn is_drawn(&self) -> bool {
        Part::Bool(self).is_made_of(is_of_body)
    }

    /// Its value where variables have these values; `None` where it depends on more than variables.
    pub fn evaluate(&self, variables: &[f64]) -> Option<bool> {
        match self {
            Self::Constant(value) => Some(*value),
            Self::Compare(comparison, a, b) => {
                Some(comparison.of(a.evaluate(variables)?, b.evaluate(variables)?))
            }
            Self::Not(a) => a.evaluate(variables).map(|a| !a),
            Self::Iff(a, b) => Some(a.evaluate(variables)? == b.evaluate(variables)?),
            Self::And(all) => {
                all.iter().try_fold(true, |so_far, one| Some(so_far & one.evaluate(variables)?))
            }
            Self::Or(all) => {
                all.iter().try_fold(false, |so_far, one| Some(so_far | one.evaluate(variables)?))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{AgentId, RegionId};

    #[test]
    fn the_remainder_has_the_sign_of_the_divisor() {
        assert_eq!(Arithmetic::Modulo.of(-1.0, 3.0), 2.0);
        assert_eq!(Arithmetic::Modulo.of(1.0, -3.0), -2.0);
        assert_eq!(Arithmetic::Modulo.of(6.0, 3.0), 0.0);
        assert!(Arithmetic::Modulo.of(1.0, 0.0).is_nan());
    }

    #[test]
    fn margins_agree_where_their_signs_do() {
        let agree = |a, b| Arithmetic::Agree.of(a, b);
        assert_eq!((agree(3.0, 2.0), agree(-1.0, -4.0)), (2.0, 1.0));
        assert_eq!((agree(-1.0, 4.0), agree(4.0, -5.0)), (-1.0, -4.0));
        assert_eq!(agree(f64::INFINITY, -2.0), -2.0);
        assert!(agree(f64::NAN, 1.0).is_nan() && agree(1.0, f64::NAN).is_nan());
    }

    #[test]
    fn a_nan_survives_min_and_max() {
        for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN)] {
            assert!(Arithmetic::Min.of(a, b).is_nan() && Arithmetic::Max.of(a, b).is_nan());
        }
        assert_eq!([Arithmetic::Min.of(1.0, 2.0), Arithmetic::Max.of(1.0, 2.0)], [1.0, 2.0]);
    }

    #[test]
    fn what_agents_have_no_part_in_is_fixed() {
        let point = Place::Point(Box::new(Num::Constant(1.0)), Box::new(Num::Constant(2.0)));
        let far = |of: &Place| Num::Distance(of.clone(), Place::Region(RegionId(0)));
        let choice = |num: Num, of: &Place| {
            let near = Bool::Compare(Comparison::Less, Box::new(far(of)), Box::new(Num::Constant(1.0)));
            let near = Bool::Not(Box::new(Bool::And(vec![near, Bool::Constant(true)])));
            Num::If(Box::new(near), Box::new(num), Box::new(Num::Constant(0.0)))
        };
        let body = |who| Num::Of(Field::Radius, who);
        let somebody = Who::Agent(AgentId(0));
        for (num, fixed, drawn) in [
            (choice(far(&point), &point), true, true),
            (choice(body(somebody), &point), false, true),
            (choice(body(Who::Running(0)), &point), false, false),
            (choice(Num::Constant(1.0), &Place::Agent(somebody)), false, false),
            (choice(Num::Variable(VariableId(0)), &point), false, false),
            (choice(Num::Time, &point), false, false),
        ] {
            assert_eq!((num.is_fixed(), num.is_drawn()), (fixed, drawn), "{num:?}");
        }
    }

    #[test]
    fn halves_round_away_from_zero() {
        assert_eq!([Function::Round.of(0.5), Function::Round.of(-0.5)], [1.0, -1.0]);
    }

    #[test]
    fn expressions_of_variables_have_values_and_others_none() {
        let v = |k| Box::new(Num::Variable(VariableId(k)));
        let sum = Num::Combine(Arithmetic::Add, v(0), v(1));
        assert_eq!(sum.evaluate(&[2.0, 3.0]), Some(5.0));
        assert_eq!(Num::Combine(Arithmetic::Add, v(0), Box::new(Num::Time)).evaluate(&[2.0]), None);
        let test = Bool::Compare(Comparison::Unequal, v(0), v(1));
        assert_eq!(test.evaluate(&[f64::NAN, 1.0]), Some(false));
        assert_eq!(Bool::Or(vec![test, Bool::Constant(true)]).evaluate(&[1.0, 1.0]), Some(true));
    }
}
