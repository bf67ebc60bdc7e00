//! Paths for tests: those with reference values, and random ones.

use crate::base::math::pow;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::route::profile::{Infeasible, Limits, Stretch, optimal};
use std::f64::consts::PI;

/// A path with limits and end speeds.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) stretches: Vec<Stretch>,
    pub(super) limits: Limits,
    pub(super) start: f64,
    pub(super) end: f64,
}

pub(super) fn line(length: f64) -> Stretch {
    Stretch { length, radius: f64::INFINITY }
}

/// An arc with a turning angle in degrees.
pub(super) fn arc(degrees: f64, radius: f64) -> Stretch {
    Stretch { length: radius * degrees * PI / 180.0, radius }
}

pub(super) const STOP: Stretch = Stretch { length: 0.0, radius: 0.0 };

/// Limits with one bound for the norm of the acceleration.
pub(super) fn circle(speed: f64, acceleration: f64) -> Limits {
    Limits { speed, along: acceleration, across: acceleration }
}

/// The path of Li, Li, Ge 2019.
pub(super) fn paper_path() -> Vec<Stretch> {
    vec![line(10.0), arc(45.0, 7.0), line(10.0), arc(60.0, 3.0), line(2.0)]
}

/// Independent numbers of one test and one shape.
pub(super) fn stream(index: u64, entity: u32) -> Stream {
    Stream::of(TrialKey { seed: 2019, index, branch: 0 }, entity, Purpose::Test)
}

/// A random path: one to six lines and arcs of all sizes, circle or ellipse, ends at rest or not.
pub(super) fn random_case(index: u64) -> Case {
    let stream = stream(index, 1);
    let mut next = 0;
    let mut uniform = || {
        next += 1;
        stream.uniform(next)
    };
    let between = |u: f64, low: f64, high: f64| low * pow(high / low, u);
    let count = 1 + (uniform() * 6.0) as usize;
    let stretches = (0..count).map(|_| {
        if uniform() < 0.4 {
            line(between(uniform(), 0.02, 20.0))
        } else {
            arc(between(uniform(), 2.0, 180.0), between(uniform(), 0.1, 20.0))
        }
    });
    let stretches: Vec<Stretch> = stretches.collect();
    let along = between(uniform(), 0.3, 3.0);
    let across = if uniform() < 0.5 { along } else { between(uniform(), 0.3, 3.0) };
    let limits = Limits { speed: between(uniform(), 0.5, 12.0), along, across };
    let mut case = Case { stretches, limits, start: 0.0, end: 0.0 };
    // End speeds up to the largest legal ones.
    let largest = |case: &Case, start: f64, end: f64| {
        let found = optimal(&case.stretches, case.limits, start, end);
        found.map_or_else(
            |why| match why {
                Infeasible::Start { largest, .. } | Infeasible::End { largest, .. } => largest,
                other => panic!("{other}"),
            },
            |_| start.max(end),
        )
    };
    if uniform() < 0.4 {
        case.start = uniform() * largest(&case, 100.0, 0.0);
    }
    if uniform() < 0.4 {
        case.end = uniform() * largest(&case, case.start, 100.0);
        case.start = case.start.min(largest(&case, case.start, case.end));
    }
    case
}
