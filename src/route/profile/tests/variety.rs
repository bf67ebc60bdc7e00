//! Varied profiles against the limits, in terms of the path alone.

use super::shape::{Case, STOP, arc, circle, line, paper_path, random_case, stream};
use crate::base::math::pow;
use crate::route::profile::{Infeasible, Law, Limits, Stretch, Varied, Variety, optimal, varied};

/// A limit counts as broken if it is exceeded by more than this share.
const ROUNDING: f64 = 1e-9;

fn with(pieces: usize, law: Law) -> Variety {
    Variety { pieces, floor: 0.1, law }
}

const WALK: Law = Law::Preferred { speed: 1.34, spread: 0.2 };

fn drawn(case: &Case, variety: &Variety, index: u64) -> Result<Varied, Infeasible> {
    let Case { stretches, limits, start, end } = case;
    let stream = stream(index, 2);
    varied(stretches, *limits, *start, *end, variety, |k| stream.uniform_pair(k))
}

/// Which limits a profile of straight pieces in u breaks. On the overlap of a piece and a stretch u and its slope are
/// largest at an end, so the ends are enough.
fn broken(profile: &Varied, stretches: &[Stretch], limits: Limits) -> Option<String> {
    let top = limits.speed * limits.speed;
    let knots = profile.knots();
    for pair in knots.windows(2) {
        let [(x, u), (to, u_to)] = [pair[0], pair[1]];
        if to <= x || u < 0.0 || u_to < 0.0 {
            return Some(format!("knots fall or u is negative: {pair:?}"));
        }
        if u + u_to <= 0.0 {
            return Some(format!("a piece that takes forever: {pair:?}"));
        }
        let slope = (u_to - u) / (to - x);
        if slope.abs() > 2.0 * limits.along * (1.0 + ROUNDING) {
            return Some(format!("along: {slope} at {x}"));
        }
        let mut begin = 0.0;
        for stretch in stretches {
            let end = begin + stretch.length;
            for place in [begin.max(x), end.min(to)] {
                if begin.max(x) >= end.min(to) {
                    continue;
                }
                let here = u + slope * (place - x);
                let across = here / stretch.radius / limits.across;
                let norm = across * across + pow(0.5 * slope / limits.along, 2.0);
                if here > top * (1.0 + ROUNDING) || norm > 1.0 + ROUNDING {
                    return Some(format!("u {here} of {top}, norm {norm} at {place}"));
                }
            }
            begin = end;
        }
    }
    None
}

/// A random path with a random variety, half of them with stops.
fn random_variety(index: u64) -> (Case, Variety) {
    let mut case = random_case(index);
    let [a, b] = stream(index, 3).uniform_pair(0);
    let [c, d] = stream(index, 3).uniform_pair(1);
    if a < 0.3 {
        case.stretches.push(STOP);
        case.stretches.extend([line(0.3 + 3.0 * a), STOP, arc(100.0 * b + 1.0, 0.5 + b), line(b)]);
        case.end = 0.0;
        // The end of the first part changed; start at rest where the old start speed is too large for that.
        if optimal(&case.stretches, case.limits, case.start, 0.0).is_err() {
            case.start = 0.0;
        }
    }
    let law = if c < 0.5 { Law::Uniform } else { Law::Preferred { speed: 3.0 * d, spread: a } };
    let pieces = 2 + (b * if d < 0.1 { 63.0 } else { 9.0 }) as usize;
    (case, Variety { pieces, floor: if c < 0.25 { 0.02 } else { 0.1 }, law })
}

fn count_violations(shapes: std::ops::Range<u64>, draws: u64) {
    let (mut refused, mut rested_refused, mut refined, mut total) = (0, 0, 0, 0);
    for shape in shapes {
        let (case, variety) = random_variety(shape);
        let at_rest = case.start == 0.0 && case.end == 0.0;
        let parts = case.stretches.split(|s| *s == STOP).filter(|part| !part.is_empty()).count();
        for draw in 0..draws {
            total += 1;
            match drawn(&case, &variety, shape * 1000 + draw) {
                Err(why) => {
                    assert_eq!(why, Infeasible::Tight, "{shape}");
                    refused += 1;
                    rested_refused += u64::from(at_rest);
                }
                Ok(profile) => {
                    let found = broken(&profile, &case.stretches, case.limits);
                    assert!(found.is_none(), "{shape} {draw}: {found:?} {case:?} {variety:?} {profile:?}");
                    let knots = profile.knots();
                    let exact = variety.pieces.max(2 * parts);
                    assert!(knots.len() > exact, "{shape} {draw}");
                    refined += u64::from(knots.len() > exact + 1);
                    assert!(!at_rest || knots.len() == exact + 1, "{shape} {draw}");
                    assert!(profile.duration().is_finite());
                    let ends = [knots[0].1.sqrt(), knots[knots.len() - 1].1.sqrt()];
                    assert!((ends[0] - case.start).abs() < 1e-9 && (ends[1] - case.end).abs() < 1e-9);
                }
            }
        }
    }
    assert_eq!(rested_refused, 0);
    assert!(refined > 0);
    // Only start speeds at the very edge have no profile of straight pieces.
    assert!(refused * 100 < total, "{refused} of {total}");
}

#[test]
fn varied_profiles_break_no_limit() {
    count_violations(0..2000, 10);
}

#[test]
#[ignore = "long: a million draws"]
fn a_million_varied_profiles_break_no_limit() {
    count_violations(100_000..150_000, 20);
}

#[test]
fn varied_profiles_take_from_the_least_time_to_the_bound_of_the_floor() {
    for (speed, acceleration) in [(10.0, 2.0), (1.5, 0.8)] {
        let case =
            Case { stretches: paper_path(), limits: circle(speed, acceleration), start: 0.0, end: 0.0 };
        let least = optimal(&case.stretches, case.limits, 0.0, 0.0).unwrap().duration();
        let durations = |law| {
            let mut found: Vec<f64> = (0..3000)
                .map(|k| {
                    let pieces = 3 + (stream(k, 4).uniform(0) * 8.0) as usize;
                    drawn(&case, &with(pieces, law), k).unwrap().duration() / least
                })
                .collect();
            found.sort_by(f64::total_cmp);
            found
        };
        let uniform = durations(Law::Uniform);
        assert!(uniform[0] >= 1.0 && uniform[2999] < 8.0, "{} {}", uniform[0], uniform[2999]);
        // The medians of an independent program, whose floor is a share of another profile.
        let expected = if speed > 5.0 { 1.89 } else { 1.76 };
        assert!((uniform[1500] / expected - 1.0).abs() < 0.05, "{}", uniform[1500]);
        // Walkers with a preferred speed.
        let preferred = durations(Law::Preferred { speed: 1.34, spread: 0.1 });
        if speed < 5.0 {
            assert!(preferred[1500] < 1.4 && preferred[1500] > 1.1, "{}", preferred[1500]);
        }
    }
}

#[test]
fn a_varied_profile_moves_as_its_knots_say() {
    for index in 0..500 {
        let (case, variety) = random_variety(index);
        let Ok(profile) = drawn(&case, &variety, index) else { continue };
        let knots = profile.knots();
        let duration = profile.duration();
        let n = 200;
        let mut before = profile.motion(0.0);
        for k in 1..=n {
            let now = profile.motion(duration * f64::from(k) / f64::from(n));
            let at = knots.partition_point(|(x, _)| *x < now.distance).clamp(1, knots.len() - 1);
            let ((x, u), (to, u_to)) = (knots[at - 1], knots[at]);
            let expected = u + (u_to - u) * (now.distance - x) / (to - x);
            let scale = u.max(u_to);
            assert!((now.speed * now.speed - expected).abs() < 1e-7 * scale, "{index} {k}");
            let step = duration / f64::from(n);
            let gained = now.distance - before.distance;
            let room = 0.5 * case.limits.along * step;
            assert!(gained >= 0.0 && gained / step <= now.speed.max(before.speed) + room);
            before = now;
        }
        assert!((before.distance - knots[knots.len() - 1].0).abs() < 1e-9);
    }
}

#[test]
fn a_profile_can_be_scaled_to_any_longer_time() {
    let case = random_case(5);
    let profile = drawn(&case, &with(6, WALK), 1).unwrap();
    let duration = profile.duration();
    for factor in [1.0, 1.1, 3.7] {
        let slower = profile.scaled_to(duration * factor).unwrap();
        assert_eq!(slower.duration(), duration * factor);
        assert!(broken(&slower, &case.stretches, case.limits).is_none());
        let (a, b) = (profile.motion(0.4 * duration), slower.motion(0.4 * duration * factor));
        assert!((a.distance - b.distance).abs() < 1e-9 && (a.speed / factor - b.speed).abs() < 1e-9);
    }
    assert!(profile.scaled_to(0.9 * duration).is_none() && profile.scaled_to(f64::NAN).is_none());
}

#[test]
fn pieces_are_shared_among_the_parts_between_stops() {
    let stretches = vec![line(8.0), STOP, line(1.0), STOP, STOP, line(4.0), STOP];
    let case = Case { stretches, limits: circle(1.5, 0.8), start: 0.0, end: 0.0 };
    for (pieces, expected) in [(0, 6), (2, 6), (6, 6), (7, 7), (13, 13), (64, 64)] {
        let profile = drawn(&case, &with(pieces, WALK), 3).unwrap();
        assert_eq!(profile.knots().len(), expected + 1);
        let at_stops = profile.knots().iter().filter(|(_, u)| *u == 0.0);
        assert_eq!(at_stops.map(|(x, _)| *x).collect::<Vec<_>>(), [0.0, 8.0, 9.0, 13.0]);
    }
}

#[test]
fn a_draw_belongs_to_its_knot() {
    // Another number at one knot changes no speed before it.
    let case = Case { stretches: vec![line(20.0)], limits: circle(1.5, 0.8), start: 0.0, end: 0.0 };
    let profile = |changed: u32| {
        let draw = |k| [0.5, if k == changed { 0.9 } else { 0.2 }];
        varied(&case.stretches, case.limits, 0.0, 0.0, &with(10, WALK), draw).unwrap()
    };
    let (a, b) = (profile(0), profile(6));
    assert_eq!(a.knots()[..6], b.knots()[..6]);
    assert!(b.knots()[6].1 > a.knots()[6].1);
}

#[test]
fn end_speeds_at_their_largest_are_joined_on_lines() {
    let limits = circle(10.0, 2.0);
    let case = |start, end| Case { stretches: vec![line(4.0), line(2.0)], limits, start, end };
    // Full braking from 4.898… m/s, and full acceleration up to it, leave one profile each.
    let full = 24f64.sqrt();
    for case in [case(full, 0.0), case(0.0, full), case(1.0, 25f64.sqrt())] {
        let profile = drawn(&case, &with(5, Law::Uniform), 2).unwrap();
        assert!(broken(&profile, &case.stretches, limits).is_none());
        let least = optimal(&case.stretches, limits, case.start, case.end).unwrap().duration();
        assert!((profile.duration() / least - 1.0).abs() < 1e-6);
    }
    // On an arc the one profile that is left is curved.
    let curved = Case { stretches: vec![arc(30.0, 2.0)], limits: circle(10.0, 2.0), start: 0.0, end: 0.0 };
    let Err(Infeasible::Start { largest, .. }) = optimal(&curved.stretches, limits, 100.0, 0.0) else {
        panic!()
    };
    let edge = Case { start: largest, ..curved.clone() };
    assert_eq!(drawn(&edge, &with(5, Law::Uniform), 2), Err(Infeasible::Tight));
    let near = Case { start: 0.99 * largest, ..curved };
    assert!(drawn(&near, &with(5, Law::Uniform), 2).unwrap().knots().len() > 6);
}

#[test]
fn tiny_paths_and_sharp_arcs_have_profiles() {
    let sharp = Stretch { length: 1e-3, radius: 1e-3 };
    let paths: [&[Stretch]; 5] = [
        &[line(1e-6)],
        &[arc(170.0, 1e-4)],
        &[line(30.0), sharp, line(30.0)],
        &[line(30.0), sharp, line(0.01), sharp, line(30.0)],
        &[line(1e5), arc(90.0, 1e3)],
    ];
    for (k, path) in paths.iter().enumerate() {
        let case = Case { stretches: path.to_vec(), limits: circle(10.0, 2.0), start: 0.0, end: 0.0 };
        for pieces in [2, 3, 10, 64] {
            for law in [Law::Uniform, WALK, Law::Preferred { speed: 100.0, spread: 0.0 }] {
                for index in 0..50 {
                    let profile = drawn(&case, &with(pieces, law), index).unwrap();
                    let found = broken(&profile, path, case.limits);
                    assert!(found.is_none(), "{k} {pieces} {law:?} {index}: {found:?}");
                    assert_eq!(profile.knots().len(), pieces + 1);
                }
            }
        }
    }
}

#[test]
fn invalid_numbers_are_refused() {
    let case = Case { stretches: vec![line(2.0)], limits: circle(1.5, 0.8), start: 0.0, end: 0.0 };
    let floor = Variety { pieces: 4, floor: 0.0, law: WALK };
    assert_eq!(drawn(&case, &floor, 0), Err(Infeasible::Floor { floor: 0.0 }));
    let law = Law::Preferred { speed: -1.0, spread: 0.1 };
    assert_eq!(drawn(&case, &with(4, law), 0), Err(Infeasible::Law { speed: -1.0, spread: 0.1 }));
}
