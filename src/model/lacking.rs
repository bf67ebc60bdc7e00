//! Which expressions can be undefined: a mean, a centroid or a spread of an empty set.
//!
//! Sets of people who are always there cannot be empty by chance, but whether they are is not asked here: an answer
//! "it can" is always safe.

use super::expression::{Bool, Fold, Num, Place};

impl Num {
    /// Whether it can lack a value in some state.
    pub fn may_lack_value(&self) -> bool {
        let lacks = |place: &Place| match place {
            Place::Centroid(_) => true,
            Place::Point(x, y) => x.may_lack_value() || y.may_lack_value(),
            Place::Agent(_) | Place::Region(_) | Place::Barrier(_) => false,
        };
        match self {
            Self::Constant(_) | Self::Time | Self::Variable(_) | Self::Of(..) | Self::OfTwo(..) => false,
            Self::OfSet(..) | Self::Fold(Fold::Mean, ..) | Self::Crossings(_, Some(_)) => true,
            Self::Crossings(_, None) | Self::Voronoi(_) => false,
            Self::Coordinate(_, place) | Self::Depth(place, _) => lacks(place),
            Self::Distance(a, b) => lacks(a) || lacks(b),
            Self::Apply(_, a) | Self::Fold(_, _, a) => a.may_lack_value(),
            Self::Combine(_, a, b) => a.may_lack_value() || b.may_lack_value(),
            Self::Count(_, condition) => condition.may_lack_value(),
            Self::If(condition, a, b) => {
                condition.may_lack_value() || a.may_lack_value() || b.may_lack_value()
            }
        }
    }
}

impl Bool {
    /// Whether it can lack a truth value in some state.
    pub fn may_lack_value(&self) -> bool {
        match self {
            Self::Constant(_) | Self::Present(_) | Self::In(..) | Self::Contact(_) | Self::Touching(..) => {
                false
            }
            Self::Compare(_, a, b) => a.may_lack_value() || b.may_lack_value(),
            Self::Iff(a, b) => a.may_lack_value() || b.may_lack_value(),
            Self::Not(a) | Self::Forall(_, a) | Self::Exists(_, a) => a.may_lack_value(),
            Self::And(all) | Self::Or(all) => all.iter().any(Self::may_lack_value),
        }
    }
}
