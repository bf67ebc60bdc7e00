//! Plans: what a driver answers when it is asked where an agent goes. Following them is the kernel's own (`driver`).

mod trajectory;

pub(super) use trajectory::Piece;
pub use trajectory::{Sample, Trajectory};

use crate::base::geometry::Vec2;
use crate::kernel::fault::Fault;
use std::any::Any;
use std::sync::Arc;

/// Where an agent goes until its driver is asked again. Times count from the moment at which the plan begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Plan {
    /// The plan that there is goes on.
    Keep,
    /// Straight to the goal of the leg, as without a driver; in a pause and at the last goal the agent stands. Where the goal is
    /// out of sight, the driver is asked again, at most every 0.5 s.
    #[default]
    Straight,
    /// Stands for so many seconds (infinite: for good). Then the driver is asked again. No force moves an agent that steps.
    Stand(f64),
    /// Stands as near to the goal as those who stand in it allow: this leg is over. At the last goal the agent stays.
    There,
    /// No way leads to the goal: stands, and the trial is counted as one in which somebody has no way.
    NoWay,
    /// Heads for each of these points in turn, m, and then for the goal of the leg. A point is passed near it, or across the
    /// line through it, once the next one is in sight; every 0.5 s points before one in sight are skipped, and a point out of
    /// sight is asked about. In sight is what a body of half the radius can go to straight.
    Way(Arc<[Vec2]>),
    /// The same, but each of the points is passed in turn: none is skipped because a later one is in sight.
    Through(Arc<[Vec2]>),
    /// Is driven along a trajectory by its driving velocity; all forces act on it.
    Follow(Arc<Trajectory>, Limits),
    /// Is moved along a trajectory by itself: no force moves it. Others feel it as a body with its velocity, which in
    /// contact does not yield. The trajectory begins where the agent is. It is one step; no leg ends before it does.
    Step(Arc<Trajectory>),
    /// The driver failed, and the trial is unresolved; with a fault no trial of the model can be trusted.
    Failed(Option<Fault>),
}

/// What a driver remembers of a person from plan to plan, in a trial.
#[derive(Clone, Debug, Default)]
pub struct Memory(Option<Arc<dyn Any + Send + Sync>>);

impl Memory {
    /// What was put there last, if it is of this type.
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.0.as_deref()?.downcast_ref()
    }

    /// Remembers something.
    pub fn put<T: Any + Send + Sync>(&mut self, value: T) {
        self.0 = Some(Arc::new(value));
    }
}

impl PartialEq for Memory {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        }
    }
}

/// How an agent is driven along a trajectory: at plan time `t` with `v(t) + tau a(t)`, which compensates the relaxation, and
/// a correction towards `p(t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest correction, m/s; it is the distance from `p(t)` over 1 s.
    pub correction: f64,
    /// Farther than this from `p(t)`, m, the time of the plan stands still.
    pub lag: f64,
    /// Farther than this from `p(t)`, m, the driver is asked for another plan, at most every 0.5 s.
    pub leave: f64,
}

/// Why a driver is asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Occasion {
    /// A trial begins.
    #[default]
    Begins,
    /// The agent comes in by a source.
    Enters,
    /// A leg of the route is finished: the next one begins.
    Leg,
    /// A behaviour changed the route, or advice ended.
    Diverted,
    /// The agent is farther from its plan than the plan allows, or the next point of a way, or the goal of a straight one, is out of sight.
    Left,
    /// The plan ends within the next step; the new plan begins when it does.
    Ended,
    /// The agent has come to another level, or to stairs.
    Storey,
    /// Doors have opened or closed.
    Doors,
    /// Its way leads to one of several exits, and it looks whether another one is quicker now.
    Looks,
}
