//! Shapes of formulas and worlds that grow: shared parts, many levels, wide windows, long horizons, large crowds. What
//! each takes grows with its size and no faster, so all of them are over in no time; a limit says so where one is
//! exceeded by far.

use crate::program::{Place, Said};
use serde_json::Value;

/// A walk over three values; it takes `horizon` steps.
fn walk(horizon: u32) -> String {
    format!(
        "horizon = {horizon} steps\n\
         process c {{\n\
           var x: 0 .. 3 = 0\n\
           when true -> 1/2: x = 0 | 1/4: x = 1 | 1/4: x = 2\n\
         }}\n"
    )
}

/// The walk, and ninety coins.
fn coins() -> String {
    let coins = "process many[90] {\n var x: 0 .. 1 = 0\n when true -> 1/2: x = 0 | 1/2: x = 1\n}\n";
    walk(20) + coins
}

/// The call ends well before this many seconds: a hundred times what it takes.
const LIMIT: &str = "20s";

fn asked(scenario: &str, properties: &str, words: &[&str]) -> Said {
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", properties)]);
    let mut call = vec!["check", "a.scn", "a.bltl", "-q", "--timeout", LIMIT];
    call.extend(words);
    place.call(&call)
}

fn results(scenario: &str, properties: &str) -> Vec<Value> {
    let said = asked(scenario, properties, &["--format", "json"]);
    assert!(matches!(said.code, Some(0 | 1 | 3 | 4)), "{}", said.err);
    let results = said.json()["results"].as_array().unwrap().clone();
    for result in &results {
        assert_ne!(result["stopped_by"], "deadline", "{result}");
    }
    results
}

/// `a <=> (b <=> (c <=> …))`.
fn chained(levels: usize, level: impl Fn(usize) -> String) -> String {
    (1..levels).fold(level(0), |inner, k| format!("{} <=> ({inner})", level(k)))
}

#[test]
fn a_count_of_many_formulas_shares_its_parts() {
    let found = results(
        &coins(),
        "estimate P(count(a in many: F<=5 steps (a.x == 1)) >= 6) by fixed(trials = 16)\n\
         estimate P(count(a in many: F<=1 steps (a.x == 1)) >= 60) by fixed(trials = 16)\n",
    );
    assert_eq!(found[0]["successes"], 16);
    assert!(found[1]["successes"].as_u64().unwrap() < 16);
}

#[test]
fn two_hundred_levels_of_iff_over_time() {
    let formula = chained(200, |k| format!("F<={} steps (c.x == {})", 1 + k % 5, k % 3));
    let found = results(
        &walk(20),
        &format!(
            "estimate P({formula}) by fixed(trials = 16)\n\
             estimate P(G<=10 steps ({formula})) by fixed(trials = 16)\n"
        ),
    );
    assert_eq!(found.len(), 2);
    let witness = found[0]["witnesses"][0]["what"].as_str().unwrap();
    assert!(witness.contains("`c.x =="), "{witness}");
}

#[test]
fn two_hundred_levels_of_iff_over_states() {
    // Each level that is false turns the truth around: x = 0 makes a third of the levels true.
    let formula = chained(200, |k| format!("c.x == {}", k % 3));
    let found = results(
        &walk(20),
        &format!(
            "estimate P({formula}) by fixed(trials = 16)\n\
             estimate P(G<=5 steps ({formula} <=> ({formula}))) by fixed(trials = 16)\n\
             estimate P(F<=5 steps !({formula} <=> ({formula}))) by fixed(trials = 16)\n\
             estimate E(robustness(F<=5 steps ({}))) in -5 .. 5 by fixed(trials = 16)\n",
            chained(200, |k| format!("c.x < {}", k % 4)),
        ),
    );
    // 67 levels say 0, of 200: 133 are false, an odd number.
    assert_eq!(found[0]["successes"], 0);
    assert_eq!((&found[1]["successes"], &found[2]["successes"]), (&16.into(), &0.into()));
    assert!(found[3]["estimate"].is_number());
}

#[test]
fn two_hundred_levels_of_iff_in_continuous_time() {
    let scenario = "horizon = 20 s\nprocess c { var x: 0 .. 1 = 0\n when true at 1 /s -> x = 1 - x }\n";
    let formula = chained(200, |k| format!("F<={} s (c.x == {})", 1 + k % 5, k % 2));
    let found = results(scenario, &format!("estimate P({formula}) by fixed(trials = 16)\n"));
    assert!(found[0]["successes"].is_number());
}

#[test]
fn explaining_nested_windows_takes_the_states_once() {
    let found = results(
        &walk(40_000),
        "estimate P(G<=20000 steps G<=15000 steps (c.x < 3)) by fixed(trials = 2)\n\
         estimate P(G<=20000 steps F<=15000 steps (c.x == 2)) by fixed(trials = 2)\n\
         estimate P(F<=20000 steps G<=15000 steps (c.x < 2)) by fixed(trials = 2)\n",
    );
    assert_eq!((&found[0]["successes"], &found[1]["successes"]), (&2.into(), &2.into()));
    assert_eq!(found[2]["successes"], 0);
    let fails = found[2]["witnesses"][0]["what"].as_str().unwrap();
    assert!(fails.starts_with("`c.x < 2` is false"), "{fails}");
}

#[test]
fn robustness_over_a_long_horizon_takes_the_states_once() {
    let found = results(
        &walk(40_000),
        "estimate E(robustness(G F (c.x < 2))) in -5 .. 5 by fixed(trials = 8)\n\
         estimate E(robustness(G<=20000 steps F<=15000 steps (c.x > 1))) in -5 .. 5 by fixed(trials = 8)\n",
    );
    assert_eq!(found[1]["estimate"], 1.0, "x is 2 again and again");
    assert!(found[0]["estimate"].as_f64().unwrap() <= 2.0);
}

#[test]
fn the_left_operand_of_an_until_is_not_needed_in_the_last_state() {
    let properties = "estimate P((F<=18 steps (c.x == 1)) U<=3 steps (c.x == 1)) by fixed(trials = 64)\n\
                      estimate P((X (c.x == 1)) U (c.x == 2)) by fixed(trials = 64)\n\
                      estimate P((c.x == 3) R<=3 steps (c.x < 3)) by fixed(trials = 64)\n";
    let found = results(&walk(20), properties);
    assert!(found[0]["successes"].as_u64().unwrap() > 0);
    assert_eq!(found[2]["successes"], 64);
    let said = asked(&walk(19), "estimate P((F<=18 steps (c.x == 1)) U<=3 steps (c.x == 1))\n", &[]);
    let refused = "the formula needs 20 steps, but the horizon is 19 steps";
    assert!(said.code == Some(2) && said.err.contains(refused), "{}", said.err);
    let said = asked(&walk(20), "estimate P((X (c.x == 1)) W (c.x == 2))\n", &[]);
    assert!(said.code == Some(2) && said.err.contains("the formula needs 21 steps"), "{}", said.err);
}

#[test]
fn thousands_of_conditions_are_compared_with_few() {
    let properties: String =
        (0..4_900).map(|k| format!("property p{k} = F<={} steps (c.x == {k} / 7)\n", 1 + k % 15)).collect();
    let said = asked(&walk(20), &format!("{properties}estimate P(p1 | p4899) by fixed(trials = 8)\n"), &[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
}

#[test]
fn names_bound_inside_a_name_hide_those_outside() {
    // `v` as an argument and as a running agent is not the property `v`, so these are counts of one state.
    let properties = "\
property v = F<=1 s (travelled(user) > 0 m)
let slow(v) = v < 1 m/s
let busy = count(v in crowd: speed(v) > 0.5 m/s)
property p = G<=1 s (count(a in crowd: slow(speed(a))) * 2 >= 0)
property q = G<=1 s (count(a in crowd: speed(a) > 0 m/s & busy > 1) * 2 >= 0)
estimate P(p), P(q) by fixed(trials = 16)
";
    let found = results(crate::program::SMALL, properties);
    assert_eq!((&found[0]["successes"], &found[1]["successes"]), (&16.into(), &16.into()));
    // A name that does stand for a temporal formula is still one.
    let said = asked(
        crate::program::SMALL,
        "property v = F<=1 s (travelled(user) > 0 m)\nlet w = v\nproperty p = count(a in crowd: w) * 2 >= 0\nestimate P(p)\n",
        &[],
    );
    assert_eq!(said.code, Some(2), "{}", said.out);
}

#[test]
fn zero_has_no_negative_powers_and_nothing_compares_with_no_number() {
    for formula in ["0 ^ -1", "(1 - 1) ^ -0.5", "1 / 0", "(0 - 1) ^ 0.5"] {
        let said = asked(&walk(20), &format!("estimate P(F (c.x > {formula}))\n"), &[]);
        assert!(said.code == Some(2) && said.err.contains("E0405"), "{formula}: {}", said.err);
    }
    // Neither equal nor unequal.
    let found = results(
        &walk(20),
        "estimate P(F (sqrt(c.x - 9) != 1)), P(F (sqrt(c.x - 9) == 1)) by fixed(trials = 16)\n",
    );
    assert!(found.iter().all(|result| result["successes"] == 0), "{found:?}");
}

#[test]
fn a_time_that_is_always_soon_enough_needs_no_state() {
    let found = results(
        &walk(20),
        "estimate P(time_until(c.x == 3) <= ∞) by fixed(trials = 4)\n\
         estimate P(time_until(c.x == 3) < ∞) by fixed(trials = 4)\n",
    );
    assert_eq!((&found[0]["successes"], &found[1]["successes"]), (&4.into(), &0.into()));
    let what = |k: usize| found[k]["witnesses"][0]["what"].as_str().unwrap().to_owned();
    assert_eq!(what(0), "its value does not depend on the trial");
    assert_eq!(what(1), "`c.x == 3` is false");
}

#[test]
fn witnesses_in_continuous_time_say_what_lasted() {
    let found = [
        ("models/tandem.scn", "properties/tandem.bltl"),
        ("models/epidemic.scn", "properties/epidemic.bltl"),
    ];
    for (scenario, properties) in found {
        let said = crate::program::at_root(&[
            "check",
            scenario,
            properties,
            "-q",
            "--format",
            "json",
            "--max-trials",
            "400",
        ]);
        for result in said.json()["results"].as_array().unwrap() {
            for witness in result["witnesses"].as_array().into_iter().flatten() {
                assert_ne!(witness["what"], "", "{}", result["text"]);
            }
        }
    }
}
