//! What a report says of a verdict: implications that never had a case, people who decided, the call that repeats it.

use crate::program::{Place, SMALL};
use serde_json::Value;

fn asked(properties: &str, words: &[&str]) -> Value {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", properties)]);
    let mut call = vec!["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "40"];
    call.extend(words);
    let said = place.call(&call);
    assert!(said.code != Some(2), "{}", said.err);
    said.json()
}

#[test]
fn implications_of_each_are_seen_to_have_no_case() {
    for (formula, idle) in [
        ("forall a in crowd: (speed(a) > 99 m/s => speed(user) > 1 m/s)", true),
        (
            "forall a in crowd: forall b in others(a): (contact(a, b) & speed(a) > 99 m/s => speed(b) > 1 m/s)",
            true,
        ),
        ("forall a in crowd: (speed(a) < 99 m/s => speed(user) < 99 m/s)", false),
        ("speed(user) > 99 m/s => (forall a in crowd: speed(a) > 1 m/s)", true),
    ] {
        let json = asked(&format!("check P(G<=1 s ({formula})) >= 0.5\n"), &[]);
        let result = &json["results"][0];
        assert_eq!(result["verdict"], "satisfied", "{result}");
        assert_eq!(result["warnings"].to_string().contains("never triggered"), idle, "{formula}: {result}");
    }
}

/// Whoever decides before the left side is known has not seen that it never holds.
#[test]
fn a_left_side_that_was_left_open_may_have_been_a_case() {
    for (formula, idle) in [
        ("(X (p.s == 1)) => p.s == 0", false),
        ("(F<=1 step (p.s == 1)) => p.s == 0", false),
        ("(G<=2 steps (p.s >= 0)) => p.s == 0", false),
        ("(p.s == 0 U<=2 steps p.s == 1) => p.s == 0", false),
        ("(X X (p.s == 0)) => X (p.s == 1)", false),
        ("F<=3 steps ((X (p.s == 1)) => p.s == 0)", false),
        ("p.s == 0 | ((X (p.s == 1)) => p.s == 1)", false),
        // Seen to its end.
        ("G<=3 steps ((X (p.s == 1 & p.s == 0)) => p.s == 0)", true),
        ("(F<=3 steps (p.s == 0 & p.s == 1)) => p.s == 1", true),
        ("G<=3 steps ((X (p.s == 1)) & p.s == 1 => p.s == 0)", true),
        ("G<=3 steps (p.s == 1 & p.s == 0 => X (p.s == 1))", true),
        // Open at the last positions, where it is true.
        ("G<=2 steps ((X X (n.n == 4)) => n.n == 2)", false),
        ("G<=2 steps ((F<=3 steps (n.n == 5)) => n.n >= 0)", false),
        ("G<=2 steps ((X X (n.n == 5)) => X X (n.n == 3))", true),
        // False at once, whatever comes.
        ("G<=3 steps (n.n == 9 & X (p.s == 1) => X (n.n == 8))", true),
        ("G<=3 steps ((G<=2 steps (n.n == 9)) => n.n == 9)", true),
        ("G<=3 steps (n.n == 9 & (F<=2 steps (p.s == 1)) => n.n == 8)", true),
        ("p.s == 0 | G<=3 steps (n.n == 9 & (F<=2 steps (p.s == 1)) => n.n == 8)", true),
        ("p.s == 0 | G<=3 steps ((F<=2 steps (n.n == 9)) => n.n == 9)", false),
        // At the horizon nothing is open.
        ("G (n.n == 3 & (F n.n == 11) => n.n == 4)", true),
        ("G ((F n.n == 9) & n.n == 9 & n.n == 8 => n.n == 4)", true),
        ("G ((F (n.n == 6 & p.s == 0)) & n.n == 6 => n.n == 6)", false),
        ("F ((G n.n >= 0) => n.n == 2)", false),
    ] {
        let model = "horizon = 6 steps\nprocess p { var s: 0 .. 1 = 0\n when s == 0 -> s = 1\n when s == 1 -> s = 0 }\n\
             process n { var n: 0 .. 9 = 0\n when n < 9 -> n = n + 1 }\n";
        let query = format!("check P({formula}) >= 0.5\n");
        let place = Place::new(&[("flip.scn", model), ("flip.bltl", &query)]);
        let json = place.call(&["check", "flip.scn", "flip.bltl", "--format", "json"]).json();
        let result = &json["results"][0];
        assert_eq!(result["verdict"], "satisfied", "{result}");
        assert_eq!(result["warnings"].to_string().contains("never triggered"), idle, "{formula}: {result}");
    }
}

const COUNTER: &str = "horizon = 6 steps\nprocess n { var n: 0 .. 9 = 0\n when n < 9 -> n = n + 1 }\n";

/// What `docs/semantics.md` says of many implications: those from the 64th on are one.
#[test]
fn the_last_of_very_many_implications_are_watched_as_one() {
    let case = |k: usize, last: usize| {
        let left = if k == last { "==" } else { "<" };
        format!("G<=4 steps (n.n {left} 9 => F<=1 step (n.n < {}))", 100 + k)
    };
    for (count, warns) in [(64, true), (65, false)] {
        let parts: Vec<String> = (1..=count).map(|k| case(k, count)).collect();
        let query = format!("check P({}) >= 0.5\n", parts.join(" & "));
        let place = Place::new(&[("a.scn", COUNTER), ("a.bltl", &query)]);
        let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]);
        let warnings = said.json()["results"][0]["warnings"].to_string();
        assert_eq!(warnings.contains("never triggered"), warns, "{count}: {warnings} {}", said.err);
    }
}

/// What it says of limits: each is told with its number, and what just keeps to it runs.
#[test]
fn formulas_beyond_reason_are_refused_with_the_limit() {
    let nested = |k: usize| format!("check P({}n.n == 0{}) >= 0.5\n", "(".repeat(k), ")".repeat(k));
    let joined = |k: usize| format!("check P({}) >= 0.5\n", vec!["n.n == 0"; k].join(" & "));
    let named = |k: usize| {
        let names: String = (1..=k).map(|k| format!("property p{k} = !p{}\n", k - 1)).collect();
        format!("property p0 = n.n == 0\n{names}check P(p{k}) >= 0.5\n")
    };
    for (within, beyond, code, limit) in [
        (nested(255), nested(256), "E0106", "256"),
        (joined(510), joined(511), "E0120", "512 levels"),
        (named(498), named(499), "E0211", "1000"),
    ] {
        let said = |query: &str| {
            let place = Place::new(&[("a.scn", COUNTER), ("a.bltl", query)]);
            place.call(&["check", "a.scn", "a.bltl", "-q"])
        };
        assert_eq!(said(&within).code, Some(0), "{}", said(&within).err);
        let said = said(&beyond);
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(said.err.contains(code) && said.err.contains(limit), "{}", said.err);
    }
}

#[test]
fn an_implication_is_a_condition_like_any_other() {
    let left = "speed(a) > 1.2 m/s";
    let right = "x(position(a)) < 5 m";
    let forms = [
        format!("G<=2 s (forall a in crowd: ({left} => {right}))"),
        format!("G<=2 s (forall a in crowd: (!({left}) | {right}))"),
        format!("G<=2 s (count(a in crowd: {left} => {right}) == count(a in crowd))"),
        format!("G<=2 s (min(if({left} => {right}, 1, 0) for a in crowd) > 0)"),
        "G<=2 s (if(speed(user) > 99 m/s => speed(user) > 1 m/s, 1, 0) > 0)".to_owned(),
    ];
    let queries: Vec<String> =
        forms.iter().map(|form| format!("estimate P({form}) by fixed(trials = 40)\n")).collect();
    let json = asked(&queries.concat(), &[]);
    let successes = |k: usize| json["results"][k]["successes"].as_u64().unwrap();
    assert!((1..40).contains(&successes(0)), "{json}");
    assert_eq!([successes(1), successes(2), successes(3)], [successes(0); 3]);
    assert_eq!(successes(4), 40);
}

#[test]
fn those_who_decided_are_named_where_a_formula_is_about_each() {
    for formula in [
        "forall o in crowd: F<=1 s (x(position(o)) < 2 m)",
        "exists o in crowd: G<=1 s (x(position(o)) < 2 m)",
        "count(o in crowd: F<=1 s (x(position(o)) < 2 m)) >= 3",
        "G<=1 s (count(o in crowd: x(position(o)) > 2 m) < 2)",
        "forall o in crowd: max<=1 s (x(position(o))) < 2 m",
    ] {
        let json = asked(&format!("check P({formula}) >= 0.5\n"), &[]);
        let witness = &json["results"][0]["witnesses"][0];
        assert!(witness["what"].as_str().unwrap().contains("crowd["), "{formula}: {witness}");
    }
}

#[test]
fn a_point_of_a_sweep_is_repeated_alone() {
    let query = "estimate P(F<=1 s contact(user)) by fixed(trials = 20)\n";
    let sweep = ["--set", "density=0.1..0.2 by 0.1"];
    let json = asked(query, &sweep);
    let replay = |k: usize| json["results"][k]["replay"].as_str().unwrap();
    assert!(replay(1).contains("--set 'density=0.2 /m^2' --only 0 --seed 0"), "{}", replay(1));
    assert!(!replay(0).contains(".."), "{}", replay(0));
    let again = asked(query, &["--set", "density=0.2 /m^2"]);
    assert_eq!(again["results"][0]["successes"], json["results"][1]["successes"]);
    // In a family the errors are shared with the other points.
    let family = asked("family confidence 95 %\nestimate P(F<=1 s contact(user)) within 0.4\n", &sweep);
    assert!(family["results"][1]["replay"].as_str().unwrap().contains(".."), "{family}");
}

#[test]
fn copies_of_processes_that_decided_are_named() {
    let model = "scenario \"Lamps\"\nhorizon = 9 steps\n\
        process s[3] { var up = true; when up -> 1/10: up = false | 9/10: { } }\n\
        process t { var n: 0 .. 3 = 0; when n < 3 -> n = n + 1 }\n";
    for (formula, shows) in [
        ("G (forall a in s: (a.up | t.n == 3))", "fails"),
        ("forall a in s: G<=#9 a.up", "fails"),
        ("F (exists a in s: !a.up)", "holds"),
    ] {
        let place = Place::new(&[
            ("a.scn", model),
            ("a.bltl", &format!("estimate P({formula}) by fixed(trials = 60)\n")),
        ]);
        let said = place.call(&["check", "a.scn", "a.bltl", "-q"]);
        let line = said.out.lines().find(|line| line.contains(&format!("{shows} in trial"))).unwrap();
        assert!(line.contains(": s["), "{formula}: {line}");
    }
}

/// Both people fly apart after the first step, in which the left side was true.
const WILD: &str = "scenario \"Wild\"\nhorizon = 10 s\nstep = 0.1 s\n\
    scene { region hall: rect (-50, -50) .. (50, 50); region exit: rect (18, 0) .. (20, 4) }\n\
    kind adult: sfm preset helbing2000 { radius = 0.25 m; speed = 1.3 m/s; A = 1e9 N }\n\
    agent user: adult { at = (1, 1); route = exit }\n\
    agent other: adult { at = (2.2, 1); route = (0, 1) }\n";

/// The warnings of an implication with this left side: `unresolved` of so many trials are, and nothing else comes of them.
fn warnings_of(model: &str, left: &str, unresolved: u64) -> String {
    let query = format!(
        "estimate P(G<=9 s (({left}) => (distance(user, other) > 0.01 m))) by clopper_pearson(trials = 20)\n"
    );
    let place = Place::new(&[("a.scn", model), ("a.bltl", &query)]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    let result = &json["results"][0];
    assert_eq!((&result["trials"], &result["unresolved"]), (&20.into(), &unresolved.into()), "{result}");
    result["warnings"].to_string()
}

#[test]
fn what_a_trial_saw_before_it_went_astray_it_saw() {
    // Whoever starts near is thrown; a left side that looks ahead is open there.
    let some = WILD
        .replace("at = (2.2, 1); route = (0, 1)", "at = uniform in rect (2, 1) .. (4, 1.1); route = (40, 1)");
    for (left, idle) in [
        ("distance(user, other) < 1.2 m", false),
        ("user in exit", true),
        ("X<=1 s (user in exit)", false),
        ("time < 0 s & X<=1 s (user in exit)", true),
    ] {
        let warnings = warnings_of(&some, left, 4);
        assert_eq!(warnings.contains("never triggered"), idle, "{left}: {warnings}");
        assert_eq!(warnings.contains("true in none of 16 resolved trials"), idle, "{left}: {warnings}");
    }
}

#[test]
fn trials_that_all_went_astray_say_nothing_of_cases() {
    for left in ["user in hall", "user in exit", "X<=1 s (user in hall)", "X<=1 s (user in exit)"] {
        let warnings = warnings_of(WILD, left, 20);
        assert!(!warnings.contains("never triggered"), "{left}: {warnings}");
    }
}

/// The first arrives after some seconds, and nobody before.
const LATE: &str = "scenario \"Late\"\nhorizon = 12 s\nstep = 0.1 s\n\
    scene { region west: rect (0, 0) .. (1, 4) }\n\
    kind adult: sfm preset helbing2000 { radius = 0.25 m; speed = 1.3 m/s }\n\
    source entrance: adult { at = uniform in rect (4, 1) .. (5, 3); every = 3 s; route = west then leave }\n";

/// A mean over nobody does no harm where nobody looks at it: the reason is that of the state in which it did, and of the
/// number that was looked at.
#[test]
fn why_a_trial_is_unresolved_is_what_made_it_so() {
    let queries = "\
        estimate P(G[1 s, 12 s] (mean(speed(a) for a in entrance) > 0 m/s)) by clopper_pearson(trials = 2)\n\
        estimate E(max[1 s, 12 s] (mean(speed(a) for a in entrance))) in 0 m/s .. 5 m/s by fixed(trials = 2)\n\
        estimate E(max[2 s, 12 s] (mean(clearance(b) for b in entrance))) in 0 m .. 50 m by fixed(trials = 2)\n";
    let place = Place::new(&[("a.scn", LATE), ("a.bltl", queries)]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    let said = [
        "in `mean(speed(a) for a in entrance) > 0 m/s` is over an empty set at 1 s",
        "in `mean(speed(a) for a in entrance)` is over an empty set at 1 s",
        "in `mean(clearance(b) for b in entrance)` is over an empty set at 2 s",
    ];
    for (result, said) in json["results"].as_array().unwrap().iter().zip(said) {
        assert_eq!(result["unresolved"], 2, "{result}");
        assert!(result["warnings"].to_string().contains(said), "{said}: {}", result["warnings"]);
    }
}

#[test]
fn a_left_side_that_parameters_make_false_never_had_a_case_in_either_time() {
    let process =
        "param mode = 1 in 0 .. 5\nprocess w { var x: 0 .. 5 = 0\n  when x < 5 TIME-> x = x + 1 }\n";
    for (head, time, unit) in [("horizon = 10 s\n", "at 1 /s ", " s"), ("horizon = 10 steps\n", "", "")] {
        let model = head.to_owned() + &process.replace("TIME", time);
        let query =
            |left: &str| format!("estimate P(G<=3{unit} ({left} => F<=2{unit} w.x == 0)) within 0.1\n");
        let properties = query("w.x > 1 & mode == 2")
            + &query("w.x > 1 & w.x - w.x + mode == 2")
            + &query("w.x < 1 & mode == 1");
        let place = Place::new(&[("a.scn", &model), ("a.bltl", &properties)]);
        let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
        let never = |k: usize| json["results"][k]["warnings"].to_string().contains("never triggered");
        assert_eq!((never(0), never(1), never(2)), (true, true, false), "{json:#}");
        let witness = &json["results"][0]["witnesses"][0];
        assert_eq!(witness["what"], "its value does not depend on the trial", "{witness}");
    }
}
