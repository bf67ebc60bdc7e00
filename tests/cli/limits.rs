//! Limits of time, memory and output, where nothing is sampled yet.

use super::formats::validated;
use crate::program::{Place, SMALL};
use std::fmt::Write as _;
use std::process::{Command, Stdio};

const ASK: &str = "check P(F<=1 s contact(user)) >= 0.5\n";

/// Walls in parallel whose surroundings overlap: to see that no two of so many meet takes far longer than a second.
fn parallel() -> String {
    let line = |k: u32| {
        let shift = f64::from(k) * 0.1;
        format!("LINESTRING (-9000 {}, 9000 {})\n", shift - 6000.0, shift + 10_000.0)
    };
    (0..30_000).map(line).collect()
}

fn slow() -> Place {
    let place = Place::new(&[("a.bltl", ASK), ("w.wkt", &parallel())]);
    place.write("a.scn", format!("scene {{ import \"w.wkt\" }}\n{SMALL}").as_bytes());
    place
}

#[test]
fn time_ends_a_call_that_is_still_preparing() {
    let place = slow();
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--timeout", "200ms", "--format", "json"]);
    assert_eq!(said.code, Some(3), "{}", said.err);
    assert_eq!(
        said.err.lines().next(),
        Some("error[E0921]: the time limit ended the call before the first trial")
    );
    let json = said.json();
    validated(&json);
    assert_eq!((&json["results"], &json["interrupted"]), (&serde_json::json!([]), &false.into()));
    assert_eq!(json["error"]["message"], "the time limit ended the call before the first trial");
    assert_eq!(json["diagnostics"][0]["code"], "E0921");
}

#[test]
fn time_ends_calls_without_results_and_leaves_no_file() {
    let place = slow();
    place.write("b.scn", SMALL.as_bytes());
    for words in [
        &["show", "a.scn"][..],
        &["path", "a.scn"],
        &["walk", "a.scn"],
        &["simulate", "b.scn", "-n", "1000000000", "-o", "b.csv"],
    ] {
        let said = place.call(&[words, &["--timeout", "200ms"]].concat());
        assert_eq!(said.code, Some(3), "{words:?}: {}", said.err);
        assert!(said.err.starts_with("error[E0921]: the time limit ended the call\n"), "{}", said.err);
        assert_eq!(std::fs::read_dir(place.path(".")).unwrap().count(), 4, "{words:?}");
    }
}

#[test]
fn a_picture_of_a_million_agents_is_refused() {
    let crowd = "scene { region hall: rect (0, 0) .. (900, 900) }\nagents crowd[200000]: adult { at = uniform in hall }\n";
    let place = Place::new(&[(
        "a.scn",
        &format!("horizon = 1 s; step = 0.02 s\nkind adult: sfm preset smc1\n{crowd}"),
    )]);
    let said = place.call(&["show", "a.scn", "--format", "svg"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("a picture shows at most 100000 agents (got 200000)"), "{}", said.err);
}

#[test]
fn a_signal_ends_a_call_that_is_still_preparing() {
    let place = slow();
    let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json"];
    let child = place.command(&words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(700));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    validated(&json);
    assert_eq!((&json["results"], &json["interrupted"]), (&serde_json::json!([]), &true.into()));
}

#[test]
fn more_memory_than_there_may_be_is_refused_with_its_number() {
    let query =
        "property p = F<=1 s contact(user)\nestimate P(p) by splitting(replicas = 1000000, runs = 1000)\n";
    let metrics = "estimate E(speed(user) at end) in 0 m/s .. 9 m/s by fixed(trials = 200000000)\n\
                   estimate Q(50 %, speed(user) at end) by fixed(trials = 200000000)\n";
    let place = Place::new(&[("a.scn", SMALL), ("s.bltl", query), ("m.bltl", metrics)]);
    let said = place.call(&["check", "a.scn", "s.bltl"]);
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert!(
        said.err.starts_with("error[E0923]: 1000000000 paths need 400.0 GB of memory; the limit is 2.0 GB"),
        "{}",
        said.err
    );
    let said = place.call(&["check", "a.scn", "m.bltl", "--max-trials", "200000000"]);
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert!(
        said.err.starts_with("error[E0923]: the values of metrics need 3.2 GB; the limit is 2.1 GB"),
        "{}",
        said.err
    );
    let said = place.call(&["check", "a.scn", "m.bltl", "--max-trials", "20", "-q"]);
    assert!(!said.err.contains("E0923"), "{}", said.err);
}

#[test]
fn errors_of_a_kind_are_shown_up_to_a_hundred_and_then_counted() {
    let mut text = String::new();
    for k in 0..250 {
        let _ = writeln!(text, "check P(q{k}) >= 0.5");
    }
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", &format!("{text}check P(1 < 2) >= 2\n"))]);
    let said = place.call(&["check", "a.scn", "a.bltl", "--format", "json"]);
    assert_eq!(said.code, Some(2));
    assert_eq!(said.err.matches("error[E0201]: unknown name `q").count(), 100, "{}", said.err);
    assert!(said.err.contains("error[E0201]: 150 more of this kind\n"), "{}", said.err);
    assert!(said.err.contains("error[E0601]"), "another kind is shown: {}", said.err);
    let message = said.json()["error"]["message"].as_str().unwrap().to_owned();
    assert!(message.contains("and 250 more errors"), "{message}");
}

#[test]
fn conditions_are_counted_by_query() {
    let mut text = String::new();
    for k in 1..=600 {
        let _ = writeln!(
            text,
            "estimate P(forall a in crowd: F<=1 s speed(a) > 0.{k:04} m/s) by fixed(trials = 1)"
        );
    }
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", &text)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--set", "density=0.8"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    // One that has too many is refused, and nothing else is said of it.
    place.write(
        "a.bltl",
        b"estimate P(forall a in crowd: F<=1 s (speed(a) > 0.1 m/s)) by fixed(trials = 1)\n",
    );
    let crowded = SMALL.replace("in 0 /m^2 .. 1 /m^2", "in 0 /m^2 .. 1000 /m^2");
    assert_ne!(crowded, SMALL);
    place.write("a.scn", crowded.as_bytes());
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--set", "density=400"]);
    assert_eq!((said.code, said.err.matches("E0211").count()), (Some(2), 1), "{}", said.err);
    assert!(!said.err.contains("W0501"), "{}", said.err);
}

#[test]
fn a_hint_lists_no_more_names_than_somebody_reads() {
    let mut states = String::new();
    for k in 0..50 {
        let _ = writeln!(
            states,
            "  state s{k} {{ after exponential(8 s) -> {} }}",
            if k == 0 { "elsewhere" } else { "s0" }
        );
    }
    let place = Place::new(&[("a.scn", &format!("{SMALL}behaviour b {{\n{states}}}\n"))]);
    let said = place.call(&["show", "a.scn"]);
    assert!(said.err.contains("s18, s19 and 30 more\n"), "{}", said.err);
}
