//! How the evidence of a query grew: what was known after 1, 2, 3, 4, 6, 8, 12, … trials, and at the end. Outcomes count in
//! the order of their indices, so this depends on nothing but input, seed and version.

use super::Interval;
use crate::stats::Weights;

/// How the evidence of a query grew.
#[derive(Clone, Debug, PartialEq)]
pub enum Evidence {
    /// Of a check or an estimate.
    Values(Vec<Snapshot>),
    /// Of a ranking: the options in order of writing, and how far each was.
    Options {
        /// The options.
        labels: Vec<String>,
        /// How far they were.
        snapshots: Vec<Standing>,
    },
}

/// What was known after some trials of a check or an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Number of trials.
    pub trials: u64,
    /// Estimate and interval; before the last of them the interval holds at all times.
    pub value: Interval,
    /// The evidence of a test for above and for below.
    pub weights: Option<Weights>,
}

/// How far the options of a ranking were.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// Number of trials of all options.
    pub trials: u64,
    /// Number of trials of each, and whether it was still sampled.
    pub options: Vec<(u64, bool)>,
}

/// The next number of trials at which something is noted: a power of two, or one and a half of it.
pub const fn next_after(trials: u64) -> u64 {
    if trials < 2 {
        return trials + 1;
    }
    let power = 1 << (u64::BITS - 1 - trials.leading_zeros());
    let half = power / 2 * 3;
    if trials < half { half } else { power.saturating_mul(2) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_grow_by_factors() {
        let numbers: Vec<u64> = std::iter::successors(Some(0), |n| Some(next_after(*n))).take(11).collect();
        assert_eq!(numbers, [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32]);
        assert_eq!([next_after(5), next_after(7), next_after(25)], [6, 8, 32]);
    }
}
