//! What is wrong with a process is said before a trial where it can be seen, else with trial, time and state.

use super::{answered, compiled};
use smc::engine::outcome::Failure;

fn refused(process: &str, code: &str) {
    let found = compiled(&format!("horizon = 5 steps\n{process}"), "").unwrap_err();
    assert!(found.contains(code), "{found}");
}

#[test]
fn errors_that_can_be_seen_are_found_before_a_trial() {
    for (process, code) in [
        ("process p { var n: 0 .. 3 = 0\n when n == 0 -> n = 1\n when n < 2 -> n = 2 }", "E0901"),
        ("process p { var n: 0 .. 3 = 0\n when n == 0 -> 1/2: n = 1 | 1/3: n = 2 }", "E0902"),
        ("process p { var n: 0 .. 3 = 1\n when true -> n/3: n = 2 | n/3: n = 1 }", "E0902"),
        ("process p { var n: 0 .. 3 = 0\n when true -> n = n + 1 }", "E0903"),
        ("process p { var n: 0 .. 3 = 4 }", "E0903"),
        ("process p { var n: 0 .. 3 = 0\n when true -> n = 1/2 }", "E0903"),
        ("process p { var n: 0 .. 3 = 0\n when true -> m = 1 }", "E0201"),
        ("process p { var n: 0 .. 3 = 0\n when n -> n = 1 }", "E0305"),
        ("process p { var n: 3 .. 0 = 0 }", "E0405"),
        ("process p { var n: 0 .. 3 = 0\n var n = true }", "E0202"),
        ("process p { var n: 0 .. 3 = 0\n when true -> { n = 1; n = 2 } }", "E0202"),
        ("process p { var n: 0 .. 3 = 0\n when true -> n = 1 m }", "E0303"),
        (
            "process p[2] { var n: 0 .. 3 = 0 }\nprocess q { var n: 0 .. 3 = 0\n when p[3].n == 1 -> n = 1 }",
            "E0212",
        ),
        ("process p { let a = b\n let b = a\n var n: 0 .. a = 0 }", "E0205"),
    ] {
        refused(process, code);
    }
}

#[test]
fn all_that_can_be_seen_is_told_at_once() {
    // Two processes, of which one has copies; each command once, two variables of one command by themselves.
    let scenario = "horizon = 9 steps\n\
        process p[3] { var n: 0 .. 3 = 0\n var m: 0 .. 3 = 0\n when true -> { n = n + 1; m = m + 1 } }\n\
        process q { var n: 0 .. 9 = 0\n when n < 5 -> n = n + 1\n when n == 3 -> n = 7\n\
        when n == 7 -> n/14: n = 1 | n/21: n = 2 }\n";
    let found = compiled(scenario, "").unwrap_err();
    let times = |what: &str| found.matches(what).count();
    assert_eq!((times("error["), times("error[E0901]"), times("error[E0903]")), (3, 1, 2), "{found}");
    // What would follow an error is no error of its own: 7 is not reached but by way of one.
    assert_eq!(times("E0902"), 0, "{found}");
    // A trial ends on one of two ways; what is wrong on the other is told, too.
    let scenario = "horizon = 5 steps\nprocess p { var n: 0 .. 3 = 0\n var m: 0 .. 3 = 0\n\
        when m == 0 -> 1/2: n = n + 5 | 1/2: m = 1\n when m == 1 -> m = m + 4 }\n";
    assert_eq!(compiled(scenario, "").unwrap_err().matches("error[E0903]").count(), 2);
    // The starts are wrong, and a command too.
    let scenario = "horizon = 5 steps\nprocess p { var n: 0 .. 3 = 4\n var on: bool = 1 m\n\
        when n == 1 s -> on = 2 s }\n";
    let found = compiled(scenario, "").unwrap_err();
    assert_eq!(found.matches("error[").count(), 4, "{found}");
}

#[test]
fn what_no_trial_reaches_is_no_error() {
    let late = "horizon = 3 steps\nprocess p { var n: 0 .. 3 = 0\n when true -> n = n + 1 }";
    assert!(compiled(late, "").is_ok());
    let scenario = "horizon = 5 steps\nprocess p { var n: 0 .. 3 = 0\n when n == 0 -> n = 1\n\
                    when n == 3 -> n = 2\n when n >= 2 -> n = n + 1 }";
    assert!(compiled(scenario, "").is_ok());
}

#[test]
fn errors_that_show_while_running_name_trial_time_and_state() {
    // A real variable: its values are not enumerated.
    let scenario = "horizon = 50 steps\nprocess p { var x = 0\n var n: 0 .. 9 = 0\n\
                    when true -> 3/4: x = x + 0.5 | 1/4: n = n + 1 }";
    let study =
        compiled(scenario, "estimate P(F<=#20 p.n > 0) within 0.01\nestimate P(F p.n > 20) within 0.01")
            .unwrap();
    let runs = [1, 2].map(|threads| answered(&study, 3, threads));
    for run in &runs {
        let Some(Failure::Model(flaw)) = &run.failure else { panic!("{:?}", run.failure) };
        let reason = flaw.to_string();
        let written = &scenario[flaw.place.unwrap().start as usize..flaw.place.unwrap().end as usize];
        assert_eq!((flaw.code.name(), written), ("E0903", "n"));
        assert!(reason.contains("`p.n` would become 10") && reason.contains("p.n = 9"), "{reason}");
        assert!(reason.starts_with("trial ") && reason.contains(" at step "), "{reason}");
        assert_eq!(smc::report::exit_code(run).code(), 2);
    }
    assert_eq!(runs[0].failure, runs[1].failure);
}

/// A level that is proven late is as one that is known: whoever stops before the trial with the error has a result.
#[test]
fn who_waits_for_a_proof_keeps_what_was_decided_before_an_error() {
    let scenario = "horizon = 9 steps\nprocess t { var t: 0 .. 3 = 0\n when t < 3 -> t = t + 1 }\n\
        process p[13] { var b: 0 .. 1 = 0\n when true -> 1/2: b = 0 | 1/2: b = 1 }\n\
        process z { var u: 0 .. 3 = 0\n when t.t == 2 & count(c in p: c.b == 1) <= 13 -> 1/500: u = u + 9 | 499/500: u = 0 }\n\
        process d { var s: 0 .. 1 = 0\n when t.t == 0 -> 1/100: s = 1 | 99/100: s = 0 }\n";
    let counts = |width: &str| {
        let queries =
            format!("estimate P(F<=#1 d.s == 1) within {width}\nestimate P(X<=#7 p[1].b == 1) within 0.02\n");
        let study = compiled(scenario, &queries).unwrap();
        let runs = [1, 2].map(|threads| answered(&study, 3, threads));
        assert_eq!(runs[0].failure, runs[1].failure);
        let Some(Failure::Model(_)) = &runs[0].failure else { panic!("{:?}", runs[0].failure) };
        runs[0].results.iter().map(|one| (one.asked.index, one.consumed.counts.trials)).collect::<Vec<_>>()
    };
    // In the table, proven, and with more trials than there are before the error.
    let (known, proven) = (counts("0.05"), counts("0.08"));
    assert_eq!((known.len(), proven.len()), (1, 1), "{known:?} {proven:?}");
    assert!(proven[0].1 < known[0].1, "{known:?} {proven:?}");
    assert_eq!(counts("0.0011"), []);
}

#[test]
fn a_trial_that_is_decided_before_the_error_counts() {
    let scenario =
        "horizon = 50 steps\nprocess p { var x = 0\n var n: 0 .. 9 = 0\n when x >= 0 -> n = n + 1 }";
    let study = compiled(scenario, "estimate P(F<=#5 p.n == 4) within 0.05").unwrap();
    let run = answered(&study, 3, 1);
    assert_eq!(run.failure, None);
    assert_eq!(run.results[0].consumed.counts.failures, 0);
}

/// What the least or greatest value of a window is compared with is looked at state by state: by `==` and `!=` too.
#[test]
fn an_extreme_beside_a_number_is_decided_by_one_state() {
    // The step from 3 is an error: whatever waits for the end of its window meets it.
    let scenario =
        "horizon = 50 steps\nprocess p { var x = 0\n var n: 0 .. 3 = 0\n when x >= 0 -> n = n + 1 }";
    let rows = [
        ("(min<=#9 p.n) == 1", Some(false)),
        ("(min<=#9 p.n) != 1", Some(true)),
        ("(max<=#9 p.n) == 2", Some(false)),
        ("(max<=#9 p.n) != 2", Some(true)),
        ("2 == (max<=#9 p.n)", Some(false)),
        ("X<=#1 ((max<=#9 p.n) != 2)", Some(true)),
        ("(min<=#9 p.n) == 0", None),
        ("(max<=#9 p.n) != 3", None),
    ];
    for (formula, holds) in rows {
        let run = answered(&compiled(scenario, &format!("estimate P({formula}) within 0.05")).unwrap(), 3, 1);
        match holds {
            Some(holds) => {
                assert_eq!(run.failure, None, "{formula}");
                let counts = &run.results[0].consumed.counts;
                assert_eq!(counts.successes, if holds { counts.trials } else { 0 }, "{formula}");
            }
            None => assert!(matches!(run.failure, Some(Failure::Model(_))), "{formula}: {:?}", run.failure),
        }
    }
}

#[test]
fn other_errors_of_clocks_and_timing() {
    for (text, code) in [
        ("horizon = 5 s\nprocess p { var n: 0 .. 3 = 0\n when n < 3 -> n = n + 1 }", "E0503"),
        ("process p { var n: 0 .. 3 = 0 }", "E0505"),
        ("horizon = 5 steps", "E0505"),
    ] {
        let found = compiled(text, "").unwrap_err();
        assert!(found.contains(code), "{found}");
    }
}
