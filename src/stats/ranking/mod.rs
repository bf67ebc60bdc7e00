//! Which of k arms has the highest mean: paired betting races, and Okamoto's bound on each arm.
//!
//! Sampling goes in rounds: `next_round` says which trials of which arms are wanted, `feed` takes their
//! outcomes, and when a round is complete the next is a function of all outcomes so far. Any dependence
//! between the arms of one trial is allowed, so common random numbers only help.

use std::cmp::Ordering;

mod aim;
mod bet;
mod booleans;
mod certified;
mod constrained;
mod contest;
mod each;
mod front;
mod gap;
mod race;
mod rounds;
mod scores;

pub use aim::Goal;
pub use booleans::Booleans;
pub use constrained::{Bound, Constrained};
pub use contest::{Choice, Contest};
pub use each::{Each, size};
pub use front::Front;
pub use race::{Allocation, Race};
pub use rounds::Share;
pub use scores::Scores;

/// Procedures of a ranking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ranking {
    /// Paired betting.
    Betting(Allocation),
    /// Okamoto on each option (Algorithm 1 of Given-Wilson et al. 2017).
    Okamoto,
}

/// Outcomes of many trials for each arm, and the evidence in their differences: over the trials that both have, or over
/// all of the leader with the best outcome where the rival has none, whichever says more.
pub trait Table {
    /// The outcome of one trial.
    type Outcome: Copy;

    /// An empty table for `arms` arms and races to within `epsilon`.
    fn new(arms: usize, epsilon: f64) -> Self;

    /// Appends the next outcomes of an arm, in index order.
    fn push(&mut self, arm: usize, outcomes: &[Self::Outcome]);

    /// The outcome that a score in [0, 1] stands for; `None` is unresolved.
    fn outcome(score: Option<f64>) -> Self::Outcome;

    /// The outcomes that scores in a range stand for.
    fn outcomes(scores: &[Option<f64>], (low, high): (f64, f64)) -> Vec<Self::Outcome> {
        scores.iter().map(|score| Self::outcome(score.map(|x| (x - low) / (high - low)))).collect()
    }

    /// Trials of an arm.
    fn trials(&self, arm: usize) -> u64;

    /// The mean of an arm; unresolved trials count half.
    fn mean(&self, arm: usize) -> f64;

    /// The logarithms of the evidence that `rival` is worse than `leader`, and that it is less than epsilon
    /// better. Exact values are needed only near `threshold`: they may be any number on the same side.
    fn evidence(&mut self, rival: usize, leader: usize, threshold: f64) -> (f64, f64);

    /// Whether that evidence reaches the threshold: that `rival` is worse, and that it is less than epsilon better.
    fn passes(&mut self, rival: usize, leader: usize, threshold: f64) -> (bool, bool);

    /// Whether the evidence that `rival` is less than epsilon better than `leader` reaches the threshold: the second of
    /// what `passes` says, of any pair.
    fn is_close(&mut self, rival: usize, leader: usize, threshold: f64) -> bool;

    /// How much work that is: trials that have to be gone through.
    fn work(&self, rival: usize, leader: usize) -> u64;

    /// An order of arms by their outcomes, in which only those with the same outcomes are equal.
    fn order(&self, one: usize, other: usize) -> Ordering;

    /// Whether two arms came out alike in each trial that both have, and have some.
    fn is_alike(&self, one: usize, other: usize) -> bool;

    /// The logarithm of the evidence that a rival is less than `gap` better than `leader`, of the rival for which
    /// it is least; infinite without rivals.
    fn least_evidence(&mut self, rivals: &[usize], leader: usize, gap: f64) -> f64;
}
