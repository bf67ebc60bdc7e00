//! The plane of a scene for vectors: open, or closed on itself along an axis. The loops over pairs are compiled for each, so
//! that an open plane costs nothing.

use super::vector::{Doubles, Part, nearest_whole};
use crate::model::{Period, Periods};
use fearless_simd::Simd;

/// Which way leads from one place to another.
pub(super) trait Plane: Copy + Sync {
    /// Whether it may be another one than the difference of the places.
    const IS_CLOSED: bool;

    /// The longest coordinates of a shortest way, m.
    fn half(self) -> (f64, f64) {
        (f64::INFINITY, f64::INFINITY)
    }

    /// The shortest way, for the way to any image.
    fn way<S: Simd>(self, part: Part<S>, way: (Doubles<S>, Doubles<S>)) -> (Doubles<S>, Doubles<S>);
}

/// Without periods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open;

impl Plane for Open {
    const IS_CLOSED: bool = false;

    #[inline(always)]
    fn way<S: Simd>(self, _: Part<S>, way: (Doubles<S>, Doubles<S>)) -> (Doubles<S>, Doubles<S>) {
        way
    }
}

/// With a period along an axis at least.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closed {
    x: Lap,
    y: Lap,
}

/// The length of a period, m, and one over it; both 0 where there is none.
#[derive(Clone, Copy, Debug, Default)]
struct Lap {
    length: f64,
    inverse: f64,
}

impl Closed {
    /// The plane with these periods, if there is any.
    pub(super) fn with(periods: &Periods) -> Option<Self> {
        let lap = |period: Period| Lap { length: period.length, inverse: 1.0 / period.length };
        let lap = |period: Option<Period>| period.map_or(Lap::default(), lap);
        (!periods.are_none()).then(|| Self { x: lap(periods.x), y: lap(periods.y) })
    }
}

impl Plane for Closed {
    const IS_CLOSED: bool = true;

    fn half(self) -> (f64, f64) {
        let half = |lap: Lap| if lap.length > 0.0 { 0.5 * lap.length } else { f64::INFINITY };
        (half(self.x), half(self.y))
    }

    #[inline(always)]
    fn way<S: Simd>(self, part: Part<S>, (dx, dy): (Doubles<S>, Doubles<S>)) -> (Doubles<S>, Doubles<S>) {
        let near =
            |d: Doubles<S>, lap: Lap| d - part.c(lap.length) * nearest_whole(part, d * part.c(lap.inverse));
        (near(dx, self.x), near(dy, self.y))
    }
}
