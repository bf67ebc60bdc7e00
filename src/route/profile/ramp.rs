//! Ramps: gaining or losing speed with full effort on one stretch, in closed form.
//!
//! On a line u changes by 2 · along a metre. On an arc put u = bend · sin(phi): the acceleration has a constant size (in
//! units of its limits) and its angle phi turns by 2 · along / bend a metre. With y = v / sqrt(bend) = sqrt(sin phi) the
//! time is sqrt(bend) / along · arcsl(y), so v is a lemniscate sine of the time.

use super::motion::Motion;
use super::stretch::Span;
use crate::base::elliptic::{QUARTER, arc_lemniscate_sine, lemniscate_sine};
use crate::base::math::{atan2, sin_cos};
use std::f64::consts::FRAC_PI_2;

/// Sine, and cosine without cancellation, of the angle of u.
fn sine_cosine(u: f64, bend: f64) -> (f64, f64) {
    let sine = (u / bend).min(1.0);
    (sine, ((1.0 - sine) * (1.0 + sine)).sqrt())
}

/// The largest u at one end of a span from `u` at the other end.
pub(super) fn gained(u: f64, span: &Span, along: f64) -> f64 {
    let (bend, cap) = (span.bend, span.cap);
    if u >= cap {
        return cap;
    }
    let gain = 2.0 * along * span.length();
    if bend == f64::INFINITY {
        return (u + gain).min(cap);
    }
    let turn = gain / bend;
    if turn >= FRAC_PI_2 {
        return cap;
    }
    let ((sine, cosine), (sine_turn, cosine_turn)) = (sine_cosine(u, bend), sin_cos(turn));
    if sine_turn >= cosine {
        return cap;
    }
    (bend * (sine * cosine_turn + cosine * sine_turn)).min(cap)
}

/// u after `distance` of full braking from `u`; at least 0.
pub(super) fn lost(u: f64, distance: f64, along: f64, bend: f64) -> f64 {
    let loss = 2.0 * along * distance;
    if bend == f64::INFINITY {
        return (u - loss).max(0.0);
    }
    let turn = loss / bend;
    if turn >= FRAC_PI_2 {
        return 0.0;
    }
    let ((sine, cosine), (sine_turn, cosine_turn)) = (sine_cosine(u, bend), sin_cos(turn));
    (bend * (sine * cosine_turn - cosine * sine_turn)).max(0.0)
}

/// A place on the ramp of an arc.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// phi, rad.
    angle: f64,
    /// arcsl(y).
    argument: f64,
}

impl Place {
    fn new(angle: f64, sine: f64, cosine: f64) -> Self {
        // 1 - sine without cancellation.
        let complement = cosine * cosine / (1.0 + sine);
        Self { angle, argument: arc_lemniscate_sine(sine, complement) }
    }

    fn of_u(u: f64, bend: f64) -> Self {
        let (sine, cosine) = sine_cosine(u, bend);
        if cosine == 0.0 {
            return Self { angle: FRAC_PI_2, argument: QUARTER };
        }
        Self::new(atan2(sine, cosine), sine, cosine)
    }
}

/// How speed changes in a phase.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// Not at all.
    None,
    /// On a line.
    Line,
    /// On an arc; the place of the slow end.
    Arc { bend: f64, slow: Place },
}

/// A part of a stretch with one kind of effort.
#[derive(Clone, Copy, Debug)]
pub(super) struct Phase {
    /// When it begins, s.
    pub(super) time: f64,
    /// Where it begins, m.
    pub(super) start: f64,
    change: Change,
    /// 1 where speed is gained, -1 where it is lost.
    sense: f64,
    /// When, where and how fast the slow end is passed (s, m, m/s). Formulas begin there, so a stop is exact.
    slow: (f64, f64, f64),
}

impl Phase {
    /// The motion at time t of the phase.
    pub(super) fn motion(&self, t: f64, along: f64) -> Motion {
        let (time, place, speed) = self.slow;
        let after = (self.sense * (t - time)).max(0.0);
        let (covered, speed, acceleration) = match self.change {
            Change::None => (speed * after, speed, 0.0),
            Change::Line => (after * (speed + 0.5 * along * after), speed + along * after, along),
            Change::Arc { bend, slow } => {
                let root = bend.sqrt();
                let (y, cosine) = lemniscate_sine(slow.argument + after * along / root);
                let turned = (atan2(y * y, cosine) - slow.angle).max(0.0);
                (turned * bend / (2.0 * along), root * y, along * cosine)
            }
        };
        Motion { distance: place + self.sense * covered, speed, acceleration: self.sense * acceleration }
    }

    /// The speed at place x of the phase, m/s.
    pub(super) fn speed_at(&self, x: f64, along: f64) -> f64 {
        let (_, place, speed) = self.slow;
        let gain = 2.0 * along * (self.sense * (x - place)).max(0.0);
        match self.change {
            Change::None => speed,
            Change::Line => (speed * speed + gain).sqrt(),
            Change::Arc { bend, slow } => {
                (bend * sin_cos((slow.angle + gain / bend).min(FRAC_PI_2)).0).sqrt()
            }
        }
    }
}

/// The fastest profile on one stretch between u = `from` and u = `to`, which ramps can join: up, hold, down. Adds its phases,
/// moves `time` on, and returns the largest u.
pub(super) fn cross(
    span: &Span,
    along: f64,
    (from, to): (f64, f64),
    time: &mut f64,
    phases: &mut Vec<Phase>,
) -> f64 {
    let (length, bend, cap) = (span.length(), span.bend, span.cap);
    // Lengths and times of the two ramps, their slow ends on an arc, and the peak.
    let (up, down, changes, peak) = if from >= cap && to >= cap {
        ((0.0, 0.0), (0.0, 0.0), [Change::None; 2], cap)
    } else if bend == f64::INFINITY {
        let peak = (0.5 * (from + to) + along * length).max(from).max(to).min(cap);
        let root = peak.sqrt();
        let ramp = |u: f64| (0.5 * (peak - u) / along, (root - u.sqrt()) / along);
        (ramp(from), ramp(to), [Change::Line; 2], peak)
    } else {
        let ends = [from, to].map(|u| Place::of_u(u, bend));
        let per_metre = 2.0 * along / bend;
        let angle = (0.5 * (ends[0].angle + ends[1].angle + per_metre * length)).min(FRAC_PI_2);
        let (sine, cosine) = sin_cos(angle);
        let (peak, top) = if angle >= FRAC_PI_2 || bend * sine >= cap {
            (cap, Place::of_u(cap, bend))
        } else {
            (bend * sine, Place::new(angle, sine, cosine))
        };
        let per_second = along / bend.sqrt();
        let ramp = |place: Place| {
            let (angle, argument) = (top.angle - place.angle, top.argument - place.argument);
            (angle.max(0.0) / per_metre, argument.max(0.0) / per_second)
        };
        let [first, last] = ends;
        let changes = ends.map(|slow| Change::Arc { bend, slow });
        (ramp(first), ramp(last), changes, peak)
    };
    if up.1 > 0.0 {
        let slow = (*time, span.start, from.sqrt());
        phases.push(Phase { time: *time, start: span.start, change: changes[0], sense: 1.0, slow });
        *time += up.1;
    }
    let held = length - up.0 - down.0;
    // Where ramps meet, rounding alone is left between them.
    if peak >= cap && held > 0.0 {
        let start = span.start + up.0;
        let slow = (*time, start, peak.sqrt());
        phases.push(Phase { time: *time, start, change: Change::None, sense: 1.0, slow });
        *time += held / slow.2;
    }
    if down.1 > 0.0 {
        let slow = (*time + down.1, span.end, to.sqrt());
        let start = span.end - down.0;
        phases.push(Phase { time: *time, start, change: changes[1], sense: -1.0, slow });
        *time += down.1;
    }
    peak
}
