//! Margins: the formula of a robustness, in which every condition is a number compared with a bound.
//!
//! Fainekos and Pappas 2009: a comparison `x > c` has the margin `x - c`, "and" the smaller, "or" the larger. A
//! quantifier over states is a fold of margins. What says only yes or no (an equality, a truth value of a
//! process) is infinitely far from the other answer.

use crate::model::{Arithmetic, Bool, Comparison, Field, Fold, Function, Num, Place, Separation, Set, Who};

fn combine(operator: Arithmetic, a: Num, b: Num) -> Num {
    Num::Combine(operator, Box::new(a), Box::new(b))
}

fn negated(a: Num) -> Num {
    Num::Apply(Function::Negate, Box::new(a))
}

/// Yes or no: as far as can be from the other answer.
pub(crate) fn infinite(truth: &Bool) -> Num {
    let ends = (Num::Constant(f64::INFINITY), Num::Constant(f64::NEG_INFINITY));
    Num::If(Box::new(truth.clone()), Box::new(ends.0), Box::new(ends.1))
}

/// The margin of a condition of one state: positive where it holds, negative where it does not; zero may be
/// either.
pub fn margin(truth: &Bool) -> Num {
    if let Some(depth) = depth(truth) {
        return depth;
    }
    match truth {
        Bool::Constant(true) => Num::Constant(f64::INFINITY),
        Bool::Constant(false) => Num::Constant(f64::NEG_INFINITY),
        Bool::Not(inner) => negated(margin(inner)),
        Bool::And(list) => joined(Arithmetic::Min, f64::INFINITY, list),
        Bool::Or(list) => joined(Arithmetic::Max, f64::NEG_INFINITY, list),
        Bool::Iff(a, b) => combine(Arithmetic::Agree, margin(a), margin(b)),
        Bool::Compare(comparison, a, b) => match comparison {
            Comparison::Equal | Comparison::Unequal => infinite(truth),
            Comparison::Less | Comparison::AtMost => difference(truth, b, a),
            Comparison::Greater | Comparison::AtLeast => difference(truth, a, b),
        },
        Bool::Present(_) => infinite(truth),
        Bool::In(who, region) => Num::Depth(Place::Agent(*who), *region),
        Bool::Contact(who) => negated(Num::Of(Field::Separation(Separation::Clearance), *who)),
        Bool::Touching(a, b) => negated(gap(*a, *b)),
        Bool::Forall(set, body) => fold(Fold::Min, set, body),
        Bool::Exists(set, body) => fold(Fold::Max, set, body),
    }
}

/// Whether a point is in a region is a distance of zero; its margin is the depth.
pub(crate) fn depth(truth: &Bool) -> Option<Num> {
    let Bool::Compare(Comparison::AtMost, distance, zero) = truth else { return None };
    match (&**distance, &**zero) {
        (Num::Distance(place, Place::Region(region)), Num::Constant(0.0)) if !nowhere(place) => {
            Some(Num::Depth(place.clone(), *region))
        }
        _ => None,
    }
}

fn joined(operator: Arithmetic, empty: f64, list: &[Bool]) -> Num {
    let margins = list.iter().map(margin);
    margins.reduce(|a, b| combine(operator, a, b)).unwrap_or(Num::Constant(empty))
}

/// `larger - smaller`; where that is no number, the truth decides.
fn difference(truth: &Bool, larger: &Num, smaller: &Num) -> Num {
    let margin = combine(Arithmetic::Subtract, larger.clone(), smaller.clone());
    if !(may_be_none(larger) || may_be_none(smaller)) {
        return margin;
    }
    let is_number = Bool::Compare(Comparison::Equal, Box::new(margin.clone()), Box::new(margin.clone()));
    // Two infinities are equal or not; a side that is no number makes it false.
    let ends = Num::If(
        Box::new(truth.clone()),
        Box::new(Num::Constant(0.0)),
        Box::new(Num::Constant(f64::NEG_INFINITY)),
    );
    Num::If(Box::new(is_number), Box::new(margin), Box::new(ends))
}

/// A fold of margins. A bound that is the same for all is taken out, so that a smallest gap stays the fast
/// instruction that it is.
fn fold(fold: Fold, set: &Set, body: &Bool) -> Num {
    let of = |fold, body: &Num| Num::Fold(fold, set.clone(), Box::new(body.clone()));
    if let Bool::Compare(comparison, a, b) = body
        && depth(body).is_none()
        && let Num::Constant(bound) = **b
        && bound.is_finite()
        && !may_be_none(a)
    {
        let bound = Num::Constant(bound);
        let other = if fold == Fold::Min { Fold::Max } else { Fold::Min };
        match comparison {
            Comparison::Greater | Comparison::AtLeast => {
                return combine(Arithmetic::Subtract, of(fold, a), bound);
            }
            Comparison::Less | Comparison::AtMost => {
                return combine(Arithmetic::Subtract, bound, of(other, a));
            }
            Comparison::Equal | Comparison::Unequal => {}
        }
    }
    of(fold, &margin(body))
}

/// The gap between two bodies; infinite where one is not in the scene.
fn gap(a: Who, b: Who) -> Num {
    let radius = |who| Num::Of(Field::Radius, who);
    let centres = Num::Distance(Place::Agent(a), Place::Agent(b));
    let gap = combine(Arithmetic::Subtract, combine(Arithmetic::Subtract, centres, radius(a)), radius(b));
    let here: Vec<Bool> = [a, b]
        .into_iter()
        .filter_map(|who| {
            // The running agent of a fold is in the scene.
            let Who::Agent(id) = who else { return None };
            let set = Set { members: [id].into(), except: None };
            let count = Num::Count(set, Box::new(Bool::Constant(true)));
            let zero = Box::new(Num::Constant(0.0));
            Some(Bool::Compare(Comparison::Greater, Box::new(count), zero))
        })
        .collect();
    if here.is_empty() {
        return gap;
    }
    Num::If(Box::new(Bool::And(here)), Box::new(gap), Box::new(Num::Constant(f64::INFINITY)))
}

/// Whether a place can have a coordinate that is none.
fn nowhere(place: &Place) -> bool {
    matches!(place, Place::Point(x, y) if may_be_none(x) || may_be_none(y))
}

/// Whether a number, or its difference from another, can be none in a trial that goes on.
fn may_be_none(num: &Num) -> bool {
    match num {
        Num::Constant(value) => !value.is_finite(),
        Num::Of(field, _) => field.may_be_infinite(),
        Num::Time | Num::OfSet(..) | Num::Count(..) | Num::Crossings(..) | Num::Voronoi(_) => false,
        Num::Distance(a, b) => nowhere(a) || nowhere(b),
        Num::Coordinate(_, place) | Num::Depth(place, _) => nowhere(place),
        Num::Variable(_) | Num::OfTwo(..) | Num::Fold(..) => true,
        Num::Apply(Function::ServiceLevel, _) => false,
        Num::Apply(function, a) => {
            !matches!(function, Function::Negate | Function::Abs | Function::Sin | Function::Cos)
                || may_be_none(a)
        }
        Num::Combine(operator, a, b) => {
            !matches!(
                operator,
                Arithmetic::Add
                    | Arithmetic::Subtract
                    | Arithmetic::Multiply
                    | Arithmetic::Min
                    | Arithmetic::Max
                    | Arithmetic::Atan2
                    | Arithmetic::Agree
            ) || may_be_none(a)
                || may_be_none(b)
        }
        Num::If(_, a, b) => may_be_none(a) || may_be_none(b),
    }
}
