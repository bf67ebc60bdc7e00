//! One step: the path of the root (the middle of the hip, on the floor) from one contact of a foot to the next contact of the
//! other one (Agethen et al. 2018, section 4.1: five spans, ten numbers; here with the duration).

use super::curve::Curve;
use crate::base::geometry::Vec2;
use crate::base::random::Stream;
use std::fmt::{self, Debug};

/// Spans of the root path of a step, equally long in time.
pub const SPANS: usize = 5;

/// A foot; of a step, the one that swings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Foot {
    /// The left one.
    #[default]
    Left,
    /// The right one.
    Right,
}

impl fmt::Display for Foot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Left { "left" } else { "right" })
    }
}

impl Foot {
    /// The other foot.
    pub fn other(self) -> Self {
        if self == Self::Left { Self::Right } else { Self::Left }
    }
}

/// The root path of a step in its own frame: it begins at the origin, along +x; +y is to the left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Where the spans end, m.
    pub landmarks: [Vec2; SPANS],
    /// How long the step takes, s.
    pub duration: f64,
}

impl Shape {
    /// The curve through the landmarks.
    pub fn curve(&self) -> Curve {
        Curve::through(self)
    }

    /// The same step turned so that its curve begins along +x.
    pub fn aligned(self) -> Self {
        let begins = self.curve().tangent(0.0);
        let turn = |p: Vec2| Vec2::new(begins.x * p.x + begins.y * p.y, begins.x * p.y - begins.y * p.x);
        Self { landmarks: self.landmarks.map(turn), ..self }
    }
}

/// Where a step stands in a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Phase {
    /// It begins from standing.
    First,
    /// It has steps before and after it.
    #[default]
    Inner,
    /// It ends in standing.
    Last,
}

/// A step that was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedStep {
    /// The take.
    pub take: String,
    /// Who was recorded.
    pub subject: String,
    /// Its number in the take, from 0; the step after it has the next number if nothing was dropped in between.
    pub number: u32,
    /// The foot that swings.
    pub foot: Foot,
    /// Where it stands in the walk.
    pub phase: Phase,
    /// Its begin and end, s since the begin of the take.
    pub span: (f64, f64),
    /// Distance between the ankles across the direction of the step, m.
    pub width: f64,
    /// Its root path, aligned.
    pub shape: Shape,
}

/// What a person has done before a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stance {
    /// The last step and the foot that it was made with; `None` for somebody who stands.
    pub last: Option<(Foot, Shape)>,
    /// Noise that drifts from step to step, in units of its kind of gait.
    pub drift: [f64; 8],
}

/// The random numbers of one step of a person: a fixed range of draws of a stream.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    stream: Stream,
    first: u32,
}

impl Draws {
    /// Most draws of a candidate of a step.
    pub const COUNT: u32 = 16;
    /// Most candidates of a step.
    pub const CANDIDATES: u32 = 1 << 12;

    /// Those of a candidate of a step, from the stream of the person.
    pub fn of(stream: Stream, step: u32, candidate: u32) -> Self {
        let number = step.wrapping_mul(Self::CANDIDATES).wrapping_add(candidate % Self::CANDIDATES);
        Self { stream, first: number.wrapping_mul(Self::COUNT) }
    }

    /// Two numbers in (0, 1), from draw `k` below [`Draws::COUNT`].
    pub fn uniform_pair(self, k: u32) -> [f64; 2] {
        self.stream.uniform_pair(self.first + k % Self::COUNT)
    }

    /// Two standard normal numbers.
    pub fn normal_pair(self, k: u32) -> [f64; 2] {
        self.stream.normal_pair(self.first + k % Self::COUNT)
    }
}

/// What draws the steps of one person.
pub trait Gait: Debug {
    /// A step with a foot: the first one if the person stands. The stance after it has this step as its last one. `share` is the
    /// preferred speed over the person's own.
    fn step(&self, before: &Stance, foot: Foot, share: f64, draws: Draws) -> Stance;

    /// Many such steps, each with its draws, from the same stance: what they have in common need be found only once.
    fn steps(
        &self,
        before: &Stance,
        foot: Foot,
        share: f64,
        draws: &mut dyn Iterator<Item = Draws>,
    ) -> Vec<Stance> {
        draws.map(|draws| self.step(before, foot, share, draws)).collect()
    }

    /// The usual length of a step when walking, m.
    fn length(&self) -> f64;

    /// The usual duration of a step when walking, s.
    fn duration(&self) -> f64;
}
