//! `smc plot` from the outside: each figure from results as `smc check` and `smc evaluate` write them, evidence that does not
//! depend on threads, and calls that are wrong.

use super::formats::validated;
use crate::program::{Place, SMALL, timeless};
use serde_json::Value;

const ASKED: &str = "property near = F<=3 s (exists a in crowd: distance(user, a) < 3 m)
check P(near) >= 0.5 by sprt(alpha = 0.05, beta = 0.05, indifference = 0.1)
property ahead = F<=3 s (x(user) > 2 m)
check P(ahead) >= 0.5
estimate P(near) within 0.1
estimate Q(0.5, time_until(x(user) > 2 m)) by fixed(trials = 100)
rank moves of user by P(near) within 0.1
compare P(near) under density = 0.1 /m^2 with density = 0.3 /m^2 within 0.3
";

fn place() -> Place {
    let near =
        "property near = F<=3 s (exists a in crowd: distance(user, a) < 1 m)\nestimate P(near) within 0.1\n";
    Place::new(&[("a.scn", SMALL), ("a.bltl", ASKED), ("sweep.bltl", near)])
}

/// The results of a call with its evidence, written to `out.json`.
fn results(place: &Place, words: &[&str]) -> Value {
    let call = [&["check", "a.scn"], words, &["-q", "--evidence", "--format", "json=out.json"]].concat();
    let said = place.call(&call);
    assert!(said.code.is_some_and(|code| code <= 3 && code != 2), "{}", said.err);
    let mut found = serde_json::from_str(&std::fs::read_to_string(place.path("out.json")).unwrap()).unwrap();
    timeless(&mut found);
    found
}

#[test]
fn evidence_grows_up_to_the_result_whatever_the_threads() {
    let place = place();
    let found = results(&place, &["a.bltl", "-j", "1"]);
    for threads in ["2", "8"] {
        assert_eq!(found, results(&place, &["a.bltl", "-j", threads]), "{threads} threads");
    }
    let mut timed = found.clone();
    timed["elapsed_s"] = 0.into();
    timed["results"].as_array_mut().unwrap().iter_mut().for_each(|result| result["elapsed_s"] = 0.into());
    validated(&timed);
    for result in found["results"].as_array().unwrap() {
        let query = &result["query"];
        let snapshots = result["evidence"]["snapshots"].as_array().unwrap();
        let trials: Vec<u64> = snapshots.iter().map(|one| one["trials"].as_u64().unwrap()).collect();
        assert!(trials.windows(2).all(|pair| pair[0] < pair[1]), "{query}: {trials:?}");
        let last = snapshots.last().unwrap();
        if result["kind"] == "rank" {
            let all: u64 =
                result["options"].as_array().unwrap().iter().map(|one| one["trials"].as_u64().unwrap()).sum();
            assert_eq!(last["trials"], all, "{query}");
            continue;
        }
        assert_eq!(trials[..4], [1, 2, 3, 4], "{query}");
        // Of a comparison pairs are counted.
        let sides = if result["kind"] == "compare" { 2 } else { 1 };
        assert_eq!(last["trials"].as_u64().map(|n| sides * n), result["trials"].as_u64(), "{query}");
        for key in ["estimate", "low", "high"] {
            assert_eq!(last[key], result[key], "{query}: {key}");
        }
        // A test decides where its evidence reaches a threshold, and not before.
        let Some(threshold) = result["evidence"]["thresholds"]["above"].as_f64() else { continue };
        let above: Vec<f64> = snapshots.iter().map(|one| one["above"].as_f64().unwrap()).collect();
        assert_eq!(result["verdict"], "satisfied", "{query}");
        let (end, before) = above.split_last().unwrap();
        assert!(*end >= threshold && before.iter().all(|log| *log < threshold), "{query}: {above:?}");
    }
    assert!(
        place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).out.find("evidence").is_none()
    );
}

#[test]
fn each_figure_is_drawn() {
    let place = place();
    results(&place, &["a.bltl"]);
    let draw = |words: &[&str]| {
        let said = place.call(&[&["plot", "out.json"], words].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert!(said.out.starts_with("<svg") && !said.out.contains("NaN"), "{}", said.out);
        said.out
    };
    draw(&["--figure", "evidence", "--only", "0"]);
    draw(&["--figure", "evidence", "--only", "4"]);
    assert!(draw(&["--figure", "evidence", "--only", "5"]).contains("no difference"));
    assert!(draw(&["--figure", "ranking"]).contains("(chosen)"));
    assert!(draw(&["--figure", "distribution"]).contains("quantile 0.5"));
    results(&place, &["sweep.bltl", "--set", "density=0.1 /m^2, 0.2 /m^2, 0.4 /m^2"]);
    let sweep = draw(&["--figure", "sweep"]);
    assert!(sweep.contains("density (/m^2)"), "{sweep}");
    let said = place.call(&["plot", "out.json", "--figure", "sweep", "-o", "sweep.svg"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""));
    assert_eq!(std::fs::read_to_string(place.path("sweep.svg")).unwrap(), sweep);
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let place = place();
    place.write("text.json", b"no JSON");
    place.write("old.json", br#"{ "schema": 2, "results": [] }"#);
    place.write("none.json", br#"{ "schema": 3, "results": [] }"#);
    let calls: [&[&str]; 6] = [
        &["text.json", "--figure", "sweep"],
        &["old.json", "--figure", "sweep"],
        &["none.json", "--figure", "evidence"],
        &["none.json", "--figure", "calibration"],
        &["none.json", "--figure", "sweep", "-o", "none.json"],
        &["missing.json", "--figure", "sweep"],
    ];
    let said = calls.map(|words| {
        let said = place.call(&[&["plot"], words].concat());
        assert_eq!(said.code, Some(2), "{words:?}");
        format!("{}\n{}", words.join(" "), said.err)
    });
    insta::assert_snapshot!(said.join("\n"));
}
