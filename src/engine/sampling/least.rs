//! Which option is best by its least score under several models: each option has a column for each of them. Also which is best
//! by a number that is no mean of differences, such as that of the largest share; that has one column.
//!
//! A confidence sequence for each column, all of them jointly valid at all times, gives an interval for the least score of
//! each option: from the least lower end to the least upper end. An option is chosen once no other one can be more than
//! epsilon better: the largest upper end of the others is at most epsilon above its lower end. Whatever is sampled and
//! whenever that is looked at, the error is at most delta, because it is that of the intervals.
//!
//! ```text
//!            model 1      model 2       least
//! option a   [.6, .9]     [.5, .7]      [.5, .7]   chosen with epsilon 0.1: nobody is above .6
//! option b   [.2, .6]     [.7, .9]      [.2, .6]
//! ```

use crate::base::math::{at_least, at_most};
use crate::engine::sampling::rank::WORD;
use crate::stats::ranking::{Choice, Contest, Goal, Share};
use crate::stats::{Interval, Invalid, Running};

/// Its name in reports.
pub(in crate::engine) const NAME: &str = "least_score";

/// A round of a column has no fewer than one in so many of the trials that it has.
const GROWTH: u64 = 8;

/// A race by least scores.
pub(super) struct Least {
    models: usize,
    epsilon: f64,
    scale: f64,
    columns: Vec<Running>,
    /// The estimate and the interval of each column, as they are after a round.
    known: Vec<(f64, Interval)>,
    deviations: Vec<f64>,
    /// What is wanted next, and how many of that are still missing.
    wanted: Vec<Share>,
    missing: usize,
}

/// The interval of the least score of an option, and its estimate.
#[derive(Clone, Copy)]
struct Score {
    estimate: f64,
    low: f64,
    high: f64,
}

impl Least {
    /// Of so many columns, with `models` to an option.
    pub(super) fn new(
        (columns, models): (usize, usize),
        (epsilon, delta): (f64, f64),
        goal: Goal,
        deviations: Vec<f64>,
    ) -> Result<Self, Invalid> {
        let (low, high) = goal.range();
        let column = goal.running(delta / columns as f64)?;
        let mut this = Self {
            models,
            epsilon,
            scale: high - low,
            known: vec![(column.estimate(), column.interval()); columns],
            columns: vec![column; columns],
            deviations: deviations.into_iter().step_by(models).collect(),
            wanted: Vec::new(),
            missing: 0,
        };
        this.plan();
        Ok(this)
    }

    fn score(&self, option: usize) -> Score {
        let worst = Score { estimate: f64::INFINITY, low: f64::INFINITY, high: f64::INFINITY };
        (option * self.models..(option + 1) * self.models).fold(worst, |score, column| {
            let (estimate, interval) = self.known[column];
            Score {
                estimate: at_most(score.estimate, estimate),
                low: at_most(score.low, interval.low),
                high: at_most(score.high, interval.high),
            }
        })
    }

    /// By how much another option may be better than one.
    fn gap(scores: &[Score], option: usize) -> f64 {
        let others = scores.iter().enumerate().filter(|(other, _)| *other != option);
        let best = others.map(|(_, score)| score.high).fold(f64::NEG_INFINITY, at_least);
        at_least(best - scores[option].low, 0.0)
    }

    /// What is known, and the option that would be chosen.
    fn standing(&self) -> (Vec<Score>, usize) {
        let scores: Vec<Score> = (0..self.deviations.len()).map(|option| self.score(option)).collect();
        let is_sure = |option: &usize| Self::gap(&scores, *option) <= self.epsilon;
        // Of several that carry the certificate the one with the least deviation, else who did best.
        let order = |a: &usize, b: &usize| {
            let (one, other) = (&scores[*a], &scores[*b]);
            let by_score = other.estimate.total_cmp(&one.estimate);
            let by_deviation = self.deviations[*a].total_cmp(&self.deviations[*b]);
            match (is_sure(a), is_sure(b)) {
                (true, true) => by_deviation.then(by_score),
                (a, b) => b.cmp(&a).then(by_score).then(by_deviation),
            }
        };
        let leader = (0..scores.len()).min_by(order).unwrap_or(0);
        (scores, leader)
    }

    /// Plans the next round: of the leader and of the one that may be better by most, whoever adds more to the gap by not being
    /// known, or both if neither adds twice as much; and of those all columns that may be the least.
    fn plan(&mut self) {
        let (scores, leader) = self.standing();
        self.wanted.clear();
        if self.columns.iter().any(|column| column.trials() == 0) {
            let all = (0..self.columns.len()).map(|arm| Share { arm, from: 0, to: WORD });
            self.wanted.extend(all);
        } else if Self::gap(&scores, leader) > self.epsilon {
            let others = (0..scores.len()).filter(|option| *option != leader);
            let Some(rival) = others.max_by(|a, b| scores[*a].high.total_cmp(&scores[*b].high)) else {
                return;
            };
            let below = scores[leader].estimate - scores[leader].low;
            let above = scores[rival].high - scores[rival].estimate;
            let asked = [(leader, below, above), (rival, above, below)];
            for (option, ..) in asked.into_iter().filter(|(_, own, other)| 2.0 * own >= *other) {
                for column in option * self.models..(option + 1) * self.models {
                    if self.known[column].1.low < scores[option].high {
                        let from = self.columns[column].trials();
                        let to = from + WORD.max(from / GROWTH / WORD * WORD);
                        self.wanted.push(Share { arm: column, from, to });
                    }
                }
            }
        }
        self.missing = self.wanted.len();
    }
}

impl Contest for Least {
    fn next_round(&self) -> &[Share] {
        &self.wanted
    }

    fn feed(&mut self, column: usize, columns: &[Vec<Option<f64>>]) -> Result<(), Invalid> {
        let running = &mut self.columns[column];
        running.observe_all(columns.first().map_or(&[], Vec::as_slice));
        self.known[column] = (running.estimate(), running.interval());
        self.missing = self.missing.saturating_sub(1);
        if self.missing == 0 {
            self.plan();
        }
        Ok(())
    }

    fn finished(&self) -> bool {
        self.wanted.is_empty()
    }

    fn choice(&mut self) -> Choice {
        let (scores, leader) = self.standing();
        let best = scores.iter().map(|score| score.low).fold(f64::NEG_INFINITY, at_least);
        let others = || (0..scores.len()).filter(|option| *option != leader);
        let is_beaten = |option: &usize| scores[*option].high < best;
        Choice {
            arm: leader,
            gap: at_most(Self::gap(&scores, leader) / self.scale, 1.0),
            open: others().filter(|option| !is_beaten(option)).collect(),
            beaten: others().filter(is_beaten).collect(),
            certified: (0..scores.len())
                .filter(|option| Self::gap(&scores, *option) <= self.epsilon)
                .collect(),
            excluded: Vec::new(),
        }
    }
}
