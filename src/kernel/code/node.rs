//! Values of an expression as a graph in which equal values are one node.
//!
//! A node is a pure function of the state and of the running agents of the loops around it. It is
//! entered once (hash-consing), so that atoms share what they have in common, and operands always come
//! before their users.

use crate::model::{Arithmetic, Axis, Comparison, Field, Fold, Function, Pair, Who};
use std::collections::HashMap;

/// Number of a node; later that of a register.
pub(super) type Id = u32;

/// A number kept for each agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Reading {
    /// Position, first coordinate.
    X,
    /// Position, second coordinate.
    Y,
    /// Where the origin of coordinates there lies in the plane.
    Origin(Axis),
    /// A field.
    Field(Field),
}

/// A list of agents, less perhaps one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Crowd {
    /// Index of the list of members.
    pub(super) list: u32,
    /// Left out.
    pub(super) except: Option<Who>,
}

/// What is measured between two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Measure {
    /// Distance of the centres.
    Centres,
    /// Distance less the radius of the fixed body, less that of the running one.
    GapFixedFirst,
    /// Distance less the radius of the running body, less that of the fixed one.
    GapRunningFirst,
}

/// Which smallest measures may be given as something larger than they are, for nothing hangs on how large they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cut {
    /// None.
    Nowhere,
    /// Those above the least that somebody of a list gets.
    Least(u32),
    /// Those above a bound, by its bits.
    Above(u64),
}

/// How a loop joins the values of its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Join {
    /// A fold of numbers.
    Fold(Fold),
    /// How often a condition holds.
    Count,
    /// Whether it holds for all.
    Forall,
    /// Whether it holds for some.
    Exists,
}

/// A value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// A number, by its bits.
    Constant(u64),
    /// Time since the start.
    Time,
    /// A variable of a process.
    Variable(u32),
    /// A number of an agent.
    Of(Reading, Who),
    /// Distance of two centres.
    Distance(Who, Who),
    /// Distance of two points: x, y, x, y.
    Between([Id; 4]),
    /// Distance of a point from a region.
    ToRegion(Id, Id, u32),
    /// Depth of a point in a region.
    Depth(Id, Id, u32),
    /// Distance of a point from a barrier.
    ToBarrier(Id, Id, u32),
    /// Distance of a point from the nearest barrier.
    ToScene(Id, Id),
    /// A number of two agents.
    OfTwo(Pair, Who, Who),
    /// How many agents have crossed a line: all, or those of the last ticks.
    Crossings(u32, Option<u64>),
    /// Voronoi density of a region.
    Voronoi(u32),
    /// Mean of a reading over a crowd.
    Mean(Reading, Crowd),
    /// Root of the mean squared distance from a point.
    Spread(Crowd, Id, Id),
    /// Smallest measure between a body and a crowd.
    Nearest(Who, Crowd, Measure),
    /// A function.
    Apply(Function, Id),
    /// Arithmetic.
    Combine(Arithmetic, Id, Id),
    /// Condition, value if it holds, value if not.
    Select(Id, Id, Id),
    /// A loop over a crowd with the body's value; the number is that of the running agent.
    Loop(Join, Crowd, u32, Id),
    /// A truth value.
    Truth(bool),
    /// Comparison.
    Compare(Comparison, Id, Id),
    /// Not.
    Not(Id),
    /// All of them.
    And(Vec<Id>),
    /// Any of them.
    Or(Vec<Id>),
    /// Whether an agent's centre is in a region.
    Inside(Who, u32),
    /// Whether an agent is in the scene.
    Present(Who),
    /// Whether this member, from 0, of a source has come in.
    Entered(u32, u32),
    /// Whether some member is in the scene.
    Somebody(Crowd),
    /// Whether for all members the comparison of the measure with a bound that is the same for all has
    /// the wanted value. Only for comparisons that hold (fail, if that is wanted) far away.
    AllFar {
        /// The fixed body.
        who: Who,
        /// The running ones.
        crowd: Crowd,
        /// What is measured.
        measure: Measure,
        /// The comparison of the measure with the bound.
        test: Comparison,
        /// The value it must have.
        wanted: bool,
        /// The bound.
        bound: Id,
        /// The smallest measure over the same crowd, where something else needs it anyway.
        nearest: Option<Id>,
    },
}

impl Node {
    /// Whether it is a truth value.
    pub(super) const fn is_truth(&self) -> bool {
        match self {
            Self::Loop(join, ..) => matches!(join, Join::Forall | Join::Exists),
            Self::Truth(_)
            | Self::Compare(..)
            | Self::Not(_)
            | Self::And(_)
            | Self::Or(_)
            | Self::Inside(..)
            | Self::Present(_)
            | Self::Entered(..)
            | Self::Somebody(_)
            | Self::AllFar { .. } => true,
            _ => false,
        }
    }

    /// Its operands, to read or to renumber.
    pub(super) fn operands_mut(&mut self) -> Vec<&mut Id> {
        match self {
            Self::Between(four) => four.iter_mut().collect(),
            Self::ToRegion(x, y, _)
            | Self::Depth(x, y, _)
            | Self::ToBarrier(x, y, _)
            | Self::ToScene(x, y)
            | Self::Spread(_, x, y) => vec![x, y],
            Self::Apply(_, a) | Self::Loop(_, _, _, a) | Self::Not(a) => vec![a],
            Self::Combine(_, a, b) | Self::Compare(_, a, b) => vec![a, b],
            Self::Select(c, a, b) => vec![c, a, b],
            Self::And(all) | Self::Or(all) => all.iter_mut().collect(),
            Self::AllFar { bound, nearest, .. } => std::iter::once(bound).chain(nearest).collect(),
            Self::Constant(_)
            | Self::Time
            | Self::Variable(_)
            | Self::Of(..)
            | Self::Distance(..)
            | Self::OfTwo(..)
            | Self::Crossings(..)
            | Self::Voronoi(_)
            | Self::Mean(..)
            | Self::Nearest(..)
            | Self::Truth(_)
            | Self::Inside(..)
            | Self::Present(_)
            | Self::Entered(..)
            | Self::Somebody(_) => Vec::new(),
        }
    }

    /// Its operands.
    pub(super) fn operands(&self) -> Vec<Id> {
        self.clone().operands_mut().into_iter().map(|id| *id).collect()
    }

    /// Whether it can be computed for eight running agents of one trial at once: it walks over no crowd from which
    /// one of them is left out.
    pub(super) const fn is_lanewise(&self) -> bool {
        match self {
            Self::Loop(..) => false,
            Self::Mean(_, crowd) | Self::Spread(crowd, ..) | Self::Somebody(crowd) => {
                !matches!(crowd.except, Some(Who::Running(_)))
            }
            _ => true,
        }
    }

    /// The agents that it names itself, not through its operands.
    fn agents(&self) -> Vec<Who> {
        let (first, second) = match *self {
            Self::Of(_, who) | Self::Inside(who, _) | Self::Present(who) => (Some(who), None),
            Self::Distance(a, b) | Self::OfTwo(_, a, b) => (Some(a), Some(b)),
            Self::Mean(_, crowd)
            | Self::Spread(crowd, ..)
            | Self::Somebody(crowd)
            | Self::Loop(_, crowd, ..) => (crowd.except, None),
            Self::Nearest(who, crowd, _) | Self::AllFar { who, crowd, .. } => (Some(who), crowd.except),
            _ => (None, None),
        };
        first.into_iter().chain(second).collect()
    }
}

/// The graph.
#[derive(Debug, Default)]
pub(super) struct Graph {
    /// The nodes; operands come before their users.
    pub(super) nodes: Vec<Node>,
    /// The running agents on which each depends, ascending.
    free: Vec<Vec<u32>>,
    known: HashMap<Node, Id>,
}

impl Graph {
    /// The node with this value, entered if it is new.
    pub(super) fn enter(&mut self, node: Node) -> Id {
        if let Some(&id) = self.known.get(&node) {
            return id;
        }
        let mut free: Vec<u32> = Vec::new();
        for operand in node.operands() {
            free.extend(&self.free[operand as usize]);
        }
        if let Node::Loop(_, _, own, _) = node {
            free.retain(|&var| var != own);
        }
        free.extend(node.agents().iter().filter_map(|who| match *who {
            Who::Running(var) => Some(var),
            Who::Agent(_) => None,
        }));
        free.sort_unstable();
        free.dedup();
        let id = self.nodes.len() as Id;
        self.known.insert(node.clone(), id);
        self.nodes.push(node);
        self.free.push(free);
        id
    }

    /// The node with this value, if it was entered.
    pub(super) fn find(&self, node: &Node) -> Option<Id> {
        self.known.get(node).copied()
    }

    /// A number.
    pub(super) fn constant(&mut self, value: f64) -> Id {
        self.enter(Node::Constant(value.to_bits()))
    }

    /// In how many ways, at most 2, a value is computed from another one.
    pub(super) fn ways(&self, value: Id, from: Id) -> u8 {
        if value < from {
            return 0;
        }
        // Operands come before their users.
        let mut ways = vec![0_u8; (value - from) as usize + 1];
        ways[(value - from) as usize] = 1;
        for id in (from..=value).rev() {
            let here = ways[(id - from) as usize];
            if here > 0 && id > from {
                for operand in self.nodes[id as usize].operands().into_iter().filter(|&one| one >= from) {
                    let of = &mut ways[(operand - from) as usize];
                    *of = (*of + here).min(2);
                }
            }
        }
        ways[0]
    }

    /// Whether a value depends on a running agent.
    pub(super) fn depends_on(&self, id: Id, var: u32) -> bool {
        self.free[id as usize].contains(&var)
    }

    /// How many loops must be around a value: 1 more than the last running agent it depends on.
    pub(super) fn level(&self, id: Id) -> u32 {
        self.free[id as usize].last().map_or(0, |&var| var + 1)
    }
}
