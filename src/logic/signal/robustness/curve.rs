//! A bound of a margin over time: a number that is constant on pieces, from the first moment that is kept to the
//! last that is asked about.

use crate::logic::signal::moment::Moment;
use std::collections::VecDeque;

/// Pieces from their first moment to the next one's.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pieces: VecDeque<(Moment, f64)>,
    first: Moment,
    /// Moments before this one have a value.
    known: Moment,
    /// Moments from here on are not asked about.
    pub(super) end: Moment,
}

impl Curve {
    pub(super) fn new(first: Moment, end: Moment) -> Self {
        Self { pieces: VecDeque::with_capacity(8), first, known: first, end }
    }

    pub(super) fn clear(&mut self) {
        self.pieces.clear();
        self.known = self.first;
    }

    /// Takes back everything from a moment on.
    pub(super) fn cut(&mut self, from: Moment) {
        while self.pieces.back().is_some_and(|piece| piece.0 >= from) {
            self.pieces.pop_back();
        }
        self.known = self.known.min(from);
    }

    /// The value up to before `to`.
    pub(super) fn push(&mut self, to: Moment, value: f64) {
        let to = to.min(self.end);
        if to > self.known {
            if self.pieces.back().is_none_or(|last| last.1.to_bits() != value.to_bits()) {
                self.pieces.push_back((self.known, value));
            }
            self.known = to;
        }
    }

    /// Drops pieces that end before a moment.
    pub(super) fn forget(&mut self, before: Moment) {
        while self.pieces.len() > 1 && self.pieces[1].0 <= before {
            self.pieces.pop_front();
        }
    }

    /// Number of pieces.
    pub(super) fn len(&self) -> usize {
        self.pieces.len()
    }

    fn index(&self, at: Moment) -> usize {
        match self.pieces.back() {
            Some(last) if last.0 <= at => self.pieces.len() - 1,
            _ => self.pieces.partition_point(|piece| piece.0 <= at).saturating_sub(1),
        }
    }
}

/// A curve as an operand, perhaps with its sign turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reader<'c> {
    pub(super) curve: &'c Curve,
    pub(super) negated: bool,
}

impl Reader<'_> {
    fn value(&self, value: f64) -> f64 {
        if self.negated { -value } else { value }
    }

    /// The first moment after the piece around `at`, and the value; minus infinity where nothing is asked.
    pub(super) fn around(&self, at: Moment) -> (Moment, f64) {
        let curve = self.curve;
        if at >= curve.known {
            return (Moment::MAX, f64::NEG_INFINITY);
        }
        let k = curve.index(at);
        let end = curve.pieces.get(k + 1).map_or(curve.known, |next| next.0);
        (end, curve.pieces.get(k).map_or(f64::NEG_INFINITY, |piece| self.value(piece.1)))
    }

    /// Pieces from the one around `at` on: first moment, first moment after it, value.
    pub(super) fn pieces(&self, at: Moment) -> impl Iterator<Item = (Moment, Moment, f64)> {
        let (curve, from) = (self.curve, self.curve.index(at));
        (from..curve.pieces.len()).filter(move |_| at < curve.known).map(move |k| {
            let (start, value) = curve.pieces[k];
            (start, curve.pieces.get(k + 1).map_or(curve.known, |next| next.0), self.value(value))
        })
    }
}
