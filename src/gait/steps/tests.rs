//! Steps of the takes made for the tests; see the tests of `data::mocap`.

use super::signal::{percentile, smoothed};
use super::*;
use crate::base::geometry::Vec2;
use crate::data::mocap::{Asf, FootTrack, Layout, Take, read_takes};
use crate::gait::{Foot, Phase};

fn takes() -> Vec<Take> {
    let [bvh, amc, csv] = [
        include_str!("../../../tests/cases/mocap/circle.bvh"),
        include_str!("../../../tests/cases/mocap/walker_01.amc"),
        include_str!("../../../tests/cases/mocap/clips.csv"),
    ];
    let asf = Asf::read(include_str!("../../../tests/cases/mocap/walker.asf")).unwrap();
    let layout = Layout { fps: Some(30.0), ..Layout::named("cmu-asfamc").unwrap() };
    let read = |file, text, asf, layout| read_takes(file, text, asf, layout, &[]).unwrap();
    let mut takes = read("circle.bvh", bvh, None, None);
    takes.extend(read("walker.amc", amc, Some(&asf), Some(&layout)));
    takes.extend(read("clips.csv", csv, None, None));
    takes
}

#[test]
fn steps_are_as_they_were_made() {
    for contact in [Contact::Rest, Contact::Adaptive] {
        let takes = takes();
        for take in takes.iter().filter(|take| take.name != "stand") {
            let cut = cut(take, contact).unwrap();
            let circle = take.name == "circle";
            let expected = if take.name == "walk" { 4 } else { 6 };
            assert!((expected - 1..=expected + 1).contains(&cut.steps.len()), "{contact:?} {}", take.name);
            for (k, step) in cut.steps.iter().enumerate() {
                let near = |a: f64, b: f64, e: f64| {
                    assert!((a - b).abs() < e, "{contact:?} {} {k}: {a} {b}", take.name);
                };
                near(step.shape.duration, 0.5, 0.01);
                near(step.shape.curve().length(), 0.6, 0.015);
                // On the circle the foot behind is not on the tangent.
                near(step.width, 0.2, if circle { 0.1 } else { 0.01 });
                let next = if step.foot == Foot::Left { 0.0 } else { 0.5 };
                // Contacts are seen a little before the foot has come to rest.
                let early = (next - step.span.1).rem_euclid(1.0);
                assert!(early < 0.15, "{contact:?} {} {k}: {early}", take.name);
                assert_eq!(step.phase, Phase::Inner);
                let curve = step.shape.curve();
                let (end, chord) = (curve.tangent(1.0), curve.place(1.0));
                near(curve.tangent(0.0).y, 0.0, 1e-12);
                // The sway of the circle is that of two steps; a chord of two steps turns by twice 0.6 / 3.
                if !circle {
                    near(end.y, 0.0, 1e-3);
                } else if let Some(next) = cut.steps.get(k + 1) {
                    assert_eq!(next.foot, step.foot.other());
                    near(step.span.1, next.span.0, 1e-12);
                    let other = next.shape.curve().tangent(1.0);
                    near(end.y.atan2(end.x) + other.y.atan2(other.x), 0.4, 0.03);
                }
                assert!(chord.x > 0.58);
            }
        }
    }
}

#[test]
fn a_walk_from_standing_to_standing_has_a_first_and_a_last_step() {
    let takes = takes();
    let take = takes.iter().find(|take| take.name == "stand").unwrap();
    let cut = cut(take, Contact::Rest).unwrap();
    let phases: Vec<Phase> = cut.steps.iter().map(|step| step.phase).collect();
    assert_eq!(phases, [Phase::First, Phase::Inner, Phase::Inner, Phase::Last]);
    let feet: Vec<Foot> = cut.steps.iter().map(|step| step.foot).collect();
    assert_eq!(feet, [Foot::Left, Foot::Right, Foot::Left, Foot::Right]);
    assert!(cut.dropped.is_empty());
    // One after the other they are the way of the root from its begin at 0.9 s to its end at 3.2 s, but for what is slower than
    // 0.2 m/s.
    let ways: f64 = cut.steps.iter().map(|step| step.shape.curve().length()).sum();
    assert!((1.7..1.8).contains(&ways), "{ways}");
    assert!(cut.steps.windows(2).all(|pair| pair[0].span.1 == pair[1].span.0));
    assert!((0.9..1.2).contains(&cut.steps[0].span.0) && (2.85..3.2).contains(&cut.steps[3].span.1));
}

#[test]
fn a_wrong_unit_is_recognised() {
    let mut take = takes().remove(0);
    assert_eq!(doubt(&take, &cut(&take, Contact::Rest)), None);
    take.root.iter_mut().for_each(|p| *p *= 100.0);
    take.hip.iter_mut().for_each(|height| *height *= 100.0);
    for p in take.feet.iter_mut().flat_map(|foot| foot.ankle.iter_mut().chain(&mut foot.toe)) {
        *p = p.map(|x| x * 100.0);
    }
    let none = cut(&take, Contact::Rest).unwrap_err();
    assert_eq!(
        none.to_string(),
        "take `circle` has no steps (1 began before the take, 6 are longer than 2 m)"
    );
    let said = doubt(&take, &Err(none)).unwrap();
    assert!(said.starts_with("its hip is 8") && said.ends_with(" m high (0.7 to 1.2 m are usual)"), "{said}");
    let mut low = take.clone();
    low.hip.iter_mut().for_each(|height| *height = 0.9);
    for p in low.feet.iter_mut().flat_map(|foot| &mut foot.ankle) {
        p[2] = 0.0;
    }
    let said = doubt(&low, &cut(&low, Contact::Rest)).unwrap();
    assert!(said.starts_with("its feet are 1"), "{said}");
    let none = cut(&take, Contact::Adaptive).unwrap_err();
    assert!(none.dropped.get(&Dropped::Long).is_some_and(|count| *count > 3), "{none}");
    // Somebody who stands has feet of the right size, and makes no steps.
    let places = vec![[0.0, 0.1, 0.08]; 50];
    let foot = FootTrack { toe: vec![[0.12, 0.1, 0.03]; 50], ankle: places };
    let still = Take { root: vec![Vec2::zeros(); 50], feet: [foot.clone(), foot], ..take };
    let still = Take { hip: vec![0.9; 50], ..still };
    let none = cut(&still, Contact::Adaptive).unwrap_err();
    assert_eq!(none.to_string(), "take `circle` has no steps");
    assert_eq!(doubt(&still, &Err(none)), None);
    assert!(cut(&still, Contact::Rest).is_err());
}

#[test]
fn signals_are_smoothed_by_the_definition() {
    // Against a sum over the signal mirrored many times.
    let signal = [1.0, 4.0, -2.0, 0.5, 7.0];
    let mirrored: Vec<f64> = signal.iter().chain(signal.iter().rev()).copied().cycle().take(100).collect();
    for sigma in [0.7, 1.5, 6.0] {
        let radius = (4.0_f64 * sigma + 0.5) as i32;
        for (k, value) in smoothed(&signal, sigma).iter().enumerate() {
            let weight = |d: i32| (-0.5 * (f64::from(d) / sigma).powi(2)).exp();
            let (mut sum, mut total) = (0.0, 0.0);
            for d in -radius..=radius {
                sum += weight(d) * mirrored[(50 + k as i32 + d) as usize];
                total += weight(d);
            }
            assert!((value - sum / total).abs() < 1e-12, "{sigma} {k}");
        }
    }
    assert_eq!(percentile(&[3.0, 1.0, 2.0], 0.25), 1.5);
    assert_eq!((percentile(&[], 0.05), percentile(&[2.0], 1.0)), (0.0, 2.0));
}

#[test]
fn steps_are_written_as_a_table_and_reported() {
    let cuts: Vec<_> = takes().iter().map(|take| cut(take, Contact::Rest)).collect();
    let steps = cuts.iter().flatten().flat_map(|cut| &cut.steps);
    let mut out = Vec::new();
    write_steps(&mut out, steps.clone()).unwrap();
    let text = String::from_utf8(out).unwrap();
    assert_eq!(text.lines().next(), Some("take,subject,step,foot,phase,from,to,length,turn,duration,width"));
    assert_eq!(text.lines().count(), steps.clone().count() + 1);
    let last = text.lines().find(|line| line.contains(",last,")).unwrap();
    assert!(last.starts_with("stand,,3,right,last,2."), "{last}");
    // On the circle the turns of two steps are 11.46 degrees each on average, to the left.
    let turns: Vec<f64> = text
        .lines()
        .filter(|line| line.starts_with("circle"))
        .map(|line| line.split(',').nth(8).unwrap().parse().unwrap())
        .collect();
    let mean = f64::midpoint(turns[0], turns[1]);
    assert!((mean - 11.46).abs() < 1.0, "{mean}");
    let report = report(&cuts);
    let lines: Vec<&str> = report.lines().collect();
    assert_eq!(lines.len(), 6);
    assert!(lines[0].starts_with("take ") && lines[5].starts_with("all "));
    assert!(lines[1].contains("120.") && lines[1].ends_with("1 began before the take"), "{report}");
}
