//! A replay line gives the same result again, also after a deadline.

#![allow(clippy::disallowed_methods, reason = "a test reads its own files")]
#![allow(dead_code, reason = "the program is called from other tests too")]

#[path = "cli/program.rs"]
mod program;

use program::{Place, SMALL, timeless};
use serde_json::Value;

const QUERIES: &str = "\
property near = F<=3 s (min(distance(user, a) for a in crowd) < 1.0 m)
estimate P(near) within 0.004
check P(near) >= 0.2 by sprt(indifference = 0.05)
compare P(near) under density = 0.1 /m^2 with density = 0.4 /m^2 within 0.005
rank moves of user by P(near) within 0.002
rank moves of user by E(min<=2 s (clearance(user))) in -1 m .. 6 m within 0.01 m
";

fn again(place: &Place, line: &str) -> Value {
    let words: Vec<&str> = line.split(' ').skip(1).chain(["-q", "--format", "json"]).collect();
    let said = place.call(&words);
    assert!(matches!(said.code, Some(0 | 1 | 3)), "{line}: {}", said.err);
    said.json()
}

fn holds(words: &[&str]) {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", QUERIES)]);
    let mut call = vec!["check", "a.scn", "a.bltl", "-q", "--format", "json"];
    call.extend(words);
    let mut first = place.call(&call).json();
    timeless(&mut first);
    let lines: Vec<&str> = first["replay"].as_str().unwrap().lines().collect();
    for result in first["results"].as_array().unwrap() {
        let line = result["replay"].as_str().unwrap();
        if result["trials"] == 0 {
            continue;
        }
        let mut second = again(&place, line);
        timeless(&mut second);
        let second = &second["results"][0];
        for field in
            ["trials", "successes", "failures", "estimate", "low", "high", "certifies", "options", "gap"]
        {
            assert_eq!(second[field], result[field], "{field} by {line}");
        }
        assert!(lines.len() == 1 || lines.contains(&line));
    }
    if lines.len() == 1 {
        let mut second = again(&place, lines[0]);
        timeless(&mut second);
        for run in [&mut first, &mut second] {
            for result in run["results"].as_array_mut().unwrap() {
                // A deadline is replayed as a largest number of trials.
                result["stopped_by"] = Value::Null;
                result["replay"] = Value::Null;
            }
        }
        assert_eq!(second["results"], first["results"]);
    }
}

#[test]
fn after_a_budget() {
    holds(&["--max-trials", "150"]);
    holds(&["--max-trials", "150", "--only", "3", "--only", "near", "--seed", "7"]);
    holds(&["--total-trials", "333", "--max-trials", "1000", "--only", "4"]);
}

#[test]
fn after_a_deadline() {
    for (only, time) in [("0", "40ms"), ("2", "40ms"), ("3", "30ms"), ("3", "70ms"), ("4", "50ms")] {
        holds(&["--timeout", time, "--only", only, "-j", "2"]);
    }
    holds(&["--timeout", "150ms"]);
}
