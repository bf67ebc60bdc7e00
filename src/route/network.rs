//! The tangent visibility graph of a scene for bodies of one radius: exact shortest ways for a disc.
//!
//! A shortest way consists of straight lines that touch two circles and of arcs around the circles (Pocchiola, Vegter 1996;
//! Liu, Arimoto 1992). A *track* is a free arc of a circle together with the sense in which it is walked; a *station* is a place
//! on a track at which a line leaves or arrives.

use super::cells::Cells;
use super::circle::{Circle, circles};
use super::tangent::{Tangent, Turn, between};
use crate::base::geometry::Vec2;
use crate::model::Sight;
use std::sync::Arc;

/// An end of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    pub(super) track: u32,
    /// How far along the track, rad.
    pub(super) at: f64,
    /// The other end of the line.
    pub(super) mate: u32,
    /// Whether the line leaves here.
    pub(super) leaves: bool,
    /// Length of the line, m.
    pub(super) length: f64,
}

/// A free arc of a circle in one sense.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) circle: u32,
    pub(super) turn: Turn,
    /// How far it goes, rad.
    pub(super) extent: f64,
    /// Angle at which it begins.
    pub(super) from: f64,
    /// Whether it leads into itself.
    pub(super) is_full: bool,
    /// Its stations, in order.
    pub(super) stations: Vec<u32>,
}

impl Track {
    /// The angle of a place on it.
    pub(super) fn angle(&self, at: f64) -> f64 {
        self.from + self.turn.sign() * at
    }

    /// How far it is from one place on it to another, rad; `None` if the other one lies behind.
    pub(super) fn ahead(&self, from: f64, to: f64) -> Option<f64> {
        let far = to - from;
        // Where two lines touch at one place, rounding does not say which is first.
        if far >= -1e-9 { Some(far.max(0.0)) } else { self.is_full.then_some(far + self.extent) }
    }

    /// The first station at a place or behind it, as an index into the list, and how far it is, rad.
    pub(super) fn next(&self, at: f64, stations: &[Station]) -> Option<(usize, f64)> {
        let k = self.stations.partition_point(|&s| stations[s as usize].at < at - 1e-9);
        let k = if k == self.stations.len() && self.is_full { 0 } else { k };
        let station = *self.stations.get(k)?;
        Some((k, self.ahead(at, stations[station as usize].at)?))
    }
}

/// All that shortest ways of bodies of one radius consist of.
#[derive(Debug)]
pub(super) struct Network {
    /// Radius of the bodies, m.
    pub(super) reach: f64,
    pub(super) sight: Arc<Sight>,
    pub(super) circles: Vec<Circle>,
    /// The first track of each circle: two for each of its arcs, one in each sense.
    first: Vec<u32>,
    pub(super) tracks: Vec<Track>,
    pub(super) stations: Vec<Station>,
    pub(super) cells: Cells,
}

impl Network {
    pub(super) fn new(sight: Arc<Sight>, reach: f64) -> Self {
        let circles = circles(&sight, reach);
        let (mut first, mut tracks) = (Vec::new(), Vec::new());
        for (k, circle) in circles.iter().enumerate() {
            first.push(tracks.len() as u32);
            for arc in &circle.arcs {
                for turn in Turn::BOTH {
                    tracks.push(Track {
                        circle: k as u32,
                        turn,
                        extent: arc.extent,
                        from: if turn == Turn::Left { arc.from } else { arc.from + arc.extent },
                        is_full: arc.is_full(),
                        stations: Vec::new(),
                    });
                }
            }
        }
        let cells = Cells::new(&circles);
        let mut out = Self { reach, sight, circles, first, tracks, stations: Vec::new(), cells };
        out.join();
        out
    }

    /// The track of a circle in a sense to which a unit vector from the centre points, and how far along it.
    pub(super) fn place(&self, circle: usize, turn: Turn, touch: Vec2) -> Option<(u32, f64)> {
        let (arc, at) = self.circles[circle].place(touch)?;
        let track = self.first[circle] + 2 * arc as u32 + u32::from(turn == Turn::Right);
        let at = if turn == Turn::Left { at } else { self.circles[circle].arcs[arc].extent - at };
        Some((track, at))
    }

    /// Finds the lines between all circles.
    fn join(&mut self) {
        for a in 0..self.circles.len() {
            for b in a + 1..self.circles.len() {
                for turn_a in Turn::BOTH {
                    for turn_b in Turn::BOTH {
                        let line = between((&self.circles[a], turn_a), (&self.circles[b], turn_b));
                        if let Some(line) = line {
                            self.add((a, turn_a), (b, turn_b), &line);
                        }
                    }
                }
            }
        }
        for (k, station) in self.stations.iter().enumerate() {
            self.tracks[station.track as usize].stations.push(k as u32);
        }
        for track in &mut self.tracks {
            let at = |k: &u32| self.stations[*k as usize].at;
            track.stations.sort_by(|a, b| at(a).total_cmp(&at(b)).then(a.cmp(b)));
        }
    }

    /// Adds a line, and the same one backwards, if it is free.
    fn add(&mut self, (a, turn_a): (usize, Turn), (b, turn_b): (usize, Turn), line: &Tangent) {
        let [touch_a, touch_b] = line.touches;
        let there = (self.place(a, turn_a, touch_a), self.place(b, turn_b, touch_b));
        let (Some(leave), Some(arrive)) = there else { return };
        if !self.sight.is_clear(line.ends[0], line.ends[1], self.reach) {
            return;
        }
        let back = |(track, at): (u32, f64)| {
            let opposite = track ^ 1;
            (opposite, self.tracks[track as usize].extent - at)
        };
        for (leave, arrive) in [(leave, arrive), (back(arrive), back(leave))] {
            let k = self.stations.len() as u32;
            let station =
                |(track, at), mate, leaves| Station { track, at, mate, leaves, length: line.length };
            self.stations.push(station(leave, k + 1, true));
            self.stations.push(station(arrive, k, false));
        }
    }
}
