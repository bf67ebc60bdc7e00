//! A trace: observations of one person over time, as far as they were inferred to belong together.

use crate::base::geometry::Vec2;

/// One point of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracePoint {
    /// Time, s.
    pub time: f64,
    /// Position, m.
    pub position: Vec2,
    /// Velocity, m/s: as observed, else the difference from the point before; `None` at a first point without either.
    pub velocity: Option<Vec2>,
}

/// Points in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Its number, from 1 in the order of birth; never used again.
    pub number: u64,
    /// The person whose id came with an observation.
    pub person: Option<u32>,
    /// Time of the first point, s.
    pub since: f64,
    /// The latest points, never empty.
    pub points: Vec<TracePoint>,
}

impl Trace {
    /// Its last point.
    pub fn end(&self) -> TracePoint {
        let unborn = TracePoint { time: self.since, position: Vec2::zeros(), velocity: None };
        self.points.last().copied().unwrap_or(unborn)
    }
}
