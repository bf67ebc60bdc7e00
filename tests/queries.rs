//! What queries ask for, seen from outside: strict checks of quantiles, combinations of sweeps, errors of families,
//! widths with units, ranges of procedures, rankings with small budgets.

use crate::program::{Place, SMALL, Said, written};
use serde_json::Value;

/// `c.x` ends as 1 with probability `p`, else as 2.
const COIN: &str = "scenario \"coin\"\nhorizon = 1 steps\nparam p = 0.3 in 0 .. 1\nparam q = 0.5 in 0 .. 1\n\
    process c {\n  var x: 0 .. 2 = 0\n  when x == 0 -> p: x = 1 | 1 - p: x = 2\n}\n";

fn called(scenario: &str, properties: &[&str], words: &[&str]) -> Said {
    let place = Place::new(&[("a.scn", scenario)]);
    let names: Vec<String> = (0..properties.len()).map(|k| format!("{k}.bltl")).collect();
    for (name, text) in names.iter().zip(properties) {
        place.write(name, text.as_bytes());
    }
    let mut call = vec!["check", "a.scn"];
    call.extend(names.iter().map(String::as_str));
    call.push("-q");
    call.extend(words);
    if !words.contains(&"--format") {
        call.extend(["--format", "json"]);
    }
    place.call(&call)
}

fn results(scenario: &str, properties: &str, words: &[&str]) -> Vec<Value> {
    called(scenario, &[properties], words).json()["results"].as_array().unwrap().clone()
}

/// The numbers of the procedure of each result by this name.
fn numbers(said: &Said, name: &str) -> Vec<f64> {
    let json = said.json();
    json["results"].as_array().unwrap().iter().map(|r| r["method"][name].as_f64().unwrap()).collect()
}

/// Of a metric with steps, `<` and `<=` differ, and so do `>` and `>=`.
#[test]
fn checks_of_quantiles_are_right_at_the_values_of_a_metric() {
    let mut asked = Vec::new();
    for (level, quantile) in [(0.1, 1.0), (0.5, 2.0), (0.9, 2.0)] {
        for bound in [0.5, 1.0, 1.5, 2.0, 2.5] {
            for (sign, holds) in [
                ("<", quantile < bound),
                ("<=", quantile <= bound),
                (">", quantile > bound),
                (">=", quantile >= bound),
            ] {
                asked.push((format!("check Q({level}, c.x at end) {sign} {bound}"), holds));
            }
        }
    }
    let text: String = asked.iter().map(|(query, _)| format!("{query}\n")).collect();
    let found = results(COIN, &text, &[]);
    assert_eq!(found.len(), asked.len());
    for (result, (query, holds)) in found.iter().zip(&asked) {
        let verdict = if *holds { "satisfied" } else { "violated" };
        assert_eq!(result["verdict"], verdict, "{query}: {result}");
        // What is certified is about the trials that were counted, and true.
        let claim = result["certifies"].as_str().unwrap().split_once(", tested as ").unwrap().1;
        let (strict, rest) = match claim.strip_prefix("P(c.x at end <= ") {
            Some(rest) => (false, rest),
            None => (true, claim.strip_prefix("P(c.x at end < ").unwrap()),
        };
        let (bound, rest) = rest.split_once(") ").unwrap();
        let bound: f64 = bound.parse().unwrap();
        let below = |x: f64| if strict { x < bound } else { x <= bound };
        let p = 0.3 * f64::from(u8::from(below(1.0))) + 0.7 * f64::from(u8::from(below(2.0)));
        let level: f64 =
            rest.trim_start_matches(['<', '>', '=']).trim_start().split_once(',').unwrap().0.parse().unwrap();
        assert!(if rest.starts_with('>') { p > level } else { p < level }, "{query}: {claim}");
    }
}

#[test]
fn too_many_combinations_of_sweeps_are_refused_before_they_are_made() {
    let sweeps = ["--set", "p=0..1 by 0.0005", "--set", "q=0..1 by 0.0005"];
    let said = called(COIN, &["check P(F (c.x == 1)) >= 0.5\n"], &sweeps);
    assert_eq!(said.code, Some(2), "{}", said.out);
    let told = format!("{}{}", said.out, said.err);
    assert!(told.contains("E0405") && told.contains("(got 4004001)"), "{told}");
    // As many as are allowed are run, in seconds.
    let sweeps = ["--set", "p=0..1 by 0.05", "--set", "q=0..1 by 0.05", "--max-trials", "1"];
    assert_eq!(results(COIN, "estimate P(F (c.x == 1)) within 0.1\n", &sweeps).len(), 441);
}

#[test]
fn sweeps_in_units_that_are_no_decimals_stay_in_their_range() {
    let scenario = "scenario \"turns\"\nhorizon = 1 steps\nconst most = 90 deg\nparam a = 45 deg in 0 deg .. most\n\
        process c { var x: 0 .. 2 = 0; when x == 0 & a >= 0 deg -> x = 1 }\n";
    let points = |sweep: &str| -> Vec<String> {
        let found = results(scenario, "estimate P(F (c.x == 1)) by fixed(trials = 1)\n", &["--set", sweep]);
        found.iter().map(|r| written(&r["settings"]["a"])).collect()
    };
    for (sweep, count, last) in [
        ("a=0 deg..90 deg by 3 deg", 31, "90 deg"),
        ("a=20 deg..80 deg by 1 deg", 61, "80 deg"),
        ("a=0 deg..89 deg by 3 deg", 30, "87 deg"),
    ] {
        let points = points(sweep);
        assert_eq!(
            (points.len(), points.last().map(String::as_str)),
            (count, Some(last)),
            "{sweep}: {points:?}"
        );
    }
    // A step that is a little too long reaches the end it is meant to.
    let sweep = ["--set", "p=0..1 by 0.33333333333334"];
    assert_eq!(results(COIN, "estimate P(F (c.x == 1)) within 0.1\n", &sweep).len(), 4);
}

#[test]
fn a_default_that_is_replaced_need_not_lie_in_its_range() {
    let scenario = format!("{COIN}param twice = 2 * q in 0 .. 1.5\n");
    let query = "estimate P(F (c.x == 1)) within 0.1\n";
    results(&scenario, query, &["--set", "twice=1", "--set", "q=1"]);
    let said = called(&scenario, &[query], &["--set", "q=1"]);
    assert!(said.err.contains("error[E0405]: the default of `twice` is outside its range"), "{}", said.err);
}

#[test]
fn a_constant_of_one_file_is_not_blamed_for_a_name_of_another() {
    let query = "estimate P(F<=1 steps (4 m < d))\n";
    let files = [&format!("const d = 3\n{query}"), &format!("let d = c.x + 1\n{query}")];
    let said = called(COIN, &files.map(String::as_str), &[]).err;
    for part in [
        "`d` has no unit, but is used as a length (m)\n --> 0.bltl:1:11",
        "expected a length (m), found a number without a unit\n --> 1.bltl:2:",
    ] {
        assert!(said.contains(part), "{said}");
    }
    assert_eq!(said.matches("used as").count(), 2, "{said}");
}

#[test]
fn a_family_holds_jointly_over_sweeps_lists_and_files() {
    let near = |found: Vec<f64>, share: f64| {
        for delta in found {
            assert!((delta - share).abs() < 1e-12, "{delta} {share}");
        }
    };
    let one = "family confidence 95 %\nestimate P(F (c.x == 1)) by okamoto(epsilon = 0.1)\n";
    let list = "family confidence 95 %\nestimate Q(0.1, 0.5, c.x at end), Q(0.9, c.x at end)\n";
    let sweep = ["--set", "p=0.1..0.5 by 0.1", "--max-trials", "10"];
    near(numbers(&called(COIN, &[one], &[]), "delta"), 0.05);
    near(numbers(&called(COIN, &[one], &sweep), "delta"), 0.05 / 5.0);
    near(numbers(&called(COIN, &[list], &[]), "delta"), 0.05 / 3.0);
    near(numbers(&called(COIN, &[list], &sweep), "delta"), 0.05 / 15.0);
    near(numbers(&called(COIN, &[one, list], &sweep), "delta"), 0.05 / 20.0);
    // A file without a family is in none, and counts for none.
    let said = called(COIN, &[one, "estimate P(F (c.x == 1)) by okamoto(epsilon = 0.1)\n"], &sweep);
    let (family, alone): (Vec<_>, Vec<_>) = numbers(&said, "delta").into_iter().partition(|d| *d < 0.02);
    assert_eq!((family.len(), alone.len()), (5, 5));
    near(family, 0.01);
    near(alone, 0.05);
    // A check errs on one side only, with either error at most its share.
    let check =
        "family confidence 95 %\ncheck P(F (c.x == 1)) >= 0.5\ncheck E(c.x at end) in 0 .. 2 >= 1.2\n";
    let said = called(COIN, &[check], &sweep);
    let json = said.json();
    for result in json["results"].as_array().unwrap() {
        let method = &result["method"];
        let error = method.get("alpha").or_else(|| method.get("delta")).and_then(Value::as_f64).unwrap();
        assert!((error - 0.005).abs() < 1e-12, "{result}");
    }
}

#[test]
fn a_list_shares_the_error_that_its_procedure_names() {
    let list = "estimate P(F (c.x == 1)), P(F (c.x == 2)) by okamoto(epsilon = 0.1, delta = 0.04)\n\
                estimate Q(0.1, 0.5, 0.9, c.x at end) by fixed(trials = 10, delta = 0.03)\n\
                estimate Q(0.1, 0.5, 0.9, c.x at end) by dkw(trials = 10, delta = 0.03)\n";
    let found = numbers(&called(COIN, &[list], &[]), "delta");
    let expected = [0.02, 0.02, 0.01, 0.01, 0.01, 0.03, 0.03, 0.03];
    assert_eq!(found.len(), expected.len());
    for (delta, expected) in found.iter().zip(expected) {
        assert!((delta - expected).abs() < 1e-12, "{found:?}");
    }
}

/// All that is out of its range is said before anything runs, where it stands.
#[test]
fn ranges_of_procedures_are_errors_of_the_text() {
    let metric = "E(c.x at end) in 0 .. 2";
    let wrong = [
        "estimate P(F (c.x == 1)) within 0.7".to_owned(),
        "estimate P(F (c.x == 1)) within 0.000001".to_owned(),
        "estimate P(F (c.x == 1)) by gbas(epsilon = 0.9999)".to_owned(),
        "estimate P(F (c.x == 1)) within 0.00005 by gbas".to_owned(),
        "estimate P(F (c.x == 1)) by massart(epsilon = 0.6)".to_owned(),
        "estimate Q(0.5, c.x at end) by fixed(trials = 1e12)".to_owned(),
        format!("estimate {metric} within 1.5"),
        format!("estimate {metric} by okamoto(epsilon = 1.5)"),
        format!("estimate {metric} within 0.1 by okamoto(epsilon = 0.1)"),
        "check P(F (c.x == 1)) >= 0.5 by sprt(indifference = 1e-20)".to_owned(),
        "check P(F (c.x == 1)) >= 0.5 by sprt2(indifference = 1e-6)".to_owned(),
        "check P(F (c.x == 1)) >= 0.5 by plan(indifference = 0.0001)".to_owned(),
        "check P(F (c.x == 1)) >= 0.5 by sprt(alpha = 0.6, beta = 0.1, indifference = 0.1)".to_owned(),
        "check P(F (c.x == 1)) >= 0.5 by eprocess(alpha = 0.5)".to_owned(),
        "check P(F (c.x == 1)) >= 0.5 confidence 40 %".to_owned(),
        format!("compare {metric} under p = 0.2 with p = 0.3 within 2.5"),
    ];
    let text: String = wrong.iter().map(|query| format!("{query}\n")).collect();
    let said = called(COIN, &[&text], &["--format", "text"]);
    assert_eq!(said.code, Some(2));
    for line in 1..=wrong.len() {
        assert!(said.err.contains(&format!("0.bltl:{line}:")), "line {line}\n{}", said.err);
    }
    assert_eq!(said.err.matches("error[").count(), wrong.len(), "{}", said.err);
    // At the ends of the ranges there is a procedure.
    let fine = format!(
        "estimate P(F (c.x == 1)) within 0.5\nestimate P(F (c.x == 1)) within 0.00001\nestimate {metric} within 1\n\
         check P(F (c.x == 1)) >= 0.5 by sprt2(indifference = 0.00001)\n\
         compare {metric} under p = 0.2 with p = 0.3 within 2\n"
    );
    let said = called(COIN, &[&fine], &["--max-trials", "10"]);
    assert_ne!(said.code, Some(2), "{}{}", said.out, said.err);
}

#[test]
fn losses_of_rankings_have_the_unit_of_their_metric() {
    let metric = "E(min<=1 s (clearance(user))) in 0 m .. 3 m";
    let said = called(
        SMALL,
        &[&format!(
            "rank moves of user by {metric}\n\
             rank moves of user by {metric} by betting(epsilon = 0.1)\n\
             rank moves of user by {metric} within 10 cm by betting(epsilon = 10 cm)\n\
             rank moves of user by {metric} within 4 m\n"
        )],
        &["--format", "text"],
    );
    assert_eq!(said.code, Some(2), "{}", said.err);
    for line in 1..=4 {
        assert_eq!(said.err.matches(&format!("0.bltl:{line}:")).count(), 1, "line {line}\n{}", said.err);
    }
    let found = called(
        SMALL,
        &[&format!("rank moves of user by {metric} by betting(epsilon = 10 cm)\n")],
        &["--max-trials", "10"],
    );
    assert_eq!(numbers(&found, "epsilon"), [0.1]);
}

#[test]
fn a_ranking_uses_the_budget_it_has() {
    let query = "rank moves of user by P(G<=1 s (clearance(user) > 0.2 m))";
    for (by, most) in
        [("", 20), (" by one_challenger", 20), ("", 40), (" by okamoto", 200), (" by okamoto", 300)]
    {
        let found = results(SMALL, &format!("{query}{by}\n"), &["--max-trials", &most.to_string()]);
        assert_eq!(found[0]["stopped_by"], "cap", "{by} {most}: {}", found[0]);
        let trials: Vec<u64> =
            found[0]["options"].as_array().unwrap().iter().map(|o| o["trials"].as_u64().unwrap()).collect();
        assert!(trials.iter().all(|n| *n <= most) && trials.contains(&most), "{by} {most}: {trials:?}");
    }
}

#[test]
fn sides_of_a_comparison_are_as_sharp_as_estimates() {
    let metric = "E(c.x at end) in 0 .. 2";
    let text = format!("compare {metric} under p = 0.2 with p = 0.8\nestimate {metric} under p = 0.2\n");
    let found = results(COIN, &text, &[]);
    let width = |value: &Value| value["high"].as_f64().unwrap() - value["low"].as_f64().unwrap();
    let (side, alone) = (width(&found[0]["first"]), width(&found[1]));
    assert!(side <= 1.05 * alone, "{side} {alone}");
    // Where the number of pairs is not planned, the interval is for all times and a little wider.
    let found = results(COIN, &format!("compare {metric} under p = 0.2 with p = 0.8 within 0.2\n"), &[]);
    assert!(width(&found[0]["second"]) < 0.4, "{}", found[0]);
}
