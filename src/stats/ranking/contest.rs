//! What all procedures of a ranking have in common: rounds of trials that they want, and a choice.

use super::rounds::Share;
use crate::stats::interval::Interval;
use crate::stats::invalid::Invalid;

/// The outcome of a ranking, at its end or at a deadline.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The chosen arm.
    pub arm: usize,
    /// The mean of the chosen arm is within this of the best mean, with error at most delta; 1 if nothing
    /// is certified, and possible before the end only for races.
    pub gap: f64,
    /// Other arms that are still in the race: they were not dropped for being worse than a leader.
    pub open: Vec<usize>,
    /// Arms that are worse than another, jointly with error at most delta: however many arms are the best, none of them
    /// is here.
    pub beaten: Vec<usize>,
    /// Arms, the chosen one included, that each carry the full certificate: within epsilon of the best. Of very many
    /// near the best not all are looked at.
    pub certified: Vec<usize>,
    /// Arms that violate a constraint, jointly with error at most delta.
    pub excluded: Vec<usize>,
}

/// A ranking on its way: rounds of trials that it wants, and what it makes of them.
pub trait Contest {
    /// The trials that are wanted now: all of this round that were not fed yet, ascending by arm. Empty once
    /// finished.
    fn next_round(&self) -> &[Share];

    /// Takes the next trials of an arm, in index order: a column of numbers, `None` where they are unresolved, for its score
    /// and for each thing that is asked besides. When the round is complete, decides. Refuses more trials than are wanted.
    fn feed(&mut self, arm: usize, columns: &[Vec<Option<f64>>]) -> Result<(), Invalid>;

    /// Whether the choice is certified, or that there is none.
    fn finished(&self) -> bool;

    /// Whether the number of trials is fixed beforehand.
    fn is_planned(&self) -> bool {
        false
    }

    /// The choice now, at the end or at a deadline.
    fn choice(&mut self) -> Choice;

    /// The estimate and the interval of an arm in a column behind the first, and whether it satisfies the constraint, where
    /// it is one.
    fn side(&self, _column: usize, _arm: usize) -> Option<(f64, Interval, Option<bool>)> {
        None
    }
}
