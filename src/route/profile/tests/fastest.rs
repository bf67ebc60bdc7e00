//! The fastest profile and the region: reference values, and an integration of the ramps that knows no closed form.

use super::shape::{Case, STOP, arc, circle, line, paper_path, random_case};
use crate::base::math::pow;
use crate::route::profile::{Infeasible, Limits, Stretch, optimal, region};

#[test]
fn durations_meet_the_reference_values() {
    let cases = [
        (paper_path(), circle(10.0, 2.0), 9.879_877_429_245_002_95),
        (paper_path(), circle(1.5, 0.8), 22.301_253_198_247_954_3),
        (vec![arc(90.0, 5.0)], circle(10.0, 2.0), 4.145_837_013_806_853_95),
        (vec![line(0.5), arc(90.0, 0.5), line(0.5)], circle(1.5, 0.8), 3.533_668_049_347_739_87),
    ];
    for (stretches, limits, duration) in cases {
        let found = optimal(&stretches, limits, 0.0, 0.0).unwrap().duration();
        assert!((found / duration - 1.0).abs() < 2e-15, "{found} {duration}");
    }
}

#[test]
fn speeds_at_joints_and_peaks_are_those_of_the_paper_path() {
    let optimum = optimal(&paper_path(), circle(10.0, 2.0), 0.0, 0.0).unwrap();
    let close = |found: Vec<f64>, squares: &[f64]| {
        assert_eq!(found.len(), squares.len());
        for (v, square) in found.iter().zip(squares) {
            assert!((v - square.sqrt()).abs() < 1e-14, "{v} {square}");
        }
    };
    close(optimum.node_speeds().collect(), &[0.0, 14.0, 14.0, 6.0, 6.0, 0.0]);
    close(optimum.peak_speeds().collect(), &[27.0, 14.0, 30.0, 6.0, 7.0]);
}

/// Where cell k of a stretch begins, as a share of its length: cells are small at both ends, where ramps are.
fn place(k: usize, cells: usize) -> f64 {
    let t = k as f64 / cells as f64;
    t * t * (3.0 - 2.0 * t)
}

/// u at the ends of the cells of one stretch, from a start value, with full effort: the classical method of Runge and Kutta.
fn integrated(u: f64, stretch: Stretch, limits: Limits, cells: usize, gain: f64) -> Vec<f64> {
    let bend = limits.across * stretch.radius;
    let cap = bend.min(limits.speed * limits.speed);
    let slope = |u: f64| {
        let share = (u / bend).clamp(0.0, 1.0);
        gain * 2.0 * limits.along * ((1.0 - share) * (1.0 + share)).sqrt()
    };
    let mut values = vec![u.min(cap)];
    let mut u = u.min(cap);
    for cell in 0..cells {
        let step = stretch.length * (place(cell + 1, cells) - place(cell, cells));
        let a = slope(u);
        let b = slope(u + 0.5 * step * a);
        let c = slope(u + 0.5 * step * b);
        let d = slope(u + step * c);
        u = (u + step * (a + 2.0 * b + 2.0 * c + d) / 6.0).clamp(0.0, cap);
        values.push(u);
    }
    values
}

/// u along the path: the ramps of all stretches one after the other.
fn chained(u: f64, stretches: &[Stretch], limits: Limits, cells: usize, gain: f64) -> Vec<Vec<f64>> {
    let mut u = u;
    let ramps = stretches.iter().map(|stretch| {
        let values = integrated(u, *stretch, limits, cells, gain);
        u = values[cells];
        values
    });
    ramps.collect()
}

fn backwards(u: f64, stretches: &[Stretch], limits: Limits, cells: usize, gain: f64) -> Vec<Vec<f64>> {
    let reversed: Vec<Stretch> = stretches.iter().rev().copied().collect();
    let mut ramps = chained(u, &reversed, limits, cells, gain);
    for ramp in &mut ramps {
        ramp.reverse();
    }
    ramps.reverse();
    ramps
}

/// The fastest profile by integration, at the ends of the cells of each stretch.
fn dense(case: &Case, cells: usize) -> Vec<Vec<f64>> {
    let Case { stretches, limits, start, end } = case;
    let forward = chained(start * start, stretches, *limits, cells, 1.0);
    let back = backwards(end * end, stretches, *limits, cells, 1.0);
    let least = |(a, b): (Vec<f64>, Vec<f64>)| a.into_iter().zip(b).map(|(a, b)| a.min(b)).collect();
    forward.into_iter().zip(back).map(least).collect()
}

/// The time of straight pieces in u.
fn dense_duration(case: &Case, cells: usize) -> f64 {
    let times = case.stretches.iter().zip(dense(case, cells)).map(|(stretch, values)| {
        let step = |cell| stretch.length * (place(cell + 1, cells) - place(cell, cells));
        let time = |(cell, w): (usize, &[f64])| 2.0 * step(cell) / (w[0].sqrt() + w[1].sqrt());
        values.windows(2).enumerate().map(time).sum::<f64>()
    });
    times.sum()
}

fn compare_with_integration(shapes: std::ops::Range<u64>, cells: usize) {
    for index in shapes {
        let case = random_case(index);
        let found = optimal(&case.stretches, case.limits, case.start, case.end).unwrap().duration();
        let error = (found / dense_duration(&case, cells) - 1.0).abs();
        assert!(error < 1e-7, "{index}: {error:e} {case:?}");
    }
}

#[test]
fn durations_agree_with_a_dense_integration() {
    compare_with_integration(0..200, 5000);
}

#[test]
#[ignore = "long: 10 000 shapes"]
fn durations_agree_with_a_dense_integration_on_many_shapes() {
    compare_with_integration(0..10_000, 8000);
}

#[test]
fn region_agrees_with_a_dense_integration() {
    const CELLS: usize = 2000;
    for index in 0..200 {
        let case = random_case(index);
        let Case { stretches, limits, start, end } = &case;
        let region = region(stretches, *limits, *start, *end).unwrap();
        let high = dense(&case, CELLS);
        let braked = chained(start * start, stretches, *limits, CELLS, -1.0);
        let needed = backwards(end * end, stretches, *limits, CELLS, -1.0);
        let mut begin = 0.0;
        for (k, stretch) in stretches.iter().enumerate() {
            for cell in (50..CELLS).step_by(100) {
                let x = begin + stretch.length * place(cell, CELLS);
                let square = limits.speed * limits.speed;
                let low = braked[k][cell].max(needed[k][cell]);
                let close = |v: f64, u: f64| (v * v - u).abs() < 2e-5 * square;
                assert!(close(region.highest(x), high[k][cell]), "{index} {x}");
                assert!(close(region.lowest(x), low), "{index} {x} {} {low}", region.lowest(x));
                assert!(region.lowest(x) <= region.highest(x) * (1.0 + 1e-9) + 1e-12);
                assert!(region.highest(x) <= region.limit(x) * (1.0 + 1e-12));
            }
            begin += stretch.length;
        }
    }
}

#[test]
fn motions_are_legal_and_their_own_derivatives() {
    for index in 0..300 {
        let case = random_case(index);
        let Case { stretches, limits, start, end } = &case;
        let optimum = optimal(stretches, *limits, *start, *end).unwrap();
        let duration = optimum.duration();
        let (first, last) = (optimum.motion(0.0), optimum.motion(duration));
        assert!((first.speed - start).abs() < 1e-7 && (last.speed - end).abs() < 1e-7, "{case:?}");
        assert!(first.distance < 1e-15 && (last.distance - optimum.length()).abs() < 1e-9);
        let (n, mut before) = (400, first);
        for k in 1..=n {
            let now = optimum.motion(duration * f64::from(k) / f64::from(n));
            let step = duration / f64::from(n);
            // Speeds rise and fall by no more than full effort, so the mean speed is bounded by the ends.
            let room = 0.5 * limits.along * step;
            let mean = (now.distance - before.distance) / step;
            assert!(mean <= before.speed.max(now.speed) + room && mean >= before.speed.min(now.speed) - room);
            assert!((now.speed - before.speed).abs() <= limits.along * step * (1.0 + 1e-9) + 1e-12);
            assert!((optimum.speed_at(now.distance) - now.speed).abs() < 1e-6 * limits.speed, "{index} {k}");
            let mut rest = now.distance;
            let at = stretches.iter().find(|stretch| {
                rest -= stretch.length;
                rest < 0.0
            });
            let at = at.unwrap_or(&stretches[stretches.len() - 1]);
            // Beside a joint rounding decides in which stretch a place lies.
            if rest < -1e-9 && rest + at.length > 1e-9 {
                let across = now.speed * now.speed / at.radius / limits.across;
                let norm = across * across + pow(now.acceleration / limits.along, 2.0);
                assert!(norm <= 1.0 + 1e-9, "{index} {k}: {norm}");
            }
            assert!(now.speed <= limits.speed * (1.0 + 1e-12));
            before = now;
        }
    }
}

#[test]
fn infeasible_ends_are_named_with_the_largest_speed() {
    let limits = circle(10.0, 2.0);
    // v^2 = 2 · 2 · 4 from rest over 4 m.
    let start = optimal(&[line(4.0)], limits, 5.0, 0.0).unwrap_err();
    assert_eq!(start, Infeasible::Start { speed: 5.0, largest: 4.0 });
    assert_eq!(
        optimal(&[line(4.0)], limits, 0.0, 5.0).unwrap_err(),
        Infeasible::End { speed: 5.0, largest: 4.0 }
    );
    assert!(matches!(optimal(&[line(4.0)], limits, -1.0, 0.0), Err(Infeasible::Start { .. })));
    assert!(matches!(optimal(&[line(4.0)], limits, f64::NAN, 0.0), Err(Infeasible::Start { .. })));
    assert!(matches!(optimal(&[line(-4.0)], limits, 0.0, 0.0), Err(Infeasible::Stretch { index: 0 })));
    assert!(matches!(optimal(&[line(4.0)], circle(0.0, 1.0), 0.0, 0.0), Err(Infeasible::Limits)));
    for index in 0..500 {
        let Case { stretches, limits, start, .. } = random_case(index);
        let Err(Infeasible::End { largest, .. }) = optimal(&stretches, limits, start, 1e3) else { panic!() };
        assert!(optimal(&stretches, limits, start, largest).is_ok());
        assert!(optimal(&stretches, limits, start, largest * (1.0 + 1e-9)).is_err());
        if let Err(Infeasible::Start { largest, .. }) = optimal(&stretches, limits, 1e3, 0.0) {
            assert!(optimal(&stretches, limits, largest, 0.0).is_ok());
            assert!(optimal(&stretches, limits, largest * (1.0 + 1e-9), 0.0).is_err());
        }
    }
}

#[test]
fn stops_split_a_path_and_empty_stretches_change_nothing() {
    let limits = circle(1.5, 0.8);
    let alone = |stretches: &[Stretch]| optimal(stretches, limits, 0.0, 0.0).unwrap().duration();
    let (a, b) = ([line(2.0), arc(30.0, 1.0)], [line(0.7)]);
    let joined = [STOP, a[0], a[1], STOP, STOP, b[0], STOP];
    assert!((alone(&joined) - alone(&a) - alone(&b)).abs() < 1e-12);
    let flat = Stretch { length: 0.0, radius: 0.01 };
    assert_eq!(alone(&[flat, a[0], flat, a[1], flat]), alone(&a));
    // Halves of a stretch are the stretch.
    let halves = [line(1.0), line(1.0), arc(15.0, 1.0), arc(15.0, 1.0)];
    assert!((alone(&halves) / alone(&a) - 1.0).abs() < 1e-14);
    let nowhere = optimal(&[], limits, 0.5, 0.5).unwrap();
    assert_eq!((nowhere.duration(), nowhere.motion(1.0).speed, nowhere.speed_at(0.0)), (0.0, 0.5, 0.5));
    assert!(optimal(&[], limits, 0.5, 0.0).is_err() && optimal(&[STOP], limits, 0.5, 0.5).is_err());
    assert_eq!(alone(&[STOP]), 0.0);
}
