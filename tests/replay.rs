//! A replay line gives the same result again, also after a deadline.

use crate::program::{Place, SMALL, timeless};
use serde_json::Value;

/// The level of its procedure is in no table and has to be proven.
const PROVEN: &str = "\
property near = F<=1 s (min(distance(user, a) for a in crowd) < 2.5 m)
estimate P(near) within 0.03
";

const QUERIES: &str = "\
property near = F<=3 s (min(distance(user, a) for a in crowd) < 1.0 m)
estimate P(near) within 0.004
check P(near) >= 0.2 by sprt(indifference = 0.05)
compare P(near) under density = 0.1 /m^2 with density = 0.4 /m^2 within 0.005
rank moves of user by P(near) within 0.002
rank moves of user by E(min<=2 s (clearance(user))) in -1 m .. 6 m within 0.01 m
rank density in 0.1 /m^2 .. 0.4 /m^2 by 0.1 /m^2 by P(near) within 0.002
";

fn again(place: &Place, line: &str) -> Value {
    let words: Vec<&str> = line.split(' ').skip(1).chain(["-q", "--format", "json"]).collect();
    let said = place.call(&words);
    assert!(matches!(said.code, Some(0 | 1 | 3 | 4)), "{line}: {}", said.err);
    said.json()
}

fn holds(words: &[&str]) {
    of(QUERIES, words);
}

fn of(queries: &str, words: &[&str]) {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", queries)]);
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
        for field in [
            "method",
            "trials",
            "successes",
            "failures",
            "estimate",
            "low",
            "high",
            "certifies",
            "options",
            "gap",
        ] {
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
    for (only, time) in
        [("0", "40ms"), ("2", "40ms"), ("3", "30ms"), ("3", "70ms"), ("4", "50ms"), ("5", "90ms")]
    {
        holds(&["--timeout", time, "--only", only, "-j", "2"]);
    }
    holds(&["--timeout", "150ms"]);
}

/// Neither the clock nor the largest number of trials chooses the procedure.
#[test]
fn the_procedure_comes_from_the_property_alone() {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", PROVEN)]);
    let result = |words: &[&str]| {
        let call = ["check", "a.scn", "a.bltl", "-q", "--format", "json"];
        place.call(&[&call[..], words].concat()).json()["results"][0].clone()
    };
    let free = result(&[]);
    assert_eq!((&free["method"]["name"], &free["stopped_by"]), (&"calibrated".into(), &"width".into()));
    assert!(free["method"]["gamma"].as_f64().is_some_and(|gamma| gamma < 0.05), "{free:#}");
    let timed = result(&["--timeout", "10min"]);
    for field in ["method", "trials", "successes", "low", "high", "interval"] {
        assert_eq!(timed[field], free[field], "{field}");
    }
    // Stopped before its level matters, it looks for none; nothing else changes.
    let late = (free["trials"].as_u64().unwrap() - 1).to_string();
    for most in ["0", "5", "200", late.as_str()] {
        let mut capped = result(&["--max-trials", most])["method"].take();
        if capped["name"] == "default" {
            capped["name"] = free["method"]["name"].clone();
            capped["gamma"] = free["method"]["gamma"].clone();
        } else {
            assert_eq!(most, late);
        }
        assert_eq!(capped, free["method"], "{most}");
    }
    of(PROVEN, &["--max-trials", "200"]);
    of(PROVEN, &["--max-trials", &late]);
    // Where few trials do, the level may end it at the trial at which it waits: at a budget of so many, too.
    for (within, most) in
        [("0.3", "5"), ("0.35", "4"), ("0.4", "3"), ("0.25", "9"), ("0.1 confidence 99.99 %", "9")]
    {
        let queries = format!(
            "property never = F<=1 s (min(distance(user, a) for a in crowd) < -1 m)\nestimate P(never) within {within}\n"
        );
        of(&queries, &["--max-trials", most]);
        let place = Place::new(&[("a.scn", SMALL), ("a.bltl", &queries)]);
        let result = |words: &[&str]| {
            let call = ["check", "a.scn", "a.bltl", "-q", "--format", "json"];
            let mut said = place.call(&[&call[..], words].concat()).json();
            timeless(&mut said);
            said["results"][0].clone()
        };
        let free = result(&[]);
        let trials = free["trials"].to_string();
        let capped = result(&["--max-trials", &trials]);
        for field in ["method", "trials", "low", "high", "stopped_by"] {
            assert_eq!(capped[field], free[field], "{field} within {within}");
        }
    }
    for time in ["200ms", "300ms", "400ms"] {
        of(PROVEN, &["--timeout", time]);
    }
}

/// A proof takes seconds at 0.0056. While it waits for its turn, trials are read for everybody.
#[test]
fn no_proof_keeps_others_from_their_trials() {
    let queries = "\
        property near = F<=3 s (min(distance(user, a) for a in crowd) < 1.0 m)\n\
        estimate P(near) within 0.0056\n\
        estimate P(near) within 0.05\n\
        check P(near) >= 0.9 by sprt(indifference = 0.05)\n";
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", queries)]);
    let call = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--timeout", "1200ms"];
    let said = place.call(&call).json();
    let results = said["results"].as_array().unwrap();
    assert_eq!(results[0]["stopped_by"], "deadline", "{said:#}");
    assert!(results[0]["trials"].as_u64().unwrap() > 100, "{said:#}");
    assert!(results[0]["low"].as_f64().unwrap() > 0.9, "{said:#}");
    assert_eq!(results[1]["stopped_by"], "width", "{said:#}");
    assert_eq!(results[2]["stopped_by"], "boundary", "{said:#}");
    of(queries, &["--timeout", "1s"]);
}
