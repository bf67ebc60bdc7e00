//! The arms that none dominates in several aims: an epsilon-Pareto front (Auer et al., "Pareto front identification from
//! stochastic bandit feedback", AISTATS 2016), by paired bets instead of intervals.
//!
//! Each aim has an epsilon: a difference that does not matter. Arm a is *kept* beside b if a is better in some aim, or b is in
//! no aim epsilon better. Arm a is *covered* by b if b is better in some aim, and a is in no aim epsilon better. Of each two
//! arms, trials show one of the two in the end, however close they are: if b is epsilon better somewhere, then a is covered
//! unless a is epsilon better elsewhere, and if not, a is kept.
//!
//! ```text
//!  aim 2 |  a        b           a and b are the front: each is better in one aim.
//!        |                       c is covered by b: as good in aim 1, worse in aim 2.
//!        |           c    d      d is covered by b: a little better in aim 1, by less than epsilon.
//!        +------------------ aim 1
//! ```
//!
//! An arm is in the front once it is kept beside all others that are not left out, and left out once one of these covers it. At
//! the end each arm that is left out must be epsilon better than some arm of the front in no aim; if it is not, since the
//! arm that covered it was left out later, it comes back, and from then on only arms of the front can cover it.
//!
//! **Why the error is at most delta.** All decisions are made from bets against "b is no worse than a" and "b is epsilon better
//! than a" in one aim. For each two arms and each aim at most two of these bets are against something true (two, if both are
//! alike; else one, because capital rises with the gap). Each of them reaches the threshold with probability at most one over it
//! (Ville's inequality), and there are k (k - 1) m of them in all.

use super::aim::{Aim, Goal};
use super::contest::{Choice, Contest};
use super::rounds::{Completed, RankingRounds, Share};
use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::{Interval, Running};

/// What is known of an arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    Open,
    /// Open again: only an arm of the front can cover it.
    Returned,
    In,
    Out,
}

impl Standing {
    const fn is_open(self) -> bool {
        matches!(self, Self::Open | Self::Returned)
    }
}

/// Arms with several aims.
#[derive(Clone, Debug)]
pub struct Front {
    aims: Vec<Aim>,
    /// The numbers of each aim but the first, arm by arm, for reports.
    sides: Vec<Vec<Running>>,
    standing: Vec<Standing>,
    /// The arm that covered each arm that is left out.
    cover: Vec<Option<usize>>,
    threshold: f64,
    rounds: RankingRounds,
    finished: bool,
}

impl Front {
    /// Of so many arms in some aims, each with the loss that does not matter, in its unit; all but for probability `delta`.
    pub fn new(arms: usize, aims: &[(Goal, f64)], delta: f64, word: u64) -> Result<Self, Invalid> {
        range("options", arms as f64, 1.0, 4096.0)?;
        range("aims", aims.len() as f64, 2.0, 16.0)?;
        probability("delta", delta)?;
        // Where intervals are compared, they have half of the error.
        let tails = aims.iter().filter(|(goal, _)| matches!(goal, Goal::Tail(..))).count();
        let bets = if tails > 0 { 0.5 * delta } else { delta };
        let each = 0.5 * delta / math::at_least(tails as f64, 1.0);
        let misleading = math::at_least((arms * (arms - 1) * aims.len()) as f64, 1.0);
        let made = aims.iter().map(|(goal, epsilon)| Aim::new(*goal, arms, *epsilon, each));
        let joint = delta / (arms * aims.len()) as f64;
        let side = |(goal, _): &(Goal, f64)| Ok(vec![goal.running(joint)?; arms]);
        Ok(Self {
            aims: made.collect::<Result<_, _>>()?,
            sides: aims[1..].iter().map(side).collect::<Result<_, Invalid>>()?,
            standing: vec![if arms == 1 { Standing::In } else { Standing::Open }; arms],
            cover: vec![None; arms],
            threshold: math::ln(misleading / bets) + 1e-9,
            rounds: RankingRounds::new(if arms == 1 { 0 } else { arms }, word, u64::MAX),
            finished: arms == 1,
        })
    }

    fn all(&self, wanted: impl Fn(Standing) -> bool) -> Vec<usize> {
        (0..self.standing.len()).filter(|arm| wanted(self.standing[*arm])).collect()
    }

    /// Whether an arm is certainly better than another in some aim, or the other in no aim epsilon better.
    fn is_kept(&mut self, arm: usize, beside: usize) -> bool {
        let threshold = self.threshold;
        self.aims.iter_mut().any(|aim| aim.passes(beside, arm, threshold).0) || self.is_matched(beside, arm)
    }

    /// Whether an arm is certainly in no aim epsilon better than another.
    fn is_matched(&mut self, arm: usize, by: usize) -> bool {
        let threshold = self.threshold;
        self.aims.iter_mut().all(|aim| aim.passes(arm, by, threshold).1)
    }

    /// Whether an arm is certainly worse than another in some aim, and in none epsilon better.
    fn is_covered(&mut self, arm: usize, by: usize) -> bool {
        let threshold = self.threshold;
        self.aims.iter_mut().any(|aim| aim.passes(arm, by, threshold).0) && self.is_matched(arm, by)
    }

    fn decide(&mut self) {
        for arm in self.all(Standing::is_open) {
            let returned = self.standing[arm] == Standing::Returned;
            let rivals = self.all(|one| if returned { one == Standing::In } else { one != Standing::Out });
            let covers = |this: &mut Self, rival: &usize| {
                *rival != arm && !this.is_kept(arm, *rival) && this.is_covered(arm, *rival)
            };
            if let Some(rival) = rivals.iter().find(|rival| covers(self, rival)) {
                (self.standing[arm], self.cover[arm]) = (Standing::Out, Some(*rival));
            }
        }
        let mut wanted = vec![false; self.standing.len()];
        let mut kept = Vec::new();
        for arm in self.all(Standing::is_open) {
            let mut is_kept = true;
            for rival in self.all(|one| one != Standing::Out) {
                if rival != arm && !self.is_kept(arm, rival) {
                    is_kept = false;
                    (wanted[arm], wanted[rival]) = (true, true);
                }
            }
            if is_kept {
                kept.push(arm);
            }
        }
        for arm in kept {
            self.standing[arm] = Standing::In;
        }
        if self.all(Standing::is_open).is_empty() {
            let front = self.all(|one| one == Standing::In);
            for arm in self.all(|one| one == Standing::Out) {
                let is_covered = self.cover[arm].is_some_and(|by| front.contains(&by));
                if !is_covered && !front.iter().any(|kept| self.is_matched(arm, *kept)) {
                    self.standing[arm] = Standing::Returned;
                    wanted[arm] = true;
                    for kept in &front {
                        wanted[*kept] = true;
                    }
                }
            }
        }
        self.finished = !wanted.contains(&true);
        let aim = &self.aims[0];
        let next = (0..wanted.len()).filter(|arm| wanted[*arm]);
        self.rounds.open(next.map(|arm| (arm, aim.trials(arm))));
    }
}

impl Contest for Front {
    fn next_round(&self) -> &[Share] {
        self.rounds.wanted()
    }

    fn feed(&mut self, arm: usize, columns: &[Vec<Option<f64>>]) -> Result<(), Invalid> {
        let completed = self.rounds.count(arm, columns.first().map_or(0, Vec::len))?;
        for (aim, scores) in self.aims.iter_mut().zip(columns) {
            aim.push(arm, scores);
        }
        for (side, values) in self.sides.iter_mut().zip(columns.iter().skip(1)) {
            side[arm].observe_all(values);
        }
        if completed == Completed::Round {
            self.decide();
        }
        Ok(())
    }

    fn finished(&self) -> bool {
        self.finished
    }

    fn side(&self, aim: usize, arm: usize) -> Option<(f64, Interval, Option<bool>)> {
        let side = &self.sides[aim][arm];
        Some((side.estimate(), side.interval(), None))
    }

    /// The front now, at the end or at a deadline: its arms are those that are certified.
    fn choice(&mut self) -> Choice {
        let front = self.all(|one| one == Standing::In);
        Choice {
            arm: front.first().copied().unwrap_or(0),
            gap: 1.0,
            open: self.all(Standing::is_open),
            beaten: self.all(|one| one == Standing::Out),
            certified: front,
            excluded: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
