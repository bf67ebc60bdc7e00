//! Which agents an expression names one by one, rather than as members of a set.

use super::agent::AgentId;
use super::expression::{Bool, Num, Place, Set, Who};

/// Tells of each agent that is named.
type Tell<'t> = &'t mut dyn FnMut(AgentId);

impl Who {
    fn mentions(self, tell: Tell<'_>) {
        if let Self::Agent(id) = self {
            tell(id);
        }
    }
}

impl Set {
    fn mentions(&self, tell: Tell<'_>) {
        if let Some(who) = self.except {
            who.mentions(tell);
        }
    }
}

impl Place {
    fn mentions(&self, tell: Tell<'_>) {
        match self {
            Self::Agent(who) => who.mentions(tell),
            Self::Point(x, y) => {
                x.mentions(tell);
                y.mentions(tell);
            }
            Self::Centroid(set) => set.mentions(tell),
            Self::Region(_) | Self::Barrier(_) => {}
        }
    }
}

impl Num {
    /// Tells of each agent that is named, perhaps more than once.
    pub fn mentions(&self, tell: Tell<'_>) {
        match self {
            Self::Constant(_) | Self::Time | Self::Variable(_) | Self::Crossings(..) | Self::Voronoi(_) => {}
            Self::Of(_, who) => who.mentions(tell),
            Self::Coordinate(_, place) | Self::Depth(place, _) => place.mentions(tell),
            Self::OfSet(_, set) => set.mentions(tell),
            Self::Distance(a, b) => {
                a.mentions(tell);
                b.mentions(tell);
            }
            Self::OfTwo(_, a, b) => {
                a.mentions(tell);
                b.mentions(tell);
            }
            Self::Apply(_, a) => a.mentions(tell),
            Self::Combine(_, a, b) => {
                a.mentions(tell);
                b.mentions(tell);
            }
            Self::Fold(_, set, body) => {
                set.mentions(tell);
                body.mentions(tell);
            }
            Self::Count(set, body) => {
                set.mentions(tell);
                body.mentions(tell);
            }
            Self::If(condition, a, b) => {
                condition.mentions(tell);
                a.mentions(tell);
                b.mentions(tell);
            }
        }
    }
}

impl Bool {
    /// Tells of each agent that is named, perhaps more than once.
    pub fn mentions(&self, tell: Tell<'_>) {
        match self {
            Self::Constant(_) => {}
            Self::Compare(_, a, b) => {
                a.mentions(tell);
                b.mentions(tell);
            }
            Self::Iff(a, b) => {
                a.mentions(tell);
                b.mentions(tell);
            }
            Self::Not(a) => a.mentions(tell),
            Self::And(all) | Self::Or(all) => all.iter().for_each(|one| one.mentions(tell)),
            Self::Present(who) | Self::In(who, _) | Self::Contact(who) => who.mentions(tell),
            Self::Touching(a, b) => {
                a.mentions(tell);
                b.mentions(tell);
            }
            Self::Forall(set, body) | Self::Exists(set, body) => {
                set.mentions(tell);
                body.mentions(tell);
            }
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
}
