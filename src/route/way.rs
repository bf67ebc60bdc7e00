//! Shortest ways: from a place to a goal.

use super::circle::direction;
use super::field::{Field, Onward};
use super::network::Network;
use super::tangent::{Turn, from_point};
use crate::base::geometry::Vec2;
use crate::model::sight::ROUNDING;

/// Most barriers from which somebody steps aside one after the other.
const STEPS_ASIDE: usize = 16;

/// On an arc a body heads for points at most so far apart, rad.
const STEP: f64 = std::f64::consts::FRAC_PI_4;

/// An arc of a way around a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Centre of the circle, m.
    pub centre: Vec2,
    /// Its radius, m.
    pub radius: f64,
    /// Angle at which the arc begins, rad.
    pub from: f64,
    /// How far it turns, rad; positive to the left.
    pub turn: f64,
}

/// A shortest way.
#[derive(Clone, Debug, PartialEq)]
pub struct ShortestWay {
    /// Its length, m.
    pub length: f64,
    /// The arcs on it; straight lines join them.
    pub bends: Vec<Bend>,
    /// Where it ends, m.
    pub end: Vec2,
    /// The portal at which it ends, if it leads on over stairs, and a place behind its line, m.
    pub over: Option<(usize, Vec2)>,
    /// Whether it leads straight to the nearest place of the goal.
    pub is_straight: bool,
}

impl Bend {
    /// The place after a share of it, m.
    pub fn at(&self, share: f64) -> Vec2 {
        self.centre + direction(self.from + share * self.turn) * self.radius
    }

    /// Corners of a polyline that stays outside of the circle: the tangents at places of the arc meet there.
    fn corners(&self) -> impl Iterator<Item = Vec2> + '_ {
        let count = (self.turn.abs() / STEP).ceil().max(1.0);
        let step = self.turn / count;
        // 1 / cos(step / 2)
        let stretch = 1.0 / direction(0.5 * step).x;
        (0..count as u32).map(move |k| {
            let angle = self.from + (f64::from(k) + 0.5) * step;
            self.centre + direction(angle) * (self.radius * stretch)
        })
    }
}

impl ShortestWay {
    /// Points to head for one after the other; the last one is the end.
    pub fn points(&self) -> Vec<Vec2> {
        self.bends
            .iter()
            .flat_map(Bend::corners)
            .chain([self.end])
            .chain(self.over.map(|(_, beyond)| beyond))
            .collect()
    }
}

/// A first piece of a way: straight to the goal, or to a place on a track.
#[derive(Clone, Copy)]
struct FirstPiece {
    length: f64,
    to: Vec2,
    then: Option<(u32, f64)>,
}

impl Network {
    /// The shortest way from a place to the goal of a field; `None` if there is none.
    pub(super) fn way(&self, field: &Field, p: Vec2) -> Option<ShortestWay> {
        if field.entry.holds(p) {
            return Some(ShortestWay {
                length: 0.0,
                bends: Vec::new(),
                end: p,
                over: None,
                is_straight: true,
            });
        }
        let mut options: Vec<FirstPiece> = Vec::new();
        let direct = |(to, length)| FirstPiece { length, to, then: None };
        options.extend(field.entry.nearest(p).map(direct));
        let nearest = options.iter().copied().reduce(|a, b| if b.length < a.length { b } else { a })?;
        // Nothing is shorter than the straight way to the nearest place.
        let mut blocker = self.sight.blocker((p, nearest.to), self.reach, None);
        if blocker.is_none() {
            let FirstPiece { length, to: end, .. } = nearest;
            return Some(ShortestWay { length, bends: Vec::new(), end, over: None, is_straight: true });
        }
        let (free, aside) = self.free(p);
        // Of all ways whose first piece is clear, the shortest; of equally long ones, the straight one or that around the first circle.
        let mut best: Option<FirstPiece> = None;
        for option in options {
            let found = self.sight.blocker((p, option.to), self.reach, blocker);
            if found.is_none() && best.is_none_or(|best| option.length < best.length) {
                best = Some(option);
            }
            blocker = found.or(blocker);
        }
        let mut around = None;
        let (cell, seen) = self.cells.seen(free, &self.circles, &self.sight);
        let all = || seen.iter().flat_map(|&circle| Turn::BOTH.map(|turn| (circle, turn)));
        // The way that was taken from this cell before soon shows how long a way may be.
        let hint = field.hint(cell);
        let hinted = all().filter(|first| Some(*first) == hint);
        for first in hinted.chain(all().filter(|first| Some(*first) != hint)) {
            let circle = &self.circles[first.0 as usize];
            let far = ((free - circle.centre).norm() - circle.radius).abs();
            let least = (aside + far + field.least(first)) * (1.0 - ROUNDING);
            if least.is_infinite() || best.is_some_and(|best| least > best.length) {
                continue;
            }
            let Some((touch, to, line)) = from_point(free, circle, first.1) else { continue };
            if blocker.is_some_and(|k| self.sight.blocks(k, (free, to), self.reach)) {
                continue;
            }
            let Some((track, at)) = self.place(first.0 as usize, first.1, touch) else { continue };
            let Some((rest, _)) = field.from(self, track, at) else { continue };
            let length = aside + line + rest;
            let is_better = |best: FirstPiece| (length, Some(first)) < (best.length, around);
            if best.is_none_or(is_better) {
                match self.sight.blocker((free, to), self.reach, None) {
                    Some(found) => blocker = Some(found),
                    None => {
                        best = Some(FirstPiece { length, to, then: Some((track, at)) });
                        around = Some(first);
                    }
                }
            }
        }
        field.remember(cell, around);
        let FirstPiece { length, to, then } = best?;
        let straight =
            || Some(ShortestWay { length, bends: Vec::new(), end: to, over: None, is_straight: false });
        then.map_or_else(straight, |place| self.follow(field, length, place))
    }

    /// Where somebody who is pressed against barriers steps first, so that the body is free, and how far that is, m. In a gap that is
    /// too narrow, the place itself.
    fn free(&self, p: Vec2) -> (Vec2, f64) {
        let mut q = p;
        for _ in 0..STEPS_ASIDE {
            let near = self.sight.near(q, self.reach);
            let nearest = near.iter().map(|piece| (piece.distance(q), piece));
            let pressed = nearest.filter(|(distance, _)| *distance < self.reach - ROUNDING);
            let Some((distance, piece)) = pressed.reduce(|a, b| if b.0 < a.0 { b } else { a }) else {
                let is_clear = self.sight.is_clear(p, q, self.reach);
                return if is_clear { (q, (q - p).norm()) } else { (p, 0.0) };
            };
            let away = q - piece.nearest(q);
            if away.norm() <= ROUNDING {
                break;
            }
            q += away.normalize() * (self.reach - distance + ROUNDING);
        }
        (p, 0.0)
    }

    /// The arcs of the way that begins at a place on a track.
    fn follow(&self, field: &Field, length: f64, (mut track, mut at): (u32, f64)) -> Option<ShortestWay> {
        let mut bends = Vec::new();
        let mut entered = at;
        let mut onward = field.from(self, track, at)?.1;
        // A way passes no station twice.
        for _ in 0..=2 * self.stations.len() + 1 {
            let line = &self.tracks[track as usize];
            let circle = &self.circles[line.circle as usize];
            let bend = |to: f64| {
                let turn = line.ahead(entered, to).unwrap_or(0.0);
                let (centre, radius) = (circle.centre, circle.radius);
                Bend { centre, radius, from: line.angle(entered), turn: line.turn.sign() * turn }
            };
            match onward {
                Onward::Goal(k) => {
                    let departure = &field.departures[k as usize];
                    bends.push(bend(departure.at));
                    return Some(ShortestWay {
                        length,
                        bends,
                        end: departure.end,
                        over: None,
                        is_straight: false,
                    });
                }
                Onward::Station(k) => {
                    let station = self.stations[k as usize];
                    if station.track == track {
                        at = station.at;
                    } else {
                        // The line from where the way is now.
                        bends.push(bend(at));
                        (track, at, entered) = (station.track, station.at, station.at);
                    }
                    onward = field.onward(k)?;
                }
            }
        }
        None
    }
}
