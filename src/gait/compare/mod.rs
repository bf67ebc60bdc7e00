//! Two sets of walks compared: clouds of points as Agethen et al. (2018, section 5.2) do, and measures that see order, shape
//! and time, which a cloud does not.
//!
//! Points of a cloud that lie densely are near each other whatever walks they come from. So distances between clouds are
//! reported both ways, beside those between two halves of the first set.

mod nearest;

use crate::data::walks::Walk;
use crate::stats::twosample::{
    Draws, EnergyTest, KolmogorovSmirnov, SignedRank, SpreadRatio, Summary, energy_test, kolmogorov_smirnov,
    signed_rank, spread_ratio,
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
        let differences: Vec<f64> = pairs.iter().map(|[one, other]| of(other) - of(one)).collect();
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
        clouds: [Summary::of(&distances[0]), Summary::of(&distances[1])],
        distances,
        halves: Summary::of(&halves),
        path: energy(0.0, 3),
        pace: energy(speed, 4),
        length: measure(Walk::length, 1),
        duration: measure(Walk::duration, 2),
    }
}

/// A walk as a vector, m: points of its path, so that the distance of two vectors is that of points in the root of the mean
/// square, and the way that `speed` makes in its time.
fn vector(walk: &Walk, speed: f64) -> Vec<f64> {
    let share = 1.0 / (POINTS as f64).sqrt();
    let points = walk.resampled(POINTS);
    points.iter().flat_map(|p| [share * p.x, share * p.y]).chain([speed * walk.duration()]).collect()
}

/// The distance of each point of some walks to the nearest point of others.
fn distances(from: &[&Walk], to: &[&Walk]) -> Vec<f64> {
    let tree = Tree::new(to.iter().flat_map(|walk| walk.points.iter().copied()).collect());
    from.iter().flat_map(|walk| &walk.points).map(|p| tree.distance(*p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::geometry::Vec2;
    use crate::base::math::sin_cos;
    use crate::base::random::{Purpose, Stream, TrialKey};

    /// How walks of 2.3 m differ from those of the population.
    #[derive(Clone, Copy)]
    struct Kind {
        sway: f64,
        scatter: f64,
        shift: f64,
        slower: f64,
    }

    const POPULATION: Kind = Kind { sway: 1.0, scatter: 1.0, shift: 0.0, slower: 1.0 };
    const STRAIGHT: Kind = Kind { sway: 0.0, scatter: 0.0, ..POPULATION };

    /// Walks with a normal scatter of 10 cm of start and goal, a sway of 2 cm at 0.9 Hz and a speed of 1.1 m/s, at 60 Hz.
    fn walks(sample: u64, count: u32, kind: Kind) -> Vec<Walk> {
        let walk = |number: u32| {
            let stream = Stream::of(TrialKey { seed: 11, index: sample, branch: 0 }, number, Purpose::Test);
            let place = |draw| Vec2::from(stream.normal_pair(draw)) * (0.1 * kind.scatter);
            let (start, goal) = (place(0), place(1) + Vec2::new(2.3 + kind.shift, kind.shift));
            let [pace, amplitude] = stream.normal_pair(2);
            let speed = 1.1 * (1.0 + 0.08 * pace * kind.scatter) / kind.slower;
            let sway = 0.02 * (1.0 + 0.2 * amplitude) * kind.sway;
            let (way, turn) = (goal - start, 6.283 * stream.uniform(3));
            let across = Vec2::new(-way.y, way.x) / way.norm();
            let rows = (way.norm() / speed * 60.0) as u32;
            let times: Vec<f64> = (0..=rows).map(|k| f64::from(k) / 60.0).collect();
            let at = |t: &f64| {
                let swing = sway * sin_cos(turn + 6.283 * 0.9 * t).0;
                start + way * (t * speed / way.norm()) + across * swing
            };
            let points = times.iter().map(at).collect();
            Walk { name: number.to_string(), leg: None, line: 0, times, points }
        };
        (0..count).map(walk).collect()
    }

    /// Cloud-to-cloud medians hardly see what the other measures do: the traps of the metric.
    #[test]
    fn what_clouds_miss_the_other_measures_see() {
        let captured = walks(0, 80, POPULATION);
        let of = |kind| compare(&captured, &walks(1, 80, kind), false, 0).whole;
        let same = of(POPULATION);
        assert!(same.path.p > 0.05 && same.pace.p > 0.05, "{:?} {:?}", same.path, same.pace);
        assert!(same.length.test.p > 0.05 && same.duration.test.p > 0.05);
        let ratio = same.length.spread.unwrap();
        assert!(ratio.low < 1.0 && ratio.high > 1.0, "{ratio:?}");
        let [_, near] = same.clouds;
        // One line: every point of it is near a captured one, but not the other way.
        let line = of(STRAIGHT);
        assert!(line.clouds[1].median < near.median, "{:?}", line.clouds);
        assert!(line.clouds[0].median > 10.0 * near.median && line.path.p == 0.001, "{:?}", line.path);
        assert_eq!(line.length.spread.unwrap().high, 0.0);
        // Half the scatter.
        let narrow = of(Kind { scatter: 0.5, ..POPULATION });
        assert!(narrow.clouds[1].median < near.median && narrow.path.p < 0.01, "{:?}", narrow.path);
        assert!(narrow.clouds[0].p95 > 3.0 * same.clouds[0].p95);
        assert!(narrow.length.spread.unwrap().high < 0.9, "{:?}", narrow.length.spread);
        // A goal 5 cm farther and to the left.
        let shifted = of(Kind { shift: 0.05, ..POPULATION });
        assert!(shifted.clouds[1].median < 1.3 * near.median && shifted.path.p < 0.01, "{:?}", shifted.path);
        // Slower walks: only measures with time see them.
        let slow = of(Kind { slower: 1.2, ..POPULATION });
        assert!(slow.clouds[1].median < 1.3 * near.median && slow.path.p > 0.05, "{:?}", slow.path);
        assert!(slow.pace.p == 0.001 && slow.duration.test.p < 1e-6 && slow.length.test.p > 0.05);
    }

    /// Two samples of one population: p has no reason to be small.
    #[test]
    fn samples_of_one_population_are_alike() {
        let of = |k: u64| {
            compare(&walks(2 * k, 14, POPULATION), &walks(2 * k + 1, 14, POPULATION), false, k).whole
        };
        let all: Vec<Comparison> = (0..20).map(of).collect();
        let shares = |of: fn(&Comparison) -> f64| {
            let small = all.iter().filter(|one| of(one) <= 0.1).count();
            let mean = all.iter().map(of).sum::<f64>() / all.len() as f64;
            // Of 20 uniform numbers, more than 6 are below 0.1 once in 400 times; the mean has a deviation of 0.065.
            assert!(small <= 6 && (mean - 0.5).abs() < 0.2, "{small} of 20, {mean}");
        };
        shares(|one| one.path.p);
        shares(|one| one.pace.p);
        shares(|one| one.length.test.p);
        shares(|one| one.duration.test.p);
    }

    #[test]
    fn pairs_and_legs_are_found_by_name() {
        let on = |leg: &str, walks: Vec<Walk>| -> Vec<Walk> {
            walks.into_iter().map(|walk| Walk { leg: Some(leg.to_owned()), ..walk }).collect()
        };
        let (short, slow) = (walks(0, 9, POPULATION), walks(0, 8, Kind { slower: 1.2, ..POPULATION }));
        let a = [on("1", short.clone()), on("2", short[..2].to_vec())].concat();
        let b = [on("2", slow[..1].to_vec()), on("1", slow.clone()), on("3", slow[..3].to_vec())].concat();
        let found = compare(&a, &b, true, 0);
        assert_eq!(found.left_out, [("2".to_owned(), [2, 1]), ("3".to_owned(), [0, 3])]);
        let [leg] = found.legs.as_slice() else { panic!("{:?}", found.legs) };
        let paired = leg.duration.paired.unwrap();
        // All eight are slower: 2 / 2^8 on both sides.
        assert_eq!((leg.leg.as_deref(), paired.pairs, paired.p), (Some("1"), 8, 2.0 / 256.0));
        assert_eq!(found.whole.duration.paired.unwrap().pairs, 9);
        assert_eq!(compare(&short, &slow, false, 0).whole.length.paired, None);
        let points = |set: &[Walk]| set.iter().map(|walk| walk.points.len()).sum::<usize>();
        assert_eq!(found.whole.distances.each_ref().map(Vec::len), [points(&a), points(&b)]);
    }

    /// The table of `docs/gait.md`.
    #[test]
    #[ignore = "prints a table"]
    fn table_of_traps() {
        let pairs = |k: u64| {
            compare(&walks(2 * k, 40, POPULATION), &walks(2 * k + 1, 40, POPULATION), false, k).whole
        };
        let all: Vec<Comparison> = (100..300).map(pairs).collect();
        for level in [0.05, 0.25, 0.5, 0.75] {
            let share =
                |of: fn(&Comparison) -> f64| all.iter().filter(|one| of(one) <= level).count() as f64 / 200.0;
            println!(
                "{level}: {} {} {}",
                share(|one| one.path.p),
                share(|one| one.pace.p),
                share(|one| one.length.test.p)
            );
        }
        let captured = walks(0, 400, POPULATION);
        let points: usize = captured.iter().map(|walk| walk.points.len()).sum();
        println!("{points} points");
        for (name, sample, kind) in [
            ("second sample of the population", 1, POPULATION),
            ("sway removed", 1, Kind { sway: 0.0, ..POPULATION }),
            ("sway doubled", 1, Kind { sway: 2.0, ..POPULATION }),
            ("goal shifted by 5 cm", 1, Kind { shift: 0.05 / 1.414_213_562, ..POPULATION }),
            ("20 % slower", 1, Kind { slower: 1.2, ..POPULATION }),
            ("half the scatter", 1, Kind { scatter: 0.5, ..POPULATION }),
            ("one straight line, 400 times", 1, STRAIGHT),
        ] {
            let one = compare(&captured, &walks(sample, 400, kind), false, 0).whole;
            let mm = |x: f64| format!("{:.1}", 1e3 * x);
            let ratio = one.length.spread.unwrap();
            println!(
                "| {name} | {} | {} | {} | {} | {:.2} [{:.2}, {:.2}] | {:.1e} | {:.1e} | {}, {:.3} | {}, {:.3} |",
                mm(one.clouds[1].median),
                mm(one.clouds[0].median),
                mm(one.clouds[0].p95),
                mm(one.halves.median),
                ratio.ratio,
                ratio.low,
                ratio.high,
                one.length.test.p,
                one.duration.test.p,
                mm(one.path.distance),
                one.path.p,
                mm(one.pace.distance),
                one.pace.p
            );
        }
    }
}
