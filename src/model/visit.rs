//! One walk over the variants of expressions: which parts an expression has, and the same expression with other agents.
//!
//! Questions about all parts are asked through it, so that a new variant is described here once:
//!
//! ```text
//! distance(a, centroid(S)) < 2 m      Bool ── Num ── Place ── Who(a)
//!                                         │       └─ Place ── Set ── Who(whoever is left out)
//!                                         └─ Num (2 m)
//! ```

use super::agent::AgentId;
use super::expression::{Bool, Fold, Num, Place, Set, Who};

/// A part of an expression.
#[derive(Clone, Copy, Debug)]
pub enum Part<'p> {
    /// A number.
    Num(&'p Num),
    /// A truth value.
    Bool(&'p Bool),
    /// Something with a distance to other things.
    Place(&'p Place),
    /// A set of agents.
    Set(&'p Set),
    /// An agent that is named: not as a member of a set.
    Who(Who),
}

impl<'p> Part<'p> {
    /// Tells of the parts that it is made of, from left to right.
    pub fn parts(self, tell: &mut dyn FnMut(Part<'p>)) {
        match self {
            Self::Num(num) => match num {
                Num::Constant(_) | Num::Time | Num::Variable(_) | Num::Crossings(..) | Num::Voronoi(_) => {}
                Num::Of(_, who) => tell(Part::Who(*who)),
                Num::Coordinate(_, place) | Num::Depth(place, _) => tell(Part::Place(place)),
                Num::Distance(a, b) => {
                    tell(Part::Place(a));
                    tell(Part::Place(b));
                }
                Num::OfTwo(_, a, b) => {
                    tell(Part::Who(*a));
                    tell(Part::Who(*b));
                }
                Num::OfSet(_, set) => tell(Part::Set(set)),
                Num::Apply(_, a) => tell(Part::Num(a)),
                Num::Combine(_, a, b) => {
                    tell(Part::Num(a));
                    tell(Part::Num(b));
                }
                Num::Fold(_, set, body) => {
                    tell(Part::Set(set));
                    tell(Part::Num(body));
                }
                Num::Count(set, body) => {
                    tell(Part::Set(set));
                    tell(Part::Bool(body));
                }
                Num::If(condition, a, b) => {
                    tell(Part::Bool(condition));
                    tell(Part::Num(a));
                    tell(Part::Num(b));
                }
            },
            Self::Bool(truth) => match truth {
                Bool::Constant(_) => {}
                Bool::Compare(_, a, b) => {
                    tell(Part::Num(a));
                    tell(Part::Num(b));
                }
                Bool::Not(a) => tell(Part::Bool(a)),
                Bool::And(all) | Bool::Or(all) => all.iter().for_each(|one| tell(Part::Bool(one))),
                Bool::Iff(a, b) => {
                    tell(Part::Bool(a));
                    tell(Part::Bool(b));
                }
                Bool::Present(who) | Bool::In(who, _) | Bool::Contact(who) => tell(Part::Who(*who)),
                Bool::Touching(a, b) => {
                    tell(Part::Who(*a));
                    tell(Part::Who(*b));
                }
                Bool::Forall(set, body) | Bool::Exists(set, body) => {
                    tell(Part::Set(set));
                    tell(Part::Bool(body));
                }
            },
            Self::Place(place) => match place {
                Place::Agent(who) => tell(Part::Who(*who)),
                Place::Point(x, y) => {
                    tell(Part::Num(x));
                    tell(Part::Num(y));
                }
                Place::Centroid(set) => tell(Part::Set(set)),
                Place::Region(_) | Place::Barrier(_) => {}
            },
            Self::Set(set) => set.except.into_iter().for_each(|who| tell(Part::Who(who))),
            Self::Who(_) => {}
        }
    }

    /// Whether something is so of all parts that it is made of; each is asked.
    pub(super) fn all(self, is: &mut dyn FnMut(Part<'p>) -> bool) -> bool {
        let mut all = true;
        self.parts(&mut |part| all &= is(part));
        all
    }

    /// Whether its value depends on its parts alone, or on nothing, wherever people are.
    pub(super) fn is_composed(self) -> bool {
        match self {
            Self::Num(num) => {
                matches!(num, Num::Constant(_) | Num::Apply(..) | Num::Combine(..) | Num::If(..))
            }
            Self::Bool(truth) => matches!(
                truth,
                Bool::Constant(_)
                    | Bool::Compare(..)
                    | Bool::Not(_)
                    | Bool::And(_)
                    | Bool::Or(_)
                    | Bool::Iff(..)
            ),
            Self::Place(_) | Self::Set(_) | Self::Who(_) => false,
        }
    }

    /// Tells of each agent that is named.
    fn mentions(self, tell: &mut dyn FnMut(AgentId)) {
        if let Self::Who(Who::Agent(id)) = self {
            tell(id);
        }
        self.parts(&mut |part| part.mentions(tell));
    }

    /// Whether it can lack a value though its parts have one: a mean, a centroid or a spread of an empty set, and what has
    /// crossed a line in a time that has not passed. Sets of people who are always there cannot be empty by chance, but
    /// whether they are is not asked here: an answer "it can" is always safe.
    fn lacks_value(self) -> bool {
        match self {
            Self::Num(num) => {
                matches!(num, Num::OfSet(..) | Num::Fold(Fold::Mean, ..) | Num::Crossings(_, Some(_)))
            }
            Self::Place(place) => matches!(place, Place::Centroid(_)),
            Self::Bool(_) | Self::Set(_) | Self::Who(_) => false,
        }
    }

    /// Whether something is so of it or of a part inside.
    fn has(self, is: &dyn Fn(Part<'p>) -> bool) -> bool {
        let mut found = is(self);
        if !found {
            self.parts(&mut |part| found = found || part.has(is));
        }
        found
    }
}

impl Num {
    /// Tells of each agent that is named, not as a member of a set, perhaps more than once.
    pub fn mentions(&self, tell: &mut dyn FnMut(AgentId)) {
        Part::Num(self).mentions(tell);
    }

    /// Whether it can lack a value in some state.
    pub fn may_lack_value(&self) -> bool {
        Part::Num(self).has(&Part::lacks_value)
    }

    /// Said of one member of the outermost fold or quantifier that it stands in.
    #[must_use]
    pub fn of_member(&self, id: AgentId) -> Self {
        self.map(&|who| who.of_member(id))
    }

    /// The same number of other agents.
    fn map(&self, who: &dyn Fn(Who) -> Who) -> Self {
        let num = |inner: &Self| Box::new(inner.map(who));
        match self {
            Self::Constant(_) | Self::Time | Self::Variable(_) | Self::Crossings(..) | Self::Voronoi(_) => {
                self.clone()
            }
            Self::Of(field, a) => Self::Of(*field, who(*a)),
            Self::Coordinate(axis, place) => Self::Coordinate(*axis, place.map(who)),
            Self::Distance(a, b) => Self::Distance(a.map(who), b.map(who)),
            Self::Depth(place, region) => Self::Depth(place.map(who), *region),
            Self::OfTwo(pair, a, b) => Self::OfTwo(*pair, who(*a), who(*b)),
            Self::OfSet(collective, set) => Self::OfSet(*collective, set.map(who)),
            Self::Apply(function, a) => Self::Apply(*function, num(a)),
            Self::Combine(operator, a, b) => Self::Combine(*operator, num(a), num(b)),
            Self::Fold(fold, set, body) => Self::Fold(*fold, set.map(who), num(body)),
            Self::Count(set, body) => Self::Count(set.map(who), Box::new(body.map(who))),
            Self::If(condition, a, b) => Self::If(Box::new(condition.map(who)), num(a), num(b)),
        }
    }
}

impl Bool {
    /// Tells of each agent that is named, not as a member of a set, perhaps more than once.
    pub fn mentions(&self, tell: &mut dyn FnMut(AgentId)) {
        Part::Bool(self).mentions(tell);
    }

    /// Whether it can lack a truth value in some state.
    pub fn may_lack_value(&self) -> bool {
        Part::Bool(self).has(&Part::lacks_value)
    }

    /// Said of one member of the outermost fold or quantifier that it stands in.
    #[must_use]
    pub fn of_member(&self, id: AgentId) -> Self {
        self.map(&|who| who.of_member(id))
    }

    /// The same truth value of other agents.
    fn map(&self, who: &dyn Fn(Who) -> Who) -> Self {
        let truth = |inner: &Self| Box::new(inner.map(who));
        match self {
            Self::Constant(_) => self.clone(),
            Self::Compare(comparison, a, b) => {
                Self::Compare(*comparison, Box::new(a.map(who)), Box::new(b.map(who)))
            }
            Self::Not(a) => Self::Not(truth(a)),
            Self::And(all) => Self::And(all.iter().map(|one| one.map(who)).collect()),
            Self::Or(all) => Self::Or(all.iter().map(|one| one.map(who)).collect()),
            Self::Iff(a, b) => Self::Iff(truth(a), truth(b)),
            Self::Present(a) => Self::Present(who(*a)),
            Self::In(a, region) => Self::In(who(*a), *region),
            Self::Contact(a) => Self::Contact(who(*a)),
            Self::Touching(a, b) => Self::Touching(who(*a), who(*b)),
            Self::Forall(set, body) => Self::Forall(set.map(who), truth(body)),
            Self::Exists(set, body) => Self::Exists(set.map(who), truth(body)),
        }
    }
}

impl Place {
    fn map(&self, who: &dyn Fn(Who) -> Who) -> Self {
        match self {
            Self::Agent(a) => Self::Agent(who(*a)),
            Self::Point(x, y) => Self::Point(Box::new(x.map(who)), Box::new(y.map(who))),
            Self::Centroid(set) => Self::Centroid(set.map(who)),
            Self::Region(_) | Self::Barrier(_) => self.clone(),
        }
    }
}

impl Set {
    fn map(&self, who: &dyn Fn(Who) -> Who) -> Self {
        Self { members: self.members.clone(), except: self.except.map(who) }
    }
}

impl Who {
    /// The running agent of the outermost fold becomes this one; those of inner ones move up a place.
    fn of_member(self, id: AgentId) -> Self {
        match self {
            Self::Running(0) => Self::Agent(id),
            Self::Running(n) => Self::Running(n - 1),
            Self::Agent(_) => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Comparison, Field};

    #[test]
    fn those_named_are_told_and_members_of_sets_are_not() {
        let agent = |n| Who::Agent(AgentId(n));
        let set = Set { members: [AgentId(1), AgentId(2)].into(), except: Some(agent(2)) };
        let running = Num::Distance(Place::Agent(agent(4)), Place::Agent(Who::Running(0)));
        let near = Bool::Compare(Comparison::Less, Box::new(running), Box::new(Num::Constant(1.0)));
        let all = Bool::And(vec![
            Bool::Forall(set, Box::new(near)),
            Bool::Compare(Comparison::Equal, Box::new(Num::Of(Field::Speed, agent(7))), Box::new(Num::Time)),
        ]);
        let mut named = Vec::new();
        all.mentions(&mut |id| named.push(id.0));
        assert_eq!(named, [2, 4, 7]);
    }

    #[test]
    fn of_a_member_the_outermost_running_agent_is_said_and_inner_ones_move_up() {
        let apart = |a, b| Num::Distance(Place::Agent(a), Place::Agent(b));
        let set = |except| Set { members: [AgentId(1), AgentId(2)].into(), except: Some(except) };
        let within = |outer, inner, set| Num::Fold(Fold::Min, set, Box::new(apart(outer, inner)));
        let body = within(Who::Running(0), Who::Running(1), set(Who::Running(0)));
        let one = Who::Agent(AgentId(5));
        assert_eq!(body.of_member(AgentId(5)), within(one, Who::Running(0), set(one)));
    }

    #[test]
    fn means_and_centroids_may_lack_a_value_wherever_they_stand() {
        let set = || Set { members: [AgentId(1)].into(), except: None };
        let speed = || Box::new(Num::Of(Field::Speed, Who::Running(0)));
        let from_middle = Num::Distance(Place::Centroid(set()), Place::Agent(Who::Agent(AgentId(0))));
        let near = Bool::Compare(Comparison::Less, Box::new(from_middle), Box::new(Num::Constant(1.0)));
        assert!(near.may_lack_value() && Num::Count(set(), Box::new(near)).may_lack_value());
        assert!(Num::Fold(Fold::Mean, set(), speed()).may_lack_value());
        assert!(!Num::Fold(Fold::Max, set(), speed()).may_lack_value());
    }
}
