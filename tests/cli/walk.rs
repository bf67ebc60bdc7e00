//! `smc walk` from the outside: formats, traces that `smc gait compare` reads, threads, and calls that are wrong.

use crate::program::Place;
use serde_json::Value;

/// A worker who steps, a visitor who is pushed by forces, and a guard without a route.
const HALL: &str = "
scenario \"Hall <1>\"
horizon = 30 s
step = 1 s / 60
scene {
  region shelf: circle (0, 0) radius 0.5 m
  region desk:  circle (4, 0) radius 0.5 m
  point door: (0, 6)
}
kind operator: stepped { }
kind adult: sfm preset helbing2000 { }
agent worker: operator { at = uniform in shelf; route = desk -> wait 1 s -> shelf }
agent visitor: adult { at = (0, 8); route = door -> (3, 6) }
agent guard: adult { at = (9, 9) }
";

fn hall() -> Place {
    Place::new(&[("hall.scn", HALL)])
}

fn walked(place: &Place, words: &[&str]) -> String {
    let said = place.call(&[&["walk", "hall.scn"], words].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    said.out
}

/// The rows of a table after its head.
fn rows(text: &str) -> Vec<Vec<&str>> {
    text.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

#[test]
fn legs_have_names_lengths_times_and_steps() {
    let place = hall();
    let text = walked(&place, &["-n", "20"]);
    for part in ["worker ", "1 shelf -> desk", "2 desk -> shelf", "visitor ", "length (m)", "IQR"] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(text.contains("1 (0, 8) -> door") && text.contains("2 door -> (3, 6)"), "{text}");
    assert!(!text.contains("guard"), "without a route there is no leg\n{text}");
    let json: Value = serde_json::from_str(&walked(&place, &["-n", "20", "--format", "json"])).unwrap();
    let schema: Value = serde_json::from_str(include_str!("../../docs/schema/legs.schema.json")).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&json), "{json:#}");
    let leg = &json["legs"][0];
    let median = |of: &str| leg[format!("{of}_median")].as_f64().unwrap();
    assert!((3.4..4.8).contains(&median("length_m")) && (4.0..12.0).contains(&median("steps")), "{leg}");
    assert_eq!((&leg["walks"], &leg["unfinished"]), (&20.into(), &0.into()));
    assert_eq!(json["legs"][3]["steps_median"], Value::Null, "a body that is pushed makes no steps");
    let csv = walked(&place, &["-n", "20", "--format", "csv", "--agent", "worker"]);
    let rows = rows(&csv);
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[0][..6], ["worker", "1", "shelf", "desk", "20", "0"]);
    assert_eq!(rows[0][6].parse::<f64>().unwrap(), median("length_m"));
}

#[test]
fn traces_agree_with_the_table_and_are_walks_to_compare() {
    let place = hall();
    let table = walked(&place, &["-n", "8", "--agent", "worker", "--format", "csv"]);
    let traces = walked(&place, &["-n", "8", "--agent", "worker", "--format", "traces"]);
    place.write("a.csv", traces.as_bytes());
    assert!(traces.starts_with("walk,leg,t,x,y,heading,foot,step\n0,1,0,"), "{}", &traces[..80]);
    let rows = rows(&traces);
    let number = |row: &[&str], k: usize| row[k].parse::<f64>().unwrap();
    let (mut lengths, mut times) = (Vec::new(), Vec::new());
    for walk in rows.chunk_by(|a, b| a[..2] == b[..2]) {
        // 120 rows a second from 0 on, and the end.
        for (k, pair) in walk[..walk.len() - 1].windows(2).enumerate() {
            assert!((number(&pair[1], 2) - (k + 1) as f64 / 120.0).abs() < 1e-5, "{pair:?}");
        }
        let steps: Vec<(u32, &str)> = walk
            .iter()
            .filter(|row| !row[7].is_empty())
            .map(|row| (row[7].parse().unwrap(), row[6]))
            .collect();
        assert_eq!(steps[0].0, 1);
        for pair in steps.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            assert!(a == b || b.0 == a.0 + 1 && b.1 != a.1, "the other foot swings next: {pair:?}");
        }
        let places: Vec<(f64, f64)> = walk.iter().map(|row| (number(row, 3), number(row, 4))).collect();
        let length = places.windows(2).map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1)).sum::<f64>();
        if walk[0][1] == "1" {
            lengths.push(length);
            times.push(number(&walk[walk.len() - 1], 2));
        }
    }
    assert_eq!(lengths.len(), 8);
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        0.5 * (values[3] + values[4])
    };
    let first: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    assert!((median(&mut lengths) - number(&first, 6)).abs() < 5e-3, "{table}");
    assert!((median(&mut times) - number(&first, 10)).abs() < 1e-4, "{table}");
    // Other rates have the same ends; both sets are read.
    let slow = walked(&place, &["-n", "8", "--agent", "worker", "--format", "traces", "--fps", "30"]);
    place.write("b.csv", slow.as_bytes());
    let said = place.call(&["gait", "compare", "a.csv", "b.csv", "--format", "json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let json = said.json();
    assert_eq!(json["legs"].as_array().unwrap().len(), 2);
    assert!(json["all"]["duration_s"]["kolmogorov_smirnov"]["d"].as_f64().unwrap() < 1e-9);
    // Of several agents, names say whose walk it is; others have no foot.
    let all = walked(&place, &["-n", "2", "--format", "traces"]);
    assert!(all.contains("\nworker 0,worker 1,0.0") && all.contains("\nvisitor 1,visitor 2,0.0"), "{all}");
    assert!(all.lines().filter(|line| line.starts_with("visitor")).all(|line| line.ends_with(",,")));
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let place = hall();
    for format in ["text", "json", "csv", "traces", "svg"] {
        let with =
            |threads: &str| walked(&place, &["-n", "11", "--seed", "4", "--format", format, "-j", threads]);
        let one = with("1");
        assert!(one == with("2") && one == with("8"), "{format}");
    }
    assert_ne!(walked(&place, &["-n", "11"]), walked(&place, &["-n", "11", "--seed", "1"]));
}

#[test]
fn pictures_show_walks_places_and_a_scale() {
    let place = hall();
    let said = place.call(&["walk", "hall.scn", "-n", "5", "--format", "svg", "-o", "walks.svg"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""), "{}", said.err);
    let picture = std::fs::read_to_string(place.path("walks.svg")).unwrap();
    assert_eq!(picture.matches("<polyline").count(), 5 * 4, "5 trials of 4 legs");
    for part in
        ["Hall &lt;1&gt;", ">shelf</text>", ">door</text>", "20 walks; cells of 0.1 m", ">y (m)</text>"]
    {
        assert!(picture.contains(part), "{part}");
    }
    // Of the walk that most cells lie on, all trials pass some cell.
    assert!(picture.contains("fill-opacity=\"0.85\""));
}

#[test]
fn legs_that_do_not_end_are_counted() {
    let text = HALL.replace("horizon = 30 s", "horizon = 5 s");
    let place = Place::new(&[("hall.scn", &text)]);
    let table = walked(&place, &["-n", "6", "--agent", "worker", "--format", "csv"]);
    let rows = rows(&table);
    assert_eq!((rows[1][4], rows[1][5], rows[1][6]), ("0", "6", ""), "{table}");
    let text = walked(&place, &["-n", "6", "--agent", "worker"]);
    let last: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
    assert_eq!(last[4..], ["0", "6", "-", "-", "-", "-", "-"], "{text}");
}

#[test]
fn calls_that_are_wrong_have_a_code_and_a_hint() {
    let place = hall();
    place.write("still.scn", b"horizon = 1 s\nstep = 0.1 s\nkind adult: sfm preset helbing2000 { }\nagent a: adult { at = (0, 0) }\n");
    for (words, parts) in [
        (&["hall.scn", "--agent", "wroker"][..], &["unknown agent `wroker`", "did you mean `worker`?"][..]),
        (
            &["hall.scn", "--agent", "guard"],
            &["agent `guard` has no route from the start", "worker, visitor"],
        ),
        (&["still.scn"], &["no agent has a route", "route = "]),
    ] {
        let said = place.call(&[&["walk"], words].concat());
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}\n{}", said.err);
        for part in ["error[E0705]: ", "help: "].iter().chain(parts) {
            assert!(said.err.contains(part), "{words:?} {part}\n{}", said.err);
        }
    }
    let said = place.call(&["walk", "hall.scn", "-o", "hall.scn"]);
    assert!(said.code == Some(2) && said.err.contains("error[E0920]: "), "{}", said.err);
    assert_eq!(place.call(&["walk", "none.scn"]).code, Some(2));
    for (words, hint) in [
        (["-n", "0"], "a whole number from 1"),
        (["-j", "0"], "write a number from 1"),
        (["--fps", "0"], "above 0 and at most 1e6, such as 120"),
        (["--fps", "-3"], "above 0 and at most 1e6"),
        (["--fps", "nan"], "above 0 and at most 1e6"),
        (["--fps", "many"], "above 0 and at most 1e6"),
    ] {
        let said = place.call(&[&["walk", "hall.scn"], &words[..]].concat());
        assert!(said.code == Some(2) && said.err.contains(hint), "{words:?}\n{}", said.err);
    }
    assert_eq!(std::fs::read_to_string(place.path("hall.scn")).unwrap(), HALL);
}

#[test]
fn n_is_short_for_trials_of_simulate_too() {
    let place = hall();
    let words = |option| ["simulate", "hall.scn", option, "2", "--until", "1s", "--every", "30"];
    let (short, long) = (place.call(&words("-n")), place.call(&words("--trials")));
    assert_eq!((short.code, &short.out), (Some(0), &long.out));
}

#[test]
fn a_gait_that_is_not_used_as_it_was_fitted_is_told() {
    let learned = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/gaits/cmu.gait")).unwrap();
    for (kind, wanted) in [
        ("gait = as_published \"x.gait\"", "`x.gait` was not fitted as published"),
        (
            "gait = learned \"x.gait\"; search = grid_a_star()",
            "usual length and duration of steps from `x.gait`",
        ),
        (
            "search = grid_a_star(); gait = learned \"x.gait\"",
            "usual length and duration of steps from `x.gait`",
        ),
    ] {
        let place =
            Place::new(&[("hall.scn", &HALL.replace("stepped { }", &format!("stepped {{ {kind} }}")))]);
        place.write("x.gait", &learned);
        let said = place.call(&["walk", "hall.scn", "-n", "2"]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert!(said.err.contains("warning[W0723]") && said.err.contains(wanted), "{kind}\n{}", said.err);
    }
    // The published search needs no other word.
    let with = |kind: &str| {
        let place =
            Place::new(&[("hall.scn", &HALL.replace("stepped { }", &format!("stepped {{ {kind} }}")))]);
        place.write("x.gait", &learned);
        place.call(&["walk", "hall.scn", "-n", "5", "--format", "json"]).out
    };
    let both = with("gait = learned \"x.gait\"; search = as_published()");
    assert_eq!(with("gait = as_published \"x.gait\""), both);
}

#[test]
fn a_damaged_gait_ends_every_call_at_its_name() {
    let whole = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/gaits/cmu.gait")).unwrap();
    let model = HALL.replace("stepped { }", "stepped { gait = learned \"x.gait\" }");
    let query = "property there = F<=20 s (done(worker))\nestimate P(there) by fixed(trials = 2)\n";
    let place = Place::new(&[("hall.scn", &model), ("q.bltl", query)]);
    place.write("x.gait", whole.as_bytes());
    assert_eq!(place.call(&["walk", "hall.scn", "-n", "1"]).code, Some(0));
    let at = whole.find("fnv1a64:").unwrap() + 8;
    let digit = if whole.as_bytes()[at] == b'0' { "1" } else { "0" };
    let other = format!("{}{digit}{}", &whole[..at], &whole[at + 1..]);
    for bytes in [b"garbage\n".as_slice(), b"", b"\xff\xfe\0", &whole.as_bytes()[..3000], other.as_bytes()] {
        place.write("x.gait", bytes);
        for words in [
            &["walk", "hall.scn", "-n", "2"][..],
            &["simulate", "hall.scn", "--until", "1s"],
            &["show", "hall.scn"],
            &["path", "hall.scn"],
            &["check", "hall.scn", "q.bltl", "-q"],
        ] {
            let said = place.call(words);
            assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}\n{}", said.err);
            for part in ["error[E0723]: `x.gait` is no gait", "gait = learned \"x.gait\"", "smc gait fit"] {
                assert!(said.err.contains(part), "{part} of {words:?}\n{}", said.err);
            }
        }
    }
}
