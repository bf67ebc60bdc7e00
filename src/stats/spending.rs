//! Clopper-Pearson with the error spent evenly over geometric looks: sound by the union bound for any
//! half-width and error, without a table.

use super::invalid::{Invalid, probability, range};
use super::{Counts, Coverage, Estimator, Interval, clopper_pearson, sequence};
use crate::base::math;

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
    counts: Counts,
    finished: bool,
}

impl Spending {
    /// P(P is not in the interval) <= delta, half-width at most `epsilon`.
    pub fn new(epsilon: f64, delta: f64) -> Result<Self, Invalid> {
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
        Ok(Self { epsilon, delta, looks, taken: 0, counts: Counts::default(), finished: false })
    }

    /// The numbers of trials at which it looks.
    pub fn looks(&self) -> &[u64] {
        &self.looks
    }

    /// The same after outcomes at which it cannot have stopped, but for the last.
    pub(super) fn after(mut self, counts: Counts) -> Self {
        self.counts = counts;
        self.taken = self.looks.partition_point(|look| *look < counts.trials());
        self.look();
        self
    }

    fn look(&mut self) {
        if self.looks.get(self.taken) == Some(&self.counts.trials()) {
            self.taken += 1;
            self.finished = self.taken == self.looks.len()
                || clopper_pearson::narrow(self.counts, self.level(), 2.0 * self.epsilon);
        }
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

impl Estimator for Spending {
    #[inline]
    fn observe(&mut self, success: bool) -> bool {
        if !self.finished {
            self.counts.add(success);
            self.look();
        }
        self.finished
    }

    fn finished(&self) -> bool {
        self.finished
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn interval(&self) -> Interval {
        if !self.finished {
            return sequence::interval(self.counts, self.delta);
        }
        Interval {
            error: self.delta,
            coverage: Coverage::Sequential,
            ..clopper_pearson::interval(self.counts, self.level())
        }
    }

    fn limit(&self) -> Option<u64> {
        self.looks.last().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_of_the_reference() {
        let spending = Spending::new(0.01, 0.05).unwrap();
        assert_eq!(spending.looks().len(), 12);
        for look in [689, 1550, 5229, 11_764, 17_646] {
            assert!(spending.looks().contains(&look), "{look} not in {:?}", spending.looks());
        }
        assert!((20_500..20_800).contains(&spending.limit().unwrap()), "{:?}", spending.limit());
    }

    #[test]
    fn begun_in_the_middle_it_goes_on_as_from_the_start() {
        let mut whole = Spending::new(0.05, 0.05).unwrap();
        let looks = whole.looks().to_vec();
        let mut n = 0u64;
        while !whole.finished() {
            for from in [looks[0] - 1, looks[1], looks[1] + 1] {
                if from == n {
                    let part = Spending::new(0.05, 0.05).unwrap().after(whole.counts());
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
