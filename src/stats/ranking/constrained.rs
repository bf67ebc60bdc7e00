//! The best of those arms that satisfy constraints, such as P(b) >= 0.9.
//!
//! Half of the error goes to the constraints: each of them has a confidence sequence for each arm, and all of them hold
//! jointly, so that no arm is taken for one that satisfies or violates a constraint although it does not. The other half goes
//! to the score, which is compared as in a race ([`super::Race`]): if a* is the best of those that satisfy the constraints,
//! then choosing an arm that is more than epsilon worse needs that the bets on the difference of the two reach
//! (k - 1) / (delta / 2), and there are k - 1 such arms.
//!
//! ```text
//!            score        constraint: at least .9
//! arm a      .80          [.95, .99]   satisfied: chosen, as c is less than epsilon better
//! arm b      .95          [.70, .85]   violated: excluded, however good
//! arm c      .79          [.85, .95]   nobody knows yet, and it does not matter
//! ```

use super::aim::{Aim, Goal};
use super::contest::{Choice, Contest};
use super::rounds::{Completed, RankingRounds, Share};
use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::{Interval, Running};

/// What each arm has to satisfy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// What is bounded.
    pub goal: Goal,
    /// Whether it has to be at least the threshold, rather than at most.
    pub at_least: bool,
    /// The threshold.
    pub threshold: f64,
}

/// Arms with a score and constraints.
#[derive(Clone, Debug)]
pub struct Constrained {
    aim: Aim,
    bounds: Vec<Bound>,
    /// The numbers of each constraint, arm by arm.
    sides: Vec<Vec<Running>>,
    /// Whether an arm satisfies all constraints, or violates one; `None` where that is not known.
    feasible: Vec<Option<bool>>,
    /// Arms that are worse than one that satisfies the constraints.
    dropped: Vec<bool>,
    threshold: f64,
    epsilon: f64,
    deviations: Vec<f64>,
    scale: f64,
    leader: usize,
    rounds: RankingRounds,
    finished: bool,
}

impl Constrained {
    /// The score of each arm, to within `epsilon` in its unit, and the constraints; all but for probability `delta`. Each
    /// constraint belongs to a column of scores that is fed beside the first.
    pub fn new(
        goal: Goal,
        bounds: Vec<Bound>,
        (epsilon, delta): (f64, f64),
        word: u64,
        deviations: Vec<f64>,
    ) -> Result<Self, Invalid> {
        let arms = deviations.len();
        range("options", arms as f64, 1.0, 4096.0)?;
        probability("delta", delta)?;
        let half = 0.5 * delta;
        let each = half / (arms * bounds.len()) as f64;
        let side = |bound: &Bound| {
            // An interval of a number has half of its error on either side, and only one side can mislead.
            let error = if bound.goal == Goal::Probability { each } else { 2.0 * each };
            Ok(vec![bound.goal.running(error)?; arms])
        };
        let sides = bounds.iter().map(side).collect::<Result<_, Invalid>>()?;
        let (low, high) = goal.range();
        let rivals = math::at_least(arms as f64 - 1.0, 1.0);
        Ok(Self {
            aim: Aim::new(goal, arms, epsilon, half)?,
            bounds,
            sides,
            feasible: vec![None; arms],
            dropped: vec![false; arms],
            threshold: math::ln(rivals / half) + 1e-9,
            epsilon,
            scale: high - low,
            leader: 0,
            rounds: RankingRounds::new(arms, word, u64::MAX),
            finished: false,
            deviations,
        })
    }

    /// What is known of the constraints of an arm; what was once known stays known.
    fn learn(&mut self, arm: usize) {
        if self.feasible[arm].is_some() {
            return;
        }
        let holds: Vec<_> =
            self.bounds.iter().zip(&self.sides).map(|(bound, side)| bound.holds(&side[arm])).collect();
        if holds.contains(&Some(false)) {
            self.feasible[arm] = Some(false);
        } else if holds.iter().all(|one| *one == Some(true)) {
            self.feasible[arm] = Some(true);
        }
    }

    fn is_live(&self, arm: usize) -> bool {
        self.feasible[arm] != Some(false) && !self.dropped[arm]
    }

    /// The arm that would be chosen: of those that seem to satisfy the constraints the one with the best score.
    fn ahead(&self) -> Option<usize> {
        let seems = |arm: usize| {
            self.feasible[arm] == Some(true)
                || self.bounds.iter().zip(&self.sides).all(|(bound, side)| bound.is_met(side[arm].estimate()))
        };
        let key = |arm: usize| (self.aim.trials(arm) > 0, seems(arm), self.feasible[arm] == Some(true));
        (0..self.feasible.len()).filter(|arm| self.is_live(*arm)).max_by(|&a, &b| {
            let (one, other) = (key(a), key(b));
            // Half of what does not matter keeps an arm ahead that certainly satisfies the constraints: another one may never.
            let sure = |arm: usize| if self.feasible[arm] == Some(true) { 0.5 * self.epsilon } else { 0.0 };
            let score = |arm: usize| self.aim.estimate(arm) + sure(arm);
            let by_score = score(a).total_cmp(&score(b));
            let by_deviation = self.deviations[b].total_cmp(&self.deviations[a]);
            (one.0, one.1)
                .cmp(&(other.0, other.1))
                .then(by_score)
                .then(one.2.cmp(&other.2))
                .then(by_deviation)
                .then(b.cmp(&a))
        })
    }

    fn decide(&mut self) {
        let Some(leader) = self.ahead() else {
            self.finished = true;
            return;
        };
        self.leader = leader;
        let sure = self.feasible[leader] == Some(true);
        let mut open: Vec<usize> = Vec::new();
        for arm in (0..self.feasible.len()).filter(|arm| *arm != leader) {
            if !self.is_live(arm) {
                continue;
            }
            let (worse, close) = self.aim.passes(arm, leader, self.threshold);
            if worse && sure {
                self.dropped[arm] = true;
            } else if !close {
                open.push(arm);
            }
        }
        self.finished = sure && open.is_empty();
        if self.finished {
            return;
        }
        open.push(leader);
        open.sort_unstable();
        let aim = &self.aim;
        self.rounds.open(open.into_iter().map(|arm| (arm, aim.trials(arm))));
    }

    /// The arms that certainly satisfy the constraints, and than which no other one that may can be epsilon better.
    fn certified(&mut self) -> Vec<usize> {
        let threshold = self.threshold;
        let live: Vec<usize> = (0..self.feasible.len()).filter(|arm| self.is_live(*arm)).collect();
        let is_sure = |arm: &usize| self.feasible[*arm] == Some(true);
        let sure: Vec<usize> = live.iter().copied().filter(is_sure).collect();
        let passes = |aim: &mut Aim, arm: usize| {
            live.iter().all(|rival| *rival == arm || aim.passes(*rival, arm, threshold).1)
        };
        sure.into_iter().filter(|arm| passes(&mut self.aim, *arm)).collect()
    }
}

impl Contest for Constrained {
    fn next_round(&self) -> &[Share] {
        self.rounds.wanted()
    }

    fn feed(&mut self, arm: usize, columns: &[Vec<Option<f64>>]) -> Result<(), Invalid> {
        let [scores, others @ ..] = columns else { return Ok(()) };
        let completed = self.rounds.count(arm, scores.len())?;
        self.aim.push(arm, scores);
        for (side, values) in self.sides.iter_mut().zip(others) {
            side[arm].observe_all(values);
        }
        if completed >= Completed::Share {
            self.learn(arm);
        }
        if completed == Completed::Round {
            self.decide();
        }
        Ok(())
    }

    fn finished(&self) -> bool {
        self.finished
    }

    fn side(&self, constraint: usize, arm: usize) -> Option<(f64, Interval, Option<bool>)> {
        let side = &self.sides[constraint][arm];
        Some((side.estimate(), side.interval(), self.bounds[constraint].holds(side)))
    }

    /// The choice now, at the end or at a deadline: of several that carry the certificate the one that deviates least. Where
    /// all arms are excluded, there is none.
    fn choice(&mut self) -> Choice {
        let arms = self.feasible.len();
        if let Some(leader) = self.ahead() {
            self.leader = leader;
        }
        let certified = if self.finished { self.certified() } else { Vec::new() };
        let by_deviation = |a: &&usize, b: &&usize| self.deviations[**a].total_cmp(&self.deviations[**b]);
        if let Some(least) = certified.iter().min_by(by_deviation)
            && self.deviations[*least] < self.deviations[self.leader]
        {
            self.leader = *least;
        } else if let Some(first) =
            certified.iter().find(|arm| self.deviations[**arm] == self.deviations[self.leader])
        {
            self.leader = *first;
        }
        let leader = self.leader;
        let others: Vec<usize> = (0..arms).filter(|arm| *arm != leader && self.is_live(*arm)).collect();
        let gap = if self.feasible[leader] != Some(true) {
            1.0
        } else if others.is_empty() {
            0.0
        } else {
            math::at_most(self.aim.gap(&others, leader, self.threshold) / self.scale, 1.0)
        };
        let is_excluded = |arm: &usize| self.feasible[*arm] == Some(false);
        Choice {
            arm: leader,
            gap,
            open: others,
            beaten: (0..arms).filter(|arm| self.dropped[*arm] && !is_excluded(arm)).collect(),
            certified,
            excluded: (0..arms).filter(is_excluded).collect(),
        }
    }
}

impl Bound {
    fn is_met(self, value: f64) -> bool {
        if self.at_least { value >= self.threshold } else { value <= self.threshold }
    }

    /// Whether it certainly holds, or is certainly violated.
    fn holds(self, of: &Running) -> Option<bool> {
        let interval = of.interval();
        match (self.is_met(interval.low), self.is_met(interval.high)) {
            (true, true) => Some(true),
            (false, false) => Some(false),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
