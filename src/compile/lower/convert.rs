//! What an expression gives is taken as a number, a place, an agent, a condition or a formula.

use crate::compile::context::{Context, Lowered, MOST_NODES, number::Number, typed::Typed};
use crate::compile::dimension::Dimension;
use crate::compile::lower::weight::Weight;
use crate::logic::{Node, NodeId, TermId};
use crate::model::{Axis, Bool, Num, Place, Set, Who};
use crate::syntax::source::Span;

impl Context<'_> {
    /// A number known at compile time, of a given dimension.
    pub(crate) fn as_known_of(&mut self, typed: Typed, span: Span, dimension: Dimension) -> Lowered<Number> {
        let number = self.as_known(typed, span)?;
        if number.dimension != dimension {
            return self.wrong_dimension(span, dimension, number.dimension);
        }
        if !number.value.is_finite() {
            return self.report(error!(E0405, span, "the value is not a finite number"));
        }
        Ok(number)
    }

    /// A number known at compile time.
    pub(crate) fn as_known(&mut self, typed: Typed, span: Span) -> Lowered<Number> {
        match typed {
            Typed::Number(number) => Ok(number),
            found @ (Typed::Num(..) | Typed::Term(..)) => {
                let when = match &found {
                    Typed::Num(num, _) if num.is_fixed() => "is computed in each trial",
                    Typed::Num(num, _) if num.is_drawn() => "is drawn in each trial",
                    _ => "changes during a trial",
                };
                let said = "the value must be known before a trial starts";
                let error = error!(E0304, span, "{said}");
                self.report(error.label(format!("{} that {when}", found.noun())))
            }
            found => self.mismatch(span, "a number", &found),
        }
    }

    /// A number of one state.
    pub(crate) fn as_num(&mut self, typed: Typed, span: Span) -> Lowered<(Num, Dimension)> {
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
    pub(crate) fn as_term(&mut self, typed: Typed, span: Span) -> Lowered<(TermId, Dimension)> {
        match typed {
            Typed::Term(term, dimension) => Ok((term, dimension)),
            other => {
                let (num, dimension) = self.as_num(other, span)?;
                Ok((self.signal(num, dimension, span), dimension))
            }
        }
    }

    /// A formula.
    pub(crate) fn as_formula(&mut self, typed: Typed, span: Span) -> Lowered<NodeId> {
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
        Some(match &self.observed.tree.nodes[node.0 as usize] {
            Node::Constant(value) => Bool::Constant(*value),
            Node::Atom(atom) => {
                let truth = &self.observed.atoms[atom.0 as usize];
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
    pub(crate) fn as_truth(&mut self, typed: Typed, span: Span) -> Lowered<Bool> {
        match typed {
            Typed::Truth(truth, _) => Ok(truth),
            Typed::Formula(node) => {
                let mut size = 0;
                let written = self.of_one_state(node, &mut 10_000, &mut size);
                self.extent.nodes = self.extent.nodes.saturating_add(size);
                if self.extent.nodes > MOST_NODES {
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
    pub(crate) fn as_agent(&mut self, typed: Typed, span: Span) -> Lowered<Who> {
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
    pub(crate) fn as_set(&mut self, typed: Typed, span: Span) -> Lowered<Set> {
        match typed {
            Typed::Agents { set, .. } => Ok(set),
            Typed::Agent(Who::Agent(id)) => Ok(Set { members: [id].into(), except: None }),
            found => self.mismatch(span, "a set of agents", &found),
        }
    }

    /// Something with a distance.
    pub(crate) fn as_place(&mut self, typed: Typed, span: Span) -> Lowered<Place> {
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
    pub(crate) fn as_vector(&mut self, typed: Typed, span: Span) -> Lowered<(Num, Num, Dimension)> {
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
}

/// The coordinates of an agent or centroid.
pub(crate) fn coordinates(place: Place) -> (Num, Num) {
    (Num::Coordinate(Axis::X, place.clone()), Num::Coordinate(Axis::Y, place))
}
