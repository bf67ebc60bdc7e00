//! Two sets of walks compared: clouds of points as Agethen et al. (2018, section 5.2) do, and measures that see order, shape
//! and time, which a cloud does not.
//!
//! Points of a cloud that lie densely are near each other whatever walks they come from. So distances between clouds are
//! reported both ways, beside those between two halves of the first set.

mod nearest;
#[cfg(test)]
mod tests;

use crate::data::walks::Walk;
use crate::stats::twosample::{
    Draws, EnergyTest, KolmogorovSmirnov, SignedRank, SpreadRatio, Summary, energy_test, kolmogorov_smirnov,
    normality, signed_rank, spread_ratio,
};
use nearest::Tree;
use std::collections::{BTreeMap, BTreeSet};

/// Points of a path in the vector of its walk.
pub const POINTS: usize = 16;
/// Permutations of an energy distance.
pub const SHUFFLES: u32 = 999;
/// Resamples of a bootstrap.
pub const RESAMPLES: u32 = 999;
/// Confidence of its interval.
pub const CONFIDENCE: f64 = 0.95;
/// Walks of a set between which the energy distance is taken, at most; of more, every second, third, ...
pub const MOST_WALKS: usize = 2000;

/// A number of each walk in both sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// In both sets.
    pub sets: [Summary; 2],
    /// Whether it has one law in both.
    pub test: KolmogorovSmirnov,
    /// Interquartile range of the second set over that of the first; none where that is 0.
    pub spread: Option<SpreadRatio>,
    /// Of pairs of walks, the second less the first.
    pub paired: Option<SignedRank>,
}

/// What a comparison of two sets gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The leg whose walks are compared; none for all walks.
    pub leg: Option<String>,
    /// Distance of each point of a set to the nearest one of the other, set by set, walk by walk, m.
    pub distances: [Vec<f64>; 2],
    /// Whether those of the first set have a normal law, with their own mean and deviation (Kolmogorov and Smirnov), as the paper
    /// asks. The points of a walk depend on each other, so p is too small.
    pub normality: KolmogorovSmirnov,
    /// The same in numbers, m.
    pub clouds: [Summary; 2],
    /// Distances between the points of two random halves of the walks of the first set, both ways, m.
    pub halves: Summary,
    /// Energy distance of the paths, m: two paths are as far apart as their points are, in the root of the mean square.
    pub path: EnergyTest,
    /// The same with the durations as a coordinate, in metres at the mean speed of both sets.
    pub pace: EnergyTest,
    /// Length, m.
    pub length: Measure,
    /// Duration, s.
    pub duration: Measure,
}

/// The comparison of all walks and of the walks of each leg.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparisons {
    /// All walks.
    pub whole: Comparison,
    /// Each leg, where walks have them, in the order of their names.
    pub legs: Vec<Comparison>,
    /// Legs with fewer than two walks in a set, and how many there are.
    pub left_out: Vec<(String, [usize; 2])>,
}

/// Two candidates against each other: which is nearer to the base (the signed rank test of Wilcoxon).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rivals {
    /// Their numbers, from 0.
    pub candidates: [usize; 2],
    /// Of each point of the base: its distance to the second candidate, less that to the first, m. As the paper does; the points of
    /// a walk depend on each other, so p is too small.
    pub points: SignedRank,
    /// The same of each walk of the base, in the mean over its points.
    pub walks: SignedRank,
}

/// All pairs of candidates.
pub fn rivals(base: &[Walk], found: &[&Comparison]) -> Vec<Rivals> {
    let pairs = (0..found.len()).flat_map(|i| (i + 1..found.len()).map(move |j| [i, j]));
    let rival = |[i, j]: [usize; 2]| {
        let both = found[i].distances[0].iter().zip(&found[j].distances[0]);
        let differences: Vec<f64> = both.map(|(one, other)| other - one).collect();
        let mut rest = differences.as_slice();
        let means = base.iter().map(|walk| {
            let (own, others) = rest.split_at(walk.points.len());
            rest = others;
            own.iter().sum::<f64>() / own.len() as f64
        });
        let means: Vec<f64> = means.collect();
        Rivals { candidates: [i, j], points: signed_rank(&differences), walks: signed_rank(&means) }
    };
    pairs.map(rival).collect()
}

/// Compares all walks, and those of each leg. Each set has at least two walks.
pub fn compare(a: &[Walk], b: &[Walk], is_paired: bool, seed: u64) -> Comparisons {
    let on = |leg: Option<&str>| {
        [a, b].map(|set| set.iter().filter(|walk| walk.leg.as_deref() == leg).collect::<Vec<_>>())
    };
    let names: BTreeSet<&str> = a.iter().chain(b).filter_map(|walk| walk.leg.as_deref()).collect();
    let (mut legs, mut left_out) = (Vec::new(), Vec::new());
    for leg in names {
        let sets = on(Some(leg));
        if sets.iter().all(|set| set.len() > 1) {
            let found = between([&sets[0], &sets[1]], is_paired, seed);
            legs.push(Comparison { leg: Some(leg.to_owned()), ..found });
        } else {
            left_out.push((leg.to_owned(), sets.map(|set| set.len())));
        }
    }
    let all = [a, b].map(|set| set.iter().collect::<Vec<_>>());
    Comparisons { whole: between([&all[0], &all[1]], is_paired, seed), legs, left_out }
}

/// Pairs of walks with one name, on one leg.
fn pairs<'w>([a, b]: [&[&'w Walk]; 2]) -> Vec<[&'w Walk; 2]> {
    let second: BTreeMap<_, _> = b.iter().map(|walk| ((&walk.leg, &walk.name), *walk)).collect();
    a.iter().filter_map(|walk| Some([*walk, *second.get(&(&walk.leg, &walk.name))?])).collect()
}

/// Whether a walk has a counterpart with its name, on its leg.
pub fn has_pairs(a: &[Walk], b: &[Walk]) -> bool {
    !pairs([&a.iter().collect::<Vec<_>>(), &b.iter().collect::<Vec<_>>()]).is_empty()
}

fn between(sets: [&[&Walk]; 2], is_paired: bool, seed: u64) -> Comparison {
    let [a, b] = sets;
    let draws = |procedure| Draws { seed, procedure };
    let distances = [distances(a, b), distances(b, a)];
    let chosen = draws(0).subset(0, a.len() / 2, a.len());
    let half = |is_chosen| -> Vec<&Walk> {
        (0..a.len()).filter(|k| chosen.binary_search(k).is_ok() == is_chosen).map(|k| a[k]).collect()
    };
    let (one, other) = (half(true), half(false));
    let halves = [self::distances(&one, &other), self::distances(&other, &one)].concat();
    let pairs = if is_paired { pairs(sets) } else { Vec::new() };
    let measure = |of: fn(&Walk) -> f64, procedure| {
        let values = sets.map(|set| set.iter().map(|walk| of(walk)).collect::<Vec<f64>>());
        let differences: Vec<f64> = pairs.iter().map(|[one, other]| rounded(of(other) - of(one))).collect();
        let [first, second] = &values;
        Measure {
            sets: [Summary::of(first), Summary::of(second)],
            test: kolmogorov_smirnov(first, second),
            spread: spread_ratio(first, second, CONFIDENCE, RESAMPLES, draws(procedure)),
            paired: is_paired.then(|| signed_rank(&differences)),
        }
    };
    // Of both sets together, so that a permutation changes no vector.
    let total = |of: fn(&Walk) -> f64| a.iter().chain(b).map(|walk| of(walk)).sum::<f64>();
    let speed = total(Walk::length) / total(Walk::duration);
    let energy = |speed: f64, procedure| {
        let [a, b] = sets.map(|set| {
            let some = set.iter().step_by(set.len().div_ceil(MOST_WALKS).max(1));
            some.map(|walk| vector(walk, speed)).collect::<Vec<_>>()
        });
        energy_test(&a, &b, SHUFFLES, draws(procedure))
    };
    Comparison {
        leg: None,
        normality: normality(&distances[0]),
        clouds: [Summary::of(&distances[0]), Summary::of(&distances[1])],
        distances,
        halves: Summary::of(&halves),
        path: energy(0.0, 3),
        pace: energy(speed, 4),
        length: measure(|walk| rounded(walk.length()), 1),
        duration: measure(duration, 2),
    }
}

/// A walk as a vector, m: points of its path, so that the distance of two vectors is that of points in the root of the mean
/// square, and the way that `speed` makes in its time.
fn vector(walk: &Walk, speed: f64) -> Vec<f64> {
    let share = 1.0 / (POINTS as f64).sqrt();
    let points = walk.resampled(POINTS);
    points.iter().flat_map(|p| [share * p.x, share * p.y]).chain([speed * duration(walk)]).collect()
}

/// A number to nine decimals: without the rounding of the sum or difference that gave it, so that equal numbers tie.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

/// The duration of a walk to nine decimals; to six where the clock counts from 1970, whose times have no more.
fn duration(walk: &Walk) -> f64 {
    let is_late = walk.times.last().is_some_and(|time| time.abs() > 1e6);
    if is_late { (walk.duration() * 1e6).round() / 1e6 } else { rounded(walk.duration()) }
}

/// The distance of each point of some walks to the nearest point of others.
fn distances(from: &[&Walk], to: &[&Walk]) -> Vec<f64> {
    let tree = Tree::new(to.iter().flat_map(|walk| walk.points.iter().copied()).collect());
    from.iter().flat_map(|walk| &walk.points).map(|p| tree.distance(*p)).collect()
}
