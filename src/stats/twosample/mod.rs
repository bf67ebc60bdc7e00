//! Do two samples come from one distribution? Tests and measures for numbers and for vectors.
//!
//! | question | function |
//! | --- | --- |
//! | vectors, any difference | [`energy_test`] |
//! | numbers, any difference | [`kolmogorov_smirnov`] |
//! | paired numbers, a shift | [`signed_rank`] |
//! | how many times as wide | [`spread_ratio`] |
//! | one sample in numbers | [`Summary`] |

mod energy;
mod kolmogorov;
mod signed_rank;
mod spread;
mod summary;

pub use energy::{EnergyTest, energy_test};
pub use kolmogorov::{KolmogorovSmirnov, kolmogorov_smirnov, normality};
pub use signed_rank::{SignedRank, signed_rank};
pub use spread::{SpreadRatio, spread_ratio};
pub use summary::{Summary, quantile};

use crate::base::random::{Purpose, Stream, TrialKey};

/// The address of the draws of one procedure of a call: procedures with different numbers share no draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Draws {
    /// Seed of the call.
    pub seed: u64,
    /// Number of the procedure, 24 bits.
    pub procedure: u32,
}

impl Draws {
    /// The stream of a repetition.
    fn stream(self, repetition: u32) -> Stream {
        let key = TrialKey { seed: self.seed, index: u64::from(repetition), branch: 0 };
        Stream::of(key, self.procedure, Purpose::Procedure)
    }

    /// `count` of the numbers 0..`of`, ascending: every set of them has the same probability (the first steps of the
    /// shuffle of Fisher and Yates).
    pub fn subset(self, repetition: u32, count: usize, of: usize) -> Vec<usize> {
        let stream = self.stream(repetition);
        let mut all: Vec<usize> = (0..of).collect();
        let count = count.min(of);
        for k in 0..count {
            all.swap(k, k + below(stream, k as u32, of - k));
        }
        all.truncate(count);
        all.sort_unstable();
        all
    }
}

/// A whole number below `count`.
fn below(stream: Stream, draw: u32, count: usize) -> usize {
    // The product may round up to `count`.
    ((stream.uniform(draw) * count as f64) as usize).min(count.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subsets_are_ascending_and_all_alike() {
        let mut seen = std::collections::BTreeMap::new();
        let draws = Draws { seed: 3, procedure: 1 };
        for repetition in 0..6000 {
            let subset = draws.subset(repetition, 2, 4);
            assert!(subset.len() == 2 && subset[0] < subset[1] && subset[1] < 4);
            *seen.entry(subset).or_insert(0) += 1;
        }
        // Six sets, 1000 expected each, standard deviation 29.
        assert_eq!(seen.len(), 6);
        assert!(seen.values().all(|count: &i32| (count - 1000).abs() < 120), "{seen:?}");
        assert_eq!(draws.subset(0, 9, 3), [0, 1, 2]);
        assert!(draws.subset(0, 0, 0).is_empty());
    }
}
