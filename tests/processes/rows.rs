//! Every row of the table of meanings, on a process, against exact values.

use super::{compiled, fits, shown};

/// The die of Knuth and Yao, with a horizon that does not matter.
pub(crate) fn die() -> String {
    include_str!("../../models/die.scn").to_owned()
}

/// Checks the probability of formulas of a scenario.
fn exactly(scenario: &str, rows: &[(&str, f64)]) {
    for (formula, p) in rows {
        let study = compiled(scenario, &format!("check P({formula}) >= 0.5")).unwrap();
        let column = match &study.queries[0].ask {
            smc::compile::study::Ask::Check { measure, .. } => measure.target.column,
            _ => unreachable!(),
        };
        let trials = shown(&study.worlds[0], 7, 20_000);
        let held = trials.iter().filter(|t| t.verdicts[column]).count();
        assert!(fits(held, trials.len(), *p), "{formula}: {held} of {}, not {p}", trials.len());
    }
}

#[test]
fn bounds_are_closed_and_zero_is_now() {
    exactly(
        &die(),
        &[
            ("F<=#0 (die.s == 0)", 1.0),
            ("F<=#0 (die.s == 1)", 0.0),
            ("F<=#3 (die.s == 7)", 0.75),
            ("F<=#2 (die.s == 7)", 0.0),
            ("F<=#5 (die.s == 7 & die.d == 6)", 5.0 / 32.0),
            ("G<=#4 (die.s == 3 => F<=#1 (die.s == 7))", 7.0 / 8.0),
        ],
    );
}

#[test]
fn a_goal_entered_before_the_lower_bound_counts_where_it_is_still_held() {
    exactly(
        &die(),
        &[
            ("(die.s < 7) U[4 steps, 6 steps] (die.s == 7)", 3.0 / 16.0),
            ("F[4 steps, 6 steps] (die.s == 7)", 15.0 / 16.0),
            ("G[#3, #5] (die.s == 7)", 0.75),
        ],
    );
}

#[test]
fn next_is_the_next_state_and_with_a_bound_exactly_that_one() {
    exactly(
        &die(),
        &[
            ("X (die.s == 1)", 0.5),
            ("X<=#3 (die.s == 7)", 0.75),
            ("X X X (die.s == 7)", 0.75),
            ("X<=#4 (die.s == 3 | die.s == 4)", 0.125),
            ("X<=#4 (die.s == 1)", 0.0),
            ("X<=#3 (die.s == 1)", 0.125),
        ],
    );
}

#[test]
fn an_extreme_is_a_number_where_all_reach_it_and_one_is_it() {
    exactly(
        &die(),
        &[
            ("(max<=#3 die.s) == 7", 0.75),
            ("(max<=#3 die.s) != 7", 0.25),
            ("(min<=#3 die.s) == 0", 1.0),
            ("X ((min<=#3 die.s) == 1)", 0.5),
            ("X ((min<=#3 die.s) != 1)", 0.5),
            ("(max<=#2 die.s) == 3 | (max<=#2 die.s) == 4", 0.5),
        ],
    );
}

#[test]
fn until_looks_at_its_goal_first_and_the_weak_and_release_forms_are_as_usual() {
    exactly(
        &die(),
        &[
            ("false U<=#3 (die.s == 0)", 1.0),
            ("(die.s < 7) U<=#3 (die.s == 7)", 0.75),
            ("(die.s < 3) U<=#3 (die.s == 7)", 0.0),
            ("(die.s < 7) W<=#2 (die.s == 7)", 1.0),
            ("(die.s < 7) W<=#4 (die.d == 6)", 1.0 - 0.75 + 0.125),
            ("(die.s == 7) R<=#3 (die.s < 7)", 0.25),
            ("(die.s == 1) R<=#3 (die.s < 7)", 0.5 + 0.5 * 0.25),
            ("false R<=#2 (die.s < 7)", 1.0),
        ],
    );
}

#[test]
fn without_an_enabled_command_time_goes_on() {
    let scenario = "horizon = 6 steps\nprocess p { var n: 0 .. 2 = 0\n when n < 2 -> 1/2: n = n + 1 | 1/2: { } }\n\
                    process clock { var t: 0 .. 9 = 0\n when true -> t = t + 1 }";
    exactly(
        scenario,
        &[
            ("G[#2, #6] (clock.t > 1)", 1.0),
            ("F (p.n == 2)", 1.0 - 7.0 / 64.0),
            ("G (p.n == 2 => G<=#0 (p.n == 2))", 1.0),
            ("X<=#6 (clock.t == 6)", 1.0),
            ("F<=#2 (p.n == 2 & clock.t == 2)", 0.25),
            // Holds only just before the end.
            ("F (clock.t == 6 & time == 6 steps)", 1.0),
        ],
    );
}

#[test]
fn steps_of_all_processes_are_synchronous() {
    let scenario = "horizon = 4 steps\nprocess a { var x: 0 .. 1 = 0\n when true -> x = b.x }\n\
                    process b { var x: 0 .. 1 = 1\n when true -> x = a.x }";
    exactly(scenario, &[("G (a.x != b.x)", 1.0), ("X (a.x == 1 & X a.x == 0)", 1.0)]);
}

#[test]
fn choose_makes_enabled_commands_equally_likely() {
    let scenario = "horizon = 1 step\nprocess c { choose\n var x: 0 .. 3 = 0\n when x == 0 -> x = 1\n\
                    when x >= 0 -> 1/4: x = 2 | 3/4: x = 3\n when x > 2 -> x = 0\n when true -> x = 2 }";
    let third = 1.0 / 3.0;
    exactly(
        scenario,
        &[("X (c.x == 1)", third), ("X (c.x == 2)", third / 4.0 + third), ("X (c.x == 3)", third * 0.75)],
    );
}

#[test]
fn arrays_labels_lets_truth_values_and_real_numbers() {
    let scenario = "horizon = 3 steps\nconst p = 1/4\n\
        process sensor[5] { var works = true\n var wear: real = 0 m\n let fails = p\n label broken = !works\n\
          when works -> fails: works = false | 1 - fails: wear = wear + 2 m }";
    exactly(
        scenario,
        &[
            ("X sensor[2].broken", 0.25),
            ("X !sensor[5].works", 0.25),
            ("X (count(s in sensor: s.works) == 5)", 0.75f64.powi(5)),
            ("X (exists s in sensor: s.broken)", 1.0 - 0.75f64.powi(5)),
            ("F (forall s in sensor: s.broken)", (1.0 - 0.75f64.powi(3)).powi(5)),
            ("forall s in sensor: F s.broken", (1.0 - 0.75f64.powi(3)).powi(5)),
            ("X<=#3 (sensor[1].wear == 6 m)", 0.75f64.powi(3)),
            ("X<=#2 (max(s.wear for s in sensor) < 2 m)", 0.25f64.powi(5)),
            ("X (sensor[1].works & !sensor[3].works)", 0.75 * 0.25),
        ],
    );
}

#[test]
fn variables_of_an_array_may_be_called_as_coordinates_are() {
    let scenario = "horizon = 3 steps\nprocess a[3] { var x: 0 .. 9 = 2\n var y: 0 .. 9 = 0\n\
                    when a[1].x < 4 -> { x = a[2].x + 1; y = 1 } }";
    exactly(scenario, &[("X (a[3].x == 3 & a[1].y == 1)", 1.0), ("G (a[2].x < 4)", 0.0)]);
}
