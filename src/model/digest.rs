//! Hashes of expressions, for tables of those that are known. Equal expressions have equal hashes.

use super::expression::{Bool, Num, Place, Set};
use std::hash::{Hash, Hasher};
use std::mem::discriminant;

impl Hash for Set {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // Sets are long and there are few: their ends tell them apart well enough.
        (self.members.len(), self.members.first(), self.members.last(), self.except).hash(state);
    }
}

impl Hash for Place {
    fn hash<H: Hasher>(&self, state: &mut H) {
        discriminant(self).hash(state);
        match self {
            Self::Agent(who) => who.hash(state),
            Self::Point(x, y) => (x, y).hash(state),
            Self::Centroid(set) => set.hash(state),
            Self::Region(region) => region.0.hash(state),
            Self::Barrier(barrier) => barrier.0.hash(state),
        }
    }
}

impl Hash for Num {
    fn hash<H: Hasher>(&self, state: &mut H) {
        discriminant(self).hash(state);
        match self {
            // The two zeros are equal.
            Self::Constant(value) => (value + 0.0).to_bits().hash(state),
            Self::Time => {}
            Self::Variable(variable) => variable.0.hash(state),
            Self::Of(field, who) => (field, who).hash(state),
            Self::Coordinate(axis, place) => (axis, place).hash(state),
            Self::Distance(a, b) => (a, b).hash(state),
            Self::Depth(place, region) => (place, region.0).hash(state),
            Self::OfTwo(pair, a, b) => (pair, a, b).hash(state),
            Self::Crossings(line, window) => (line, window).hash(state),
            Self::Voronoi(region) => region.hash(state),
            Self::OfSet(collective, set) => (collective, set).hash(state),
            Self::Apply(function, a) => (function, a).hash(state),
            Self::Combine(operator, a, b) => (operator, a, b).hash(state),
            Self::Fold(fold, set, body) => (fold, set, body).hash(state),
            Self::Count(set, body) => (set, body).hash(state),
            Self::If(condition, a, b) => (condition, a, b).hash(state),
        }
    }
}

impl Hash for Bool {
    fn hash<H: Hasher>(&self, state: &mut H) {
        discriminant(self).hash(state);
        match self {
            Self::Constant(value) => value.hash(state),
            Self::Compare(comparison, a, b) => (comparison, a, b).hash(state),
            Self::Not(a) => a.hash(state),
            Self::And(list) | Self::Or(list) => list.hash(state),
            Self::Iff(a, b) => (a, b).hash(state),
            Self::Present(who) | Self::Contact(who) => who.hash(state),
            Self::In(who, region) => (who, region.0).hash(state),
            Self::Touching(a, b) => (a, b).hash(state),
            Self::Forall(set, body) | Self::Exists(set, body) => (set, body).hash(state),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{AgentId, Arithmetic, Field, Who};
    use std::hash::DefaultHasher;

    fn digest(item: &impl Hash) -> u64 {
        let mut hasher = DefaultHasher::new();
        item.hash(&mut hasher);
        hasher.finish()
    }

    #[test]
    fn equal_expressions_have_equal_digests_and_others_hardly_ever() {
        let speed = |id| Num::Of(Field::Speed, Who::Agent(AgentId(id)));
        let twice = |a: Num| Num::Combine(Arithmetic::Multiply, Box::new(a), Box::new(Num::Constant(2.0)));
        assert_eq!(digest(&twice(speed(3))), digest(&twice(speed(3))));
        assert_ne!(digest(&twice(speed(3))), digest(&twice(speed(4))));
        assert_eq!(Num::Constant(0.0), Num::Constant(-0.0));
        assert_eq!(digest(&Num::Constant(0.0)), digest(&Num::Constant(-0.0)));
        let set = |members: &[u32], except| Set {
            members: members.iter().map(|&id| AgentId(id)).collect(),
            except,
        };
        let all = Bool::Forall(set(&[1, 2], None), Box::new(Bool::Constant(true)));
        let any = Bool::Exists(set(&[1, 2], None), Box::new(Bool::Constant(true)));
        assert_ne!(digest(&all), digest(&any));
        assert_ne!(digest(&set(&[1, 2], None)), digest(&set(&[1, 2], Some(Who::Running(0)))));
    }
}
