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

/// Smaller distances are those of equal vectors whose coordinates were computed in two ways.
const EQUAL: f64 = 1e-9;

/// Divisions whose distances are summed at a time, one in each lane of vector instructions.
const LANES: usize = 16;

/// Tests whether vectors, all of one length, come from one law. `p` is exact for exchangeable vectors whatever the number
/// of `shuffles`; its least value is 1 / (`shuffles` + 1). NaN where a sample is empty.
pub fn energy_test(a: &[Vec<f64>], b: &[Vec<f64>], shuffles: u32, draws: Draws) -> EnergyTest {
    let pooled = Pooled::new(&a.iter().chain(b).collect::<Vec<_>>(), a.len());
    let mut first = vec![[0.0; LANES]; a.len() + b.len()];
    first[..a.len()].fill([1.0; LANES]);
    let distance = pooled.energies(&first)[0];
    if distance.is_nan() {
        return EnergyTest { distance, p: f64::NAN };
    }
    // Equal divisions differ by the rounding of their sums.
    let least = distance - 1e-12 * pooled.total / (a.len() * b.len()) as f64;
    let mut as_far = 1;
    for block in (0..shuffles).step_by(LANES) {
        first.fill([0.0; LANES]);
        for lane in 0..LANES {
            for member in draws.subset(block + lane as u32, a.len(), first.len()) {
                first[member][lane] = 1.0;
            }
        }
        let lanes = LANES.min((shuffles - block) as usize);
        as_far += pooled.energies(&first)[..lanes].iter().filter(|energy| **energy >= least).count();
    }
    EnergyTest { distance, p: as_far as f64 / (f64::from(shuffles) + 1.0) }
}

/// The distances of a pooled sample.
struct Pooled {
    /// From each vector to those before it.
    rows: Vec<Vec<f64>>,
    /// From each vector to all others.
    sums: Vec<f64>,
    /// Of all pairs.
    total: f64,
    /// Sizes of the two samples.
    sizes: [f64; 2],
}

impl Pooled {
    fn new(all: &[&Vec<f64>], first: usize) -> Self {
        let apart = |x: &[f64], y: &[f64]| {
            let distance = x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
            if distance < EQUAL { 0.0 } else { distance }
        };
        let rows: Vec<Vec<f64>> =
            (0..all.len()).map(|i| all[..i].iter().map(|other| apart(all[i], other)).collect()).collect();
        let mut sums = vec![0.0; all.len()];
        for (i, row) in rows.iter().enumerate() {
            for (j, distance) in row.iter().enumerate() {
                sums[i] += distance;
                sums[j] += distance;
            }
        }
        let total = 0.5 * sums.iter().sum::<f64>();
        Self { rows, sums, total, sizes: [first as f64, (all.len() - first) as f64] }
    }

    /// The energy distances of divisions, given 1 for each member of their first set and 0 for the others. The sum over
    /// the pairs within the first set determines the other sums, given those of the rows.
    fn energies(&self, first: &[[f64; LANES]]) -> [f64; LANES] {
        let (mut within, mut touching) = ([0.0; LANES], [0.0; LANES]);
        for ((row, sum), is_member) in self.rows.iter().zip(&self.sums).zip(first) {
            let mut to_members = [0.0; LANES];
            for (distance, others) in row.iter().zip(first) {
                for lane in 0..LANES {
                    to_members[lane] += distance * others[lane];
                }
            }
            for lane in 0..LANES {
                within[lane] += is_member[lane] * to_members[lane];
                touching[lane] += is_member[lane] * sum;
            }
        }
        let [n, m] = self.sizes;
        std::array::from_fn(|lane| {
            let across = touching[lane] - 2.0 * within[lane];
            let others = self.total - within[lane] - across;
            2.0 * (across / (n * m) - within[lane] / (n * n) - others / (m * m))
        })
    }
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
