//! The figures of crowds: what they count, and that they stay small and in one piece.

use super::*;
use crate::base::geometry::{Bounds, Segment, Vec2};
use crate::engine::traces::{Walk, recorded};
use crate::model::{Island, Line, Scene, Storeys};

/// Somebody with a place every 0.1 s.
fn walk(k: usize, frames: usize, at: impl Fn(f64) -> (f64, f64)) -> Walk {
    let point = |frame: usize| {
        let time = 0.1 * frame as f64;
        let (x, y) = at(time);
        (time, Vec2::new(x, y))
    };
    Walk { name: format!("a[{k}]"), points: (0..frames).map(point).collect(), groups: Vec::new() }
}

fn line(name: &str, x: f64) -> Scene {
    let segment = Segment::new(Vec2::new(x, -1.0), Vec2::new(x, 1.0));
    Scene { lines: vec![Line { name: name.to_owned(), segment }], ..Scene::default() }
}

/// A trial in which people walk so.
fn trial(scene: Scene, walks: &[Walk]) -> Trace {
    Trace { recording: None, ..recorded("t", scene, walks).unwrap() }
}

fn figures(traces: &[Trace]) -> Vec<Figure> {
    let (crowds, _) = crowds(&CallResult::default(), traces);
    crowds.into_iter().flat_map(|crowd| crowd.figures).collect()
}

#[test]
fn each_person_crosses_a_line_once() {
    // One a second, 1 m/s; the fourth goes back and comes again.
    let back = |time: f64| 1.0 - (time - 4.0).abs() + if time > 6.0 { 2.0 * (time - 6.0) } else { 0.0 };
    let walks: Vec<Walk> = (0..4)
        .map(|k| {
            walk(k, 101, move |time| (if k == 3 { back(time) } else { time - k as f64 }, 0.1 * k as f64))
        })
        .collect();
    let found = figures(&[trial(line("door", 0.55), &walks)]);
    assert_eq!(found.len(), 1, "four people are no crowd, but there is a line");
    let caption = &found[0].caption;
    assert!(caption.starts_with("Agents that have crossed `door`, N(t). By the end: 4; flow"), "{caption}");
    // The first crosses at 0.6 s, the last at 3.6 s.
    assert!(caption.contains(": 1 1/s, on 2 m: 0.5 1/(m s)."), "{caption}");
    let nobody = figures(&[trial(line("door", 99.0), &walks)]);
    assert!(nobody[0].caption.contains("By the end: 0. No trace has two crossings"), "{}", nobody[0].caption);
}

#[test]
fn a_mean_and_a_range_are_over_the_traces() {
    let people = |count: usize| -> Vec<Walk> {
        (0..count).map(|k| walk(k, 51, move |time| (time - 0.2 * k as f64, 0.0))).collect()
    };
    let mut second = trial(line("door", 0.55), &people(4));
    let first = trial(line("door", 0.55), &people(2));
    second.scenario = Arc::clone(&first.scenario);
    let found = figures(&[first, second]);
    assert!(found[0].caption.contains("By the end: 3 (2 to 4)"), "{}", found[0].caption);
    assert!(found[0].svg.contains("<polygon"), "the range is a band");
}

#[test]
fn heat_maps_say_where_people_stood_and_touched() {
    // Two in touch and six apart, who all stand.
    let place = |k: usize| if k < 2 { (0.3 * k as f64 + 0.1, 0.1) } else { (2.0 * k as f64 + 0.1, 3.1) };
    let walks: Vec<Walk> = (0..8).map(|k| walk(k, 31, move |_| place(k))).collect();
    let found = figures(&[trial(Scene::default(), &walks)]);
    let titles: Vec<&str> =
        found.iter().map(|figure| figure.caption.split(':').next().unwrap_or_default()).collect();
    assert_eq!(titles[..3], ["Presence", "Density", "Contact"]);
    assert!(titles[3].starts_with("Speed against density"), "{titles:?}");
    let values = |svg: &str| -> Vec<String> {
        svg.split("<title>").skip(1).map(|rest| rest.split("</title>").next().unwrap().to_owned()).collect()
    };
    // Cells of 0.2 m: somebody who stands in one all the time is 25 agents/m² there.
    assert_eq!(values(&found[0].svg), vec!["25"; 8]);
    // Alone: a polygon of 12 sides, of 3 m².
    let densities = values(&found[1].svg);
    assert_eq!(densities.iter().filter(|value| *value == "0.3333").count(), 6, "{densities:?}");
    assert_eq!(values(&found[2].svg), ["1", "1"]);
    // A recording has no bodies that could touch.
    let recording = recorded("r", Scene::default(), &walks).unwrap();
    assert!(figures(&[recording]).iter().all(|figure| !figure.caption.starts_with("Contact")));
}

#[test]
fn nobody_has_no_figures_and_names_stay_inside() {
    assert!(figures(&[]).is_empty());
    let mut empty = trial(line("door", 0.0), &[walk(0, 2, |_| (0.0, 0.0))]);
    empty.motion.tracks.clear();
    assert!(figures(&[empty]).is_empty());
    let hostile = format!("</script>\"' onload=x <b> é\u{202e}{}", "n".repeat(3000));
    let walks: Vec<Walk> = (0..8).map(|k| walk(k, 12, move |time| (time, k as f64))).collect();
    for figure in figures(&[trial(line(&hostile, 0.5), &walks)]) {
        assert!(!figure.svg.contains("</script>") && !figure.svg.contains("<b>"), "{}", figure.svg);
        assert!(figure.caption.len() < 600, "{}", figure.caption);
    }
}

#[test]
fn figures_of_thousands_stay_small() {
    let place = |k: usize, time: f64| ((k % 60) as f64 + time, (k / 60) as f64 + 0.01 * time);
    let walks: Vec<Walk> = (0..3000).map(|k| walk(k, 60, move |time| place(k, time))).collect();
    let found = figures(&[trial(line("door", 30.5), &walks)]);
    assert_eq!(found.len(), 4, "nobody touches");
    let size: usize = found.iter().map(|figure| figure.svg.len()).sum();
    assert!(size < 500_000, "{size} bytes");
}

#[test]
fn a_number_of_crossings_never_falls() {
    let people = |count: usize, frames: usize| -> Vec<Walk> {
        (0..count).map(|k| walk(k, frames, move |time| (time - 0.2 * k as f64, 0.0))).collect()
    };
    let mut second = trial(line("door", 0.55), &people(2, 51));
    let first = trial(line("door", 0.55), &people(6, 25));
    assert!(first.end < second.end);
    second.scenario = Arc::clone(&first.scenario);
    let found = figures(&[first, second]);
    let heights: Vec<f64> = found[0]
        .svg
        .split("<polyline points=\"")
        .skip(1)
        .flat_map(|rest| rest.split('"').next().unwrap().split(' '))
        .map(|point| point.split_once(',').unwrap().1.parse().unwrap())
        .collect();
    assert!(heights.len() > 100 && heights.is_sorted_by(|a, b| a >= b), "{heights:?}");
}

#[test]
fn people_who_left_are_counted_by_exit() {
    use crate::base::geometry::Shape;
    use crate::model::Region;
    let region =
        |name: &str, x: f64| Region::new(name, Shape::rectangle(Vec2::new(x, -9.0), Vec2::new(x + 1.0, 9.0)));
    let scene = Scene { regions: vec![region("west", -3.0), region("east", 3.0)], ..Scene::default() };
    // Six go east and are there after 3.0, 3.5, ... s; two stay.
    let walks: Vec<Walk> = (0..8)
        .map(|k| match k {
            0..6 => walk(k, 31 + 5 * k, move |time| (time.min(3.2), k as f64)),
            _ => walk(k, 81, move |_| (0.0, k as f64)),
        })
        .collect();
    let (crowds, _) = crowds(&CallResult::default(), &[trial(scene.clone(), &walks)]);
    assert_eq!(crowds[0].tables[0].rows, [["east", "6", "2", "5.5"]]);
    let map = crowds[0].figures.iter().find(|figure| figure.caption.starts_with("Time to leave"));
    assert!(map.is_some_and(|map| map.svg.contains("<rect")));
    // In a recording people are only not seen any more.
    let (crowds, _) = super::crowds(&CallResult::default(), &[recorded("r", scene, &walks).unwrap()]);
    assert!(crowds[0].tables.is_empty());
}

#[test]
fn each_level_has_heat_maps_of_its_own_people() {
    let island = |name: &str, x: f64| Island {
        name: name.to_owned(),
        origin: Vec2::new(x, 0.0),
        bounds: Bounds { low: Vec2::new(x, 0.0), high: Vec2::new(x + 10.0, 10.0) },
        height: Some(x),
    };
    let names = ["a", "b", "c", "d", "e", "f"];
    let islands: Vec<Island> =
        names.iter().zip(0..).map(|(name, k)| island(name, 50.0 * f64::from(k))).collect();
    let storeys = Storeys { islands, portals: Vec::new() };
    // Two people more on each level than on the one before, but none on the last; the fewest have no map.
    let people = (0..5).flat_map(|level| (0..=2 * level).map(move |k| (f64::from(level), f64::from(k))));
    let walks: Vec<Walk> = people
        .enumerate()
        .map(|(k, (level, y))| walk(k, 21, move |time| (50.0 * level + 1.0 + time, 1.0 + y)))
        .collect();
    let (crowds, _) = crowds(&CallResult::default(), &[trial(Scene { storeys, ..Scene::default() }, &walks)]);
    let captions = |of: &str| -> Vec<String> {
        let all =
            crowds[0].figures.iter().filter_map(|figure| figure.caption.split_once(&format!("{of} on ")));
        all.map(|(_, rest)| rest.split(':').next().unwrap_or_default().to_owned()).collect()
    };
    assert_eq!(captions("Presence"), ["b", "c", "d", "e"]);
    assert!(crowds[0].note.contains("the maps of 1 of 6 levels and stairs"), "{}", crowds[0].note);
    // On level b there were three people for two seconds, 0.1 s apart.
    let first = &crowds[0].figures[0];
    assert!(first.svg.matches("<title>").count() >= 3, "{}", first.svg);
}
