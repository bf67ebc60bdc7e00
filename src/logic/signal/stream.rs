//! A number over time, known from the first moment asked about up to some moment.

use super::moment::Moment;
use std::collections::VecDeque;

/// A number at the moments that its parents ask about. It becomes known in order.
#[derive(Clone, Debug)]
pub(super) struct Stream {
    /// Pieces from their first moment to the next one's.
    pieces: VecDeque<(Moment, f64)>,
    first: Moment,
    /// Moments from here on are not asked about.
    pub(super) end: Moment,
    /// Moments before this one are known.
    pub(super) known: Moment,
    /// `known` before the present step.
    mark: Moment,
}

impl Stream {
    pub(super) fn new(first: Moment, end: Moment) -> Self {
        Self { pieces: VecDeque::with_capacity(16), first, end, known: first, mark: first }
    }

    pub(super) fn clear(&mut self) {
        self.pieces.clear();
        self.known = self.first;
        self.mark();
    }

    /// The number is this one up to before `to`.
    pub(super) fn extend(&mut self, to: Moment, value: f64) {
        let to = to.min(self.end);
        if to > self.known {
            if self.pieces.back().is_none_or(|last| last.1.to_bits() != value.to_bits()) {
                self.pieces.push_back((self.known, value));
            }
            self.known = to;
        }
    }

    /// Index of the piece around a moment, which is known and kept.
    fn index(&self, at: Moment) -> usize {
        let last = self.pieces.len().saturating_sub(1);
        match self.pieces.get(last) {
            Some(piece) if piece.0 <= at => last,
            _ => self.pieces.partition_point(|piece| piece.0 <= at).saturating_sub(1),
        }
    }

    /// The first moment of the piece around a moment, which is known and kept.
    pub(super) fn since(&self, at: Moment) -> Moment {
        self.pieces.get(self.index(at)).map_or(self.first, |piece| piece.0)
    }

    /// The number around a moment, which is known and kept, and the first moment after its piece.
    pub(super) fn around(&self, at: Moment) -> (Moment, f64) {
        let k = self.index(at);
        let end = self.pieces.get(k + 1).map_or(self.known, |next| next.0);
        (end, self.pieces.get(k).map_or(f64::NAN, |piece| piece.1))
    }

    /// Pieces from the one around a known moment on: first moment, first moment after it, value.
    pub(super) fn pieces(&self, at: Moment) -> impl Iterator<Item = (Moment, Moment, f64)> {
        (self.index(at)..self.pieces.len()).filter(move |_| at < self.known).map(|k| {
            let (start, value) = self.pieces[k];
            (start, self.pieces.get(k + 1).map_or(self.known, |next| next.0), value)
        })
    }

    /// A step begins.
    pub(super) fn mark(&mut self) {
        self.mark = self.known;
    }

    /// Forgets what the present step found.
    pub(super) fn take_back(&mut self) {
        self.cut(self.mark);
    }

    /// Forgets everything from a moment on.
    pub(super) fn cut(&mut self, from: Moment) {
        while self.pieces.back().is_some_and(|piece| piece.0 >= from) {
            self.pieces.pop_back();
        }
        self.known = self.known.min(from);
    }

    /// The first moment that is asked about and not known.
    pub(super) fn first_open(&self) -> Option<Moment> {
        (self.known < self.end).then_some(self.known)
    }

    /// Drops pieces that end before a moment.
    pub(super) fn forget(&mut self, before: Moment) {
        while self.pieces.len() > 1 && self.pieces[1].0 <= before {
            self.pieces.pop_front();
        }
    }

    pub(super) fn len(&self) -> usize {
        self.pieces.len()
    }
}
