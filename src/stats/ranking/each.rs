//! Okamoto's bound on each arm at half of epsilon: the baseline, with a joint guarantee.

use super::contest::{Choice, Contest};
use super::rounds::{Completed, RankingRounds, Share};
use super::{Booleans, Table as _};
use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::{Counts, Outcome, sequence};

/// The same fixed number of trials for every arm.
#[derive(Clone, Debug)]
pub struct Each {
    epsilon: f64,
    /// Error of each arm.
    delta: f64,
    size: u64,
    /// Successes and trials of each arm with unresolved ones as failures, and unresolved ones.
    arms: Vec<(Counts, u64)>,
    rounds: RankingRounds,
    deviations: Vec<f64>,
}

/// ceil(ln(2 k / delta) / (2 (epsilon / 2)^2)).
pub fn size(arms: usize, epsilon: f64, delta: f64) -> u64 {
    crate::stats::okamoto::size(0.5 * epsilon, delta / arms as f64)
}

impl Each {
    /// The chosen arm is within `epsilon` of the best, and every share of successes within epsilon / 2 of
    /// its probability, but for probability `delta` in all. Rounds give up to `word` trials to every arm.
    pub fn new(arms: usize, epsilon: f64, delta: f64, word: u64) -> Result<Self, Invalid> {
        range("options", arms as f64, 1.0, 4096.0)?;
        range("epsilon", epsilon, 1e-5, 1.0)?;
        range("trials a round", word as f64, 1.0, 1e9)?;
        probability("delta", delta)?;
        let size = size(arms, epsilon, delta);
        Ok(Self {
            epsilon,
            delta: delta / arms as f64,
            size,
            arms: vec![(Counts::default(), 0); arms],
            rounds: RankingRounds::new(arms, word, size),
            deviations: Vec::new(),
        })
    }

    /// Prefers arms by their deviations, one number per arm: the least decides among arms with the same shares, and among
    /// those that are surely within epsilon of the best.
    #[must_use]
    pub fn preferring(mut self, deviations: Vec<f64>) -> Self {
        self.deviations = deviations;
        self
    }

    /// Trials of each arm in all.
    pub const fn size(&self) -> u64 {
        self.size
    }

    /// Takes the next outcomes of an arm; refuses more than are wanted.
    pub fn feed(&mut self, arm: usize, outcomes: &[Outcome]) -> Result<(), Invalid> {
        let completed = self.rounds.count(arm, outcomes.len())?;
        for outcome in outcomes {
            self.arms[arm].0.add(*outcome == Outcome::True);
            self.arms[arm].1 += u64::from(*outcome == Outcome::Unresolved);
        }
        if completed == Completed::Round {
            let from = self.arms[0].0.trials();
            self.rounds.open((0..self.arms.len()).map(|arm| (arm, from)));
        }
        Ok(())
    }

    /// The lowest and highest share of successes that an arm can have.
    fn shares(&self, arm: usize) -> (f64, f64) {
        let (counts, unresolved) = self.arms[arm];
        if counts.trials() == 0 {
            return (0.0, 1.0);
        }
        let n = counts.trials() as f64;
        (counts.successes as f64 / n, (counts.successes + unresolved) as f64 / n)
    }

    /// Where the probability of an arm lies. At the end within epsilon / 2 of the shares; before, in the interval of the
    /// confidence sequence, which holds at all times.
    fn ends(&self, arm: usize) -> (f64, f64) {
        if self.finished() {
            let (low, high) = self.shares(arm);
            return (low - 0.5 * self.epsilon, high + 0.5 * self.epsilon);
        }
        let (Counts { successes, failures }, unresolved) = self.arms[arm];
        let resolved = Counts { successes, failures: failures - unresolved };
        let interval = sequence::interval_with(resolved, unresolved, self.delta);
        (interval.low, interval.high)
    }
}

impl Contest for Each {
    fn next_round(&self) -> &[Share] {
        self.rounds.wanted()
    }

    fn feed(&mut self, arm: usize, columns: &[Vec<Option<f64>>]) -> Result<(), Invalid> {
        let outcomes = Booleans::outcomes(columns.first().map_or(&[], Vec::as_slice), (0.0, 1.0));
        Self::feed(self, arm, &outcomes)
    }

    fn finished(&self) -> bool {
        self.rounds.wanted().is_empty()
    }

    fn is_planned(&self) -> bool {
        true
    }

    /// The choice, with a gap that holds at any time. Unresolved trials count against the chosen arm and for its rivals,
    /// and widen the gap.
    fn choice(&mut self) -> Choice {
        let k = self.arms.len();
        let middle = |arm: usize| {
            let (low, high) = self.shares(arm);
            low + high
        };
        let mut leader = 0;
        let of = |arm: usize| self.deviations.get(arm).copied().unwrap_or(f64::INFINITY);
        for arm in 1..k {
            // Of those with the same shares, but for a round of as many trials, the one that deviates least.
            let trials = |arm: usize| self.arms[arm].0.trials();
            let is_alike = trials(arm).abs_diff(trials(leader)) < self.rounds.word
                && self.shares(arm) == self.shares(leader);
            if middle(arm) > middle(leader) || is_alike && of(arm) < of(leader) {
                leader = arm;
            }
        }
        let ends: Vec<(f64, f64)> = (0..k).map(|arm| self.ends(arm)).collect();
        // At the end no more than epsilon is claimed, however far the others are behind.
        let least = if self.finished() { self.epsilon } else { 0.0 };
        let gap_of = |arm: usize| {
            let rivals = (0..k).filter(|rival| *rival != arm);
            let gap = rivals.map(|rival| ends[rival].1 - ends[arm].0).fold(least, math::at_least);
            math::at_most(gap, 1.0)
        };
        let certified: Vec<usize> = (0..k).filter(|arm| gap_of(*arm) <= self.epsilon + 1e-12).collect();
        let mut arm = leader;
        for other in &certified {
            if of(*other) < of(arm) {
                arm = *other;
            }
        }
        let (open, beaten) =
            (0..k).filter(|other| *other != arm).partition(|other| ends[*other].1 > ends[leader].0);
        Choice { arm, gap: gap_of(arm), open, beaten, certified, excluded: Vec::new() }
    }
}
