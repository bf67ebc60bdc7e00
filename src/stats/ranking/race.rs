//! The paired betting race (PB-LUCB): LUCB (Kalyanakrishnan et al. 2012) with a betting test on the
//! differences of paired trials instead of confidence bounds on each arm.
//!
//! Let K(b, a; e) be the mixture of bets against "b is at least e better than a". For each rival a of the
//! true best arm a*, dropping a* and stopping on an a more than epsilon worse both need
//! K(a*, a; epsilon) >= (k - 1)/delta at some time, because K rises in e; by Ville's inequality that has
//! probability at most delta/(k - 1), and there are k - 1 rivals. Chains of eliminations are harmless, and
//! so is adaptive sampling: every trial exists before it is looked at, and the bound holds for all prefixes.
//!
//! At a deadline K(b, a; e) is asked for gaps e above epsilon, with larger bets where e is wide: its factors still rise with
//! e (`bet::bets_on`). So a gap that is too small needs, like a false stop, that K of the true gap reaches the threshold at
//! some time, and all of these together have the same bound.
//!
//! For the same reason a rival need not be tried as often as the leader. Were its missing trials the best there are, K would
//! only be smaller; so what K reaches with them, it reaches in truth, at no further risk. A leader that hardly ever fails
//! is certified by its own trials.

use super::contest::{Choice, Contest};
use super::rounds::{Completed, RankingRounds, Share};
use super::{Table, bet, certified, gap};
use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range};
use std::cmp::Ordering;

/// Which of the rivals that are not yet decided get more trials in a round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Allocation {
    /// All of them: the tightest certificate.
    #[default]
    AllFailing,
    /// The least decided one: the best choice under a starving budget. To be chosen before sampling.
    OneChallenger,
}

/// A race between arms over a table of outcomes.
#[derive(Clone, Debug)]
pub struct Race<T> {
    table: T,
    epsilon: f64,
    /// ln((k - 1) / delta).
    threshold: f64,
    allocation: Allocation,
    live: Vec<usize>,
    leader: usize,
    rounds: RankingRounds,
    arms: usize,
    /// Arms that do not pass yet, with the evidence: room to work.
    failing: Vec<(usize, f64)>,
    /// How far each arm is from what is wished: among equals the least comes first. Empty if there is no wish.
    deviations: Vec<f64>,
    /// The range of scores.
    range: (f64, f64),
    /// Whether a round is complete.
    decided: bool,
    finished: bool,
}

impl<T: Table> Race<T> {
    /// The chosen arm is within `epsilon` of the best but for probability `delta`. A round gives `word`
    /// trials to an arm (64, or 32 where trials are slow).
    pub fn new(
        arms: usize,
        epsilon: f64,
        delta: f64,
        word: u64,
        allocation: Allocation,
    ) -> Result<Self, Invalid> {
        range("options", arms as f64, 1.0, 4096.0)?;
        range("epsilon", epsilon, 1e-5, 1.0)?;
        range("trials a round", word as f64, 1.0, 1e6)?;
        probability("delta", delta)?;
        let rivals = math::at_least(arms as f64 - 1.0, 1.0);
        let alone = arms == 1;
        Ok(Self {
            table: T::new(arms, epsilon),
            epsilon,
            threshold: math::ln(rivals / delta) + 1e-9,
            allocation,
            live: (0..arms).collect(),
            leader: 0,
            rounds: RankingRounds::new(if alone { 0 } else { arms }, word, u64::MAX),
            arms,
            failing: Vec::new(),
            deviations: Vec::new(),
            range: (0.0, 1.0),
            decided: false,
            finished: alone,
        })
    }

    /// Prefers arms by their deviations, one number per arm: of those with the highest mean the least leads. It also
    /// decides among arms that each carry the full certificate, and before there are any among those that came out
    /// as the leader, trial by trial.
    #[must_use]
    pub fn preferring(mut self, deviations: Vec<f64>) -> Self {
        self.deviations = deviations;
        self
    }

    /// Takes scores in a range, of which `epsilon` is a share.
    #[must_use]
    pub const fn over(mut self, range: (f64, f64)) -> Self {
        self.range = range;
        self
    }

    /// Takes the next outcomes of an arm, in index order; when the round is complete, decides. Refuses more
    /// outcomes than are wanted.
    pub fn feed(&mut self, arm: usize, outcomes: &[T::Outcome]) -> Result<(), Invalid> {
        let completed = self.rounds.count(arm, outcomes.len())?;
        self.table.push(arm, outcomes);
        if completed == Completed::Round {
            self.decide();
        }
        Ok(())
    }

    fn deviation(&self, arm: usize) -> f64 {
        self.deviations.get(arm).copied().unwrap_or(f64::INFINITY)
    }

    /// The live arm with the highest mean; of equals the one that deviates least, or else the first. Two more trials, of
    /// which one holds, keep those who were tried little from leading by luck. Who has had no trial is behind all who
    /// have.
    fn ahead(&self) -> usize {
        let mean = |arm: usize| {
            let trials = self.table.trials(arm) as f64;
            (self.table.mean(arm) * trials + 1.0) / (trials + 2.0)
        };
        let key = |arm: usize| (self.table.trials(arm) > 0, mean(arm));
        let mut best = self.live[0];
        for &arm in &self.live[1..] {
            let (one, other) = (key(arm), key(best));
            if one > other || one == other && self.deviation(arm) < self.deviation(best) {
                best = arm;
            }
        }
        best
    }

    /// Whether the leader is likely to be certified sooner by trials of its own than by trials of all who are failing:
    /// evidence grows on as it has so far.
    fn leads_alone(&mut self) -> bool {
        let growth = bet::growth(self.table.mean(self.leader), self.epsilon);
        let mut alone = self.threshold / growth - self.table.trials(self.leader) as f64;
        if growth <= 0.0 {
            return false;
        }
        for (rival, _) in &self.failing {
            let trials =
                math::at_most(self.table.trials(*rival) as f64, self.table.trials(self.leader) as f64);
            let (_, evidence) = self.table.evidence(*rival, self.leader, self.threshold);
            if evidence <= 0.0 {
                return true;
            }
            alone -= math::at_least(self.threshold / evidence - 1.0, 0.0) * trials;
        }
        alone <= 0.0
    }

    fn decide(&mut self) {
        self.decided = true;
        let leader = self.ahead();
        self.leader = leader;
        let one = self.allocation == Allocation::OneChallenger;
        let (table, threshold, failing) = (&mut self.table, self.threshold, &mut self.failing);
        failing.clear();
        self.live.retain(|arm| {
            if *arm == leader {
                return true;
            }
            // Who is the only challenger depends on the evidence, not only on which side it lies.
            let (worse, close, evidence) = if one {
                let (worse, close) = table.evidence(*arm, leader, threshold);
                (worse >= threshold, close >= threshold, close)
            } else {
                let (worse, close) = table.passes(*arm, leader, threshold);
                (worse, close, 0.0)
            };
            if !worse && !close {
                failing.push((*arm, evidence));
            }
            !worse
        });
        if failing.is_empty() {
            self.finished = true;
            return;
        }
        if one {
            let mut least = failing[0];
            for rival in &failing[1..] {
                if rival.1 < least.1 {
                    least = *rival;
                }
            }
            *failing = vec![least];
        }
        let most = failing.iter().fold(0, |most, (arm, _)| table.trials(*arm).max(most));
        let is_behind = table.trials(leader) <= most;
        if !one && self.leads_alone() {
            self.failing.clear();
        }
        if is_behind || self.failing.is_empty() {
            self.failing.push((leader, 0.0));
        }
        self.failing.sort_unstable_by_key(|(arm, _)| *arm);
        let table = &self.table;
        self.rounds.open(self.failing.iter().map(|(arm, _)| (*arm, table.trials(*arm))));
    }

    /// The outcomes so far.
    pub const fn table(&self) -> &T {
        &self.table
    }

    /// Trials so far, over all arms.
    pub fn trials(&self) -> u64 {
        (0..self.arms).map(|arm| self.table.trials(arm)).sum()
    }

    /// The smallest gap, to a millionth of the largest, such that `arm` is within it of the best but for
    /// probability delta: at any time and for a live arm. 1 if nothing is certified.
    pub fn gap(&mut self, arm: usize) -> f64 {
        self.gap_below(arm, 1.0)
    }

    /// The smallest gap, at most `most`, which is taken for granted.
    fn gap_below(&mut self, arm: usize, most: f64) -> f64 {
        let mut rivals: Vec<usize> = self.live.iter().copied().filter(|rival| *rival != arm).collect();
        // One of those with the same outcomes stands for all of them.
        rivals.sort_by(|a, b| self.table.order(*a, *b).then(a.cmp(b)));
        rivals.dedup_by(|a, b| self.table.order(*a, *b) == Ordering::Equal);
        if rivals.is_empty() {
            return 0.0;
        }
        let (table, threshold) = (&mut self.table, self.threshold);
        gap::smallest(most, |gap| table.least_evidence(&rivals, arm, gap) - threshold)
    }
}

impl<T: Table> Contest for Race<T> {
    fn next_round(&self) -> &[Share] {
        self.rounds.wanted()
    }

    fn feed(&mut self, arm: usize, columns: &[Vec<Option<f64>>]) -> Result<(), Invalid> {
        let outcomes = T::outcomes(columns.first().map_or(&[], Vec::as_slice), self.range);
        Self::feed(self, arm, &outcomes)
    }

    fn finished(&self) -> bool {
        self.finished
    }

    fn choice(&mut self) -> Choice {
        if !self.decided {
            // No round is complete: the trials there are have to do.
            self.leader = self.ahead();
        }
        let live = self.live.clone();
        let deviations = &self.deviations;
        let of = |arm: usize| deviations.get(arm).copied().unwrap_or(f64::INFINITY);
        let certified = if self.finished {
            certified::among(&mut self.table, &live, self.leader, self.threshold, &of)
        } else {
            Vec::new()
        };
        let mut arm = self.leader;
        // A decided race keeps its promise: only who carries the certificate takes the leader's place. Before that those
        // that came out as the leader are as good as it, if they were tried as often, but for a round.
        let (table, leader, word) = (&self.table, self.leader, self.rounds.word);
        let alike = |other: &&usize| {
            table.trials(**other).abs_diff(table.trials(leader)) < word && table.is_alike(**other, leader)
        };
        let others = if self.finished { &[][..] } else { &live };
        for other in certified.iter().chain(others.iter().filter(alike)) {
            if of(*other) < of(arm) {
                arm = *other;
            }
        }
        // The certificate is at least what the stopping rule has checked.
        let most = if certified.contains(&arm) { math::at_most(self.epsilon, 1.0) } else { 1.0 };
        let gap = self.gap_below(arm, most);
        let open = live.into_iter().filter(|other| *other != arm).collect();
        // Where all arms are the best, each of k (k - 1) pairs can make a false label; one that is dropped is not shown to
        // be worse by that alone.
        let jointly = self.threshold + math::ln(self.arms as f64);
        let (table, leader) = (&mut self.table, self.leader);
        let is_beaten = |other: &usize| *other != arm && table.passes(*other, leader, jointly).0;
        let beaten = (0..self.arms).filter(is_beaten).collect();
        Choice { arm, gap, open, beaten, certified, excluded: Vec::new() }
    }
}
