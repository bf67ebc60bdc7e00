use super::*;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::gait::step::SPANS;

fn stream(index: u64) -> Stream {
    Stream::of(TrialKey { seed: 5, index, branch: 0 }, 0, Purpose::Test)
}

fn gait(height: f64, speed: f64) -> SyntheticGait {
    SyntheticGait::of(Person { height, speed, width: 0.155 })
}

fn angle(a: Vec2) -> f64 {
    math::atan2(a.y, a.x)
}

/// A step of a chain in the frame of the floor.
struct Made {
    foot: Foot,
    shape: Shape,
    begin: Vec2,
    /// Direction of +x of its frame.
    frame: Vec2,
}

impl Made {
    fn chord(&self) -> Vec2 {
        turned(self.shape.landmarks[SPANS - 1], self.frame)
    }
}

/// A chain of steps from standing; `next` makes the step with a number.
fn chain(count: u32, next: impl Fn(u32, &Stance, Foot) -> Stance) -> Vec<Made> {
    let (mut stance, mut foot, mut begin, mut frame) =
        (Stance::default(), Foot::Left, Vec2::zeros(), Vec2::x());
    let mut made = Vec::new();
    for number in 0..count {
        stance = next(number, &stance, foot);
        let (_, shape) = stance.last.unwrap();
        made.push(Made { foot, shape, begin, frame });
        begin += turned(shape.landmarks[SPANS - 1], frame);
        frame = turned(shape.curve().tangent(1.0), frame);
        foot = foot.other();
    }
    made
}

fn straight(gait: &SyntheticGait, share: f64, count: u32, index: u64) -> Vec<Made> {
    chain(count, |number, before, foot| {
        gait.toward(before, foot, share, 0.0, Draws::of(stream(index), number, 0))
    })
}

fn mean_and_cv(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, square.sqrt() / mean)
}

/// Largest deviation of the path of a step from its chord, towards its side.
fn deviation(shape: &Shape) -> f64 {
    let chord = shape.landmarks[SPANS - 1];
    let across = left_of(chord) / chord.norm();
    let curve = shape.curve();
    let at = |k: i32| curve.place(f64::from(k) / 100.0).dot(&across);
    (0..=100).map(at).fold(0.0, |widest: f64, d| if d.abs() > widest.abs() { d } else { widest })
}

#[test]
fn people_have_the_laws_of_their_fields() {
    let people: Vec<Person> = (0..20_000).map(|k| Person::draw(stream(k), None, None)).collect();
    let close = |of: fn(&Person) -> f64, mean: f64, sd: f64| {
        let (m, cv) = mean_and_cv(people.iter().map(of));
        assert!((m - mean).abs() < 0.03 * sd && (m * cv - sd).abs() < 0.03 * sd, "{m} {cv}");
    };
    close(|p| p.height, 1.72, 0.09);
    // Cut at 0.5 and 2.2 m/s.
    close(|p| p.speed, 1.3402, 0.2575);
    close(|p| p.width, 0.155, 0.03);
    assert!(people.iter().all(|p| (0.5..=2.2).contains(&p.speed) && p.width > 0.0));
    let given = Person::draw(stream(3), Some(1.5), None);
    assert_eq!(given, Person { height: 1.5, ..people[3] });
    assert_eq!(Person::draw(stream(3), None, Some(1.0)), Person { speed: 1.0, ..people[3] });
}

#[test]
fn length_and_cadence_keep_their_ratio() {
    let gait = gait(1.72, 1.34);
    assert!((1.0 / gait.duration() - 1.87).abs() < 0.005, "{}", gait.duration());
    assert!((gait.length() - 0.72).abs() < 0.005);
    for speed in [0.6, 1.0, 1.34, 1.8] {
        let made = straight(&gait, speed / 1.34, 600, 1);
        let (time, _) = mean_and_cv(made[1..].iter().map(|m| m.shape.duration));
        let (length, _) = mean_and_cv(made[1..].iter().map(|m| m.chord().norm()));
        // Metres over steps a minute: 6.0 to 6.6e-3 in adults.
        assert!((length * time / 60.0 - 6.37e-3).abs() < 0.1e-3, "{speed} {length} {time}");
        assert!((length / time / speed - 1.0).abs() < 0.015, "{speed} {length} {time}");
    }
}

#[test]
fn sway_is_towards_the_stance_foot_and_falls_with_speed_as_measured() {
    for speed in [0.9, 1.0, 1.1, 1.2, 1.34, 1.5, 1.6] {
        let made = straight(&gait(1.72, speed), 1.0, 400, 2);
        let towards = |m: &Made| deviation(&m.shape) * side(m.foot);
        assert!(made[1..].iter().all(|m| towards(m) > 0.01));
        let (mean, _) = mean_and_cv(made[1..].iter().map(towards));
        assert!((mean * 100.0 - (4.5 - 1.55 * speed)).abs() < 0.5, "{speed} {mean}");
    }
}

#[test]
fn steps_begin_along_x_and_the_next_knows_the_speed_at_their_end() {
    for number in 0..200 {
        let made = chain(6, |k, before, foot| {
            gait(1.7, 1.3).step(before, foot, 1.0, Draws::of(stream(number), k, 7))
        });
        for m in made {
            // The speed at the end, without a curve.
            let entry = gait(1.7, 1.3).entry(&Stance { last: Some((m.foot, m.shape)), drift: [0.0; 8] });
            assert!((m.shape.curve().rise(1.0).norm() / m.shape.duration - entry.speed).abs() < 1e-12);
            assert!((m.shape.curve().tangent(0.0) - Vec2::x()).norm() < 1e-9);
        }
    }
}

#[test]
fn a_long_straight_chain_stays_straight_at_the_speed_of_the_person() {
    let (mut spread, mut speeds) = (Vec::new(), Vec::new());
    for index in 0..20 {
        let gait = SyntheticGait::of(Person::draw(stream(index), None, None));
        let made = straight(&gait, 1.0, 1000, index);
        let (last, first) = (&made[999], &made[0]);
        let whole = last.begin + last.chord() - first.begin;
        assert!(angle(whole).abs() < 0.02, "{}", angle(whole));
        let time: f64 = made[1..].iter().map(|m| m.shape.duration).sum();
        speeds.push((whole - first.chord()).norm() / time / gait.person.speed);
        spread.extend(made.iter().map(|m| angle(m.chord()).to_degrees()));
    }
    let (speed, cv) = mean_and_cv(speeds.into_iter());
    assert!((speed - 1.0).abs() < 0.01 && cv < 0.01, "{speed} {cv}");
    let square = spread.iter().map(|a| a * a).sum::<f64>() / spread.len() as f64;
    assert!((square.sqrt() - 1.2).abs() < 0.1, "{}", square.sqrt());
}

#[test]
fn turns_keep_their_limits_and_reach_them() {
    // From the direction of walking before a step to that after it; speeds above and below that of a pivot.
    for (share, limit) in [(1.0, 50.0f64), (0.4, 90.0)] {
        let gait = gait(1.72, 1.34);
        let mut widest = 0.0f64;
        for index in 0..400 {
            let before =
                gait.toward(&Stance::default(), Foot::Left, share, 0.0, Draws::of(stream(index), 0, 0));
            for candidate in 0..24 {
                let after = gait.step(&before, Foot::Right, share, Draws::of(stream(index), 1, candidate));
                let frame = after.last.unwrap().1.curve().tangent(1.0);
                let (from, to) = (gait.entry(&before).walking, turned(gait.entry(&after).walking, frame));
                widest = widest.max(angle(turned(to, Vec2::new(from.x, -from.y))).abs());
            }
        }
        assert!((0.98 * limit..limit + 1e-9).contains(&widest.to_degrees()), "{widest}");
    }
}

#[test]
fn the_best_of_24_turns_by_90_degrees_in_three_steps() {
    let gait = gait(1.72, 1.34);
    let mut turns = Vec::new();
    for index in 0..400 {
        // Three straight steps, three times the candidate that points most to the left, a straight step.
        let made = chain(7, |number, before, foot| {
            let draws = |candidate| Draws::of(stream(index), number, candidate);
            if !(3..6).contains(&number) {
                return gait.toward(before, foot, 1.0, 0.0, draws(0));
            }
            let left = |s: &Stance| angle(s.last.unwrap().1.landmarks[SPANS - 1]);
            (0..24)
                .map(|k| gait.step(before, foot, 1.0, draws(k)))
                .max_by(|a, b| left(a).total_cmp(&left(b)))
                .unwrap()
        });
        let (from, to) = (made[2].chord(), made[6].chord());
        turns.push(angle(turned(to, Vec2::new(from.x, -from.y))).to_degrees().rem_euclid(360.0));
    }
    let (mean, cv) = mean_and_cv(turns.into_iter());
    assert!((75.0..105.0).contains(&mean) && mean * cv < 30.0, "{mean} {}", mean * cv);
}

#[test]
fn the_direction_of_walking_turns_by_what_is_asked() {
    let gait = gait(1.72, 1.34);
    let speed = |m: &Made| m.chord().norm() / m.shape.duration;
    for degrees in [-50.0f64, -20.0, 0.0, 20.0, 50.0] {
        let (mut turns, mut speeds) = (Vec::new(), Vec::new());
        for index in 0..400 {
            let made = chain(8, |number, before, foot| {
                let turn = if number == 4 { degrees.to_radians() } else { 0.0 };
                gait.toward(before, foot, 1.0, turn, Draws::of(stream(index), number, 0))
            });
            // Chords 3 and 5 are straight steps before and after the turn.
            let (a, b) = (made[3].chord(), made[5].chord());
            turns.push(angle(turned(b, Vec2::new(a.x, -a.y))).to_degrees());
            speeds.push(speed(&made[4]));
        }
        let mean = turns.iter().sum::<f64>() / 400.0;
        let (speed, _) = mean_and_cv(speeds.into_iter());
        assert!((mean - degrees).abs() < 1.0, "{degrees} {mean}");
        assert!((speed / 1.34 - slowing(degrees.to_radians())).abs() < 0.01);
    }
    // Medians of section 4 in the middle of their classes.
    for (degrees, speed) in [(11.0f64, 1.21), (18.5, 1.20), (26.0, 1.16), (40.0, 1.12)] {
        assert!((slowing(degrees.to_radians()) - speed / 1.30).abs() < 0.015, "{degrees}");
    }
    assert_eq!(SyntheticGait::widest(&gait.entry(&Stance::default())), PI / 2.0);
    let walking = gait.toward(&Stance::default(), Foot::Left, 1.0, 0.0, Draws::of(stream(0), 0, 0));
    assert!((SyntheticGait::widest(&gait.entry(&walking)).to_degrees() - 50.0).abs() < 1e-9);
}

#[test]
fn first_steps_begin_slowly() {
    let gait = gait(1.72, 1.34);
    let made = straight(&gait, 1.0, 5, 9);
    let speed = |s: &Shape, u: f64| s.curve().rise(u).norm() / s.duration;
    assert!(speed(&made[0].shape, 0.0) < 0.1 && (speed(&made[0].shape, 1.0) / 1.34 - 1.0).abs() < 0.15);
    let (length, _) = mean_and_cv((0..500).map(|k| straight(&gait, 1.0, 1, k)[0].chord().norm()));
    assert!((length - 0.57 * gait.length()).abs() < 0.005);
}

#[test]
fn a_step_has_the_same_bytes_everywhere() {
    let gait = SyntheticGait::of(Person::draw(stream(1), None, None));
    let mut stance = Stance::default();
    let mut foot = Foot::Left;
    let mut sum = 0u64;
    for number in 0..50 {
        stance = gait.step(&stance, foot, 0.9, Draws::of(stream(1), number, 3));
        foot = foot.other();
        let shape = stance.last.unwrap().1;
        for value in
            shape.landmarks.iter().flat_map(|p| [p.x, p.y]).chain([shape.duration]).chain(stance.drift)
        {
            sum = sum.rotate_left(5).wrapping_mul(0x0000_0100_0000_01b3) ^ value.to_bits();
        }
    }
    assert_eq!(sum, 0x3fcb_0334_7bd3_ef22, "{sum:#x}");
}
