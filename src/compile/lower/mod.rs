//! Lowering of expressions: names, units and types are settled, sugar is gone.

mod arithmetic;
mod builtin;
mod call;
mod gist;
mod legs;
mod logic;
mod mention;
mod misread;
mod name;
mod quantifier;
mod select;
mod tally;
mod temporal;
mod traffic;

pub(super) use builtin::{BUILT_IN, DISTRIBUTIONS, OPERATORS};
pub(super) use logic::relation;

use super::dimension::{self, Dimension};
use super::elaborator::{Elaborator, Locals, Lowered, MOST_NODES, Reported};
use super::number::Number;
use super::study::{Form, Part};
use super::typed::Typed;
use super::weight::Weight;
use crate::logic::{Node, NodeId, TermId};
use crate::model::{Axis, Bool, Num, Place, Set, Who};
use crate::syntax::ast::{Expr, ExprKind, Ident, UnaryOp};
use crate::syntax::source::Span;
use std::sync::Arc;

impl Elaborator<'_> {
    /// What an expression means.
    pub(super) fn lower(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Typed> {
        self.descend(expr.span)?;
        let around = std::mem::replace(&mut self.frame, locals.frame.clone());
        let lowered = match self.lower_kind(expr, locals) {
            Ok(Typed::Truth(truth, phrase)) if self.temporal => {
                Ok(self.phrased(expr, (truth, phrase), locals))
            }
            other => other,
        };
        self.frame = around;
        self.depth -= 1;
        lowered
    }

    /// A condition that knows how it is written here.
    fn phrased(&mut self, expr: &Expr, (truth, phrase): (Bool, Option<Arc<Part>>), locals: &Locals) -> Typed {
        let phrase = match (matches!(truth, Bool::Constant(_)), phrase, &expr.kind) {
            (true, ..) => None,
            (false, None, _) => self.phrase(expr.span, Form::Plain(truth.clone())),
            // An argument is what it stands for.
            (false, Some(inner), ExprKind::Name(name))
                if locals.names.iter().any(|(bound, _)| bound == name) =>
            {
                Some(inner)
            }
            (false, Some(inner), ExprKind::Name(_) | ExprKind::Call { .. } | ExprKind::Member(..)) => {
                self.phrase(expr.span, Form::Named(inner))
            }
            (false, phrase, _) => phrase,
        };
        Typed::Truth(truth, phrase)
    }

    /// What some expressions mean. What is wrong with each is said.
    pub(in crate::compile) fn lower_all<'e>(
        &mut self,
        exprs: impl IntoIterator<Item = &'e Expr>,
        locals: &Locals,
    ) -> Lowered<Vec<Typed>> {
        let lowered: Vec<_> = exprs.into_iter().map(|expr| self.lower(expr, locals)).collect();
        lowered.into_iter().collect()
    }

    fn lower_kind(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Typed> {
        match &expr.kind {
            ExprKind::Quantity(quantity) => {
                let unit = match &quantity.unit {
                    Some(unit) => match dimension::resolve(unit) {
                        Ok(unit) => unit,
                        Err(error) => return self.report(error),
                    },
                    None => return Ok(Typed::Number(Number::exact(quantity.value, Dimension::NONE))),
                };
                Ok(Typed::Number(Number::literal(quantity.value, &unit)))
            }
            ExprKind::Infinity => Ok(Typed::Infinity),
            ExprKind::Broken => Err(Reported),
            ExprKind::Bool(value) => Ok(Typed::truth(Bool::Constant(*value))),
            ExprKind::Text(text) => Ok(Typed::Text(text.clone())),
            ExprKind::Name(name) => self.lower_name(name, expr.span, locals),
            ExprKind::Member(base, field)
                if matches!(field.name.as_str(), "x" | "y") && !matches!(base.kind, ExprKind::Name(_)) =>
            {
                let typed = self.lower(base, locals)?;
                // A variable of a process may be called so.
                if let Typed::Process { .. } | Typed::Processes(_) = typed {
                    return self.lower_member(base, field, locals);
                }
                // So may a behaviour.
                if matches!(typed, Typed::Agent(_))
                    && self.behaviours.iter().any(|decl| decl.name.name == field.name)
                {
                    return self.lower_member(base, field, locals);
                }
                if let Typed::Point(x, y) = typed {
                    return Ok(Typed::Number(if field.name == "x" { x } else { y }));
                }
                let (x, y, dimension) = self.as_vector(typed, base.span)?;
                Ok(Typed::Num(if field.name == "x" { x } else { y }, dimension))
            }
            ExprKind::Member(base, member) => self.lower_member(base, member, locals),
            ExprKind::Index(base, index) => self.lower_index(base, index, locals),
            ExprKind::Call { function, arguments } => self.lower_call(expr, function, arguments, locals),
            ExprKind::Point { x, y, unit } => self.lower_point(x, y, unit.as_ref(), locals),
            ExprKind::Unary(UnaryOp::Minus, operand) => self.lower_minus(operand, locals),
            ExprKind::Unary(UnaryOp::Not, operand) => self.lower_not(expr.span, operand, locals),
            ExprKind::Binary(op, left, right) => self.lower_binary(expr, *op, left, right, locals),
            ExprKind::Quantified { quantifier, variable, set, body } => {
                self.lower_quantified(expr.span, *quantifier, variable, set, body, locals)
            }
            ExprKind::Temporal(op, bound, body) => {
                self.lower_temporal(expr.span, *op, bound.as_ref(), body, locals)
            }
            ExprKind::TemporalPair(op, bound, left, right) => {
                self.lower_temporal_pair(expr.span, *op, bound.as_ref(), left, right, locals)
            }
            ExprKind::Window(aggregate, bound, body) => {
                self.lower_window(expr.span, *aggregate, bound, body, locals)
            }
            ExprKind::At(inner, moment) => {
                let is_number = matches!(
                    &inner.kind,
                    ExprKind::Call { .. } | ExprKind::Member(..) | ExprKind::Name(_) | ExprKind::Quantity(_)
                );
                let read = Some(self.text(inner.span)).filter(|_| !is_number);
                self.misplaced_moment((expr.span, inner.span), read.as_deref(), moment)
            }
        }
    }

    fn lower_point(
        &mut self,
        x: &Expr,
        y: &Expr,
        unit: Option<&crate::syntax::ast::UnitExpr>,
        locals: &Locals,
    ) -> Lowered<Typed> {
        let coordinates = (self.lower(x, locals), self.lower(y, locals));
        let (first, second) = (coordinates.0?, coordinates.1?);
        let scale = match unit.map(dimension::resolve) {
            Some(Ok(unit)) => Some(unit),
            Some(Err(error)) => return self.report(error),
            None => None,
        };
        let metre = dimension::unit("m");
        let fixed = |this: &mut Self, typed: &Typed, span: Span| -> Lowered<Option<Number>> {
            let Typed::Number(number) = typed else { return Ok(None) };
            match (scale, number.dimension.is_none()) {
                // `(1, 2) m/s`: the unit belongs to both coordinates.
                (Some(unit), true) => {
                    Ok(number.times(Number::literal(crate::base::decimal::Decimal::ONE, &unit)))
                }
                (Some(_), false) => this
                    .report(error!(E0303, span, "both the coordinate and the point have a unit";
                        hint: "write the unit once, after the parenthesis or in each coordinate")),
                // A point without a unit is in metres.
                (None, true) => Ok(metre
                    .map(|m| Number::literal(crate::base::decimal::Decimal::ONE, &m))
                    .and_then(|m| number.times(m))),
                (None, false) => Ok(Some(*number)),
            }
        };
        let a = fixed(self, &first, x.span)?;
        let b = fixed(self, &second, y.span)?;
        if let (Some(a), Some(b)) = (a, b) {
            if a.dimension != b.dimension {
                return self.unlike_coordinates((x.span, a.dimension), (y.span, b.dimension));
            }
            return Ok(Typed::Point(a, b));
        }
        let (a, da) = self.as_num(first, x.span)?;
        let (b, db) = self.as_num(second, y.span)?;
        if da != db {
            return self.unlike_coordinates((x.span, da), (y.span, db));
        }
        Ok(Typed::Vector(a, b, da))
    }

    /// Of two coordinates of which one is a length or a speed, as those of points and velocities are, the other is wrong.
    fn unlike_coordinates<T>(&mut self, x: (Span, Dimension), y: (Span, Dimension)) -> Lowered<T> {
        let is_usual = |dimension| dimension == Dimension::LENGTH || dimension == Dimension::SPEED;
        let (right, wrong) = if is_usual(y.1) && !is_usual(x.1) { (y, x) } else { (x, y) };
        self.wrong_dimension(wrong.0, right.1, wrong.1)
    }

    /// A number of one state.
    pub(super) fn as_num(&mut self, typed: Typed, span: Span) -> Lowered<(Num, Dimension)> {
        match typed {
            Typed::Number(number) => Ok((Num::Constant(number.value), number.dimension)),
            Typed::Num(num, dimension) => Ok((num, dimension)),
            Typed::Tally(_) => self.report(
                error!(E0504, span, "a count of temporal formulas can only be compared with a number";
                    hint: "write for example `count(a in crowd: F<=5 s (a in exit)) >= 3`"),
            ),
            Typed::Term(..) => self.report(error!(
                E0504,
                span, "a value of one state is needed here, not an aggregate over time"
            )),
            found => self.mismatch(span, "a number", &found),
        }
    }

    /// A number of the states from the present one on.
    pub(super) fn as_term(&mut self, typed: Typed, span: Span) -> Lowered<(TermId, Dimension)> {
        match typed {
            Typed::Term(term, dimension) => Ok((term, dimension)),
            other => {
                let (num, dimension) = self.as_num(other, span)?;
                Ok((self.signal(num, dimension, span), dimension))
            }
        }
    }

    /// A formula.
    pub(super) fn as_formula(&mut self, typed: Typed, span: Span) -> Lowered<NodeId> {
        match typed {
            Typed::Formula(node) => Ok(node),
            Typed::Truth(truth, phrase) => Ok(self.atom(truth, span, phrase.as_ref())),
            found => self.mismatch(span, "a condition", &found),
        }
    }

    /// A formula as a truth value of one state, if it joins nothing but such values: implications are formulas, so
    /// that monitors see them, wherever they stand. `room` is left for so many parts: shared ones are written out.
    /// `size` counts what their conditions are made of.
    fn of_one_state(&self, node: NodeId, room: &mut u32, size: &mut u64) -> Option<Bool> {
        *room = room.checked_sub(1)?;
        let mut parts = |parts: &[NodeId]| -> Option<Vec<Bool>> {
            parts.iter().map(|part| self.of_one_state(*part, room, size)).collect()
        };
        Some(match &self.tree.nodes[node.0 as usize] {
            Node::Constant(value) => Bool::Constant(*value),
            Node::Atom(atom) => {
                let truth = &self.atoms[atom.0 as usize];
                *size += Weight::of_truth(truth).nodes();
                if *size > MOST_NODES {
                    return None;
                }
                truth.clone()
            }
            Node::Not(part) => Bool::Not(Box::new(self.of_one_state(*part, room, size)?)),
            Node::And(all) => Bool::And(parts(all)?),
            Node::Or(all) => Bool::Or(parts(all)?),
            _ => return None,
        })
    }

    /// A truth value of one state.
    pub(super) fn as_truth(&mut self, typed: Typed, span: Span) -> Lowered<Bool> {
        match typed {
            Typed::Truth(truth, _) => Ok(truth),
            Typed::Formula(node) => {
                let mut size = 0;
                let written = self.of_one_state(node, &mut 10_000, &mut size);
                self.nodes = self.nodes.saturating_add(size);
                if self.nodes > MOST_NODES {
                    return self.too_large(span);
                }
                if let Some(truth) = written {
                    return Ok(truth);
                }
                self.report(error!(
                    E0504,
                    span, "a condition of one state is needed here, not a temporal formula"
                ))
            }
            found => self.mismatch(span, "a condition", &found),
        }
    }

    /// One agent.
    pub(super) fn as_agent(&mut self, typed: Typed, span: Span) -> Lowered<Who> {
        match typed {
            Typed::Agent(who) => Ok(who),
            Typed::Agents { set, particle: true } if set.members.len() == 1 => Ok(Who::Agent(set.members[0])),
            found @ Typed::Agents { .. } => self
                .report(error!(E0305, span, "expected an agent, found {}", found.noun();
                    hint: "choose a member such as `crowd[1]`, or quantify: `forall a in crowd: …`")),
            found => self.mismatch(span, "an agent", &found),
        }
    }

    /// A set of agents.
    pub(super) fn as_set(&mut self, typed: Typed, span: Span) -> Lowered<Set> {
        match typed {
            Typed::Agents { set, .. } => Ok(set),
            Typed::Agent(Who::Agent(id)) => Ok(Set { members: [id].into(), except: None }),
            found => self.mismatch(span, "a set of agents", &found),
        }
    }

    /// Something with a distance.
    pub(super) fn as_place(&mut self, typed: Typed, span: Span) -> Lowered<Place> {
        match typed {
            Typed::Agent(who) => Ok(Place::Agent(who)),
            Typed::Agents { set, particle: true } if set.members.len() == 1 => {
                Ok(Place::Agent(Who::Agent(set.members[0])))
            }
            Typed::Region(id) => Ok(Place::Region(id)),
            Typed::Barrier(id) => Ok(Place::Barrier(id)),
            Typed::Point(x, y) => {
                if x.dimension != Dimension::LENGTH {
                    return self.wrong_dimension(span, Dimension::LENGTH, x.dimension);
                }
                Ok(Place::Point(Box::new(Num::Constant(x.value)), Box::new(Num::Constant(y.value))))
            }
            Typed::Vector(x, y, dimension) => {
                if dimension != Dimension::LENGTH {
                    return self.wrong_dimension(span, Dimension::LENGTH, dimension);
                }
                // Keep centroids and agents recognisable: they have fast instructions.
                if let (Num::Coordinate(Axis::X, a), Num::Coordinate(Axis::Y, b)) = (&x, &y)
                    && a == b
                {
                    return Ok(a.clone());
                }
                Ok(Place::Point(Box::new(x), Box::new(y)))
            }
            found @ Typed::Agents { .. } => {
                let error = error!(E0305, span, "expected a place, found {}", found.noun();
                        hint: "use `centroid(…)` or a member");
                self.report(error)
            }
            found => self.mismatch(span, "a place: an agent, point, region or wall", &found),
        }
    }

    /// The coordinates of something that has them.
    pub(super) fn as_vector(&mut self, typed: Typed, span: Span) -> Lowered<(Num, Num, Dimension)> {
        match typed {
            Typed::Vector(x, y, dimension) => Ok((x, y, dimension)),
            Typed::Point(x, y) => Ok((Num::Constant(x.value), Num::Constant(y.value), x.dimension)),
            other => match self.as_place(other, span)? {
                place @ (Place::Agent(_) | Place::Centroid(_)) => {
                    let (x, y) = coordinates(place);
                    Ok((x, y, Dimension::LENGTH))
                }
                Place::Point(x, y) => Ok((*x, *y, Dimension::LENGTH)),
                Place::Region(_) | Place::Barrier(_) => {
                    self.report(error!(E0305, span, "a region or an obstacle has no single position"))
                }
            },
        }
    }

    /// Reports a wrong number of arguments. They are looked at all the same.
    pub(in crate::compile) fn arity<T>(
        &mut self,
        function: &Ident,
        span: Span,
        wanted: &str,
        (arguments, locals): (&[Expr], &Locals),
    ) -> Lowered<T> {
        let found = arguments.len();
        self.note(error!(
            E0204,
            span,
            "`{}` needs {wanted}, but {found} {} given",
            function.name,
            if found == 1 { "is" } else { "are" }
        ));
        let _ = self.lower_all(arguments, locals);
        Err(Reported)
    }
}

/// Some number of arguments, as one says it.
pub(in crate::compile) fn counted_arguments(count: usize) -> String {
    format!("{count} argument{}", if count == 1 { "" } else { "s" })
}

/// The coordinates of an agent or centroid.
pub(super) fn coordinates(place: Place) -> (Num, Num) {
    (Num::Coordinate(Axis::X, place.clone()), Num::Coordinate(Axis::Y, place))
}
