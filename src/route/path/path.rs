//! A path: pieces one after the other, and places by distance along them.

use super::piece::{Piece, Place};
use crate::base::geometry::Vec2;

/// Pieces that are shorter, m, are left out.
const SHORTEST: f64 = 1e-12;

/// Directions that differ by less, rad, go on smoothly.
const SMOOTH: f64 = 1e-6;

/// Pieces that begin where the one before ends. The direction is continuous except at [`Piece::Turn`].
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    start: Vec2,
    pieces: Vec<Piece>,
    /// Distance along the path at which each piece begins, m; at the end its length.
    joints: Vec<f64>,
}

impl Path {
    /// A path of length 0.
    pub fn empty(start: Vec2) -> Self {
        Self { start, pieces: Vec::new(), joints: vec![0.0] }
    }

    /// Of pieces, each of which begins where the one before ends. Pieces without length are left out, except turns. A
    /// turn is inserted where the direction jumps.
    pub fn new(start: Vec2, pieces: impl IntoIterator<Item = Piece>) -> Self {
        let mut path = Self::empty(start);
        for piece in pieces {
            path.push(piece);
        }
        path
    }

    /// Goes straight to a place.
    pub(super) fn push_line(&mut self, to: Vec2) {
        self.push(Piece::Line { from: self.end().position, to });
    }

    /// Adds a piece that begins at the end.
    pub(super) fn push(&mut self, piece: Piece) {
        let length = piece.length();
        if matches!(piece, Piece::Turn { .. }) {
            self.pieces.push(piece);
            self.joints.push(self.length());
        } else if length > SHORTEST {
            let next = piece.at(0.0);
            if let Some(last) = self.pieces.last() {
                let before = last.end().direction;
                if (next.direction - before).norm() > SMOOTH {
                    self.push(Piece::Turn { at: next.position, from: before, to: next.direction });
                }
            }
            self.pieces.push(piece);
            self.joints.push(self.length() + length);
        }
    }

    /// Its length, m.
    pub fn length(&self) -> f64 {
        self.joints.last().copied().unwrap_or(0.0)
    }

    /// Its pieces.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The distances at which its pieces begin, m, and its length. The first one is 0.
    pub fn joints(&self) -> &[f64] {
        &self.joints
    }

    /// Its pieces with the distances at which they begin and end, m.
    fn spans(&self) -> impl Iterator<Item = (f64, f64, &Piece)> {
        self.joints
            .iter()
            .zip(self.joints.iter().skip(1))
            .zip(&self.pieces)
            .map(|((&a, &b), piece)| (a, b, piece))
    }

    /// The place at a distance along it, m, held between 0 and the length. Where two pieces meet, the later one
    /// counts. An empty path points along +x.
    pub fn at(&self, along: f64) -> Place {
        let k = self.joints.partition_point(|&joint| joint <= along).max(1) - 1;
        let k = k.min(self.pieces.len().saturating_sub(1));
        match (self.pieces.get(k), self.joints.get(k)) {
            (Some(piece), Some(joint)) => piece.at(along - joint),
            _ => Place { position: self.start, direction: Vec2::x(), curvature: 0.0 },
        }
    }

    /// Its last place.
    pub fn end(&self) -> Place {
        self.at(self.length())
    }

    /// The nearest place of it: its distance along the path and its distance from `p`, m. The first of several that
    /// are equally near.
    pub fn nearest(&self, p: Vec2) -> (f64, f64) {
        self.nearest_within(p, 0.0, self.length())
    }

    /// As [`Path::nearest`], of the part between two distances along it, m, which are held between 0 and the length.
    pub fn nearest_within(&self, p: Vec2, from: f64, to: f64) -> (f64, f64) {
        let from = from.min(self.length()).max(0.0);
        let to = to.min(self.length()).max(from);
        let first = self.joints.partition_point(|&joint| joint < from).max(1) - 1;
        let mut best = (from, f64::INFINITY);
        for (begin, end, piece) in self.spans().skip(first).take_while(|(begin, _, _)| *begin <= to) {
            // Most arcs need no angle: the circle is farther away.
            if let Piece::Arc { centre, radius, .. } = piece
                && ((p - centre).norm() - radius).abs() >= best.1
            {
                continue;
            }
            let (low, high) = ((from - begin).max(0.0), (to.min(end) - begin).max(0.0));
            let (along, distance) = piece.nearest_within(p, low.min(high), high);
            if distance < best.1 {
                best = ((begin + along).min(to), distance);
            }
        }
        if best.1.is_finite() { best } else { (from, (p - self.at(from).position).norm()) }
    }
}
