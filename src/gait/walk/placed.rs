//! A step at its place on the floor.

use crate::base::geometry::Vec2;
use crate::base::math;
use crate::gait::{Curve, Foot, Shape};

/// `v` turned by the angle of `by`, which has length 1.
pub(super) fn turned(v: Vec2, by: Vec2) -> Vec2 {
    Vec2::new(by.x * v.x - by.y * v.y, by.x * v.y + by.y * v.x)
}

/// The angle from one direction to another, rad, positive to the left.
pub(super) fn angle(from: Vec2, to: Vec2) -> f64 {
    math::atan2(from.x * to.y - from.y * to.x, from.dot(&to))
}

/// The end of a step in its frame, m.
pub(super) fn end_of(shape: &Shape) -> Vec2 {
    shape.landmarks[shape.landmarks.len() - 1]
}

/// A step of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedStep {
    /// The foot that swings.
    pub foot: Foot,
    /// Where the root is at its begin, m.
    pub start: Vec2,
    /// The direction of +x of its frame, of length 1.
    pub heading: Vec2,
    /// The step in its frame.
    pub shape: Shape,
    curve: Curve,
}

impl PlacedStep {
    /// A step that begins at a place in a direction of length 1.
    pub fn new(foot: Foot, start: Vec2, heading: Vec2, shape: Shape) -> Self {
        Self { foot, start, heading, shape, curve: shape.curve() }
    }

    /// The place of the root at a share of the duration, m.
    pub fn place(&self, share: f64) -> Vec2 {
        self.start + turned(self.curve.place(share), self.heading)
    }

    /// The velocity of the root there, m/s.
    pub fn velocity(&self, share: f64) -> Vec2 {
        turned(self.curve.rise(share), self.heading) / self.shape.duration
    }

    /// Where it ends, m.
    pub fn end(&self) -> Vec2 {
        self.start + turned(end_of(&self.shape), self.heading)
    }

    /// The direction in which it ends, of length 1.
    pub fn end_heading(&self) -> Vec2 {
        turned(self.curve.tangent(1.0), self.heading)
    }

    /// How long it takes, s.
    pub fn duration(&self) -> f64 {
        self.shape.duration
    }

    /// The length of its path, m.
    pub fn length(&self) -> f64 {
        self.curve.length()
    }

    /// An upper bound of the change of velocity over the duration, m: of the second derivative by the share.
    pub(super) fn bend(&self) -> f64 {
        self.curve.bend()
    }
}
