//! Estimates by splitting in property files: near the exact value, the plain trials beside them, refused where
//! these contradict, and the same bytes with any number of threads.

use crate::program::{Place, SMALL, timeless};
use serde_json::Value;

/// Wins with probability 0.3; many paths share a level.
const GAMBLER: &str = r#"scenario "Gambler"
horizon = 400 steps
process gambler {
  var wealth: 0 .. 14 = 2
  when wealth > 0 & wealth < 14 -> 0.3: wealth = wealth + 1 | 0.7: wealth = wealth - 1
}
"#;

fn run(model: &str, properties: &str, words: &[&str]) -> Value {
    let place = Place::new(&[("a.scn", model), ("a.bltl", properties)]);
    let mut call = vec!["check", "a.scn", "a.bltl", "-q", "--format", "json"];
    call.extend(words);
    let said = place.call(&call);
    let cut = words.contains(&"--max-trials");
    assert_eq!(said.code, Some(if cut { 4 } else { 0 }), "{}", said.err);
    let mut json = said.json();
    timeless(&mut json);
    json
}

fn text(model: &str, properties: &str) -> String {
    let place = Place::new(&[("a.scn", model), ("a.bltl", properties)]);
    place.call(&["check", "a.scn", "a.bltl", "-q"]).out
}

#[test]
fn a_gambler_is_lucky_as_often_as_the_formula_says() {
    let ratio: f64 = 0.7 / 0.3;
    let exact = (ratio.powi(2) - 1.0) / (ratio.powi(14) - 1.0);
    for (method, runs) in [("splitting", 40.0), ("fixed_effort", 40.0)] {
        let properties = format!(
            "estimate P(F (gambler.wealth >= 14)) by {method}(replicas = 200, runs = 40, plain = 2000)\n"
        );
        // With an error of 5 % a floor may lie above; at this seed it does not.
        let result = &run(GAMBLER, &properties, &["--seed", "1"])["results"][0];
        let number = |field: &str| result["splitting"][field].as_f64().unwrap();
        let error = number("deviation") / f64::sqrt(runs);
        assert!((number("estimate") - exact).abs() < 4.0 * error, "{method}: {exact} and {result}");
        assert!(error < 0.3 * exact, "{method}: it is worth it");
        assert_eq!(result["splitting"]["agrees"], true);
        assert_eq!(result["estimate"], result["splitting"]["estimate"]);
        assert_eq!(result["trials"], 2000);
        assert!(result["interval"].as_str().unwrap().starts_with("asymptotic, 95 %"), "{result}");
        // Only the plain trials certify anything: none of 2000.
        let certified = result["certifies"].as_str().unwrap();
        assert!(certified.contains("<= 0.0015, error at most 0.05"), "{certified}");
        // From below the runs do.
        assert!(certified.contains("; P(F (gambler.wealth >= 14)) >= 0.0000"), "{certified}");
        assert!(number("floor") <= exact && number("floor") > 0.3 * exact, "{result}");
        assert!(result["replay"].as_str().unwrap().contains("--only 0 --seed 1"));
    }
}

#[test]
fn threads_change_no_byte() {
    let gambler = "estimate P(F (gambler.wealth >= 14)) by splitting(replicas = 50, runs = 4, plain = 500)\n\
                   estimate P(F (gambler.wealth >= 12)) by fixed_effort(replicas = 50, runs = 4, plain = 500)\n";
    let crowd =
        "estimate P(F<=3 s (clearance(user) < -0.05 m)) by splitting(replicas = 20, runs = 2, plain = 100)\n";
    for (model, properties) in [(GAMBLER, gambler), (SMALL, crowd)] {
        let threads = |n: &str| run(model, properties, &["-j", n]).to_string();
        let one = threads("1");
        assert_eq!(threads("2"), one);
        assert_eq!(threads("8"), one);
    }
}

/// What comes out of the blue is no matter of level.
const FAULT: &str = r#"scenario "Fault"
horizon = 50 steps
process machine {
  var load: 0 .. 40 = 0
  var broken = false
  when load < 40 & !broken -> 0.001: broken = true | 0.2: load = load + 1 | 0.799: load = max(load - 1, 0)
}
"#;

#[test]
fn what_the_plain_trials_contradict_is_refused() {
    let properties = "estimate P(F (machine.broken | machine.load >= 30)) by splitting(replicas = 10, runs = 2, plain = 10000)\n";
    let result = &run(FAULT, properties, &[])["results"][0];
    assert_eq!(result["splitting"]["agrees"], false, "{result}");
    let warnings = result["warnings"].to_string();
    assert!(warnings.contains("E0802") && warnings.contains("refused"), "{warnings}");
    assert_eq!(result["estimate"], Value::Null, "{result}");
    assert!(result["low"].as_f64().unwrap() > 0.02, "what the plain trials say: {result}");
    assert_eq!(result["method"]["name"], "clopper_pearson");
    assert!(text(FAULT, properties).contains("E0802"));
}

#[test]
fn an_event_that_never_comes_nearer_is_refused() {
    let properties =
        "estimate P(G (gambler.wealth >= 2)) by splitting(replicas = 10, runs = 2, plain = 100)\n";
    let place = Place::new(&[("a.scn", GAMBLER), ("a.bltl", properties)]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    assert!(json["results"][0]["warnings"].to_string().contains("E0802"), "{json}");
}

#[test]
fn a_budget_cuts_it_short_and_says_so() {
    let properties =
        "estimate P(F (gambler.wealth >= 14)) by splitting(replicas = 200, runs = 10, plain = 1000)\n";
    let result = &run(GAMBLER, properties, &["--max-trials", "3500"])["results"][0];
    assert_eq!((&result["stopped_by"], &result["splitting"]["estimate"]), (&"cap".into(), &Value::Null));
    assert!(result["warnings"].to_string().contains("ended before"), "{result}");
    let plain = &run(GAMBLER, properties, &["--max-trials", "300"])["results"][0];
    assert_eq!((&plain["stopped_by"], &plain["trials"]), (&"cap".into(), &300.into()));
}

/// A door through which the first one comes after a while.
const DOOR: &str = r#"scenario "Door"
horizon = 6 s
step = 0.1 s
kind person: sfm preset helbing2000 { noise = 0.2 m/s }
source door: person { at = (0, 0); velocity = (1, 0) m/s; every = uniform(1 s, 2 s); route = (50, 0) }
"#;

#[test]
fn a_mean_of_nobody_loses_no_path_where_nobody_asks_for_it() {
    let fast = "F[3 s, 5 s] (mean(speed(a) for a in door) > 1.9 m/s)";
    let properties = format!("estimate P({fast}) by splitting(replicas = 50, runs = 4, plain = 200)\n");
    let result = &run(DOOR, &properties, &[])["results"][0];
    assert_eq!(result["unresolved"], 0, "{result}");
    assert!(!result["warnings"].to_string().contains("unresolved"), "{result}");
    assert!(result["splitting"]["estimate"].as_f64().unwrap() > 0.0, "{result}");
}
