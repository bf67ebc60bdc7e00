//! A body that asks, and what is measured from it to others.

use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::code::node::Measure;
use crate::kernel::near::{FARTHEST, Index};
use crate::kernel::state::State;
use crate::model::Parameter;

/// Relative margin within which a comparison without square root is not trusted: a million times what
/// rounding can do.
pub(in crate::kernel::code) const MARGIN: f64 = 1e-9;

/// A body that asks.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel::code) struct Asker {
    /// Its number.
    pub(super) agent: usize,
    pub(super) at: Vec2,
    pub(super) radius: f64,
    pub(super) measure: Measure,
}

impl Asker {
    /// How far apart the centres of the asker and a member can be if the measure is at most `bound`: never too little.
    #[inline(always)]
    pub(super) fn reach(&self, index: &Index, bound: f64) -> f64 {
        if self.measure == Measure::Centres {
            return bound + bound.abs() * MARGIN + 1e-30;
        }
        let slack = (bound.abs() + self.radius.abs() + index.widest.abs()) * MARGIN + 1e-30;
        bound + self.radius + index.widest + slack
    }

    /// An agent of the only trial of a state.
    #[inline(always)]
    pub(in crate::kernel::code) fn new(state: &State, agent: usize, measure: Measure) -> Self {
        let radius =
            if measure == Measure::Centres { 0.0 } else { of(&state.bodies[Parameter::Radius], agent) };
        Self { agent, at: Vec2::new(of(&state.motion.x, agent), of(&state.motion.y, agent)), radius, measure }
    }

    /// Whether the cells can answer.
    #[inline(always)]
    pub(super) fn is_reasonable(&self) -> bool {
        self.at.x.abs() <= FARTHEST && self.at.y.abs() <= FARTHEST && self.radius.abs() <= FARTHEST
    }
}

#[inline(always)]
fn of(field: &[Lanes], agent: usize) -> f64 {
    field[agent / LANES].0[agent % LANES]
}

/// Whether an agent belongs to a set.
#[inline(always)]
pub(super) fn has(set: &[Mask], agent: u32) -> bool {
    set[agent as usize / LANES].has(agent as usize % LANES)
}

/// Squared distance of an agent from a place.
#[inline(always)]
pub(super) fn squared(index: &Index, at: Vec2, k: usize) -> f64 {
    let (dx, dy) = (at.x - index.x[k], at.y - index.y[k]);
    dx * dx + dy * dy
}

/// The square of a reach; nobody is nearer than one below 0.
#[inline(always)]
pub(super) fn square(reach: f64) -> f64 {
    if reach > 0.0 { reach * reach } else { 0.0 }
}

/// The measure at a distance between a fixed body and a running one of these radii, with the roundings of the expression
/// that it stands for.
#[inline(always)]
pub(super) fn value(measure: Measure, distance: f64, fixed: f64, running: f64) -> f64 {
    match measure {
        Measure::Centres => distance,
        Measure::GapFixedFirst => distance - fixed - running,
        Measure::GapRunningFirst => distance - running - fixed,
    }
}
