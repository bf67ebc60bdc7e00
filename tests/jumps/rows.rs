//! Every row of the table of meanings in continuous time, and the same processes seen at steps. Delays that are
//! fixed make every instant known, so a formula holds in all trials or in none.

use super::{compiled, count};

/// What holds always or never.
fn exactly(scenario: &str, rows: &[(&str, bool)]) {
    for (formula, truth) in rows {
        let held = count(scenario, formula, 3);
        assert!(held == 0 || held == 3, "{formula}");
        assert_eq!(held == 3, *truth, "{formula}");
    }
}

/// The value of a metric that is the same in all trials.
fn value(scenario: &str, metric: &str) -> f64 {
    let study = compiled(scenario, &format!("estimate Q(0.5, {metric})")).unwrap_or_else(|e| panic!("{e}"));
    let run = super::answered(&study, 1, 1);
    run.results[0].estimate.unwrap()
}

/// 0 up to 2 s, 1 for a microsecond, 2 up to 5 s, then 3 for ever.
const STAIRS: &str = "horizon = 10 s
process p {
  var s: 0 .. 3 = 0
  when s == 0 after 2 s        -> s = 1
  when s == 1 after 0.000001 s -> s = 2
  when s == 2 after 2.999999 s -> s = 3
}
";

#[test]
fn states_are_held_up_to_their_jumps_and_both_ends_of_intervals_count() {
    exactly(
        STAIRS,
        &[
            ("F<=0 s (p.s == 0)", true),
            ("F<=0 s (p.s == 1)", false),
            // The state at a time is the one that begins there.
            ("F<=2 s (p.s == 1)", true),
            ("F[2 s, 2 s] (p.s == 0)", false),
            ("F<=1.999999 s (p.s == 1)", false),
            // What holds just before the end of the window counts.
            ("F[1.9 s, 2 s] (p.s == 0)", true),
            ("G<=2 s (p.s == 0)", false),
            ("G<=1.999999999 s (p.s == 0)", true),
            ("F[2 s, 4 s] (p.s == 0)", false),
            // A state that lasts a microsecond counts.
            ("F<=5 s (p.s == 1)", true),
            ("G[3 s, 4 s] (p.s == 2)", true),
            ("F[2.0000005 s, 2.0000008 s] (p.s == 1)", true),
        ],
    );
}

#[test]
fn until_looks_at_its_goal_first_and_the_weak_and_release_forms_are_as_usual() {
    exactly(
        STAIRS,
        &[
            ("false U<=3 s (p.s == 0)", true),
            ("(p.s == 0) U<=2 s (p.s == 1)", true),
            ("(p.s == 0) U<=1.9 s (p.s == 1)", false),
            ("(p.s == 0) U<=3 s (p.s == 2)", false),
            ("(p.s < 2) U<=3 s (p.s == 2)", true),
            // A goal that is entered before the window and left there, and one that is held.
            ("(p.s < 3) U[3 s, 4 s] (p.s == 1)", false),
            ("(p.s < 3) U[3 s, 4 s] (p.s == 2)", true),
            ("(p.s < 2) U[3 s, 4 s] (p.s == 2)", false),
            ("(p.s == 0) W<=1 s (p.s == 3)", true),
            ("(p.s == 0) W<=3 s (p.s == 3)", false),
            ("(p.s == 1) R<=4 s (p.s < 2)", true),
            ("(p.s == 2) R<=4 s (p.s < 2)", false),
            ("false R<=1 s (p.s == 0)", true),
        ],
    );
}

#[test]
fn nested_operators_are_exact() {
    exactly(
        STAIRS,
        &[
            // From every instant up to 1 s, s == 1 comes within a second and not before.
            ("G<=1 s F[1 s, 2 s] (p.s == 1)", true),
            ("G<=1 s F<=1 s (p.s == 1)", false),
            ("F<=1 s G[1 s, 1.000001 s] (p.s >= 1)", true),
            ("F<=1 s G<=1 s (p.s == 0)", true),
            ("F<=3 s G<=2 s (p.s == 2)", true),
            ("F<=4 s G<=3 s (p.s == 2)", false),
            ("(F<=1 s (p.s == 1)) U<=3 s (p.s == 2)", false),
            ("(F<=2 s (p.s == 1)) U<=3 s (p.s == 2)", true),
            ("F<=2 s ((p.s == 1) & (F<=3 s (p.s == 3)))", true),
            ("F<=2 s ((p.s == 1) & (F<=2.9 s (p.s == 3)))", false),
        ],
    );
}

#[test]
fn without_a_bound_the_horizon_is_the_end_and_deadlocks_stutter() {
    exactly(
        STAIRS,
        &[
            ("F (p.s == 3)", true),
            ("F G (p.s == 3)", true),
            ("G[5 s, 10 s] (p.s == 3)", true),
            ("F[10 s, 10 s] (p.s == 3)", true),
            ("G (p.s == 3 => G[0 s, 0 s] (p.s == 3))", true),
            ("(p.s < 3) U (p.s == 3)", true),
            ("G (p.s < 3)", false),
        ],
    );
    // Nothing ever happens.
    let idle = "horizon = 5 s\nprocess p { var up = true\n when !up at 1 /s -> up = true\n when up at 0 /s -> up = false }";
    exactly(idle, &[("G p.up", true), ("F[5 s, 5 s] p.up", true), ("F !p.up", false)]);
    // Just before the horizon, and at it.
    let late = "horizon = 2 s\nprocess p { var s: 0 .. 2 = 0\n when s == 0 after 1.9999999 s -> s = 1\n\
                when s == 1 after 0.0000001 s -> s = 2 }";
    exactly(late, &[("F (p.s == 1)", true), ("F (p.s == 2)", true), ("F[2 s, 2 s] (p.s == 2)", true)]);
    let study = compiled(idle, "estimate P(G p.up) by fixed(trials = 10)").unwrap();
    assert_eq!(study.queries[0].horizon.as_deref(), Some("5 s"));
}

#[test]
fn of_several_jumps_at_one_time_the_last_counts_in_order_of_writing() {
    let scenario = "horizon = 5 s\nprocess a { var s: 0 .. 2 = 0\n when s == 0 after 1 s -> s = 1\n\
        when s == 1 after 0 s -> s = 2 }\n\
        process b { var seen: 0 .. 2 = 0\n when a.s < 2 & seen == 0 after 1 s -> seen = 1 + a.s }";
    // a jumps twice before b's turn comes, which disables b's command.
    exactly(
        scenario,
        &[
            ("F (a.s == 1)", false),
            ("F<=1 s (a.s == 2)", true),
            ("G<=1 s (a.s == 0)", false),
            ("F[1 s, 1 s] (a.s == 2 & b.seen == 0)", true),
        ],
    );
}

#[test]
fn numbers_over_time() {
    let cases = [
        ("mean<=5 s (p.s)", (0.000_001 + 2.0 * 2.999_999) / 5.0),
        ("mean[1 s, 3 s] (p.s)", 0.000_000_5 + 0.999_999),
        ("mean[3 s, 3 s] (p.s)", 2.0),
        ("min<=5 s (p.s)", 0.0),
        ("min[2 s, 3 s] (p.s)", 1.0),
        ("max<=2 s (p.s)", 1.0),
        ("max[2.1 s, 5 s] (p.s)", 3.0),
        ("p.s at end", 3.0),
        ("p.s at 2 s", 1.0),
        ("p.s at 1.999999 s", 0.0),
        ("time_until(p.s == 1)", 2.0),
        ("time_until(p.s == 3)", 5.0),
        ("time_until(p.s == 0)", 0.0),
    ];
    for (metric, exact) in cases {
        let found = value(STAIRS, metric);
        assert!((found - exact).abs() < 1e-9, "{metric}: {found}, not {exact}");
    }
    assert_eq!(value(STAIRS, "time_until(p.s == 1 & p.s == 2)"), f64::INFINITY);
    exactly(
        STAIRS,
        &[
            ("mean<=5 s (p.s) <= 1.21", true),
            ("max<=2 s (p.s) >= 1", true),
            ("min[2 s, 3 s] (p.s) < 1", false),
            ("time_until(p.s == 1) <= 2 s", true),
            ("G<=1 s (time_until(p.s == 1) >= 1 s)", true),
            // The average of the next second passes one half where a quarter of it lies behind the jump to 2.
            ("F<=2.25 s (mean<=1 s (p.s) >= 1.99)", true),
            ("F<=1.2 s (mean<=1 s (p.s) >= 0.5)", false),
            ("F<=1.3 s (mean<=1 s (p.s) >= 0.5)", true),
        ],
    );
}

#[test]
fn with_a_step_the_same_process_is_seen_at_the_steps() {
    let stepped = STAIRS.replace("horizon = 10 s", "horizon = 10 s\nstep = 0.5 s");
    exactly(
        &stepped,
        &[
            ("F<=0 s (p.s == 0)", true),
            // The state at a step is the one that holds there: it began at just this time.
            ("F[2 s, 2 s] (p.s == 1)", true),
            ("X<=#4 (p.s == 1)", true),
            ("X<=#5 (p.s == 2)", true),
            ("G[#5, #9] (p.s == 2)", true),
            ("F[5 s, 5 s] (p.s == 3)", true),
            ("(p.s == 0) U<=2 s (p.s == 1)", true),
            ("(p.s < 2) W<=2 s (p.s == 3)", true),
            ("(p.s == 2) R<=#4 (p.s < 2)", true),
            ("G (p.s == 3 => G<=#0 (p.s == 3))", true),
            ("sum<=2 s (p.s) == 1", true),
            ("mean<=2 s (p.s) == 1 / 5", true),
        ],
    );
    // What begins and ends between two steps is not seen.
    let brief = "horizon = 4 s\nstep = 1 s\nprocess p { var s: 0 .. 2 = 0\n when s == 0 after 1.2 s -> s = 1\n\
                 when s == 1 after 0.5 s -> s = 2 }";
    exactly(brief, &[("F (p.s == 1)", false), ("X<=#2 (p.s == 2)", true), ("X (p.s == 0)", true)]);
    assert_eq!(value(brief, "time_until(p.s == 2)"), 2.0);
    // What is due at once belongs to the first state.
    let soon = brief.replace("after 1.2 s", "after 0 s");
    exactly(&soon, &[("F<=0 s (p.s == 1)", true), ("X (p.s == 2)", true)]);
}

#[test]
fn a_process_that_jumps_too_often_between_two_steps_ends_its_trial() {
    let text =
        "horizon = 4 s\nstep = 1 s\nprocess p { var s: 0 .. 1 = 0\n when true at 3000000 /s -> s = 1 - s }";
    let study = compiled(text, "estimate P(F[3 s, 3 s] (p.s == 0)) by fixed(trials = 3)").unwrap();
    let counts = super::answered(&study, 0, 1).results[0].consumed.counts;
    assert_eq!((counts.trials, counts.unresolved), (3, 3));
}

#[test]
fn implications_that_never_had_a_case_are_told() {
    let warned = |formula: &str| {
        let study = compiled(STAIRS, &format!("estimate P({formula}) by fixed(trials = 5)")).unwrap();
        let run = super::answered(&study, 1, 1);
        assert_eq!(run.results[0].consumed.counts.successes, 5, "{formula}");
        run.results[0].warnings.iter().any(|warning| warning.contains("never triggered"))
    };
    // s is 1 from 2 s on, for a microsecond, and 3 from 5 s on.
    for (formula, never) in [
        ("G<=4 s (p.s == 3 => p.s == 0)", true),
        ("G<=5 s (p.s == 3 => p.s == 3)", false),
        ("G<=1 s (p.s == 1 => F<=1 s (p.s == 3))", true),
        ("G<=2 s (p.s == 1 => F<=3 s (p.s == 3))", false),
        ("F<=1 s (p.s == 0 => G<=1 s (p.s == 0))", false),
    ] {
        assert_eq!(warned(formula), never, "{formula}");
    }
}

#[test]
fn what_is_due_at_a_bound_happens_by_then() {
    // Sums of what is no double, and of what is no decimal, meet the bounds and the steps that are written so.
    for (wait, parts) in [("0.1 s", 10_u32), ("1 s / 3", 3), ("1 s / 60", 60)] {
        for step in ["", "step = 1 s / 60\n"] {
            for horizon in [7, 30_u32] {
                let scenario = format!(
                    "horizon = {horizon} s\n{step}process q {{ var n: 0 .. 2000 = 0\n when n < 2000 after {wait} -> n = n + 1 }}\n"
                );
                for k in [1, 3, 7, 8, 23, 32, 41, 46, 59].into_iter().filter(|k| *k <= horizon * parts) {
                    let bound = format!("({k} s / {parts})");
                    let reached = format!("F<={bound} (q.n == {k})");
                    let at = format!("F[{bound}, {bound}] (q.n == {k})");
                    let first = format!("time_until(q.n == {k}) <= {bound}");
                    exactly(&scenario, &[(&reached, true), (&at, true)]);
                    // Numbers that are compared are no bounds: a third of a second is a double among them.
                    if parts == 10 {
                        exactly(&scenario, &[(&first, true)]);
                    }
                }
            }
        }
    }
}

#[test]
fn a_time_compared_with_a_constant_is_refused_where_finally_is_and_means_the_same() {
    let steps = "horizon = 4 steps\nprocess p { var s: 0 .. 5 = 0\nwhen s < 5 -> s = s + 1 }\n";
    let steps_of = ["1 steps", "2 steps", "3 steps", "4 steps"];
    for (scenario, inner, bounds) in
        [(steps, "F<=2 (p.s == 3)", steps_of), (STAIRS, "F<=8 s (p.s == 3)", ["1 s", "2 s", "2.5 s", "10 s"])]
    {
        let mut accepted = 0;
        for bound in bounds {
            let pairs = [
                (format!("time_until({inner}) <= {bound}"), format!("F<={bound} {inner}")),
                (format!("{bound} >= time_until({inner})"), format!("F<={bound} {inner}")),
                (format!("time_until({inner}) > {bound}"), format!("!F<={bound} {inner}")),
                (format!("G (time_until(p.s == 3) <= {bound})"), format!("G F<={bound} (p.s == 3)")),
            ];
            for (time, finally) in pairs {
                let query = |formula: &str| format!("estimate P({formula}) by fixed(trials = 3)");
                let is_legal = |formula: &str| compiled(scenario, &query(formula)).is_ok();
                assert_eq!(is_legal(&time), is_legal(&finally), "{time}");
                if is_legal(&time) {
                    accepted += 1;
                    assert_eq!(count(scenario, &time, 3), count(scenario, &finally, 3), "{time}");
                }
            }
        }
        assert_eq!(accepted, 6);
    }
}
