//! `smc gait compare` from the outside: the report, the table of points, and tables that are wrong.

use crate::program::Place;
use serde_json::Value;

/// Straight walks of about 2 m that spread to one side. Walks are on these legs in turn, if there are any.
fn walks(count: u32, seconds: f64, legs: &[&str]) -> String {
    let mut table = if legs.is_empty() { "walk,t,x,y\n" } else { "walk,t,x,y,leg\n" }.to_owned();
    for walk in 0..count {
        let (side, length) = (f64::from(walk * 7 % 11) * 0.02, 2.0 + f64::from(walk * 5 % 13) * 0.03);
        let leg =
            legs.get(walk as usize % legs.len().max(1)).map(|leg| format!(",{leg}")).unwrap_or_default();
        for row in 0..=20 {
            let share = f64::from(row) / 20.0;
            let t = seconds * share * (1.0 + 0.01 * f64::from(walk % 5));
            table += &format!("{walk},{t},{},{}{leg}\n", length * share, side * share);
        }
    }
    table
}

#[test]
fn two_sets_are_compared_as_text_json_and_points() {
    let tables = [walks(24, 2.0, &["in", "out"]), walks(24, 2.4, &["in", "out"])];
    let place = Place::new(&[("a.csv", &tables[0]), ("b.csv", &tables[1])]);
    let said = place.call(&["gait", "compare", "a.csv", "b.csv", "--paired"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    for part in ["A  a.csv  (24 walks, 504 points)", "All walks: 24 of A", "Leg out: 12 of A", "pairs, B - A"]
    {
        assert!(said.out.contains(part), "{part}\n{}", said.out);
    }
    let words =
        ["gait", "compare", "a.csv", "b.csv", "--paired", "--format", "json", "--points", "points.csv"];
    let said = place.call(&words);
    let json = said.json();
    let schema: Value = serde_json::from_str(include_str!("../../docs/schema/walks.schema.json")).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&json), "{json:#}");
    assert_eq!(json["all"]["energy"]["path"]["p"], 1.0, "the paths are the same");
    assert_eq!(json["all"]["energy"]["path_and_duration"]["p"], 0.001);
    assert!(json["all"]["duration_s"]["signed_rank"]["p"].as_f64().unwrap() < 1e-4);
    assert_eq!(json["legs"].as_array().unwrap().len(), 2);
    // Several candidates: the nearer one, and both in one picture.
    let beside = walks(24, 2.0, &["in", "out"]).replace(",in", "5,in").replace(",out", "5,out");
    place.write("c.csv", beside.as_bytes());
    let several = ["gait", "compare", "a.csv", "c.csv", "b.csv"];
    let said = place.call(&several);
    assert!(
        said.out.contains("\nC is the nearest to A; ") && said.out.contains("  C less B"),
        "{}",
        said.out
    );
    let all = place.call(&[&several[..], &["--format", "json"]].concat()).json();
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&all), "{all:#}");
    assert_eq!(all["rivals"][0]["candidates"], serde_json::json!([0, 1]));
    assert!(all["rivals"][0]["walks"]["median_difference_m"].as_f64().unwrap() < 0.0);
    let svg = place.call(&[&several[..], &["--format", "svg", "--width", "170mm"]].concat()).out;
    assert!(svg.contains("(a) a: 24 walks, the base") && svg.contains("(c) b: 24 walks"), "{svg}");
    let said = place.call(&[&several[..], &["--points", "points.csv"]].concat());
    assert!(said.code == Some(2) && said.err.contains("`--points` takes one candidate"), "{}", said.err);
    let said = place.call(&words);
    let points = std::fs::read_to_string(place.path("points.csv")).unwrap();
    assert!(points.starts_with("set,walk,leg,t,x,y,distance\nA,0,in,0,0,0,0\n"), "{}", &points[..80]);
    assert_eq!(points.lines().count(), 1 + 2 * 504);
    let again = place.call(&words);
    assert_eq!((again.code, again.out), (said.code, said.out), "the same seed gives the same bytes");
    let other = place.call(&["gait", "compare", "a.csv", "b.csv", "--seed", "1", "--format", "json"]).json();
    assert_ne!(other["all"]["cloud_m"]["halves_of_a"], json["all"]["cloud_m"]["halves_of_a"]);
    let said = place.call(&["gait", "compare", "a.csv", "b.csv", "-o", "c.txt"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""));
    assert!(place.path("c.txt").is_file());
}

#[test]
fn tables_that_are_wrong_have_a_code_and_a_place() {
    let good = walks(4, 2.0, &[]);
    let place = Place::new(&[
        ("a.csv", &good),
        ("legs.csv", &walks(4, 2.0, &["in"])),
        ("one.csv", "walk,t,x,y\n1,0,0,0\n1,1,0,0\n"),
        ("columns.csv", "# recorded\nwalk,time,x,y\n1,0,0,0\n"),
        ("cells.csv", "walk,t,x,y\n1,0,0,0\n1,1,é,0\n2,0,0,0\n2,0,0,0\n"),
        ("others.csv", good.replace('\n', "\nn").trim_end_matches('n')),
        ("empty.csv", "\n"),
    ]);
    place.write("latin.csv", b"walk,t,x,y\n\xe9,0,0,0\n");
    for (words, parts) in [
        (&["one.csv", "a.csv"][..], &["error[E0708]: ", "one.csv:2:1", "1 walk"][..]),
        (&["a.csv", "columns.csv"], &["error[E0708]: ", "columns.csv:2:1", "no column `t`"]),
        (
            &["a.csv", "cells.csv"],
            &["cells.csv:3:5", "`x` must be a number", "cells.csv:5:3", "must increase"],
        ),
        (&["a.csv", "legs.csv"], &["error[E0708]: ", "a.csv:1:1", "no column `leg`"]),
        (&["a.csv", "others.csv", "--paired"], &["error[E0705]: ", "--paired"]),
        (&["a.csv", "none.csv"], &["error[E0701]: ", "none.csv"]),
        (&["-", "-"], &["error[E0701]: ", "once"]),
        (&["a.csv", "empty.csv"], &["error[E0", "empty.csv"]),
        (&["latin.csv", "a.csv"], &["error[E0", "latin.csv", "UTF-8"]),
        (&["a.csv", "a.csv", "-o", "a.csv"], &["error[E0920]: ", "overwrite"]),
    ] {
        let said = place.call(&[&["gait", "compare"], words].concat());
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}\n{}", said.err);
        for part in parts {
            assert!(said.err.contains(part), "{part} of {words:?}\n{}", said.err);
        }
    }
}
