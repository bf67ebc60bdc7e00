//! A gait made from published relations; it needs no data.
//!
//! - Step rate: `2.122 (v/h)^0.5` Hz for speed v and stature h; a step is as long as the speed over it. Length and rate then keep
//!   one ratio at all speeds, as healthy adults do (Sekiya, Nagasaki 1998); at 1.34 m/s and 1.72 m it is the rate of Grieve and
//!   Gear 1966, whose exponent of 0.57 would lengthen the steps of slow walkers by 7 %.
//! - Sway: while a foot swings, the root moves towards the other one and back, a half sine of amplitude
//!   `(2 w/pi) w0²/(w0² + omega²)`, omega = pi · step rate, w0² = g/(0.53 h), step width w: the response of an inverted
//!   pendulum to alternating support.
//! - Slower in turns; at most 50 degrees a step, 90 degrees below 0.7 m/s.
//! - First and last steps are 0.57 and 0.56 of the usual length and begin or end (nearly) at rest.
//! - Noise: see `noise`.
//!
//! The direction of walking of a straight step is that of its chord. Sway makes its path begin and end at an angle to it.
//! The frame of the next step begins along that end, so a step first finds the direction of walking: from the speed and
//! duration of the last step it knows how fast the root was moving sideways.

mod noise;
#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests;

use super::step::{Draws, Foot, Gait, Shape, Stance};
use crate::base::geometry::Vec2;
use crate::base::math;
use crate::base::random::{Stream, name_hash};
use crate::model::{Family, Law};
use noise::Noise;
use std::f64::consts::{FRAC_PI_2, PI};

/// Share of the drawn steps that turn, half to each side; the others go straight on. The angle is the limit times the
/// square of a uniform number. A planner that draws 24 candidates and keeps the best needs both: 18 straight ones, which
/// differ by noise, keep lines straight; the wider of 3 to each side turns by 0.6 of the limit on average, so that 90
/// degrees take three steps, as measured. A planner should compare directions of chords, or of ends of steps with the
/// same foot: sway turns the end of a step by 6 degrees at 1.34 m/s, which the next step turns back.
const TURNING: f64 = 0.25;
/// Widest turn of a step, rad: when walking (50 degrees), and for a pivot (90 degrees).
const WIDEST: [f64; 2] = [0.872_664_625_997_164_8, FRAC_PI_2];
/// Speed below which a step can be a pivot, m/s.
const PIVOTS_BELOW: f64 = 0.7;
/// Length of first steps, over the usual one.
const FIRST: f64 = 0.57;
/// Slowest walk that the relations are used for, m/s.
const SLOWEST: f64 = 0.2;
/// Speed of a root at rest over the usual one: it gives the path a direction there.
const REST: f64 = 0.05;
/// sin(pi k/5), and its slope at 0 as the curve of a step has it (the sine has pi).
const SINE: [f64; 5] =
    [0.587_785_252_292_473_1, 0.951_056_516_295_153_5, 0.951_056_516_295_153_5, 0.587_785_252_292_473_1, 0.0];
const SLOPE: f64 = 3.222_696_680_761_075;

/// 18 times the weights of the landmarks in the rise of their curve at its end; a curve itself would take longer.
const LEAVING: [f64; 5] = [16.0, -74.0, 191.0, -304.0, 173.0];

/// The gait of one person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SyntheticGait {
    person: Person,
    /// Square of the angular frequency of the inverted pendulum, 1/s².
    pendulum: f64,
}

/// How a step begins: along +x of its frame.
struct Entry {
    /// Speed of the root, m/s.
    speed: f64,
    /// Direction of walking.
    walking: Vec2,
}

/// How a step goes on from there.
struct Exit {
    chord: Vec2,
    /// Change of the place at its end, over the duration.
    rise: Vec2,
    /// Direction of walking on average; sway is across it.
    middle: Vec2,
    duration: f64,
}

fn direction(angle: f64) -> Vec2 {
    let (sin, cos) = math::sin_cos(angle);
    Vec2::new(cos, sin)
}

/// `a` turned by the angle of `b`, which has length 1.
fn turned(a: Vec2, b: Vec2) -> Vec2 {
    Vec2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

fn left_of(a: Vec2) -> Vec2 {
    Vec2::new(-a.y, a.x)
}

/// Speed in a turn over that of going straight: medians 1.25, 1.21, 1.20, 1.16, 1.12 of 1.30 m/s at 5 to 40 degrees.
fn slowing(turn: f64) -> f64 {
    let degrees = turn.abs() * (180.0 / PI);
    1.0 - math::at_most(0.0062 * degrees, 0.0418 + 0.0024 * degrees)
}

/// The side to which the root sways while a foot swings: towards the other one.
fn side(foot: Foot) -> f64 {
    if foot == Foot::Left { -1.0 } else { 1.0 }
}

impl SyntheticGait {
    /// The gait of a person.
    pub fn of(person: Person) -> Self {
        Self { person, pendulum: 9.81 / (0.53 * person.height) }
    }

    /// Steps a second at a speed (m/s).
    pub fn rate(&self, speed: f64) -> f64 {
        2.122 * (speed / self.person.height).sqrt()
    }

    /// Amplitude of the sway in a step of a duration (s), m.
    fn sway(&self, duration: f64) -> f64 {
        let omega = PI / duration;
        2.0 * self.person.width / PI * self.pendulum / (self.pendulum + omega * omega)
    }

    /// The widest turn of the next step to either side, rad.
    fn widest(entry: &Entry) -> f64 {
        WIDEST[usize::from(entry.speed < PIVOTS_BELOW)]
    }

    fn entry(&self, before: &Stance) -> Entry {
        let Some((foot, shape)) = &before.last else {
            return Entry { speed: REST * self.person.speed, walking: Vec2::x() };
        };
        let rise = shape.landmarks.iter().zip(LEAVING).map(|(p, weight)| p * (weight / 18.0)).sum::<Vec2>();
        let speed = rise.norm() / shape.duration;
        let aside = self.sway(shape.duration) * SLOPE / shape.duration;
        // Half the speed: steps that were scaled to almost nothing still have a direction.
        let sin = side(*foot) * math::at_most(aside / speed, 0.5);
        Entry { speed, walking: Vec2::new((1.0 - sin * sin).sqrt(), sin) }
    }

    /// A cubic polynomial from the entry to the exit, and the sway.
    fn shape(&self, entry: &Entry, foot: Foot, exit: &Exit) -> Shape {
        let Exit { chord, duration, .. } = *exit;
        let sway = left_of(exit.middle) * (side(foot) * self.sway(duration));
        let begin = Vec2::new(entry.speed * duration, 0.0) - sway * SLOPE;
        let end = exit.rise + sway * SLOPE;
        let landmarks = std::array::from_fn(|k| {
            let u = (k + 1) as f64 / SINE.len() as f64;
            let left = 1.0 - u;
            begin * (u * left * left) + chord * (u * u * (3.0 - 2.0 * u)) - end * (u * u * left)
                + sway * SINE[k]
        });
        Shape { landmarks, duration }
    }

    /// A step that turns by an angle (rad, to the left) before noise.
    pub fn toward(&self, before: &Stance, foot: Foot, share: f64, turn: f64, draws: Draws) -> Stance {
        self.step_from(&self.entry(before), before, foot, share, turn, draws)
    }

    fn step_from(
        &self,
        entry: &Entry,
        before: &Stance,
        foot: Foot,
        share: f64,
        turn: f64,
        draws: Draws,
    ) -> Stance {
        let noise = Noise::after(before.last.is_some().then_some(&before.drift), draws, 1);
        let widest = Self::widest(entry);
        let bend = math::at_most(math::at_least(turn + noise.heading[0] - noise.heading[1], -widest), widest);
        let speed = math::at_least(self.person.speed * share * slowing(turn) * noise.factors[0], SLOWEST);
        let rate = self.rate(speed);
        let duration = noise.factors[2] / rate;
        let usual = speed / rate * noise.factors[1];
        let length = if before.last.is_some() { usual } else { FIRST * usual };
        let half = direction(0.5 * bend);
        let middle = turned(entry.walking, half);
        let walking = turned(middle, half);
        let aside = side(foot) * self.sway(duration) * SLOPE;
        let exit = Exit {
            chord: turned(middle, direction(noise.aside)) * length,
            rise: walking * usual - left_of(walking) * aside,
            middle,
            duration,
        };
        Stance { last: Some((foot, self.shape(entry, foot, &exit))), drift: noise.drift }
    }
}

impl Gait for SyntheticGait {
    fn step(&self, before: &Stance, foot: Foot, share: f64, draws: Draws) -> Stance {
        let entry = self.entry(before);
        let [kind, size] = draws.uniform_pair(0);
        let wide = Self::widest(&entry) * size * size;
        let turn = if kind < 0.5 * TURNING {
            wide
        } else if kind < TURNING {
            -wide
        } else {
            0.0
        };
        self.step_from(&entry, before, foot, share, turn, draws)
    }

    fn length(&self) -> f64 {
        self.person.speed / self.rate(self.person.speed)
    }

    fn duration(&self) -> f64 {
        1.0 / self.rate(self.person.speed)
    }
}

// Differences between people who walk (Weidmann 1993 for the speed; stature and step width of adults).

/// What the gait of a person depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    /// Stature, m.
    pub height: f64,
    /// Speed chosen on free ground, m/s.
    pub speed: f64,
    /// Distance between the feet across the direction of walking, m.
    pub width: f64,
}

impl Person {
    /// Draws a person. A height (m) or speed (m/s) that is given replaces the drawn one and changes no other draw.
    pub fn draw(stream: Stream, height: Option<f64>, speed: Option<f64>) -> Self {
        let drawn = |address: u64, mean, sd, low, high| {
            let law = Law::Random { family: Family::Normal { mean, sd }, low, high };
            law.draw(stream.uniform(address as u32))
        };
        Self {
            height: height.unwrap_or_else(|| drawn(const { name_hash("gait height") }, 1.72, 0.09, 1.3, 2.2)),
            speed: speed.unwrap_or_else(|| drawn(const { name_hash("gait speed") }, 1.34, 0.26, 0.5, 2.2)),
            width: drawn(const { name_hash("gait width") }, 0.155, 0.03, 0.05, 0.3),
        }
    }
}
