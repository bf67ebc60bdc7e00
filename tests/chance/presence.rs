//! Only who is present counts: in sets, in quantified formulas, in tables.

use super::{HEAD, answered, compiled};

/// A share of trials, of all of them.
fn share(scenario: &str, formula: &str) -> f64 {
    let study = compiled(scenario, &format!("estimate P({formula}) by fixed(trials = 64)"));
    let run = answered(&study, 1, 1, 1_000);
    assert_eq!(run.failure, None);
    let counts = &run.results[0].consumed.counts;
    assert_eq!(counts.unresolved, 0, "{formula}");
    counts.successes as f64 / counts.trials as f64
}

/// Somebody comes each five seconds at 6 m, walks to 2 m and leaves, after less than four seconds.
fn doors() -> String {
    format!(
        "{HEAD}agent user: adult {{ at = (3, 20); noise = 0 m/s }}\n\
         source doors: adult {{ at = (6, 0); every = 5 s; route = near; noise = 0 m/s; speed = 1.5 m/s }}"
    )
}

#[test]
fn sets_hold_those_who_are_there() {
    let text = doors();
    for formula in [
        "count(a in doors) == 0",
        "G<=4.98 s (count(a in doors) == 0)",
        "F[5 s, 5 s] (count(a in doors) == 1)",
        "G<=20 s (count(a in doors) <= 1)",
        "F[9.5 s, 9.5 s] (count(a in doors) == 0)",
        "G<=4 s (min(distance(user, a) for a in doors) == ∞)",
        "G<=4 s (forall a in doors: false)",
        "G<=4 s !(exists a in doors: true)",
        "F[5 s, 5 s] (min(distance(user, a) for a in others(user)) < 21 m)",
        "G<=20 s (count(a in everyone) == 1 + count(a in doors))",
        "G<=60 s (count(a in near) <= 12)",
    ] {
        let formula = formula.replace("count(a in near)", "count(a in doors: a in near)");
        assert_eq!(share(&text, &formula), 1.0, "{formula}");
    }
}

#[test]
fn one_person_before_and_after_the_time_in_the_scene() {
    let text = doors();
    for (formula, expected) in [
        ("present(doors[1])", 0.0),
        ("F[5 s, 5 s] present(doors[1])", 1.0),
        ("F[9.5 s, 9.5 s] present(doors[1])", 0.0),
        // Before they come they have no numbers: every comparison is false.
        ("G<=4 s (distance(user, doors[1]) > 0 m)", 0.0),
        ("F<=4 s (distance(user, doors[1]) > 0 m)", 0.0),
        ("F<=4 s (distance(user, doors[1]) < 100 m)", 0.0),
        ("F<=4 s (speed(doors[1]) >= 0 m/s)", 0.0),
        ("F<=4 s (doors[1] in near)", 0.0),
        ("F<=4 s contact(doors[1])", 0.0),
        ("F<=4 s (clearance(doors[1]) < 100 m)", 0.0),
        ("F<=4 s (min(distance(doors[1], a) for a in others(doors[1])) < 100 m)", 0.0),
        // Afterwards they keep the last ones.
        ("F[9.5 s, 9.5 s] (doors[1] in near)", 1.0),
        ("F[9.5 s, 9.5 s] (travelled(doors[1]) > 3 m)", 1.0),
    ] {
        assert_eq!(share(&text, formula), expected, "{formula}");
    }
}

#[test]
fn the_robustness_has_the_sign_of_the_truth_before_somebody_comes() {
    for (formula, positive) in [
        ("G<=4 s (distance(user, doors[1]) < 100 m)", false),
        ("F<=6 s (distance(user, doors[1]) < 100 m)", true),
        ("G<=4 s !(doors[1] in near)", true),
        ("F[9.5 s, 9.5 s] (doors[1] in near & distance(user, doors[1]) > 1 m)", true),
        ("G<=20 s (forall a in doors: distance(user, a) > 5 m)", true),
    ] {
        let ask = format!("estimate E(robustness({formula})) in -100 m .. 100 m by fixed(trials = 16)");
        let run = answered(&compiled(&doors(), &ask), 1, 1, 1_000);
        let estimate = run.results[0].estimate.unwrap();
        assert_eq!(run.results[0].consumed.counts.unresolved, 0, "{formula}");
        assert!(if positive { estimate > 0.0 } else { estimate < 0.0 }, "{formula}: {estimate}");
        assert_eq!(share(&doors(), formula), f64::from(positive), "{formula}");
    }
}

#[test]
fn formulas_over_time_ask_who_is_there_when_they_are_asked() {
    let text = doors();
    for (formula, expected) in [
        // Nobody is there at the start.
        ("forall a in doors: F<=20 s (a in near)", 1.0),
        ("exists a in doors: F<=20 s (a in near)", 0.0),
        ("G<=20 s (forall a in doors: F<=5 s (a in near))", 1.0),
        ("G<=20 s (forall a in doors: F<=1 s (a in near))", 0.0),
        ("F<=20 s (exists a in doors: F<=5 s (a in near))", 1.0),
        // Who reaches the goal leaves: nobody is present and there.
        ("F<=20 s (exists a in doors: G<=1 s (a in near))", 0.0),
    ] {
        assert_eq!(share(&text, formula), expected, "{formula}");
    }
    let leaver = format!(
        "{HEAD}agents two[2]: adult {{ at = uniform in rect (4, 0) .. (6, 6); route = near then leave }}"
    );
    assert_eq!(share(&leaver, "F<=15 s (forall a in two: G<=1 s (a in west))"), 1.0, "once both have left");
}

#[test]
fn a_mean_of_nobody_matters_only_where_it_is_looked_at() {
    // Nobody is there before 5 s, somebody from 5 s to 7.6 s.
    let text = doors();
    for formula in [
        "F[5 s, 6 s] (mean(speed(a) for a in doors) > 0.1 m/s)",
        "G<=12 s ((count(a in doors) > 0) => mean(speed(a) for a in doors) >= 0 m/s)",
        "G<=12 s ((count(a in doors) == 0) | mean(speed(a) for a in doors) >= 0 m/s)",
        "(count(a in doors) < 1) U<=5 s (count(a in doors) > 0 & spread(doors) >= 0 m)",
        "max[5 s, 6 s] (mean(speed(a) for a in doors)) > 0.1 m/s",
    ] {
        assert_eq!(share(&text, formula), 1.0, "{formula}");
    }
    for formula in [
        "F<=6 s (mean(speed(a) for a in doors) > 0.1 m/s)",
        "G<=12 s (mean(speed(a) for a in doors) >= 0 m/s)",
        "F[4 s, 6 s] (spread(doors) >= 0 m)",
    ] {
        let study = compiled(&text, &format!("estimate P({formula}) by fixed(trials = 8)"));
        assert_eq!(answered(&study, 1, 1, 1_000).results[0].consumed.counts.unresolved, 8, "{formula}");
    }
    let query = "estimate E(mean(speed(a) for a in doors) at 5.5 s) in 0 m/s .. 3 m/s by fixed(trials = 8)";
    let run = answered(&compiled(&text, query), 1, 1, 1_000);
    assert_eq!(run.results[0].consumed.counts.unresolved, 0);
}
