//! Models of human motion, which project the ends of traces to the time of a batch (Algorithm 2).

use super::trace::TracePoint;
use crate::base::geometry::Vec2;

/// A model of motion. It gets the ends of all active traces at once, because people react to each other. It may remember
/// earlier calls, so each recording needs one of its own.
pub trait Motion {
    /// The points at `time` (s, not before any end), in the order of `ends`, each with a velocity if its end has one.
    fn project(&mut self, ends: &[TracePoint], time: f64) -> Vec<TracePoint>;

    /// Its name in reports.
    fn name(&self) -> &'static str;
}

/// Everybody keeps the velocity. An end without a velocity stands.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConstantVelocity;

impl Motion for ConstantVelocity {
    fn project(&mut self, ends: &[TracePoint], time: f64) -> Vec<TracePoint> {
        let moved = |end: &TracePoint| {
            let way = end.velocity.map_or_else(Vec2::zeros, |v| v * (time - end.time));
            TracePoint { time, position: end.position + way, velocity: end.velocity }
        };
        ends.iter().map(moved).collect()
    }

    fn name(&self) -> &'static str {
        "constant"
    }
}

/// Everybody stands.
#[derive(Clone, Copy, Debug, Default)]
pub struct Standing;

impl Motion for Standing {
    fn project(&mut self, ends: &[TracePoint], time: f64) -> Vec<TracePoint> {
        ends.iter().map(|end| TracePoint { time, ..*end }).collect()
    }

    fn name(&self) -> &'static str {
        "standing"
    }
}
