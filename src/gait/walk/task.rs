//! What a walk is asked for: from where to where, on which floor, with whose steps, and how they are found.

use super::ground::Ground;
use super::others::OtherBody;
use crate::base::geometry::Vec2;
use crate::base::random::Stream;
use crate::gait::Gait;
use crate::route::grid::GoalField;

/// How the next step is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// One of some candidates, by detour and heading. Where all of them meet a barrier, hybrid A* with its usual parameters.
    Guided {
        /// Steps that are drawn from the gait for each choice, at most 512.
        candidates: u32,
    },
    /// Hybrid A*: all steps to the goal at once.
    HybridAStar(HybridAStar),
    /// Along the shortest path over cells, in even steps of the usual length: what the paper compares with.
    GridAStar,
}

impl Default for Search {
    fn default() -> Self {
        Self::Guided { candidates: 24 }
    }
}

/// Parameters of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridAStar {
    /// Side of the cells that are closed, m.
    pub cell: f64,
    /// First steps that are drawn; at most 32.
    pub starters: u32,
    /// Successors that are drawn of each step; at most 32.
    pub successors: u32,
    /// Most steps that are expanded; at most 32 000.
    pub expansions: u32,
    /// As in the paper: straight-line distance as heuristic, only ends of steps are tested, cells are closed whatever the foot
    /// and the heading, and a walk ends within 0.25 m of the goal.
    pub is_as_published: bool,
}

impl Default for HybridAStar {
    fn default() -> Self {
        Self { cell: 0.08, starters: 30, successors: 10, expansions: 20_000, is_as_published: false }
    }
}

impl HybridAStar {
    /// As Agethen et al. 2018 describe it. Its walks cross obstacles between the ends of steps, and are too short.
    pub fn as_published() -> Self {
        Self { is_as_published: true, ..Self::default() }
    }
}

/// What is fixed during a walk of one person.
#[derive(Clone, Copy, Debug)]
pub struct Walk<'a> {
    /// The floor, for the radius of the body.
    pub ground: &'a Ground,
    /// The ways to the goal.
    pub field: &'a GoalField,
    /// The goal point, m: that of the field, or near it and in sight of it.
    pub goal: Vec2,
    /// What draws the steps.
    pub gait: &'a dyn Gait,
    /// Preferred speed over the person's own.
    pub share: f64,
    /// Random numbers of the person.
    pub stream: Stream,
    /// How steps are found.
    pub search: Search,
    /// Bodies that stand, around which a search of all steps leads.
    pub around: &'a [OtherBody],
}
