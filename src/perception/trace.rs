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

/// Position, m, and velocity, m/s, if it is known.
pub(super) type Placed = (Vec2, Option<Vec2>);

/// Distance of a projected trace and an observation, `D_trace`, m: `D² = |Δx|² + (1 s · |Δv| / discount)²`, without the second
/// term where one side has no velocity.
pub(super) fn distance((a, v): Placed, (b, w): Placed, discount: f64) -> f64 {
    let speed = match (v, w) {
        (Some(v), Some(w)) => (v - w).norm_squared() / (discount * discount),
        _ => 0.0,
    };
    ((a - b).norm_squared() + speed).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_count_half_and_only_if_both_are_known() {
        let (a, b) = (Vec2::new(0.0, 0.0), Vec2::new(3.0, 0.0));
        let fast = Some(Vec2::new(0.0, 8.0));
        assert_eq!(distance((a, fast), (b, Some(Vec2::zeros())), 2.0), 5.0);
        assert_eq!(distance((a, fast), (b, None), 2.0), 3.0);
        assert_eq!(distance((a, None), (b, fast), 2.0), 3.0);
    }
}
