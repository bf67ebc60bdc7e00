//! Lengths of the shortest ways to a goal from everywhere on the tracks of a network (Dijkstra 1959, from the goal backwards).

use super::goal::{Departure, Entry};
use super::network::Network;
use super::tangent::Turn;
use crate::base::frontier::Frontier;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// How a way goes on from a place on a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Onward {
    /// Along the track to a station, and from there as the field says.
    Station(u32),
    /// Along the track to a departure for the goal, by its number.
    Goal(u32),
}

/// The shortest ways to one goal.
#[derive(Debug)]
pub(super) struct Field {
    pub(super) entry: Entry,
    pub(super) departures: Vec<Departure>,
    /// For each track, the range of its departures; they are sorted by track.
    of_track: Vec<(u32, u32)>,
    /// Length of the way from each station, m.
    lengths: Vec<f64>,
    /// How it goes on; of a station that is left by its line, the mate.
    onward: Vec<Option<Onward>>,
    /// For each circle, less than or as long as any way that turns around it to the left and to the right, m.
    least: Vec<[f64; 2]>,
    /// For each cell, around which circle and in which sense a way from it began last; no result depends on it.
    hints: Vec<AtomicU32>,
}

impl Field {
    pub(super) fn new(network: &Network, entry: Entry) -> Self {
        let mut departures = entry.departures(network);
        departures.sort_by(|a, b| a.track.cmp(&b.track).then(a.at.total_cmp(&b.at)));
        let mut of_track = vec![(0, 0); network.tracks.len()];
        for (k, departure) in departures.iter().enumerate() {
            let range = &mut of_track[departure.track as usize];
            *range = if range.1 == 0 { (k as u32, k as u32 + 1) } else { (range.0, k as u32 + 1) };
        }
        let count = network.stations.len();
        let mut field = Self {
            entry,
            departures,
            of_track,
            lengths: vec![f64::INFINITY; count],
            onward: vec![None; count],
            least: vec![[f64::INFINITY; 2]; network.circles.len()],
            hints: (0..network.cells.count()).map(|_| AtomicU32::new(u32::MAX)).collect(),
        };
        field.spread(network);
        field.bound(network);
        field
    }

    fn spread(&mut self, network: &Network) {
        let mut queue = Frontier::new();
        for (k, station) in network.stations.iter().enumerate() {
            if let Some((length, departure)) = self.leave(network, station.track, station.at) {
                self.lengths[k] = length;
                self.onward[k] = Some(Onward::Goal(departure));
                queue.push(length, k as u32);
            }
        }
        while let Some((length, at)) = queue.pop() {
            if length > self.lengths[at as usize] {
                continue;
            }
            let station = network.stations[at as usize];
            let mut reach = |from: u32, length: f64, onward| {
                if length < self.lengths[from as usize] {
                    self.lengths[from as usize] = length;
                    self.onward[from as usize] = Some(onward);
                    queue.push(length, from);
                }
            };
            if !station.leaves {
                reach(station.mate, length + station.length, Onward::Station(at));
            }
            // The station before on the track.
            let track = &network.tracks[station.track as usize];
            let place = |k: u32| (network.stations[k as usize].at, k);
            let before = track.stations.partition_point(|&k| place(k) < (station.at, at));
            let before = match before.checked_sub(1) {
                Some(before) => Some(before),
                None if track.is_full => track.stations.len().checked_sub(1),
                None => None,
            };
            if let Some(from) = before.map(|before| track.stations[before]).filter(|from| *from != at) {
                let from_at = network.stations[from as usize].at;
                if let Some(turn) = track.ahead(from_at, station.at) {
                    let radius = network.circles[track.circle as usize].radius;
                    reach(from, length + turn * radius, Onward::Station(at));
                }
            }
        }
    }

    fn bound(&mut self, network: &Network) {
        let departures = self.departures.iter().map(|departure| (departure.track, departure.length));
        let stations =
            network.stations.iter().zip(&self.lengths).map(|(station, length)| (station.track, *length));
        for (track, length) in departures.chain(stations) {
            let track = &network.tracks[track as usize];
            let least = &mut self.least[track.circle as usize][usize::from(track.turn == Turn::Right)];
            *least = least.min(length);
        }
    }

    /// Less than or as long as any way that turns around a circle in a sense, m; infinite where none does.
    pub(super) fn least(&self, (circle, turn): (u32, Turn)) -> f64 {
        self.least[circle as usize][usize::from(turn == Turn::Right)]
    }

    /// Around which circle and in which sense a way from a cell began last.
    pub(super) fn hint(&self, cell: Option<usize>) -> Option<(u32, Turn)> {
        let hint = self.hints.get(cell?)?.load(Relaxed);
        let turn = if hint % 2 == 0 { Turn::Left } else { Turn::Right };
        (hint != u32::MAX).then_some((hint / 2, turn))
    }

    /// Remembers that.
    pub(super) fn remember(&self, cell: Option<usize>, first: Option<(u32, Turn)>) {
        if let (Some(place), Some((circle, turn))) = (cell.and_then(|cell| self.hints.get(cell)), first) {
            place.store(2 * circle + u32::from(turn == Turn::Right), Relaxed);
        }
    }

    /// The shortest way from a place on a track by a departure on the same track: its length, and the departure.
    fn leave(&self, network: &Network, track: u32, at: f64) -> Option<(f64, u32)> {
        let (from, to) = self.of_track[track as usize];
        let line = &network.tracks[track as usize];
        let radius = network.circles[line.circle as usize].radius;
        let mut best: Option<(f64, u32)> = None;
        for k in from..to {
            let departure = &self.departures[k as usize];
            if let Some(turn) = line.ahead(at, departure.at) {
                let length = turn * radius + departure.length;
                if best.is_none_or(|(known, _)| length < known) {
                    best = Some((length, k));
                }
            }
        }
        best
    }

    /// The shortest way from a place on a track: its length, m, and how it goes on.
    pub(super) fn from(&self, network: &Network, track: u32, at: f64) -> Option<(f64, Onward)> {
        let direct = self.leave(network, track, at).map(|(length, k)| (length, Onward::Goal(k)));
        let line = &network.tracks[track as usize];
        let next = line.next(at, &network.stations).and_then(|(k, turn)| {
            let station = line.stations[k];
            let rest = self.lengths[station as usize];
            let radius = network.circles[line.circle as usize].radius;
            rest.is_finite().then_some((rest + turn * radius, Onward::Station(station)))
        });
        match (direct, next) {
            (Some(direct), Some(next)) => Some(if next.0 < direct.0 { next } else { direct }),
            (direct, next) => direct.or(next),
        }
    }

    /// How the way from a station goes on.
    pub(super) fn onward(&self, station: u32) -> Option<Onward> {
        self.onward[station as usize]
    }
}
