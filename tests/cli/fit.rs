//! `smc fit` from the outside: a parameter of a synthetic recording, threads, and calls that do not fit.

use crate::program::Place;
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Command, Stdio};

/// Thirty people, far from each other, who walk east at 1 m/s. From 2 s on each keeps a turn of its own: the quantiles of a
/// normal law of 20 degrees.
fn turning() -> String {
    let mut rows = String::from("time,id,x,y\n");
    let count = 30;
    for id in 0..count {
        // Quantiles of the logistic law with this standard deviation, close to normal.
        let p = (f64::from(id) + 0.5) / f64::from(count);
        let turn = (p / (1.0 - p)).ln() * 20.0 * 3_f64.sqrt() / std::f64::consts::PI;
        let (sin, cos) = turn.to_radians().sin_cos();
        for k in 0..=18 {
            let time = 0.4 * f64::from(k);
            let (ahead, after) = (time.min(2.0), (time - 2.0).max(0.0));
            let (x, y) = (50.0 * f64::from(id) + ahead + after * cos, after * sin);
            rows += &format!("{time},{},{x},{y}\n", id + 1);
        }
    }
    rows
}

const MODEL: &str = "horizon = 4.8 s\nstep = 0.1 s\ntracks here = csv \"t.csv\"\n\
    kind adult: sfm preset helbing2000 { A = 0 N; tau = 0.1 s; noise = 0.02 m/s }\n\
    agent user: adult from here at 0 s id 1 { heading = recorded + normal(0 deg, 5 deg) }\n\
    agents others: adult from here at 0 s except 1 { heading = recorded + normal(0 deg, 5 deg) }\n";

fn place(model: &str) -> Place {
    let near = "property north = F<=4.8 s (y(user) > 1 m)\n";
    Place::new(&[("a.scn", model), ("near.bltl", near), ("t.csv", &turning())])
}

const CALL: [&str; 8] = ["fit", "a.scn", "--tracks", "here", "--every", "2s", "--from", "2s"];

#[test]
fn a_fit_recovers_the_law_of_a_recording_with_the_same_bytes_at_any_number_of_threads() {
    let place = place(MODEL);
    let words = ["--to", "2.2s", "--parameters", "heading", "--generations", "12", "--held-out", "10%"];
    let json = |threads: &str| {
        place.call(&[&CALL[..], &words[..], &["--format", "json", "--quiet", "-j", threads]].concat())
    };
    let said = json("1");
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{}", said.out);
    for threads in ["2", "8"] {
        assert_eq!(json(threads).out, said.out, "{threads} threads");
    }
    let found = said.json();
    let schema: Value = serde_json::from_str(include_str!("../../docs/schema/fit.schema.json")).unwrap();
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&found), "{found:#}");
    let heading = found["parameters"][0]["value"].as_f64().unwrap();
    assert!((heading - 20.0).abs() < 6.0, "{heading} degrees");
    assert_eq!(found["parameters"][0]["start"].as_f64().map(f64::round), Some(5.0));
    assert!(found["fitted"]["gain"]["estimate"].as_f64().unwrap() > 0.0);
    // What it prints is a scenario again.
    let text = place.call(&[&CALL[..], &words[..]].concat());
    assert!(text.err.starts_with("generation 1: best "), "{}", text.err);
    assert!(text.out.contains("heading = recorded + normal(0 deg, "), "{}", text.out);
    let block = found["block"].as_str().unwrap();
    let shown = Place::new(&[("b.scn", &format!("{MODEL}{block}")), ("t.csv", &turning())]);
    assert_eq!(shown.call(&["show", "b.scn"]).code, Some(0));
}

#[test]
fn a_property_can_be_fitted_too() {
    let words = ["--to", "2.2s", "--parameters", "heading", "--generations", "6", "--by", "near.bltl"];
    let said = place(MODEL).call(&[&CALL[..], &words[..], &["--format", "json", "--quiet"]].concat());
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    let found = said.json();
    assert_eq!(found["score"], "brier");
    let [before, after] =
        ["/fitted/model", "/fitted/fitted/estimate"].map(|at| found.pointer(at).unwrap().as_f64().unwrap());
    assert!(after < before, "{after} {before}");
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let place = place(MODEL);
    let refused = |words: &[&str]| {
        let said = place.call(&[&CALL[..], words].concat());
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{}", said.err);
        said.err
    };
    let all = [
        refused(&["--parameters", "B", "--quiet"]),
        refused(&["--parameters", "heading,stride"]),
        refused(&["--parameters", "tau", "--speed", "1.1"]),
        refused(&["--parameters", "tau", "--kind", "walker"]),
        refused(&["--parameters", "tau", "--quiet", "--generations", "1", "--test", "none.scn"]),
    ];
    insta::assert_snapshot!("fit_refused", all.join("\n"));
}

#[cfg(unix)]
#[test]
fn an_interrupted_fit_prints_its_best() {
    let place = place(MODEL);
    let words = ["--parameters", "heading", "--population", "40", "--generations", "1e6", "--trials", "400"];
    let mut child = place
        .command(&[&CALL[..], &words[..], &["--format", "json"]].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut log, mut line) = (BufReader::new(child.stderr.take().unwrap()), String::new());
    log.read_line(&mut line).unwrap();
    assert!(line.starts_with("generation 1: "), "{line}");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    log.read_to_string(&mut line).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{line}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found["parameters"][0]["value"].as_f64().unwrap() > 5.0, "{found:#}");
}
