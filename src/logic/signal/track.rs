//! What is known of a truth over time: pieces that are true, false or still open.

use super::moment::Moment;
use std::collections::VecDeque;

/// A truth value, perhaps not yet known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    Open,
    False,
    True,
}

impl Known {
    pub(super) fn of(truth: bool) -> Self {
        if truth { Self::True } else { Self::False }
    }

    pub(super) fn not_if(self, negated: bool) -> Self {
        match (self, negated) {
            (Self::True, true) => Self::False,
            (Self::False, true) => Self::True,
            (same, _) => same,
        }
    }
}

/// Moments `from .. to` that have just become known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fresh {
    pub(super) from: Moment,
    pub(super) to: Moment,
    pub(super) truth: bool,
}

/// A truth at the moments that its parents ask about.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Pieces from their first moment to the next one's; neighbours differ.
    pieces: VecDeque<(Moment, Known)>,
    /// The first moment that is asked about.
    pub(super) first: Moment,
    /// Moments from here on are not asked about.
    pub(super) end: Moment,
    /// The values that became known in the present step.
    pub(super) fresh: Vec<Fresh>,
}

impl Track {
    pub(super) fn new(first: Moment, end: Moment) -> Self {
        let mut track =
            Self { pieces: VecDeque::with_capacity(16), first, end, fresh: Vec::with_capacity(8) };
        track.clear();
        track
    }

    pub(super) fn clear(&mut self) {
        self.pieces.clear();
        self.pieces.push_back((self.first, Known::Open));
        self.fresh.clear();
    }

    /// Index of the piece that holds a moment between the first kept one and the end.
    fn index(&self, at: Moment) -> usize {
        let last = self.pieces.len() - 1;
        // Nearly always one of the last two.
        if self.pieces[last].0 <= at {
            return last;
        }
        if last > 0 && self.pieces[last - 1].0 <= at {
            return last - 1;
        }
        self.pieces.partition_point(|piece| piece.0 <= at).saturating_sub(1)
    }

    fn piece_end(&self, k: usize) -> Moment {
        self.pieces.get(k + 1).map_or(self.end, |next| next.0)
    }

    /// The piece around a moment: its first moment, the first one after it, and its truth. What is
    /// not kept or not asked about is open.
    pub(super) fn around(&self, at: Moment) -> (Moment, Moment, Known) {
        let front = self.pieces[0].0;
        if at < front {
            return (Moment::MIN, front, Known::Open);
        }
        if at >= self.end {
            return (self.end, Moment::MAX, Known::Open);
        }
        let k = self.index(at);
        (self.pieces[k].0, self.piece_end(k), self.pieces[k].1)
    }

    /// These moments have this truth. Those known already stay as they are.
    pub(super) fn settle(&mut self, from: Moment, to: Moment, truth: bool) {
        let (mut at, to) = (from.max(self.pieces[0].0), to.min(self.end));
        while at < to {
            let (_, end, known) = self.around(at);
            let end = end.min(to);
            if known == Known::Open {
                self.assign(at, end, Known::of(truth));
                self.fresh.push(Fresh { from: at, to: end, truth });
            }
            at = end;
        }
    }

    /// Forgets what the present step found.
    pub(super) fn take_back(&mut self) {
        while let Some(Fresh { from, to, .. }) = self.fresh.pop() {
            self.assign(from, to, Known::Open);
        }
    }

    /// Overwrites moments `from .. to`, which are kept and before the end.
    fn assign(&mut self, from: Moment, to: Moment, known: Known) {
        let mut k = self.index(from);
        if self.pieces[k].0 < from {
            k += 1;
            self.pieces.insert(k, (from, self.pieces[k - 1].1));
        }
        let mut last = k;
        while self.piece_end(last) < to {
            last += 1;
        }
        let after = self.pieces[last].1;
        if to < self.piece_end(last) {
            self.pieces.insert(last + 1, (to, after));
        }
        if last > k {
            self.pieces.drain(k + 1..=last);
        }
        self.pieces[k].1 = known;
        if self.pieces.get(k + 1).is_some_and(|next| next.1 == known) {
            self.pieces.remove(k + 1);
        }
        if k > 0 && self.pieces[k - 1].1 == known {
            self.pieces.remove(k);
        }
    }

    /// The first moment that is asked about and open.
    pub(super) fn first_open(&self) -> Option<Moment> {
        self.pieces.iter().find(|piece| piece.1 == Known::Open).map(|piece| piece.0)
    }

    /// Drops pieces that end before a moment.
    pub(super) fn forget(&mut self, before: Moment) {
        while self.pieces.len() > 1 && self.pieces[0].1 != Known::Open && self.pieces[1].0 <= before {
            self.pieces.pop_front();
        }
    }

    pub(super) fn len(&self) -> usize {
        self.pieces.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_set_once_merged_and_taken_back() {
        let mut track = Track::new(0, 100);
        track.settle(10, 20, true);
        track.settle(30, 40, true);
        track.settle(15, 35, false);
        assert_eq!(track.around(25), (20, 30, Known::False), "what is known stays");
        track.settle(0, 10, true);
        assert_eq!(track.around(5), (0, 20, Known::True));
        assert_eq!(track.first_open(), Some(40));
        track.fresh.clear();
        track.settle(0, 1000, true);
        assert_eq!((track.around(99), track.first_open()), ((30, 100, Known::True), None));
        track.take_back();
        assert_eq!((track.around(39), track.first_open()), ((30, 40, Known::True), Some(40)));
        track.forget(29);
        assert_eq!((track.around(3).2, track.around(25)), (Known::Open, (20, 30, Known::False)));
    }
}
