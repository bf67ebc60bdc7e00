//! Possible next steps: drawn from the gait, and some of them turned towards the way.

use super::course::Course;
use super::placed::{PlacedStep, angle, end_of, turned};
use super::task::Walk;
use super::turn;
use crate::base::geometry::Vec2;
use crate::base::math;
use crate::gait::{Draws, Foot, SPANS, Shape, Stance};
use crate::route::grid::Way;
use std::f64::consts::PI;

/// The negative logarithm of the weight of a step with a detour of 1 m.
pub(super) const DETOUR: f64 = 12.0;

/// An error of the heading of 1 rad counts as a detour of this length, m.
pub(super) const HEADING: f64 = 0.35;

/// Larger errors of the heading count as this, rad.
const MOST_ERROR: f64 = 1.5;

/// The weight of a step falls with the square of the angle e between its chord and the way, as `1/(1 + e^2/(2 s^2))`, s this, rad:
/// recorded strides on straight ways have a standard deviation of 0.9 degrees. The tail is that of Cauchy's law, so that among
/// steps that all turn or get out of somebody's way the angle decides little.
const STRAIGHT: f64 = 1.5 * PI / 180.0;

/// Where a step begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) at: Vec2,
    pub(super) heading: Vec2,
    pub(super) stance: Stance,
    pub(super) foot: Foot,
}

impl Pose {
    /// After a step.
    pub(super) fn after(step: &PlacedStep, stance: Stance) -> Self {
        Self { at: step.end(), heading: step.end_heading(), stance, foot: step.foot.other() }
    }
}

/// A possible next step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) step: PlacedStep,
    pub(super) after: Stance,
    /// Distance between its ends, m.
    pub(super) length: f64,
    /// The way from its end.
    pub(super) way: Way,
    /// Error of the heading at its end, rad, faded out within the last metre.
    pub(super) turning: f64,
    /// Negative logarithm of its weight.
    pub(super) cost: f64,
}

/// How a step is changed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Change<'a> {
    /// Not at all.
    Never,
    /// Turned towards the way by 0.6 to 1.4 of its error, where this share lies in 0 .. 1, and led along the course; without
    /// one, by up to 1.5 of the error along the whole step.
    Steer {
        /// The share.
        share: f64,
        /// The way ahead.
        course: Option<&'a Course>,
    },
    /// Turned by a share of the widest turn, and scaled: to get out of the way of others.
    Swerve(f64, f64),
}

impl Walk<'_> {
    /// Steps of the gait from a pose.
    pub(super) fn drawn(&self, pose: &Pose, mut draws: impl Iterator<Item = Draws>) -> Vec<Stance> {
        self.gait.steps(&pose.stance, pose.foot, self.share, &mut draws)
    }

    /// A drawn step from a pose, from which `way` leads to the goal; `None` if no way leads on from its end.
    pub(super) fn candidate(
        &self,
        pose: &Pose,
        way: &Way,
        mut after: Stance,
        change: Change<'_>,
    ) -> Option<Candidate> {
        let (foot, mut shape) = after.last?;
        let end = end_of(&shape);
        let own = || angle(Vec2::x(), shape.curve().tangent(1.0));
        let error = || angle(turned(end, pose.heading), way.direction);
        let (by, scale, course) = match change {
            Change::Never => (0.0, 1.0, None),
            Change::Steer { share, course: None } => (error() * 1.5 * share, 1.0, None),
            Change::Steer { share, course } => (error() * (0.6 + 0.8 * share), 1.0, course),
            Change::Swerve(share, scale) => (turn::WIDEST * share, scale, None),
        };
        let (later, chord) = course.map_or((0.0, Vec2::x()), |course| course.ahead(end.norm()));
        if by != 0.0 || scale != 1.0 {
            let (own, widest) = (own() + later, turn::limit(&shape));
            let by = (own + by).clamp(-widest.max(own.abs()), widest.max(own.abs())) - own;
            // Measured medians: 1.30 m/s straight on, 1.12 m/s in turns of 40 degrees.
            let sharp = (by + later).abs().min(turn::WIDEST);
            let scale = scale * (1.0 - 0.29 * sharp * sharp);
            shape = match course {
                Some(course) => course.led(&shape, by, scale),
                None => turn::bent(&shape, by, scale),
            };
            after.last = Some((foot, shape));
        }
        let step = PlacedStep::new(foot, pose.at, pose.heading, shape);
        let onward = self.way(step.end())?;
        let length = end_of(&shape).norm();
        let error = angle(step.end_heading(), onward.direction).abs().min(MOST_ERROR);
        let detour = length + onward.length - way.length;
        let turning = error * onward.length.min(1.0);
        let chord = angle(turned(end_of(&shape), pose.heading), turned(chord, way.direction)) / STRAIGHT;
        let astray = math::ln(1.0 + 0.5 * chord * chord) * onward.length.min(1.0);
        let slowing = 4.0 * (1.0 - scale);
        let cost = DETOUR * (detour + HEADING * turning) + slowing + astray;
        Some(Candidate { step, after, length, way: onward, turning, cost })
    }

    /// Whether a step may go on from its end: a straight or a turned line of the length of a step is clear. True far from
    /// barriers.
    pub(super) fn goes_on(&self, found: &Candidate) -> bool {
        let (at, heading) = (found.step.end(), found.step.end_heading());
        let length = self.usual().min(found.way.length);
        if self.ground.grid().clearance(at) > length + self.ground.grid().reach() {
            return true;
        }
        let error = angle(heading, found.way.direction).clamp(-turn::WIDEST, turn::WIDEST);
        let line = |scale: f64| Shape {
            landmarks: std::array::from_fn(|k| {
                Vec2::new(length * scale * (k + 1) as f64 / SPANS as f64, 0.0)
            }),
            duration: 1.0,
        };
        [(1.0, 1.0), (0.5, 1.0), (1.0, 0.6)].into_iter().any(|(share, scale)| {
            let shape = turn::bent(&line(scale), share * error, 1.0);
            self.is_clear(&PlacedStep::new(found.step.foot.other(), at, heading, shape))
        })
    }
}
