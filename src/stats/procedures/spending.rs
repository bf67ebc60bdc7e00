//! Clopper-Pearson with the error spent evenly over geometric looks: sound by the union bound for any
//! half-width and error, without a table.

use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::{Counts, Coverage, Estimator, Interval, Rule, Sequential, clopper_pearson};

/// Each look is at half as many trials again.
const RATIO: f64 = 1.5;

/// Estimates P within a half-width.
#[derive(Clone, Debug, PartialEq)]
pub struct Spending {
    epsilon: f64,
    delta: f64,
    looks: Vec<u64>,
    /// Looks already taken.
    taken: usize,
}

impl Spending {
    /// P(P is not in the interval) <= delta, half-width at most `epsilon`.
    pub fn new(epsilon: f64, delta: f64) -> Result<Sequential<Self>, Invalid> {
        Self::rule(epsilon, delta).map(Sequential::new)
    }

    pub(in crate::stats) fn rule(epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        range("epsilon", epsilon, 1e-5, 0.5)?;
        probability("delta", delta)?;
        // The more looks, the longer each takes: the smallest number that reaches the end.
        let mut looks = Vec::new();
        for number in 1..200 {
            looks = schedule(epsilon, delta / f64::from(number));
            if looks.len() <= number as usize {
                break;
            }
        }
        Ok(Self { epsilon, delta, looks, taken: 0 })
    }

    /// The numbers of trials at which it looks.
    pub fn looks(&self) -> &[u64] {
        &self.looks
    }

    /// Goes on after outcomes at which it cannot have stopped, but for the last.
    pub(in crate::stats) fn resumed(mut self, counts: Counts) -> Sequential<Self> {
        self.taken = self.looks.partition_point(|look| *look < counts.trials());
        let finished = self.look(counts, false);
        Sequential::resumed(self, counts, finished)
    }

    fn level(&self) -> f64 {
        self.delta / self.looks.len() as f64
    }
}

/// The looks at one level: from where no successes at all suffice to where any outcomes do.
fn schedule(epsilon: f64, level: f64) -> Vec<u64> {
    let first = (math::ln(0.5 * level) / math::ln_1p(-2.0 * epsilon)).ceil();
    let first = if first.is_finite() { math::at_least(first, 1.0) } else { 1.0 };
    let last = clopper_pearson::size(epsilon, level);
    let mut looks = Vec::new();
    let mut n = first;
    while (n.ceil() as u64) < last {
        looks.push(n.ceil() as u64);
        n *= RATIO;
    }
    looks.push(last);
    looks
}

impl Rule for Spending {
    type Answer = bool;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> bool {
        if self.looks.get(self.taken) != Some(&counts.trials()) {
            return false;
        }
        self.taken += 1;
        self.taken == self.looks.len() || clopper_pearson::narrow(counts, self.level(), 2.0 * self.epsilon)
    }

    fn limit(&self) -> Option<u64> {
        self.looks.last().copied()
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![("looks", self.looks.len() as f64)]
    }
}

impl Estimator for Spending {
    fn error(&self) -> f64 {
        self.delta
    }

    fn at_stop(&self, counts: Counts) -> Interval {
        Interval {
            error: self.delta,
            coverage: Coverage::Sequential,
            ..clopper_pearson::interval(counts, self.level())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_of_the_reference() {
        let spending = Spending::new(0.01, 0.05).unwrap();
        assert_eq!(spending.rule().looks().len(), 12);
        for look in [689, 1550, 5229, 11_764, 17_646] {
            assert!(spending.rule().looks().contains(&look), "{look} not in {:?}", spending.rule().looks());
        }
        assert!((20_500..20_800).contains(&spending.limit().unwrap()), "{:?}", spending.limit());
    }

    #[test]
    fn begun_in_the_middle_it_goes_on_as_from_the_start() {
        let mut whole = Spending::new(0.05, 0.05).unwrap();
        let looks = whole.rule().looks().to_vec();
        let mut n = 0u64;
        while !whole.finished() {
            for from in [looks[0] - 1, looks[1], looks[1] + 1] {
                if from == n {
                    let part = Spending::rule(0.05, 0.05).unwrap().resumed(whole.counts());
                    assert_eq!(part, whole);
                }
            }
            whole.observe(n.is_multiple_of(3));
            n += 1;
        }
        assert!(n > looks[1] + 1);
    }

    #[test]
    fn the_width_is_kept_at_every_stop() {
        for share in [0, 1, 3, 5] {
            let mut spending = Spending::new(0.05, 0.05).unwrap();
            let mut n = 0;
            while !spending.observe(n % 10 < share) {
                n += 1;
            }
            assert!(spending.interval().half_width() <= 0.05);
        }
    }
}
