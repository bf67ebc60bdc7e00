//! The fastest profile of a path, in closed form.
//!
//! The pointwise maximum of two legal profiles is legal, so there is a largest one, and it is the fastest. It is the
//! minimum of full-effort ramps from all joints: one pass forward and one backward over the joints give the speeds there,
//! and each stretch between is ramp, cruise, ramp (`ramp`).

use super::motion::Motion;
use super::ramp::{Phase, cross, gained};
use super::stretch::{Infeasible, Limits, Span, Stretch, spans};

/// An end speed that exceeds its limit by rounding alone is taken for the limit.
const ROUNDING: f64 = 1.0 + 8.0 * f64::EPSILON;

/// A joint of two stretches or an end of the path.
#[derive(Clone, Copy, Debug)]
struct Joint {
    /// u there, m^2/s^2.
    square: f64,
    /// Largest u on the stretch that begins there, m^2/s^2.
    peak: f64,
}

/// The fastest profile of a path.
#[derive(Clone, Debug)]
pub struct Optimum {
    phases: Vec<Phase>,
    joints: Vec<Joint>,
    along: f64,
    duration: f64,
    length: f64,
}

/// The fastest profile of a path that begins with `start_speed` and ends with `end_speed`, m/s. The time is linear in the
/// number of stretches.
///
/// # Errors
///
/// An invalid number, or an end speed that is too large; the error names the largest one.
pub fn optimal(
    stretches: &[Stretch],
    limits: Limits,
    start_speed: f64,
    end_speed: f64,
) -> Result<Optimum, Infeasible> {
    Optimum::over(&spans(stretches, limits)?, limits, start_speed, end_speed)
}

impl Optimum {
    /// The fastest profile over the spans of a path.
    pub(super) fn over(spans: &[Span], limits: Limits, start: f64, end: f64) -> Result<Self, Infeasible> {
        let along = limits.along;
        // Forward: as fast as the start and the caps before allow.
        let mut joints = Vec::with_capacity(spans.len() + 1);
        let mut reached = (start * start).min(limits.speed * limits.speed);
        for span in spans {
            let square = reached.min(span.cap);
            joints.push(Joint { square, peak: square });
            reached = gained(square, span, along);
        }
        // Backward: as fast as the end and the caps behind allow.
        let mut square = reached.min(end * end);
        let (last, mut most) = (Joint { square, peak: square }, square);
        for (joint, span) in joints.iter_mut().zip(spans).rev() {
            most = gained(square, span, along);
            square = joint.square.min(most);
            joint.square = square;
        }
        if !(start >= 0.0 && start * start <= most * ROUNDING) {
            return Err(Infeasible::Start { speed: start, largest: most.sqrt() });
        }
        if !(end >= 0.0 && end * end <= reached * ROUNDING) {
            return Err(Infeasible::End { speed: end, largest: reached.sqrt() });
        }
        joints.push(last);
        // Between joints: ramp, cruise, ramp.
        let mut phases = Vec::with_capacity(3 * spans.len());
        let (mut duration, mut rest) = (0.0, joints.as_mut_slice());
        for span in spans {
            let [from, after @ ..] = rest else { break };
            let to = after.first().map_or(0.0, |joint| joint.square);
            from.peak = cross(span, along, (from.square, to), &mut duration, &mut phases);
            rest = after;
        }
        let length = spans.last().map_or(0.0, |span| span.end);
        Ok(Self { phases, joints, along, duration, length })
    }

    /// How long the motion takes, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// How long the path is, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The speeds at the start, at all joints, and at the end, m/s.
    pub fn node_speeds(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.joints.iter().map(|joint| joint.square.sqrt())
    }

    /// The largest speed on each stretch, m/s.
    pub fn peak_speeds(&self) -> impl Iterator<Item = f64> + '_ {
        let stretches = self.joints.len() - 1;
        self.joints.iter().take(stretches).map(|joint| joint.peak.sqrt())
    }

    /// The motion at time t, s. A time outside of the motion is taken for its nearest end.
    pub fn motion(&self, t: f64) -> Motion {
        let t = t.max(0.0).min(self.duration);
        let after = self.phases.partition_point(|phase| phase.time <= t);
        match self.phases.get(after.max(1) - 1) {
            Some(phase) => phase.motion(t, self.along),
            // A path without length.
            None => {
                Motion { speed: self.joints.first().map_or(0.0, |j| j.square.sqrt()), ..Motion::default() }
            }
        }
    }

    /// The speed at distance x from the start, m/s. A place outside of the path is taken for its nearest end.
    pub fn speed_at(&self, x: f64) -> f64 {
        let x = x.max(0.0).min(self.length);
        let after = self.phases.partition_point(|phase| phase.start <= x);
        match self.phases.get(after.max(1) - 1) {
            Some(phase) => phase.speed_at(x, self.along),
            None => self.motion(0.0).speed,
        }
    }

    /// Where the kind of effort changes, m from the start: all places at which u bends.
    pub(super) fn turns(&self) -> impl Iterator<Item = f64> + '_ {
        self.phases.iter().map(|phase| phase.start)
    }
}
