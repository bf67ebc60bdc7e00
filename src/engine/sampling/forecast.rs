//! Forecasts: how many trials a query is likely to take, from its first ones. Nothing that a result depends on.
//!
//! What a procedure takes at a given truth is its own (`stats::Spec::forecast`).

use crate::base::math::{self, ln};
use crate::compile::study::{Ask, MeasureKind};
use crate::engine::sampling::procedure::Procedure;
use crate::engine::sampling::watch::Likely;
use crate::stats;
use crate::stats::mean::until_narrow;
use crate::stats::ranking::Ranking;
use crate::stats::spec::Guess;
use crate::trials::cell::{Cell, Reading};

/// Error of what a few trials say of a share.
const UNSURE: f64 = 0.08;
/// Steps from one end of it to the other.
const STEPS: u32 = 24;

/// First readings of a column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::engine) struct PilotStatistics {
    /// Trials.
    trials: f64,
    /// Sum of the readings; a truth value reads as 0 or 1.
    sum: f64,
    /// Sum of their squares.
    squares: f64,
    /// Truth values read, and how many of them were true; they read as 0 and 1.
    truths: u64,
    held: u64,
}

impl PilotStatistics {
    /// Adds a number.
    pub(super) fn add(&mut self, x: f64) {
        if x.is_finite() {
            self.trials += 1.0;
            self.sum += x;
            self.squares += x * x;
        }
    }

    /// Adds truth values, so many of them true.
    pub(super) fn count(&mut self, truths: u64, held: u64) {
        self.truths += truths;
        self.held += held;
    }

    fn trials(&self) -> f64 {
        self.trials + self.truths as f64
    }

    fn sum(&self) -> f64 {
        self.sum + self.held as f64
    }

    /// Adds what a cell reads, clipped to a range.
    pub(super) fn read(&mut self, cell: &Cell, (low, high): (f64, f64)) {
        match cell.reading {
            Reading::Truth(held) => self.count(1, u64::from(held)),
            Reading::Value(value) => self.add(value.clamp(low, high)),
            Reading::Unresolved | Reading::Faulty => {}
        }
    }

    /// Share of successes by Laplace's rule, which keeps away from 0 and 1.
    fn share(&self) -> f64 {
        (self.sum() + 1.0) / (self.trials() + 2.0)
    }

    /// The only number, if there is one.
    pub(super) fn only(&self) -> Option<f64> {
        (self.trials() > 0.0).then(|| self.mean())
    }

    /// The mean, 0 of no numbers.
    pub(super) fn mean(&self) -> f64 {
        if self.trials() > 0.0 { self.sum() / self.trials() } else { 0.0 }
    }

    /// What the readings say themselves.
    fn guess(&self, least: f64) -> Guess {
        guess(self.share(), self.mean(), self.variance(least))
    }

    /// What the truth may be as well, beside them. `least` is a distance that one more reading could have.
    fn guesses(&self, least: f64) -> Vec<Guess> {
        let (n, middle) = (self.trials(), self.guess(least));
        let read = stats::Counts { successes: self.held, failures: self.truths - self.held };
        let shares = stats::clopper_pearson::interval(read, UNSURE);
        let spread = self.variance(0.0);
        let off = 2.0 * ((spread + least * least / (n + 1.0)) / n.max(1.0)).sqrt();
        let mut guesses = Vec::new();
        for k in 0..=STEPS {
            // From end to end.
            let at = f64::from(k) / f64::from(STEPS);
            let share = (shares.low + at * (shares.high - shares.low)).clamp(1e-9, 1.0 - 1e-9);
            let mean = middle.mean + (2.0 * at - 1.0) * off;
            let other = 4.0 * spread + 4.0 * least * least / (n + 1.0);
            guesses.extend([0.3 * spread, other].map(|variance| guess(share, mean, variance)));
        }
        guesses
    }

    /// The fewest trials, those that the readings themselves foretell, and the most.
    fn spread(&self, least: f64, trials: impl Fn(Guess) -> f64) -> [f64; 3] {
        let likely = trials(self.guess(least));
        let all = self.guesses(least).into_iter().map(trials);
        all.fold([likely; 3], |[a, _, b], n| [math::at_most(n, a), likely, math::at_least(n, b)])
    }

    /// Variance; with few trials never far below that of one more reading at distance `least`.
    fn variance(&self, least: f64) -> f64 {
        let n = self.trials().max(1.0);
        let mean = self.mean();
        let spread = ((self.squares + self.held as f64) / n - mean * mean).max(0.0);
        spread + least * least / (n + 1.0)
    }
}

/// Trials that a check or estimate takes: with what the first of them say, and with what the truth may be as well.
pub(super) fn entry(ask: &Ask, procedure: &Procedure, statistics: &PilotStatistics) -> Option<Likely> {
    let limit = procedure.limit();
    let (measure, chosen, theta) = match ask {
        Ask::Check { measure, test, threshold, .. } => (measure, test, *threshold),
        Ask::Estimate { measure, estimator, .. } => (measure, estimator, f64::NAN),
        Ask::Compare { .. } | Ask::Rank { .. } => return limit.map(Likely::exactly),
    };
    let Some(forecast) = chosen.spec.forecast.filter(|_| !procedure.is_planned()) else {
        return limit.map(Likely::exactly);
    };
    let range = match measure.kind {
        MeasureKind::Expectation { range: (low, high), .. } => high - low,
        MeasureKind::Probability | MeasureKind::Quantile { .. } | MeasureKind::Curve { .. } => 1.0,
    };
    let tail = measure.kind.share().unwrap_or(1.0);
    let trials = |guess: Guess| (forecast.trials)(&chosen.values, &Guess { theta, range, tail, ..guess });
    let [least, likely, most] = statistics.spread(0.1 * range, trials);
    let whole = |n: f64| (math::at_most(n, 1e18) as u64).clamp(1, limit.unwrap_or(u64::MAX).max(1));
    // Runs of one procedure at one truth scatter as well.
    let (fewer, more) = forecast.scatter;
    Some(Likely { least: whole(fewer * least), likely: whole(likely), most: whole(more * most) })
}

/// First trials of a query that are requested from elsewhere.
pub(in crate::engine) const FIRST: u64 = 256;

/// Up to which trial outcomes are requested from elsewhere, where so many are read: as many as will surely be needed, or as the
/// fewest that are likely to be, and at least a fifth more, so that of what comes less than a quarter is in vain.
pub(super) fn ahead(read: u64, likely: Option<Likely>) -> u64 {
    let known = likely.filter(|likely| read >= FIRST || likely.least == likely.most);
    (read + read / 5).max(known.map_or(FIRST, |likely| likely.least))
}

/// What the truth may be, of a query that is not known yet.
const fn guess(share: f64, mean: f64, variance: f64) -> Guess {
    Guess { share, mean, variance, theta: f64::NAN, range: 1.0, tail: 1.0 }
}

/// Pairs that a comparison is likely to take; `statistics` is that of the differences.
pub(super) fn compare(statistics: &PilotStatistics, range: f64, epsilon: f64, delta: f64) -> Likely {
    let of = |guess: Guess| until_narrow(guess.variance, 2.0 * range, epsilon, delta);
    let [fewest, likely, most] = statistics.spread(0.1 * range, of);
    let whole = |n: f64| math::at_most(n, 1e18) as u64;
    Likely { least: whole(0.4 * fewest), likely: whole(likely), most: whole(2.0 * most) }
}

/// Trials that a ranking is likely to take, of all options together; `statistics` are those of the options,
/// `differences` those of each option to the one that leads, `scale` the range of the score.
pub(super) fn rank(
    statistics: &[PilotStatistics],
    differences: &[PilotStatistics],
    scale: f64,
    (epsilon, delta, ranking): (f64, f64, Ranking),
) -> Likely {
    let arms = statistics.len().max(2) as f64;
    if ranking == Ranking::Okamoto {
        let each = stats::okamoto::size(epsilon / scale, delta / arms);
        return Likely::exactly((arms as u64).saturating_mul(each));
    }
    let level = ln(arms / delta);
    let best = statistics.iter().map(PilotStatistics::mean).fold(f64::NEG_INFINITY, f64::max);
    let of = |(one, difference): (&PilotStatistics, &PilotStatistics)| {
        let gap = (best - one.mean()).max(epsilon);
        2.0 * difference.variance(0.1 * scale) * level / (gap * gap) + scale * level / gap
    };
    let likely = math::at_most(statistics.iter().zip(differences).map(of).sum::<f64>(), 1e17);
    // Who leads is not sure yet, and how far the others are behind.
    Likely { least: (0.1 * likely) as u64, likely: likely as u64, most: (4.0 * likely) as u64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::ranking::Allocation;

    #[test]
    fn a_ranking_of_equals_costs_the_most() {
        let with = |share: f64| {
            let mut statistics = PilotStatistics::default();
            (0..32).for_each(|k| statistics.add(f64::from(u8::from(f64::from(k) < 32.0 * share))));
            statistics
        };
        let rule = (0.02, 0.05, Ranking::Betting(Allocation::AllFailing));
        let level = rank(&[with(0.5), with(0.5)], &[with(0.0), with(0.5)], 1.0, rule);
        let apart = rank(&[with(0.9), with(0.1)], &[with(0.0), with(0.8)], 1.0, rule);
        assert!(level.likely > 5 * apart.likely, "{level:?} {apart:?}");
    }
}
