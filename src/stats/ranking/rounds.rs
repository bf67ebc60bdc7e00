//! Rounds of a ranking: which trials of which arms are wanted, and which of them are still missing.

use crate::stats::invalid::{Invalid, range};

/// Trials `from .. to` of one arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// The arm.
    pub arm: usize,
    /// First trial index.
    pub from: u64,
    /// One past the last.
    pub to: u64,
}

/// What the trials of an arm completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Completed {
    Nothing,
    Share,
    Round,
}

/// The present round.
#[derive(Clone, Debug)]
pub(super) struct RankingRounds {
    /// Trials that an arm gets in a round.
    pub(super) word: u64,
    /// Trials that an arm gets in all.
    most: u64,
    pending: Vec<Share>,
}

impl RankingRounds {
    /// The first round of so many arms. An arm gets `word` trials in a round, and no more than `most` in all.
    pub(super) fn new(arms: usize, word: u64, most: u64) -> Self {
        let mut rounds = Self { word, most, pending: Vec::new() };
        rounds.open((0..arms).map(|arm| (arm, 0)));
        rounds
    }

    /// Opens a round of arms that have so many trials, ascending by arm.
    pub(super) fn open(&mut self, arms: impl Iterator<Item = (usize, u64)>) {
        let (word, most) = (self.word, self.most);
        let share = |(arm, from): (usize, u64)| Share { arm, from, to: most.min(from.saturating_add(word)) };
        self.pending = arms.map(share).filter(|share| share.from < share.to).collect();
    }

    /// All trials of this round that were not counted yet.
    pub(super) fn wanted(&self) -> &[Share] {
        &self.pending
    }

    /// Counts the next trials of an arm. Refuses more than are wanted.
    pub(super) fn count(&mut self, arm: usize, trials: usize) -> Result<Completed, Invalid> {
        let place = self.pending.iter().position(|share| share.arm == arm);
        let wanted = place.map_or(0, |at| self.pending[at].to - self.pending[at].from);
        range("outcomes", trials as f64, 0.0, wanted as f64)?;
        let Some(place) = place else { return Ok(Completed::Nothing) };
        self.pending[place].from += trials as u64;
        if self.pending[place].from < self.pending[place].to {
            return Ok(Completed::Nothing);
        }
        self.pending.remove(place);
        Ok(if self.pending.is_empty() { Completed::Round } else { Completed::Share })
    }
}
