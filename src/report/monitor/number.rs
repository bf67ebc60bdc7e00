//! A number of a property file over all instants of a recording: a mean, a quantile, or the mean of the largest values.

use crate::base::math;
use crate::replay::{Asked, Judged, Sought};
use crate::stats::bootstrap::{Bootstrap, DRAWS, Estimate};
use std::collections::BTreeMap;

/// With one person, blocks of this length are drawn instead of persons, s.
pub(super) const BLOCK: f64 = 30.0;

/// What a number came to.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MonitoredNumber {
    /// As it is asked: `E(min<=4.8 s (distance(user, friend)))`.
    pub name: String,
    /// Its unit; empty if it has none.
    pub unit: String,
    /// Instants with a value.
    pub instants: u64,
    /// Instants without one.
    pub unresolved: u64,
    /// Values outside of the range of a mean.
    pub clipped: u64,
    /// Persons, or blocks of time, with an instant.
    pub parts: u64,
    /// The number with its interval; `None` if no instant has a value.
    #[serde(rename = "value")]
    pub estimate: Option<Estimate>,
}

impl MonitoredNumber {
    /// Number `index` of some instants. With one user blocks of time are resampled, else persons.
    pub fn of(asked: &Asked, index: usize, instants: &[Judged], is_alone: bool, confidence: f64) -> Self {
        let mut parts: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
        let (mut unresolved, mut clipped) = (0, 0);
        for one in instants {
            let block =
                if is_alone { (one.instant.time / BLOCK).floor() as u64 } else { one.instant.person.into() };
            let part = parts.entry(block).or_default();
            match one.values.get(index).copied().flatten() {
                Some(value) => {
                    let inside = asked.range.map_or(value, |(low, high)| value.clamp(low, high));
                    clipped += u64::from(inside != value);
                    part.push(inside);
                }
                None => unresolved += 1,
            }
        }
        let mut values: Vec<(f64, usize)> =
            parts.values().enumerate().flat_map(|(part, all)| all.iter().map(move |x| (*x, part))).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let bootstrap = Bootstrap { persons: parts.len(), draws: DRAWS, seed: 0, confidence };
        let estimate = bootstrap.estimate(|counts| statistic(asked.sought, &values, counts));
        Self {
            name: asked.name.clone(),
            unit: asked.unit.clone(),
            instants: values.len() as u64,
            unresolved,
            clipped,
            parts: parts.len() as u64,
            estimate,
        }
    }
}

/// A statistic of ascending values, each of a part that counts so often.
fn statistic(sought: Sought, values: &[(f64, usize)], counts: &[u32]) -> Option<f64> {
    let weight = |part: usize| f64::from(counts[part]);
    let all: f64 = values.iter().map(|(_, part)| weight(*part)).sum();
    if all == 0.0 {
        return None;
    }
    let found = match sought {
        Sought::Mean => values.iter().map(|(x, part)| x * weight(*part)).sum::<f64>() / all,
        // The least value such that at least this share is not above it.
        Sought::Quantile(level) => {
            let mut below = 0.0;
            let reached = values.iter().find(|(_, part)| {
                below += weight(*part);
                below >= level * all - 1e-9
            });
            reached.or(values.last())?.0
        }
        Sought::Tail(level) => {
            let room = (1.0 - level) * all;
            let (mut left, mut sum) = (room, 0.0);
            for (x, part) in values.iter().rev() {
                let share = math::at_most(weight(*part), left);
                sum += share * x;
                left -= share;
            }
            sum / room
        }
    };
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_count_each_part_as_often_as_it_is_drawn() {
        let values = [(1.0, 0), (2.0, 1), (3.0, 0), (4.0, 1)];
        let of = |sought, counts: [u32; 2]| statistic(sought, &values, &counts).unwrap();
        assert_eq!(
            (of(Sought::Mean, [1, 1]), of(Sought::Mean, [1, 0]), of(Sought::Mean, [1, 3])),
            (2.5, 2.0, 2.75)
        );
        assert_eq!((of(Sought::Quantile(0.5), [1, 1]), of(Sought::Quantile(0.5), [0, 1])), (2.0, 2.0));
        assert_eq!((of(Sought::Tail(0.5), [1, 1]), of(Sought::Tail(0.75), [1, 1])), (3.5, 4.0));
        assert_eq!(statistic(Sought::Mean, &values, &[0, 0]), None);
    }
}
