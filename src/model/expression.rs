//! Expressions over one state: typed, in SI units, with agents as indices.
//!
//! The kernel turns them into linear code over lane vectors.

use super::agent::AgentId;
use super::function::{Collective, Field, Pair};
use super::index::VariableId;
use super::scene::{BarrierId, LineId, RegionId};
use std::sync::Arc;

/// An agent: a fixed one, or the one that the n-th enclosing fold or quantifier runs over, counted
/// from the outermost (0).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Who {
    /// This one.
    Agent(AgentId),
    /// The running one of an enclosing fold.
    Running(u32),
}

/// A set of agents. Only those present count.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    /// Ascending.
    pub members: Arc<[AgentId]>,
    /// Left out, if a member.
    pub except: Option<Who>,
}

/// Axis of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
}

/// Something with a distance to other things.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Centre of an agent's body.
    Agent(Who),
    /// A point.
    Point(Box<Num>, Box<Num>),
    /// Mean position of a set; undefined for an empty set.
    Centroid(Set),
    /// A region: distance 0 inside. Only in distances.
    Region(RegionId),
    /// A wall or obstacle: negative inside a solid. Only in distances.
    Barrier(BarrierId),
}

/// How a fold joins the values of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fold {
    /// Smallest; infinite over an empty set.
    Min,
    /// Largest; minus infinity over an empty set.
    Max,
    /// Sum, ascending; 0 over an empty set.
    Sum,
    /// Mean; undefined over an empty set.
    Mean,
}

/// Arithmetic of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Arithmetic {
    /// Sum.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
    /// Power.
    Power,
    /// Smaller of two.
    Min,
    /// Larger of two.
    Max,
    /// Angle of the point (second, first): atan2(first, second).
    Atan2,
    /// Remainder with the sign of the divisor.
    Modulo,
    /// How far two margins are from differing in sign: the magnitude of the smaller, negative if the signs differ. The
    /// margin of "both or neither".
    Agree,
}

/// Functions of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    /// The other sign.
    Negate,
    /// Magnitude.
    Abs,
    /// Square root.
    Sqrt,
    /// Exponential.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Largest whole number not above.
    Floor,
    /// Smallest whole number not below.
    Ceil,
    /// Nearest whole number, halves away from zero.
    Round,
    /// Level of service of an area per person, m²: 1 for A to 6 for F.
    ServiceLevel,
}

/// Comparisons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
    /// `==`
    Equal,
    /// `!=`
    Unequal,
}

/// A number of one state.
#[derive(Clone, Debug, PartialEq)]
pub enum Num {
    /// The same in every state.
    Constant(f64),
    /// Seconds since the start (steps where steps have no length).
    Time,
    /// A variable of a process; truth values are 0 and 1.
    Variable(VariableId),
    /// A number of an agent.
    Of(Field, Who),
    /// A coordinate of a place (no region or barrier), m.
    Coordinate(Axis, Place),
    /// Distance of two places, m. Of two agents: of their centres.
    Distance(Place, Place),
    /// How deep a place (no region or barrier) lies in a region, m: its distance from the rim, negative
    /// outside.
    Depth(Place, RegionId),
    /// A number of two agents.
    OfTwo(Pair, Who, Who),
    /// A number of a set.
    OfSet(Collective, Set),
    /// How many agents have crossed a line, each counted once; with a number of ticks, only in the last so many. It has no
    /// value before the end of so many ticks.
    Crossings(LineId, Option<u64>),
    /// Voronoi density of a region, 1/m².
    Voronoi(RegionId),
    /// A function of a number.
    Apply(Function, Box<Num>),
    /// Arithmetic of two numbers.
    Combine(Arithmetic, Box<Num>, Box<Num>),
    /// A fold over a set; inside `body`, the running agent is the next `Who::Running`.
    Fold(Fold, Set, Box<Num>),
    /// Number of members of a set for which the condition holds.
    Count(Set, Box<Bool>),
    /// One of two numbers.
    If(Box<Bool>, Box<Num>, Box<Num>),
}

/// A truth value of one state.
#[derive(Clone, Debug, PartialEq)]
pub enum Bool {
    /// The same in every state.
    Constant(bool),
    /// Comparison of two numbers. False where a side is not a number.
    Compare(Comparison, Box<Num>, Box<Num>),
    /// Not.
    Not(Box<Bool>),
    /// All of them.
    And(Vec<Bool>),
    /// Any of them.
    Or(Vec<Bool>),
    /// Both or neither.
    Iff(Box<Bool>, Box<Bool>),
    /// Whether an agent is in the scene.
    Present(Who),
    /// Whether the centre of an agent's body is in a region.
    In(Who, RegionId),
    /// Whether an agent's body touches any other body, wall or obstacle.
    Contact(Who),
    /// Whether the bodies of two agents touch.
    Touching(Who, Who),
    /// Whether it holds for all members; true for an empty set.
    Forall(Set, Box<Bool>),
    /// Whether it holds for some member; false for an empty set.
    Exists(Set, Box<Bool>),
}
