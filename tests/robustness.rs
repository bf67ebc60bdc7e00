//! Robustness in property files: its sign is the verdict, trial by trial; it stops as soon as its bounds force
//! what is asked; it is estimated, checked, compared and ranked as any metric.

use crate::program::{Place, SMALL, timeless};
use serde_json::Value;

fn results(properties: &str, words: &[&str]) -> Vec<Value> {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", properties)]);
    let mut call = vec!["check", "a.scn", "a.bltl", "-q", "--format", "json"];
    call.extend(words);
    let said = place.call(&call);
    assert!(matches!(said.code, Some(0 | 1 | 3 | 4)), "{}", said.err);
    let mut json = said.json();
    timeless(&mut json);
    json["results"].as_array().unwrap().clone()
}

/// Formulas of one unit, with nested windows, untils, regions, contacts, folds and times.
const FORMULAS: [&str; 10] = [
    "G<=3 s (forall a in crowd: distance(user, a) > 1.2 m)",
    "F<=3 s (min(distance(user, a) for a in crowd) < 1.0 m)",
    "G<=1 s F<=1 s (clearance(user) < 1.5 m | user in hall)",
    "(distance(user, crowd[1]) > 2 m) U<=3 s (user in hall)",
    "!(exists a in crowd: a in exit) W<=2 s (travelled(user) >= 2 m)",
    "G<=2 s (contact(user) => F<=1 s !contact(user))",
    "(clearance(user) > 0.5 m) R<=2 s (distance(user, crowd[2]) > 0.5 m)",
    "time_until(travelled(user) > 3 m) <= 2.5 s",
    "count(a in crowd: F<=2 s (distance(user, a) < 1.5 m)) >= 2",
    "min<=3 s (clearance(user)) > 0.4 m & max<=2 s (travelled(user)) > 2 m",
];

#[test]
fn the_sign_is_the_verdict() {
    for formula in FORMULAS {
        let properties = format!(
            "property p = {formula}\n\
             estimate P(p), P(robustness(p) > 0 m), P(robustness(p) >= 0 m), P(0 m > robustness(p)) by fixed(trials = 96)\n"
        );
        let found = results(&properties, &[]);
        let passed: Vec<u64> = found.iter().map(|r| r["successes"].as_u64().unwrap()).collect();
        // No margin is exactly zero here.
        assert_eq!((passed[1], passed[2], passed[3]), (passed[0], passed[0], 96 - passed[0]), "{formula}");
        // The sign is known exactly when the verdict falls.
        assert_eq!(found[1]["steps"], found[0]["steps"], "{formula}");
    }
}

#[test]
fn trials_end_once_the_bounds_force_the_answer() {
    let properties = "\
property safe = G<=3 s (forall a in crowd: distance(user, a) > 1.2 m)
estimate E(robustness(safe)) in -1 m .. 5 m by fixed(trials = 96)
estimate E(robustness(safe)) in 0.5 m .. 5 m by fixed(trials = 96)
estimate Q(0.25, robustness(safe)) by fixed(trials = 96)
estimate P(safe) by fixed(trials = 96)
check Q(0.25, robustness(safe)) >= -5 m
check E(robustness(safe)) in -1 m .. 5 m >= -0.9 m
";
    let found = results(properties, &[]);
    let number = |at: usize, field: &str| found[at][field].as_f64().unwrap();
    assert!(number(1, "steps") < number(0, "steps"), "below the range is soon known");
    assert_eq!(number(0, "steps"), number(2, "steps"), "the range of the first holds all values");
    assert_eq!(number(0, "clipped"), 0.0);
    // Every trial that falls below 0.5 m is clipped there.
    assert!(number(1, "clipped") > 0.0 && number(1, "estimate") > number(0, "estimate"));
    let above = number(3, "successes") / 96.0;
    assert_eq!(number(2, "estimate") < 0.0, above < 0.75, "the quantile is negative if a quarter fails");
    assert_eq!((&found[4]["verdict"], &found[5]["verdict"]), (&"satisfied".into(), &"satisfied".into()));
    assert_eq!((&found[0]["unit"], &found[2]["unit"]), (&"m".into(), &"m".into()));
}

#[test]
fn moves_are_ranked_by_it_and_worlds_compared() {
    let properties = "\
property safe = G<=3 s (forall a in crowd: distance(user, a) > 1.2 m)
rank moves of user by E(robustness(safe)) in -1.2 m .. 5 m within 0.3 m
compare E(robustness(safe)) in -1.2 m .. 5 m under density = 0.1 /m^2 with density = 0.9 /m^2
";
    let found = results(properties, &["--max-trials", "600"]);
    assert_eq!(found[0]["options"].as_array().unwrap().len(), 5, "{}", found[0]);
    assert!(found[0]["certifies"].as_str().unwrap().contains("E(robustness(safe))"));
    assert!(found[1]["estimate"].as_f64().unwrap() > 0.0, "fewer people, more room: {}", found[1]);
    let threads = results(properties, &["--max-trials", "600", "-j", "1"]);
    assert_eq!(threads[0].to_string(), found[0].to_string());
}

#[test]
fn pure_numbers_join_what_has_different_units() {
    let properties = "\
property calm = G<=2 s (speed(user) / 1 m/s < 2.5 & clearance(user) / 1 m > -1)
estimate E(robustness(calm)) in -1 .. 3
";
    let found = results(properties, &[]);
    assert_eq!(found[0]["unit"], "");
    assert!(found[0]["estimate"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_witness_names_the_moment_and_the_condition_of_its_margin() {
    let query = "estimate E(robustness(G<=3 s (distance(user, crowd[1]) > 0.2 m))) in -1 m .. 9 m by fixed(trials = 20)\n\
                 estimate P(robustness(G<=3 s (forall a in crowd: distance(user, a) > 0.2 m)) >= 1 m) by fixed(trials = 20)\n";
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", query)]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    let lowest = &json["results"][0]["witnesses"][0];
    assert_eq!(lowest["shows"], "lowest");
    let what = lowest["what"].as_str().unwrap();
    assert!(what.starts_with("margin ") && what.contains("`distance(user, crowd[1]) > 0.2 m`"), "{what}");
    // The states of the trial say the same.
    let trial = lowest["trial"].to_string();
    let rows = place.call(&["simulate", "a.scn", "--trial", &trial, "--until", "3"]).out;
    let mut lines = rows.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let (time, agent, x, y) = (column("time"), column("agent"), column("x"), column("y"));
    let mut places = std::collections::BTreeMap::new();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let point = (cells[x].parse::<f64>().unwrap(), cells[y].parse::<f64>().unwrap());
        places.insert((cells[time].to_owned(), cells[agent].to_owned()), point);
    }
    let mut least = (f64::INFINITY, 0.0);
    for ((time, agent), (x, y)) in &places {
        if agent == "user" {
            let (a, b) = places[&(time.clone(), "crowd[1]".to_owned())];
            let gap = ((x - a) * (x - a) + (y - b) * (y - b)).sqrt() - 0.2;
            if gap < least.0 {
                least = (gap, time.parse::<f64>().unwrap());
            }
        }
    }
    assert!((lowest["value"].as_f64().unwrap() - least.0).abs() < 1e-6, "{lowest} {least:?}");
    assert!((lowest["time"].as_f64().unwrap() - least.1).abs() < 1e-9, "{lowest} {least:?}");
    // A side of a threshold says the margin and whose it is.
    let found = json["results"][1]["witnesses"].as_array().unwrap();
    assert!(!found.is_empty());
    for witness in found {
        assert!(witness["what"].as_str().unwrap().contains(": crowd["), "{witness}");
    }
}

#[test]
fn outside_of_its_range_a_margin_is_shown_as_it_is() {
    let formula = "robustness(G<=3 s (distance(user, crowd[1]) > 2 m))";
    let of = |range: &str| {
        let properties = format!(
            "check E({formula}) in {range} >= 0.02 m\n\
             check P({formula} >= 0.1 m) >= 0.5\n\
             rank moves of user by E({formula}) in {range} within 0.1 m\n"
        );
        results(&properties, &["--max-trials", "200"])
    };
    let (narrow, wide) = (of("-0.2 m .. 0.1 m"), of("-9 m .. 9 m"));
    assert!(narrow[0]["clipped"].as_f64().unwrap() > 0.0 && wide[0]["clipped"] == 0.0, "{}", narrow[0]);
    let fails = |found: &[Value]| {
        let witnesses = found[0]["witnesses"].as_array().unwrap();
        let first = witnesses.iter().find(|one| one["shows"] == "fails").unwrap();
        (first["trial"].clone(), first["value"].clone(), first["time"].clone(), first["what"].clone())
    };
    assert_eq!(fails(&narrow).0, fails(&wide).0);
    assert_eq!(fails(&narrow), fails(&wide));
    // A probability has no unit, the margin has.
    let what = narrow[1]["witnesses"][0]["what"].as_str().unwrap();
    assert!(what.starts_with("margin ") && what.contains(" m, of `"), "{what}");
    // Which option is lowest nobody knows where trials ended at the range.
    assert!(narrow[2]["witnesses"].as_array().unwrap().is_empty(), "{}", narrow[2]);
    assert_eq!(wide[2]["witnesses"].as_array().unwrap().len(), 2);
}

#[test]
fn beyond_the_end_of_a_trial_no_margin_is_told() {
    let model = "scenario \"a\"\nhorizon = 5 s\nstep = 0.1 s\n\
scene { region exit: rect (2, 0) .. (3, 4) }\nkind adult: sfm preset helbing2000\n\
agents c[1]: adult { at = (0, 2); route = exit then leave }\n";
    let query = |range: &str| {
        format!("check E(robustness(G<=4.9 s (mean(travelled(a) for a in c) < 1 m))) in {range} >= 0.9 m\n")
    };
    let place =
        Place::new(&[("a.scn", model), ("a.bltl", &query("0 m .. 5 m")), ("b.bltl", &query("-5 m .. 5 m"))]);
    let result = |file: &str| {
        place.call(&["check", "a.scn", file, "-q", "--format", "json", "--max-trials", "40"]).json()["results"][0].clone()
    };
    // Nobody is there at the end: as far as the margin matters the trial has no end.
    assert!(result("b.bltl")["unresolved"].as_u64().unwrap() > 0);
    let found = result("a.bltl");
    assert_eq!(found["unresolved"], 0, "{found}");
    let witness = &found["witnesses"][0];
    assert_eq!((&witness["shows"], &witness["value"]), (&"fails".into(), &Value::Null), "{witness}");
    let what = witness["what"].as_str().unwrap();
    assert!(what.contains("outside its range") && what.ends_with("the trial ends at 1.5 s"), "{witness}");
    // It is outside as soon as somebody has gone 1 m.
    assert_eq!(witness["time"], 0.9, "{witness}");
}

#[test]
fn each_level_of_a_quantile_is_certified_by_its_own_name() {
    let found =
        results("estimate Q(0.25, 0.75, time_until(travelled(user) > 1 m)) by fixed(trials = 96)\n", &[]);
    for (result, level) in found.iter().zip(["0.25", "0.75"]) {
        let certifies = result["certifies"].as_str().unwrap();
        let name = format!("Q({level}, time_until(travelled(user) > 1 m)) ");
        assert!(certifies.starts_with(&name), "{certifies}");
    }
}

/// Whether a point is in a region is a distance of zero; its margin is the depth, and so it is within a quantifier.
#[test]
fn points_of_all_have_the_depth_in_a_region_as_their_margin() {
    let scenario = "scenario \"a\"\nhorizon = 1 s\nstep = 0.1 s\n\
        scene { region big: rect (-10, -10) .. (30, 30); region far: rect (20, 0) .. (30, 10) }\n\
        kind adult: sfm preset helbing2000\nagent one: adult { at = (1, 1) }\nagent two: adult { at = (5, 5) }\n";
    let asked = [
        ("forall a in everyone: (position(a) + (1, 0)) in big", 11.0),
        ("exists a in everyone: (position(a) + (1, 0)) in big", 15.0),
        ("forall a in everyone: (position(a) + (1, 0)) in far", -18.0),
        ("exists a in everyone: (position(a) + (1, 0)) in far", -14.0),
        ("(position(one) + (1, 0)) in big", 11.0),
    ];
    let queries: String = asked
        .iter()
        .map(|(formula, _)| {
            format!("estimate E(robustness({formula})) in -20 m .. 20 m by fixed(trials = 8)\n")
        })
        .collect();
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", &queries)]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    for (result, (formula, margin)) in json["results"].as_array().unwrap().iter().zip(asked) {
        assert!((result["estimate"].as_f64().unwrap() - margin).abs() < 1e-9, "{formula}: {result}");
    }
}

#[test]
fn conditions_that_parameters_decide_have_margins() {
    let process =
        "param mode = 1 in 0 .. 5\nprocess w { var x: 0 .. 9 = 0\n  when x < 9 TIME-> x = x + 1 }\n";
    for (head, time, unit) in [("horizon = 4 s\n", "after 1.5 s ", " s"), ("horizon = 4 steps\n", "", "")] {
        let model = head.to_owned() + &process.replace("TIME", time);
        let f = format!("F<=0{unit}");
        let margins = [
            (format!("{f} (w.x > 2 | mode >= 2)"), -1.0),
            (format!("{f} (w.x > 2 | w.x - w.x + mode >= 2)"), -1.0),
            (format!("{f} (w.x > -2 & mode >= 0)"), 1.0),
            (format!("{f} !(w.x > 2 | mode >= 2)"), 1.0),
            (format!("{f} (w.x >= -9 & !(2 <= mode))"), 1.0),
            (format!("G<=2{unit} (mode > 0.25 | w.x > 5)"), 0.75),
            (format!("F<=2{unit} (mode > 3) | G<=1{unit} (w.x > 7)"), -2.0),
            (format!("(mode > 0.25) U<=1{unit} (w.x > -3)"), 3.0),
            (format!("{f} (w.x < 3 & (mode == 1 => mode < 3))"), 2.0),
            (format!("min<=2{unit} (w.x + mode) > 0.5 & mode > 0.75"), 0.25),
        ];
        for (formula, margin) in margins {
            let query = format!("estimate E(robustness({formula})) in -10 .. 10 by fixed(trials = 2)\n");
            let place = Place::new(&[("a.scn", &model), ("a.bltl", &query)]);
            let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]);
            assert_eq!(said.code, Some(0), "{formula}: {}", said.err);
            let found = said.json()["results"][0]["estimate"].as_f64().unwrap();
            assert!((found - margin).abs() < 1e-9, "{formula}: {found}");
        }
        // A named one, too, whatever it was asked for before.
        let query = format!(
            "const strict = mode >= 2\nestimate P(F<=2{unit} (strict | w.x > 0)) by fixed(trials = 2)\n\
             estimate E(robustness({f} (w.x > 2 | strict))) in -10 .. 10 by fixed(trials = 2)\n"
        );
        let place = Place::new(&[("a.scn", &model), ("a.bltl", &query)]);
        let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
        let found = json["results"][1]["estimate"].as_f64().unwrap();
        assert!((found + 1.0).abs() < 1e-9, "{found}");
        // The witness names the condition whose margin it is.
        if unit.is_empty() {
            let query =
                "estimate E(robustness(F<=0 (w.x > 2 | mode >= 2))) in -10 .. 10 by fixed(trials = 2)\n";
            let place = Place::new(&[("a.scn", &model), ("a.bltl", query)]);
            let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
            let what = &json["results"][0]["witnesses"][0]["what"];
            assert_eq!(what, "margin -1, of `mode >= 2`", "{what}");
        }
    }
}
