//! What is wrong with rates, delays and questions in continuous time.

use super::{answered, compiled};
use smc::engine::outcome::Failure;

const QUEUE: &str = include_str!("../../models/queue.scn");

#[test]
fn errors_that_can_be_seen_are_found_before_a_trial() {
    for (process, code) in [
        ("process p { var n: 0 .. 3 = 0\n when n < 3 at -1 /s -> n = n + 1 }", "E0904"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 at (1 /s) / 0 -> n = n + 1 }", "E0405"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 at 1 /s * (2 - 3 * n) -> n = n + 1 }", "E0904"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 at 1 /s / n -> n = n + 1 }", "E0904"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 at 1 s -> n = n + 1 }", "E0303"),
        ("process p { var n: 0 .. 3 = 0\n when true at 1 /s -> n = n + 1 }", "E0903"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 at 1 /s -> n/4: n = 3 | 1/2: n = n + 1 }", "E0902"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 after normal(1 s, 1 s) -> n = n + 1 }", "E0906"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 after -1 s -> n = n + 1 }", "E0906"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 after 2 m -> n = n + 1 }", "E0303"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 after uniform(2 s, 1 s) -> n = n + 1 }", "E0404"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 at 1 /s -> n = n + 1\n when n == 3 -> n = 0 }", "E0905"),
        ("process p { var n: 0 .. 3 = 0\n when n < 3 & time < 2 s at 1 /s -> n = n + 1 }", "E0508"),
    ] {
        let found = compiled(&format!("horizon = 5 s\n{process}"), "").unwrap_err();
        assert!(found.contains(code), "{process}\n{found}");
    }
    let steps = "horizon = 5 steps\nprocess p { var n: 0 .. 3 = 0\n when n < 3 at 1 /s -> n = n + 1 }";
    assert!(compiled(steps, "").unwrap_err().contains("E0303"));
}

#[test]
fn what_no_trial_reaches_is_no_error() {
    // A zero rate disables, as a guard does.
    let zero = "horizon = 5 s\nprocess p { var n: 0 .. 3 = 0\n when true at 1 /s * (3 - n) -> n = n + 1 }";
    assert!(compiled(zero, "").is_ok());
    // Two commands enabled at once are a race.
    let race = "horizon = 5 s\nprocess p { var n: 0 .. 3 = 0\n when n == 0 at 1 /s -> n = 1\n when n < 2 at 1 /s -> n = 2 }";
    assert!(compiled(race, "").is_ok());
    // The delay of 1 s always ends first.
    let first = "horizon = 5 s\nprocess p { var n: 0 .. 1 = 0\n var m: 0 .. 1 = 0\n when n == 0 after 1 s -> n = 1\n\
                 when n == 0 after 2 s -> m = m + 2 }";
    let study = compiled(first, "estimate P(F<=1 s (p.n == 1)) by fixed(trials = 10)").unwrap();
    assert_eq!(answered(&study, 0, 1).results[0].consumed.counts.successes, 10);
}

#[test]
fn questions_that_have_no_meaning_in_continuous_time() {
    for (question, code) in [
        ("check P(X (queue.n == 1)) >= 0.5", "E0507"),
        ("check P(F<=#5 (queue.n == 1)) >= 0.5", "E0503"),
        ("check P(F<=5 (queue.n == 1)) >= 0.5", "E0503"),
        ("estimate E(sum<=5 s (queue.n)) in 0 .. 5", "E0508"),
        ("check P(F (queue.n == 1 & time > 5 s)) >= 0.5", "E0508"),
        ("check P(F<=2 s (mean<=1 s (queue.n) > mean<=2 s (queue.n))) >= 0.5", "E0508"),
        ("check P(F<=11 s (queue.n == 1)) >= 0.5", "E0502"),
        ("check P(G F<=1 s (queue.n == 1)) >= 0.5", "E0502"),
        ("check P(F[2 s, 1 s] (queue.n == 1)) >= 0.5", "E0503"),
        ("check P(F<=0.0000000000001234567 s (queue.n == 1)) >= 0.5", "E0501"),
    ] {
        let found = compiled(QUEUE, question).unwrap_err();
        assert!(found.contains(code), "{question}\n{found}");
    }
    let horizon = compiled(QUEUE, "check P(F<=11 s (queue.n == 1)) >= 0.5").unwrap_err();
    assert!(horizon.contains("needs 11 s") && horizon.contains("the horizon is 10 s"), "{horizon}");
}

#[test]
fn errors_that_show_while_running_name_trial_time_and_state() {
    for (process, what, code) in [
        (
            "when true at 1 /s * (x - 0.5) -> x = x + 1",
            "rate of command 1 of `p` must be finite and not negative (got -0.5 /s)",
            "E0904",
        ),
        ("when true at 1 /s -> x = x / 0", "`p.x` would become", "E0903"),
        ("when true at 1 /s -> x / 3: x = 1 | 2 / 3: x = 2", "probabilities of command 1 of `p`", "E0902"),
        ("when x >= 0 after 0 s -> x = x + 1", "more than 100000 jumps at one time", "E0907"),
    ] {
        let scenario = format!("horizon = 50 s\nprocess p {{ var x = 0\n {process} }}");
        let study = compiled(&scenario, "estimate P(F (p.x > 9000000)) within 0.01").unwrap();
        let runs = [1, 2].map(|threads| answered(&study, 3, threads));
        for run in &runs {
            let Some(Failure::Model(flaw)) = &run.failure else { panic!("{process}: {:?}", run.failure) };
            let reason = flaw.to_string();
            let place = flaw.place.unwrap();
            let written = &scenario[place.start as usize..place.end as usize];
            assert_eq!((flaw.code.name(), written), (code, if code == "E0903" { "x" } else { process }));
            assert!(reason.contains(what) && reason.contains("p.x = "), "{reason}");
            assert!(reason.starts_with("trial 0 at ") && reason.contains(" s: "), "{reason}");
            assert_eq!(smc::report::exit_code(run).code(), 2);
        }
        assert_eq!(runs[0].failure, runs[1].failure);
    }
}

#[test]
fn a_trial_that_is_decided_before_the_error_counts() {
    let scenario = "horizon = 50 s\nprocess p { var x = 0\n when true after 1 s -> x = x + 1\n\
                    when x == 5 at -1 /s * x -> x = 0 }";
    let study = compiled(scenario, "estimate P(F<=4.5 s (p.x == 4)) by fixed(trials = 20)").unwrap();
    let run = answered(&study, 3, 1);
    assert_eq!((run.failure, run.results[0].consumed.counts.successes), (None, 20));
    // Decided at 4.7 s, and the next jump is the error.
    let study = compiled(scenario, "estimate P(G<=4.7 s (p.x < 5)) by fixed(trials = 20)").unwrap();
    let run = answered(&study, 3, 1);
    assert_eq!((run.failure, run.results[0].consumed.counts.successes), (None, 20));
    let study = compiled(scenario, "estimate P(G<=5 s (p.x < 5)) by fixed(trials = 20)").unwrap();
    assert!(matches!(answered(&study, 3, 1).failure, Some(Failure::Model(_))));
}

#[test]
fn rates_that_read_people_are_checked_while_running() {
    let scenario = "horizon = 5 s\nstep = 0.1 s\nkind adult: sfm preset helbing2000 { noise = 0 m/s }\n\
        agent user: adult { at = (0, 0); velocity = (1, 0) m/s; speed = 1 m/s; route = (20, 0) }\n\
        process alarm { var on = false\n when !on at 1 /s * (1 - travelled(user) / 2 m) -> on = true }";
    let study = compiled(scenario, "estimate P(F (alarm.on & travelled(user) > 2.5 m)) within 0.1").unwrap();
    let Some(Failure::Model(flaw)) = answered(&study, 0, 2).failure else { panic!() };
    let reason = flaw.to_string();
    assert!(
        reason.contains("rate of command 1 of `alarm`") && reason.contains(" at 2 s: ")
            || reason.contains(" at 2.1 s: "),
        "{reason}"
    );
}
