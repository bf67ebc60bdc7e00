//! The traps of comparing clouds: synthetic walks that differ in one thing each.

#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "tests may use the platform's functions")]

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
        let (way, turn) = (goal - start, std::f64::consts::TAU * stream.uniform(3));
        let across = Vec2::new(-way.y, way.x) / way.norm();
        let rows = (way.norm() / speed * 60.0) as u32;
        let times: Vec<f64> = (0..=rows).map(|k| f64::from(k) / 60.0).collect();
        let at = |t: &f64| {
            let swing = sway * sin_cos(turn + std::f64::consts::TAU * 0.9 * t).0;
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
    let of =
        |k: u64| compare(&walks(2 * k, 14, POPULATION), &walks(2 * k + 1, 14, POPULATION), false, k).whole;
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
    let pairs =
        |k: u64| compare(&walks(2 * k, 40, POPULATION), &walks(2 * k + 1, 40, POPULATION), false, k).whole;
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
        ("goal shifted by 5 cm", 1, Kind { shift: 0.05 / std::f64::consts::SQRT_2, ..POPULATION }),
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

/// Equal walks stay equal when their clocks and places begin elsewhere.
#[test]
fn shifted_clocks_and_places_do_not_part_equal_walks() {
    let set = |time: f64, place: f64, long: &[u32]| -> Vec<Walk> {
        let walk = |(number, rows): (usize, &u32)| {
            let parts = (0..=*rows).map(|k| f64::from(k) / 10.0);
            let points = parts.clone().map(|part| Vec2::new(place + part, 0.0)).collect();
            Walk {
                name: number.to_string(),
                times: parts.map(|part| time + part).collect(),
                points,
                ..Walk::default()
            }
        };
        long.iter().enumerate().map(walk).collect()
    };
    for (time, place, long) in [
        (0.1, 0.0, [3; 12]),
        (7.7, 0.0, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]),
        (1.7e9, 0.3, [3, 3, 3, 4, 4, 4, 5, 5, 5, 6, 6, 6]),
    ] {
        let found = compare(&set(0.0, place, &long), &set(time, place, &long), true, 0).whole;
        for measure in [&found.length, &found.duration] {
            assert_eq!(measure.test.p, 1.0, "{time} {measure:?}");
            assert_eq!(measure.paired.unwrap().equal, 12, "{time} {measure:?}");
        }
        assert_eq!((found.path.p, found.pace.p), (1.0, 1.0), "{time} {:?}", found.pace);
    }
    // Half of the walks take one row longer, half one row less: all differences have one size.
    let long = [3, 4, 5, 6, 7, 8];
    let other = [4, 3, 6, 5, 8, 7];
    let found = compare(&set(0.0, 0.0, &long), &set(0.3, 0.0, &other), true, 0).whole;
    assert_eq!(found.duration.paired.unwrap().w, 10.5);
    assert_eq!(found.length.paired.unwrap().w, 10.5);
}
