//! Scores in [0, 1] by trial index; a pair keeps the capital of each bet.

use super::Table;
use super::bet::{BETS, ROUNDING, bets, bets_on, log_mean, log_mean_below, log_mean_near};
use crate::base::math;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Factors of a product before its logarithm is taken: each lies between 0.05 and two million, so sixteen stay far
/// from the ends of the doubles.
const CHUNK: u64 = 16;

/// Scores of one arm, as the least and the greatest they can be.
#[derive(Clone, Debug, Default)]
struct Arm {
    least: Vec<f64>,
    greatest: Vec<f64>,
    sum: f64,
}

/// Logarithms of the capital of each bet, on a gap of 0 and of epsilon, after whole chunks.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    trials: u64,
    logs: [[f64; BETS]; 2],
}

/// Real-valued scores; values outside of [0, 1] are clipped, and `None` (or NaN) is unresolved: 1 for the
/// rival and 0 for the leader.
#[derive(Clone, Debug)]
pub struct Scores {
    epsilon: f64,
    bets: [f64; BETS],
    arms: Vec<Arm>,
    pairs: BTreeMap<(usize, usize), Pair>,
}

impl Scores {
    /// Adds the logarithms of the factors of trials `from .. to` for a gap. Where the rival has no trial its score
    /// is 1.
    fn add(&self, logs: &mut [f64; BETS], rival: usize, leader: usize, gap: f64, (from, to): (u64, u64)) {
        let (b, a) = (&self.arms[rival].greatest, &self.arms[leader].least);
        let bets = bets_on(gap, self.epsilon, &self.bets);
        let mut start = from;
        while start < to {
            let lattice = (start / CHUNK + 1) * CHUNK;
            let end = if lattice < to { lattice } else { to };
            let mut products = [1.0; BETS];
            for t in start as usize..end as usize {
                let excess = gap - (b.get(t).copied().unwrap_or(1.0) - a[t]);
                for (product, bet) in products.iter_mut().zip(&bets) {
                    *product *= 1.0 + bet * excess;
                }
            }
            let rounding = ROUNDING * (end - start) as f64;
            for (log, product) in logs.iter_mut().zip(products) {
                *log += math::ln(product) - rounding;
            }
            start = end;
        }
    }

    /// The logarithms after all common trials, those after whole chunks given. Chunks lie on a fixed lattice of trial
    /// indices and only whole ones are kept, so that sums do not depend on the rounds, nor on who was compared when.
    fn ended(&self, mut logs: [f64; BETS], rival: usize, leader: usize, gap: f64) -> [f64; BETS] {
        let common = self.common(rival, leader);
        self.add(&mut logs, rival, leader, gap, (whole(common), common));
        logs
    }

    /// The same over all trials of the leader: where the rival has none, its score is taken to be 1. Whichever of the two
    /// says more.
    fn completed(&self, plain: [f64; BETS], rival: usize, leader: usize, gap: f64) -> [f64; BETS] {
        let (common, all) = (self.common(rival, leader), self.trials(leader));
        if common == all {
            return plain;
        }
        let mut logs = plain;
        self.add(&mut logs, rival, leader, gap, (common, all));
        if log_mean(&logs) > log_mean(&plain) { logs } else { plain }
    }

    fn common(&self, rival: usize, leader: usize) -> u64 {
        let (b, a) = (self.trials(rival), self.trials(leader));
        if a < b { a } else { b }
    }
}

/// The trials of whole chunks.
const fn whole(trials: u64) -> u64 {
    trials - trials % CHUNK
}

impl Table for Scores {
    type Outcome = Option<f64>;

    fn new(arms: usize, epsilon: f64) -> Self {
        Self { epsilon, bets: bets(), arms: vec![Arm::default(); arms], pairs: BTreeMap::new() }
    }

    fn push(&mut self, arm: usize, outcomes: &[Option<f64>]) {
        let arm = &mut self.arms[arm];
        for outcome in outcomes {
            let (least, greatest) = match outcome.filter(|x| !x.is_nan()) {
                Some(x) => {
                    let x = math::at_most(math::at_least(x, 0.0), 1.0);
                    (x, x)
                }
                None => (0.0, 1.0),
            };
            arm.least.push(least);
            arm.greatest.push(greatest);
            arm.sum += 0.5 * (least + greatest);
        }
    }

    fn outcome(score: Option<f64>) -> Option<f64> {
        score
    }

    fn trials(&self, arm: usize) -> u64 {
        self.arms[arm].least.len() as u64
    }

    fn mean(&self, arm: usize) -> f64 {
        let Arm { least, sum, .. } = &self.arms[arm];
        if least.is_empty() { 0.5 } else { sum / least.len() as f64 }
    }

    fn evidence(&mut self, rival: usize, leader: usize, threshold: f64) -> (f64, f64) {
        let mut pair = self.pairs.get(&(rival, leader)).copied().unwrap_or_default();
        let chunks = whole(self.common(rival, leader));
        self.add(&mut pair.logs[0], rival, leader, 0.0, (pair.trials, chunks));
        self.add(&mut pair.logs[1], rival, leader, self.epsilon, (pair.trials, chunks));
        pair.trials = chunks;
        self.pairs.insert((rival, leader), pair);
        let worse = self.ended(pair.logs[0], rival, leader, 0.0);
        let close = self.ended(pair.logs[1], rival, leader, self.epsilon);
        let close = self.completed(close, rival, leader, self.epsilon);
        (log_mean_near(&worse, threshold), log_mean_near(&close, threshold))
    }

    fn passes(&mut self, rival: usize, leader: usize, threshold: f64) -> (bool, bool) {
        let (worse, close) = self.evidence(rival, leader, threshold);
        (worse >= threshold, close >= threshold)
    }

    fn is_close(&mut self, rival: usize, leader: usize, threshold: f64) -> bool {
        // Of those who never led nothing is kept: this is asked once, at the end.
        let Pair { trials, logs: [_, mut logs] } =
            self.pairs.get(&(rival, leader)).copied().unwrap_or_default();
        self.add(&mut logs, rival, leader, self.epsilon, (trials, whole(self.common(rival, leader))));
        let close = self.ended(logs, rival, leader, self.epsilon);
        log_mean_near(&self.completed(close, rival, leader, self.epsilon), threshold) >= threshold
    }

    fn work(&self, rival: usize, leader: usize) -> u64 {
        let known = self.pairs.get(&(rival, leader)).map_or(0, |pair| pair.trials);
        1 + self.common(rival, leader).saturating_sub(known)
    }

    fn order(&self, one: usize, other: usize) -> Ordering {
        let bits = |arm: usize| {
            let Arm { least, greatest, .. } = &self.arms[arm];
            least.iter().zip(greatest).map(|(low, high)| (low.to_bits(), high.to_bits()))
        };
        bits(one).cmp(bits(other))
    }

    fn is_alike(&self, one: usize, other: usize) -> bool {
        let bits = |arm: usize| {
            let Arm { least, greatest, .. } = &self.arms[arm];
            least.iter().zip(greatest).map(|(low, high)| (low.to_bits(), high.to_bits()))
        };
        self.common(one, other) > 0 && bits(one).zip(bits(other)).all(|(one, other)| one == other)
    }

    fn least_evidence(&mut self, rivals: &[usize], leader: usize, gap: f64) -> f64 {
        rivals.iter().fold(f64::INFINITY, |least, rival| {
            let mut logs = [0.0; BETS];
            self.add(&mut logs, *rival, leader, gap, (0, self.common(*rival, leader)));
            log_mean_below(&self.completed(logs, *rival, leader, gap), least)
        })
    }
}
