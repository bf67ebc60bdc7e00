//! Pulls a polyline taut around circles.
//!
//! Where circles take the place of vertices, the legs move. A leg that then comes too near to another corner of a
//! barrier gets the circle around that corner as a further stop; a circle that the taut line leaves is dropped.

use super::around::{Leg, Stop, arc, discs};
use crate::base::geometry::{Segment, cross};
use crate::model::Sight;
use crate::model::sight::ROUNDING;
use std::f64::consts::PI;

/// A taut line leaves a circle around which its legs would turn farther, rad.
const FARTHEST_TURN: f64 = 1.5 * PI;

/// The stops with circles in the place of vertices, `circles` by stop. Where legs or arcs are not free the vertices stay.
pub(super) fn replace(
    stops: &[Stop],
    mut circles: Vec<Option<Stop>>,
    reach: f64,
    sight: &Sight,
) -> Vec<Stop> {
    loop {
        let mut line = Line { stops: Vec::with_capacity(stops.len()), reach, sight };
        for (k, (stop, circle)) in stops.iter().zip(&circles).enumerate() {
            // Several vertices may lead around one circle.
            if circle.is_none() || line.stops.last().map(|last| last.0) != *circle {
                line.stops.push((circle.unwrap_or(*stop), k));
            }
        }
        let Some(failed) = line.pull() else { return line.stops.into_iter().map(|(stop, _)| stop).collect() };
        let circle = circles.get(failed).copied().flatten();
        for place in circles.iter_mut().skip(failed).take_while(|place| **place == circle) {
            *place = None;
        }
        if circle.is_none() {
            return stops.to_vec();
        }
    }
}

/// What a taut line needs at a stop.
enum Change {
    /// A further stop before the stop of this number.
    Insert(usize, Stop),
    /// The circle is left.
    Remove(usize),
    /// The circle that came from this vertex has no room.
    Fail(usize),
}

/// A line around stops. Each has the number of the vertex that it came from; a stop that was inserted, that of its
/// neighbour.
struct Line<'a> {
    stops: Vec<(Stop, usize)>,
    reach: f64,
    sight: &'a Sight,
}

impl Line<'_> {
    /// Makes the line free. Returns the number of a vertex whose circle prevents it.
    fn pull(&mut self) -> Option<usize> {
        let rounds = 4 * self.stops.len() + 16;
        for _ in 0..rounds {
            match self.change()? {
                Change::Insert(k, stop) => {
                    let origin = self.origin(k);
                    self.stops.insert(k, (stop, origin));
                }
                Change::Remove(k) => {
                    self.stops.remove(k);
                }
                Change::Fail(origin) => return Some(origin),
            }
        }
        // It does not settle.
        let circle = self.stops.iter().find(|(stop, _)| stop.around != 0.0);
        Some(circle.map_or(0, |(_, origin)| *origin))
    }

    /// The vertex of a circle at an end of the leg that leads to stop `k`.
    fn origin(&self, k: usize) -> usize {
        let ends = [self.stops.get(k), self.stops.get(k.wrapping_sub(1))];
        let circle = ends.into_iter().flatten().find(|(stop, _)| stop.around != 0.0);
        circle.or(ends[1]).map_or(0, |(_, origin)| *origin)
    }

    /// The first change that the line needs.
    fn change(&self) -> Option<Change> {
        let mut before: Option<Leg> = None;
        for (k, pair) in self.stops.windows(2).enumerate() {
            let &[(a, first), (b, second)] = pair else { continue };
            let leg = Leg::between(a, b);
            if let (Some(before), Some(leg)) = (before, leg)
                && a.around != 0.0
                && arc(a, before.along, leg.along).length() > FARTHEST_TURN * a.around.abs()
            {
                return Some(Change::Remove(k));
            }
            let Some(leg) = leg else { return Some(Change::Fail(self.origin(k + 1))) };
            let is_old = a.around == 0.0 && b.around == 0.0 && second == first + 1;
            if !is_old && let Some(change) = self.free(k, &leg, (a, b)) {
                return Some(change);
            }
            before = Some(leg);
        }
        let arcs = self.stops.windows(3).filter_map(|three| match *three {
            [(a, _), (stop, origin), (b, _)] if stop.around != 0.0 => {
                Some((origin, arc(stop, Leg::between(a, stop)?.along, Leg::between(stop, b)?.along), stop.at))
            }
            _ => None,
        });
        for (origin, arc, at) in arcs {
            let near = self.sight.near(at, arc.radius() + self.reach);
            if near.iter().any(|surface| arc.distance_to(surface) < self.reach - ROUNDING) {
                return Some(Change::Fail(origin));
            }
        }
        None
    }

    /// The change that makes leg `k` free.
    fn free(&self, k: usize, leg: &Leg, ends: (Stop, Stop)) -> Option<Change> {
        let line = Segment::new(leg.from, leg.to);
        let mut deepest: Option<(f64, Stop)> = None;
        self.sight.any_along(&line, self.reach, |surface| {
            for (at, radius) in discs(surface, self.reach) {
                // An end that is a vertex may itself be too near.
                let least = [ends.0, ends.1].iter().fold(radius - ROUNDING, |least, end| match end.around {
                    0.0 => least.min((at - end.at).norm() - ROUNDING),
                    _ if end.at == at => f64::NEG_INFINITY,
                    _ => least,
                });
                let depth = least - line.distance(at);
                if depth > 0.0 && deepest.is_none_or(|(most, _)| depth > most) {
                    let side = if cross(leg.along, at - leg.from) < 0.0 { -1.0 } else { 1.0 };
                    deepest = Some((depth, Stop { at, around: side * radius }));
                }
            }
            false
        });
        let is_clear = || self.sight.is_clear(leg.from, leg.to, self.reach);
        match deepest {
            Some((_, stop)) => Some(Change::Insert(k + 1, stop)),
            None if is_clear() => None,
            None => Some(Change::Fail(self.origin(k + 1))),
        }
    }
}
