//! Margins: the formula of a robustness, in which every condition is a number compared with a bound.
//!
//! Fainekos and Pappas 2009: a comparison `x > c` has the margin `x - c`, "and" the smaller, "or" the larger. A
//! quantifier over states is a fold of margins. What says only yes or no (an equality, a truth value of a
//! process) is infinitely far from the other answer.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Lowered};
use super::lower::relation;
use super::study::{Form, Part};
use super::typed::Typed;
use crate::base::tick::Clock;
use crate::logic::{Invalid, Node, NodeId, Relation, Robustness, SignalRobustness, Term, TermId};
use crate::model::{
    Arithmetic, Bool, Comparison, Domain, Field, Fold, Function, Num, Place, Separation, Set, Who,
};
use crate::syntax::ast::BinaryOp;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// Knowledge about the margins of the formula that is being lowered.
#[derive(Clone, Debug, Default)]
pub(super) struct Margins {
    /// Dimension of the first condition with a margin, and where it stands.
    first: Option<(Dimension, Span)>,
    /// Whether another dimension was found.
    mixed: bool,
    /// How many numbers are around the present place: conditions inside a number are none of the formula.
    pub(super) inside: u32,
    /// The first equality of numbers, which has none, and what to write instead.
    equality: Option<(Span, String)>,
}

/// The range of a number of which nothing is known.
const UNKNOWN: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl Elaborator<'_> {
    /// An equality: it has no margin. At an end of a range an inequality says the same.
    pub(super) fn note_equality(
        &mut self,
        op: BinaryOp,
        (left, right): (Span, Span),
        sides: (&Typed, &Typed),
    ) {
        let (a, Typed::Number(b)) = sides else { return };
        if self.margins.as_ref().is_none_or(|m| m.equality.is_some()) {
            return;
        }
        let (low, high) = if let Typed::Num(num, _) = a { self.reach(num) } else { UNKNOWN };
        let [above, below] = if op == BinaryOp::Equal { [">=", "<="] } else { [">", "<"] };
        let (at_low, at_high) = (b.value <= low, b.value >= high);
        let sign = if at_low == (op == BinaryOp::Equal) && (at_low || at_high) { below } else { above };
        let other = if at_low || at_high { String::new() } else { format!(", or `{below}`") };
        let instead = format!("write `{} {sign} {}`{other}", self.text(left), self.text(right));
        if let Some(margins) = &mut self.margins {
            margins.equality = Some((left.to(right), instead));
        }
    }

    /// The smallest and the largest value that a number can have.
    fn reach(&self, num: &Num) -> (f64, f64) {
        match num {
            Num::Constant(value) => (*value, *value),
            Num::Variable(variable) => match self.domain(*variable).and_then(Domain::values) {
                Some((low, count)) => (low, low + (count - 1) as f64),
                None => UNKNOWN,
            },
            // Truth values, as they are counted.
            Num::If(_, yes, no) if (&**yes, &**no) == (&Num::Constant(1.0), &Num::Constant(0.0)) => {
                (0.0, 1.0)
            }
            Num::Combine(Arithmetic::Add, a, b) => {
                let (a, b) = (self.reach(a), self.reach(b));
                (a.0 + b.0, a.1 + b.1)
            }
            Num::Count(set, _) => (0.0, set.members.len() as f64),
            _ => UNKNOWN,
        }
    }

    /// A condition with a margin of this dimension.
    pub(super) fn note_margin(&mut self, dimension: Dimension, span: Span) {
        let Some(margins) = &mut self.margins else { return };
        if margins.inside > 0 {
            return;
        }
        match margins.first {
            None => margins.first = Some((dimension, span)),
            Some((first, place)) if first != dimension && !margins.mixed => {
                margins.mixed = true;
                let name = |d: Dimension| super::dimension::describe(d);
                let error = error!(
                    E0611,
                    span,
                    "all margins of a robustness need the same unit (found {} and {})",
                    name(dimension),
                    name(first)
                )
                .related(place, "first margin")
                .hint("divide both sides by a reference value: `speed(user) / 1 m/s < 1.3`");
                self.note(error);
            }
            Some(_) => {}
        }
    }

    /// The formula whose conditions have margins, and their dimension. `lower` lowers the formula itself.
    pub(super) fn robustness(
        &mut self,
        span: Span,
        lower: impl FnOnce(&mut Self) -> Lowered<NodeId>,
    ) -> Lowered<(NodeId, Dimension)> {
        let outer = self.margins.replace(Margins::default());
        let node = lower(self);
        let margins = std::mem::replace(&mut self.margins, outer).unwrap_or_default();
        let node = node?;
        if margins.mixed {
            return Err(super::elaborator::Reported);
        }
        let Some((dimension, _)) = margins.first else {
            if let Some((place, instead)) = margins.equality {
                let title = format!(
                    "`{}` has no margin, because `==` and `!=` are only true or false",
                    self.text(place)
                );
                return self.report(error!(E0610, place, "{title}"; hint: "{instead}"));
            }
            return self.report(error!(E0610, span, "no condition in this formula has a margin";
                hint: "comparisons with `<`, `<=`, `>`, `>=`, contacts and regions have a margin"));
        };
        let node = Rewriting {
            elaborator: self,
            dimension,
            span,
            text: String::new(),
            nodes: BTreeMap::new(),
            terms: BTreeMap::new(),
        }
        .node(node);
        let made = match self.clock {
            Clock::Jumps(tick) => SignalRobustness::new(&self.tree, node, self.horizon, tick).err(),
            clock => Robustness::new(&self.tree, node, self.horizon, clock).err(),
        };
        match made {
            Some(Invalid::NoMargin | Invalid::MovingNumber) => {
                let error = error!(E0610, span, "a condition in this formula has no margin")
                    .label("this compares an aggregate of several states")
                    .hint(
                        "compare in each state, or compare the smallest or largest value: `min<=5 s (x) > c`",
                    );
                self.report(error)
            }
            // A bound beyond the horizon is said by whoever asks how far the formula looks.
            _ => Ok((node, dimension)),
        }
    }
}

/// Rewrites a formula so that all its conditions are comparisons of numbers.
struct Rewriting<'e, 'a> {
    elaborator: &'e mut Elaborator<'a>,
    dimension: Dimension,
    span: Span,
    /// The condition that is rewritten, as written.
    text: String,
    nodes: BTreeMap<u32, NodeId>,
    terms: BTreeMap<u32, TermId>,
}

impl Rewriting<'_, '_> {
    fn node(&mut self, id: NodeId) -> NodeId {
        if let Some(known) = self.nodes.get(&id.0) {
            return *known;
        }
        let made = match self.elaborator.tree.nodes[id.0 as usize].clone() {
            Node::Atom(atom) => {
                let truth = self.elaborator.atoms[atom.0 as usize].clone();
                let text = self.elaborator.texts.atoms.get(atom.0 as usize).cloned();
                self.text = text.unwrap_or_default();
                match self.elaborator.texts.parts.get(&atom.0).cloned() {
                    Some(part) => self.part(&part),
                    None => self.condition(&truth),
                }
            }
            Node::Compare(relation, a, b) => {
                let (a, b) = (self.term(a), self.term(b));
                let text = self.elaborator.texts.comparisons.get(&id.0).map(|(text, _)| text.clone());
                self.text = text.unwrap_or_default();
                self.comparison(relation, a, b)
            }
            node => {
                let node = node.map(|part| self.node(part));
                self.elaborator.node(node)
            }
        };
        self.nodes.insert(id.0, made);
        made
    }

    fn term(&mut self, id: TermId) -> TermId {
        if let Some(known) = self.terms.get(&id.0) {
            return *known;
        }
        let made = match self.elaborator.tree.terms[id.0 as usize].clone() {
            Term::Constant(_) | Term::Signal(_) => id,
            Term::TimeUntil(node) => {
                let node = self.node(node);
                self.elaborator.term(Term::TimeUntil(node))
            }
            term => {
                let term = term.map(|part| self.term(part));
                self.elaborator.term(term)
            }
        };
        self.terms.insert(id.0, made);
        made
    }

    /// A comparison that stands for a condition, and is named as it was written.
    fn comparison(&mut self, relation: Relation, a: TermId, b: TermId) -> NodeId {
        self.elaborator.comparison((relation, a, b), self.text.clone(), self.dimension)
    }

    fn number(&mut self, num: &Num) -> TermId {
        self.elaborator.signal(num.clone(), self.dimension, self.span)
    }

    /// The same of a condition whose parts are known: each is named as it was written.
    fn part(&mut self, part: &Part) -> NodeId {
        match &part.form {
            Form::Named(inner) => self.part(inner),
            Form::Not(inner) => {
                let inner = self.part(inner);
                self.elaborator.node(Node::Not(inner))
            }
            Form::All(list) | Form::Any(list) => {
                let all = matches!(part.form, Form::All(_));
                let list = list.iter().map(|one| self.part(one)).collect();
                self.elaborator.node(if all { Node::And(list) } else { Node::Or(list) })
            }
            Form::Both(a, b) => {
                let (a, b) = (self.part(a), self.part(b));
                self.elaborator.iff(a, b)
            }
            Form::Plain(_) | Form::Each(..) | Form::Someone(..) => {
                self.text = self.elaborator.said_of(part);
                self.condition(&part.truth())
            }
        }
    }

    /// A condition of one state as a formula of comparisons.
    fn condition(&mut self, truth: &Bool) -> NodeId {
        match truth {
            Bool::Constant(value) => self.elaborator.node(Node::Constant(*value)),
            Bool::Not(inner) => {
                let inner = self.condition(inner);
                self.elaborator.node(Node::Not(inner))
            }
            Bool::And(list) | Bool::Or(list) => {
                let all = matches!(truth, Bool::And(_));
                let list = list.iter().map(|one| self.condition(one)).collect();
                self.elaborator.node(if all { Node::And(list) } else { Node::Or(list) })
            }
            Bool::Iff(a, b) => {
                let (a, b) = (self.condition(a), self.condition(b));
                self.elaborator.iff(a, b)
            }
            // Who has not come in yet has no numbers: then the truth decides.
            _ if self.elaborator.coming => {
                let margin = margin(truth);
                let same = (Box::new(margin.clone()), Box::new(margin.clone()));
                let is_number = Bool::Compare(Comparison::Equal, same.0, same.1);
                let margin = Num::If(Box::new(is_number), Box::new(margin), Box::new(infinite(truth)));
                let (margin, zero) = (self.number(&margin), self.elaborator.term(Term::Constant(0.0)));
                self.comparison(Relation::Greater, margin, zero)
            }
            Bool::Compare(comparison, a, b)
                if !matches!(comparison, Comparison::Equal | Comparison::Unequal)
                    && depth(truth).is_none() =>
            {
                let (a, b) = (self.number(a), self.number(b));
                self.comparison(relation(*comparison), a, b)
            }
            _ => {
                let margin = self.number(&margin(truth));
                let zero = self.elaborator.term(Term::Constant(0.0));
                self.comparison(Relation::Greater, margin, zero)
            }
        }
    }
}

fn combine(operator: Arithmetic, a: Num, b: Num) -> Num {
    Num::Combine(operator, Box::new(a), Box::new(b))
}

fn negated(a: Num) -> Num {
    Num::Apply(Function::Negate, Box::new(a))
}

/// Yes or no: as far as can be from the other answer.
fn infinite(truth: &Bool) -> Num {
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
fn depth(truth: &Bool) -> Option<Num> {
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
