//! Boolean outcomes as bitsets by trial index; a pair is compared by counting bits.

use super::Table;
use super::bet::{BETS, Factors, bets, bets_on, log_mean, log_mean_below, log_mean_near, reaches};
use crate::stats::Outcome;
use std::cmp::Ordering;

/// Outcomes of one arm.
#[derive(Clone, Debug, Default)]
struct Arm {
    trials: u64,
    /// Bits of trials that held.
    sure: Vec<u64>,
    /// Bits of trials that held or are unresolved.
    possible: Vec<u64>,
    /// How many bits each has.
    count: (u64, u64),
}

/// What is known of a pair over the first `trials` trials.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    trials: u64,
    wins: u64,
    losses: u64,
}

/// Boolean outcomes; unresolved ones count for the rival and against the leader.
#[derive(Clone, Debug)]
pub struct Booleans {
    arms: Vec<Arm>,
    pairs: Vec<Pair>,
    epsilon: f64,
    bets: [f64; BETS],
    /// Bets on a gap of 0 and of epsilon.
    factors: [Factors; 2],
}

impl Booleans {
    /// Successes, failures and unresolved trials of an arm.
    pub fn counts(&self, arm: usize) -> (u64, u64, u64) {
        let Arm { trials, count: (sure, possible), .. } = &self.arms[arm];
        (*sure, trials - possible, possible - sure)
    }

    /// Brings the counts of a pair up to the common prefix.
    fn pair(&mut self, rival: usize, leader: usize) -> Pair {
        let (b, a) = (&self.arms[rival], &self.arms[leader]);
        let pair = &mut self.pairs[rival * self.arms.len() + leader];
        let common = if a.trials < b.trials { a.trials } else { b.trials };
        while pair.trials < common {
            // From here to the end of the word or of the common prefix.
            let word = (pair.trials / 64) as usize;
            let bit = pair.trials % 64;
            let end = if common < (word as u64 + 1) * 64 { common } else { (word as u64 + 1) * 64 };
            let width = end - pair.trials;
            let mask = (u64::MAX >> (64 - width)) << bit;
            pair.wins += u64::from((b.possible[word] & !a.sure[word] & mask).count_ones());
            pair.losses += u64::from((a.sure[word] & !b.possible[word] & mask).count_ones());
            pair.trials = end;
        }
        *pair
    }

    /// A pair over all trials of the leader: where the rival has none, it is taken to hold. `None` if it has as many.
    fn completed(&self, pair: Pair, leader: usize) -> Option<Pair> {
        let a = &self.arms[leader];
        let whole = (pair.trials / 64) as usize;
        let rest = (1u64 << (pair.trials % 64)) - 1;
        let ones = |words: &[u64]| words.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
        let later = a.trials - pair.trials;
        (later > 0).then(|| {
            let earlier = ones(&a.sure[..whole]) + ones(&[a.sure[whole] & rest]);
            Pair { trials: a.trials, wins: pair.wins + later - (a.count.0 - earlier), losses: pair.losses }
        })
    }

    /// The logarithms of the evidence of a pair, of the way to count it that says more.
    fn logs(&self, pair: Pair, leader: usize, factors: &Factors) -> [f64; BETS] {
        let plain = logs(pair, factors);
        match self.completed(pair, leader).map(|pair| logs(pair, factors)) {
            Some(other) if log_mean(&other) > log_mean(&plain) => other,
            _ => plain,
        }
    }
}

fn logs(pair: Pair, factors: &Factors) -> [f64; BETS] {
    factors.logs(pair.wins, pair.trials - pair.wins - pair.losses, pair.losses)
}

impl Table for Booleans {
    type Outcome = Outcome;

    fn new(arms: usize, epsilon: f64) -> Self {
        let bets = bets();
        Self {
            epsilon,
            bets,
            arms: vec![Arm::default(); arms],
            pairs: vec![Pair::default(); arms * arms],
            factors: [Factors::new(&bets, 0.0), Factors::new(&bets, epsilon)],
        }
    }

    fn push(&mut self, arm: usize, outcomes: &[Outcome]) {
        let arm = &mut self.arms[arm];
        let mut rest = outcomes;
        while !rest.is_empty() {
            let bit = (arm.trials % 64) as usize;
            if bit == 0 {
                arm.sure.push(0);
                arm.possible.push(0);
            }
            // Up to the end of the word.
            let room = 64 - bit;
            let (now, later) = rest.split_at(if rest.len() < room { rest.len() } else { room });
            let (mut sure, mut possible) = (0u64, 0u64);
            let mut at = 0;
            let (bytes, few) = now.as_chunks::<8>();
            for byte in bytes {
                let (mut held, mut open) = (0u8, 0u8);
                for k in 0..8 {
                    held |= u8::from(byte[k] == Outcome::True) << k;
                    open |= u8::from(byte[k] != Outcome::False) << k;
                }
                sure |= u64::from(held) << at;
                possible |= u64::from(open) << at;
                at += 8;
            }
            for outcome in few {
                sure |= u64::from(*outcome == Outcome::True) << at;
                possible |= u64::from(*outcome != Outcome::False) << at;
                at += 1;
            }
            let word = (arm.trials / 64) as usize;
            arm.sure[word] |= sure << bit;
            arm.possible[word] |= possible << bit;
            arm.count.0 += u64::from(sure.count_ones());
            arm.count.1 += u64::from(possible.count_ones());
            arm.trials += now.len() as u64;
            rest = later;
        }
    }

    fn outcome(score: Option<f64>) -> Outcome {
        score.map_or(Outcome::Unresolved, |x| Outcome::from(x > 0.5))
    }

    fn trials(&self, arm: usize) -> u64 {
        self.arms[arm].trials
    }

    fn mean(&self, arm: usize) -> f64 {
        let Arm { trials, count: (sure, possible), .. } = &self.arms[arm];
        if *trials == 0 { 0.5 } else { (sure + possible) as f64 / (2 * trials) as f64 }
    }

    fn evidence(&mut self, rival: usize, leader: usize, threshold: f64) -> (f64, f64) {
        let pair = self.pair(rival, leader);
        let [worse, close] = &self.factors;
        let close = log_mean_near(&self.logs(pair, leader, close), threshold);
        if close < threshold {
            // The evidence against being better at all is smaller still.
            return (close, close);
        }
        (log_mean_near(&logs(pair, worse), threshold), close)
    }

    fn passes(&mut self, rival: usize, leader: usize, threshold: f64) -> (bool, bool) {
        let pair = self.pair(rival, leader);
        let [worse, close] = &self.factors;
        // The evidence against being better at all is the smaller.
        let both = reaches(&logs(pair, close), threshold);
        let completed =
            || self.completed(pair, leader).is_some_and(|pair| reaches(&logs(pair, close), threshold));
        let close = both || completed();
        (both && reaches(&logs(pair, worse), threshold), close)
    }

    fn is_close(&mut self, rival: usize, leader: usize, threshold: f64) -> bool {
        self.passes(rival, leader, threshold).1
    }

    fn work(&self, rival: usize, leader: usize) -> u64 {
        // Words of 64 trials, each about as dear as one trial of two scores.
        let trials = |arm: usize| self.arms[arm].trials;
        let common = if trials(rival) < trials(leader) { trials(rival) } else { trials(leader) };
        8 + common.saturating_sub(self.pairs[rival * self.arms.len() + leader].trials) / 64
    }

    fn order(&self, one: usize, other: usize) -> Ordering {
        let (one, other) = (&self.arms[one], &self.arms[other]);
        (one.trials, &one.sure, &one.possible).cmp(&(other.trials, &other.sure, &other.possible))
    }

    fn is_alike(&self, one: usize, other: usize) -> bool {
        let (one, other) = (&self.arms[one], &self.arms[other]);
        let common = if one.trials < other.trials { one.trials } else { other.trials };
        let whole = (common / 64) as usize;
        // The trials of the last word that both have.
        let rest = (1u64 << (common % 64)) - 1;
        let alike = |one: &[u64], other: &[u64]| {
            let last = |words: &[u64]| words.get(whole).copied().unwrap_or(0) & rest;
            one[..whole] == other[..whole] && last(one) == last(other)
        };
        common > 0 && alike(&one.sure, &other.sure) && alike(&one.possible, &other.possible)
    }

    fn least_evidence(&mut self, rivals: &[usize], leader: usize, gap: f64) -> f64 {
        let factors = Factors::new(&bets_on(gap, self.epsilon, &self.bets), gap);
        rivals.iter().fold(f64::INFINITY, |least, rival| {
            let pair = self.pair(*rival, leader);
            log_mean_below(&self.logs(pair, leader, &factors), least)
        })
    }
}
