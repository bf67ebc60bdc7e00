//! The energy distance between two samples of vectors, and its permutation test (Szekely and Rizzo 2004, 2013).
//!
//! With independent X, X' of one law and Y, Y' of the other, 2 E|X - Y| - E|X - X'| - E|Y - Y'| is never negative, and 0
//! only where the laws are equal. The empirical value replaces means over laws by means over samples.

use super::Draws;

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyTest {
    /// The energy distance, in the unit of the coordinates.
    pub distance: f64,
    /// The share of all divisions of the pooled sample, the observed one included, that lie at least as far apart.
    pub p: f64,
}

/// Tests whether vectors, all of one length, come from one law. `p` is exact for exchangeable vectors whatever the number
/// of `shuffles`; its least value is 1 / (`shuffles` + 1). NaN where a sample is empty.
pub fn energy_test(a: &[Vec<f64>], b: &[Vec<f64>], shuffles: u32, draws: Draws) -> EnergyTest {
    let pooled: Vec<&Vec<f64>> = a.iter().chain(b).collect();
    let apart = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
    // Below the diagonal; the distances within the first set determine all sums, given the sums of the rows.
    let rows: Vec<Vec<f64>> = (0..pooled.len())
        .map(|i| pooled[..i].iter().map(|other| apart(pooled[i], other)).collect())
        .collect();
    let mut sums = vec![0.0; pooled.len()];
    for (i, row) in rows.iter().enumerate() {
        for (j, distance) in row.iter().enumerate() {
            sums[i] += distance;
            sums[j] += distance;
        }
    }
    let total = 0.5 * sums.iter().sum::<f64>();
    let (n, m) = (a.len() as f64, b.len() as f64);
    let energy = |first: &[usize]| {
        let (mut within, mut touching) = (0.0, 0.0);
        for (k, &i) in first.iter().enumerate() {
            let row = &rows[i];
            within += first[..k].iter().map(|&j| row[j]).sum::<f64>();
            touching += sums[i];
        }
        let across = touching - 2.0 * within;
        let others = total - within - across;
        2.0 * (across / (n * m) - within / (n * n) - others / (m * m))
    };
    let distance = energy(&(0..a.len()).collect::<Vec<_>>());
    // Equal divisions differ by the rounding of their sums.
    let least = distance - 1e-12 * total / (n * m);
    let as_far = (0..shuffles).filter(|&k| energy(&draws.subset(k, a.len(), pooled.len())) >= least).count();
    let p = (as_far as f64 + 1.0) / (f64::from(shuffles) + 1.0);
    EnergyTest { distance, p: if distance.is_nan() { f64::NAN } else { p } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    fn normal(index: u64, count: u32, shift: f64) -> Vec<Vec<f64>> {
        let stream = Stream::of(TrialKey { seed: 5, index, branch: 0 }, 0, Purpose::Test);
        let of = |k| stream.normal_pair(k).map(|z| z + shift).to_vec();
        (0..count).map(of).collect()
    }

    /// The definition, sum by sum.
    fn defined(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
        let mean = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            let apart = |x: &Vec<f64>, y: &Vec<f64>| {
                x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
            };
            let sum: f64 = a.iter().map(|x| b.iter().map(|y| apart(x, y)).sum::<f64>()).sum();
            sum / (a.len() * b.len()) as f64
        };
        2.0 * mean(a, b) - mean(a, a) - mean(b, b)
    }

    #[test]
    fn the_distance_is_that_of_the_definition() {
        for (n, m) in [(1, 1), (2, 5), (30, 17)] {
            let (a, b) = (normal(1, n, 0.0), normal(2, m, 0.3));
            let found = energy_test(&a, &b, 0, Draws::default()).distance;
            assert!((found - defined(&a, &b)).abs() < 1e-12, "{found}");
        }
        // scipy.stats.energy_distance([0, 1, 3], [5, 6, 8, 10]) ** 2: twice the area between squared distributions.
        let line = |values: &[f64]| values.iter().map(|x| vec![*x]).collect::<Vec<_>>();
        let found = energy_test(&line(&[0.0, 1.0, 3.0]), &line(&[5.0, 6.0, 8.0, 10.0]), 0, Draws::default());
        assert!((found.distance - SCIPY_LINE).abs() < 1e-12, "{}", found.distance);
    }

    const SCIPY_LINE: f64 = 8.375;

    /// All divisions of six values, by hand: those at least as far apart as the observed one.
    #[test]
    fn p_is_the_share_of_the_divisions() {
        let line = |values: &[f64]| values.iter().map(|x| vec![*x]).collect::<Vec<_>>();
        let (a, b) = (line(&[0.0, 1.0, 2.5]), line(&[2.0, 4.0, 7.0]));
        let pooled: Vec<Vec<f64>> = a.iter().chain(&b).cloned().collect();
        let observed = defined(&a, &b);
        let (mut as_far, mut all) = (0.0, 0.0);
        for chosen in 0..64_u32 {
            if chosen.count_ones() == 3 {
                let side = |one: bool| {
                    let of = (0..6).filter(|k| (chosen >> k & 1 == 1) == one);
                    of.map(|k| pooled[k].clone()).collect::<Vec<_>>()
                };
                all += 1.0;
                as_far += f64::from(u8::from(defined(&side(true), &side(false)) >= observed - 1e-12));
            }
        }
        let found = energy_test(&a, &b, 20_000, Draws { seed: 1, procedure: 0 }).p;
        // Three standard deviations of 20 000 shuffles.
        assert!((found - as_far / all).abs() < 0.011, "{found} {}", as_far / all);
    }

    #[test]
    fn p_of_one_law_is_uniform_and_small_for_two() {
        let of = |k: u64, shift: f64| {
            let draws = Draws { seed: k, procedure: 0 };
            energy_test(&normal(2 * k + 10, 12, 0.0), &normal(2 * k + 11, 12, shift), 99, draws).p
        };
        let same: Vec<f64> = (0..200).map(|k| of(k, 0.0)).collect();
        for level in [0.1, 0.25, 0.5, 0.75, 0.9] {
            let share = same.iter().filter(|p| **p <= level).count() as f64 / 200.0;
            assert!((share - level).abs() < 0.11, "{share} of p are at most {level}");
        }
        assert!(of(0, 2.0) == 0.01);
        assert!(energy_test(&[], &normal(0, 3, 0.0), 9, Draws::default()).p.is_nan());
    }
}
