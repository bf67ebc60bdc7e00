//! `smc check --outcomes`: queries about outcomes that exist already, from a table or a stream.

use crate::program::{Place, timeless};
use std::io::Write;
use std::process::Stdio;

/// Truth values and times of so many trials, from a generator with a period beyond all of them (Park and Miller 1988).
fn trials(count: u64) -> Vec<(bool, f64)> {
    let mut state = 2026_u64;
    let mut draw = || {
        state = state * 16_807 % 2_147_483_647;
        state as f64 / 2_147_483_647.0
    };
    (0..count).map(|_| (draw() < 0.9, 10.0 + 4.0 * draw())).collect()
}

fn table(trials: &[(bool, f64)]) -> String {
    let rows = trials.iter().enumerate();
    let rows = rows.map(|(k, (safe, time))| format!("{k},safe,{safe}\n{k},time,{time:.4} s\n"));
    format!("trial,query,value\n{}", rows.collect::<String>())
}

const QUERIES: &str = "\
check P(safe) >= 0.85
check P(safe & time < 13 s) >= 0.8
estimate E(time) in 0 s .. 20 s within 0.4 s
estimate Q(0.5, time)
estimate P(safe) by clopper_pearson(trials = 700)
";

#[test]
fn counts_are_those_of_the_table() {
    let all = trials(4000);
    let place = Place::new(&[("a.csv", &table(&all)), ("a.bltl", QUERIES)]);
    let said = place.call(&["check", "--outcomes", "a.csv", "a.bltl", "--format", "json"]);
    let json = said.json();
    for (result, limit) in [(0, f64::INFINITY), (1, 13.0), (4, f64::INFINITY)] {
        let result = &json["results"][result];
        let count = result["trials"].as_u64().unwrap();
        let wanted =
            all[..count as usize].iter().filter(|(safe, time)| *safe && *time < limit).count() as u64;
        assert_eq!(result["successes"].as_u64(), Some(wanted), "{result}");
        assert!(count < 4000);
    }
    assert_eq!(json["results"][4]["trials"], 700);
    let mean = &json["results"][2];
    let within = |low: f64, high: f64| (low..=high).contains(&mean["estimate"].as_f64().unwrap());
    assert!(within(11.6, 12.4) && mean["unit"] == "s", "{mean}");
    assert_eq!(json["results"][0]["given"], "the outcomes of a.csv, if they are independent");
}

#[test]
fn a_stream_and_any_number_of_threads_give_the_same_results() {
    let all = table(&trials(4000));
    let place = Place::new(&[("a.csv", &all), ("a.bltl", QUERIES)]);
    let results = |mut json: serde_json::Value| {
        timeless(&mut json);
        let mut results = json["results"].take();
        for result in results.as_array_mut().unwrap() {
            result["given"].take();
            result["replay"].take();
        }
        results
    };
    let of = |table: &str, threads: &str| {
        let words = ["check", "--outcomes", table, "a.bltl", "--format", "json", "-j", threads];
        results(place.fed(&words, if table == "-" { &all } else { "" }).json())
    };
    let alone = of("a.csv", "1");
    for (table, threads) in [("a.csv", "2"), ("a.csv", "7"), ("-", "1"), ("-", "3")] {
        assert_eq!(of(table, threads), alone, "{table}, {threads} threads");
    }
}

#[test]
fn a_stream_is_read_no_farther_than_a_verdict_needs() {
    let place = Place::new(&[("a.bltl", "check P(safe) >= 0.5")]);
    let mut child = place
        .command(&["check", "--outcomes", "-", "a.bltl", "--brief"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    writeln!(stdin, "trial,query,value").unwrap();
    // The stream ends when nobody listens any longer, long before so many trials.
    let written = (0..100_000_000_u64).find(|k| writeln!(stdin, "{k},safe,true").is_err()).unwrap();
    let said = child.wait_with_output().unwrap();
    assert_eq!(said.status.code(), Some(0));
    assert!(written > 10, "{written}");
}

#[test]
fn a_trial_without_a_value_is_unresolved_where_it_is_needed() {
    let rows = (0..100).map(|k| {
        let time = ["", "NaN", "11 s", "12 s"][k % 4];
        format!("{k},time,{time}\n{k},safe,true\n")
    });
    let table = format!("trial,query,value\n{}", rows.collect::<String>());
    let queries = "estimate P(safe) by clopper_pearson(trials = 100)\n\
                   estimate P(time < 20 s) by clopper_pearson(trials = 100)";
    let place = Place::new(&[("a.csv", &table), ("a.bltl", queries)]);
    let json = place.call(&["check", "--outcomes", "a.csv", "a.bltl", "--format", "json"]).json();
    let counts = |k: usize| {
        ["successes", "failures", "unresolved"].map(|name| json["results"][k][name].as_u64().unwrap())
    };
    assert_eq!((counts(0), counts(1)), ([100, 0, 0], [50, 0, 50]));
}

#[test]
fn too_few_trials_leave_a_query_open() {
    let place = Place::new(&[("a.csv", &table(&trials(20))), ("a.bltl", "check P(safe) >= 0.85")]);
    let said = place.call(&["check", "--outcomes", "a.csv", "a.bltl"]);
    assert_eq!(said.code, Some(3), "{}{}", said.out, said.err);
    assert!(said.out.contains("stopped where outcomes are missing"), "{}", said.out);
}

#[test]
fn outcomes_that_depend_on_each_other_draw_a_warning() {
    let warned = |truth: &dyn Fn(u64) -> bool| {
        let rows = (0..400).map(|k| format!("{k},safe,{}\n", truth(k)));
        let table = format!("trial,query,value\n{}", rows.collect::<String>());
        let place =
            Place::new(&[("a.csv", &table), ("a.bltl", "estimate P(safe) by clopper_pearson(trials = 400)")]);
        let said = place.call(&["check", "--outcomes", "a.csv", "a.bltl"]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.out.contains("depend on each other") || said.err.contains("depend on each other")
    };
    let all = trials(400);
    assert!(!warned(&|k| all[k as usize].1 < 12.0));
    // Sorted, and in turn.
    assert!(warned(&|k| k < 200));
    assert!(warned(&|k| k % 2 == 0));
}

#[test]
fn tables_that_break_a_rule_are_refused_with_the_line() {
    let head = "trial,query,value\n";
    for (table, wanted) in [
        ("", "there are no outcomes"),
        (head, "there are no outcomes"),
        ("trial,query\n0,a\n", "line 1: the table has no column `value`"),
        ("trial,query,value\n0,a\n", "line 2: 2 cells are too few"),
        ("trial,query,value\nzero,a,1\n", "line 2: `zero` is not the number of a trial"),
        (
            "trial,query,value\n0,a,true\n2,a,true\n",
            "line 3: trial 2 follows trial 0; trials are missing between them",
        ),
        ("trial,query,value\n1,a,true\n0,a,true\n", "line 3: trial 0 follows trial 1; trials must ascend"),
        ("trial,query,value\n0,a,true\n0,a,true\n", "line 3: trial 0 has a second outcome of `a`"),
        ("trial,query,value\n0,a,maybe\n", "line 2: `maybe` is neither true, false nor a finite number"),
        ("trial,query,value\n0,a,inf\n", "line 2: `inf` is neither true, false nor a finite number"),
        ("trial,query,value\n0,a,1 parsek\n", "`parsek` is not a unit"),
        ("trial,query,value\n0,check,1\n", "`check` cannot be a name in a property file"),
        ("trial,query,value\n0,a b,1\n", "`a b` cannot be a name in a property file"),
        (
            "trial,query,value\n0,a,true\n1,b,true\n",
            "trial 1 has an outcome of `b`, and the first trial has none",
        ),
        (
            "trial,query,value\n0,a,true\n1,a,3 m\n",
            "trial 1: `a` is a number in m, and in the first trial a truth value",
        ),
    ] {
        let place = Place::new(&[("a.csv", table), ("a.bltl", "check P(a) >= 0.5")]);
        let said = place.call(&["check", "--outcomes", "a.csv", "a.bltl"]);
        assert_eq!(said.code, Some(2), "{table}");
        assert!(said.err.contains(&format!("error[E0707]: a.csv: {wanted}")), "{table}\n{}", said.err);
        assert!(said.out.is_empty(), "{}", said.out);
    }
}

#[test]
fn what_needs_a_model_is_refused() {
    let csv = "trial,query,value\n0,a,true\n0,way,3 m\n";
    let refused = |query: &str, words: &[&str], wanted: &str| {
        let place = Place::new(&[("a.csv", csv), ("a.bltl", query)]);
        let said = place.call(&[&["check", "--outcomes", "a.csv", "a.bltl"], words].concat());
        assert_eq!(said.code, Some(2), "{query}: {}", said.out);
        assert!(said.err.contains(wanted), "{query}: {}", said.err);
    };
    refused(
        "estimate P(F<=1 step (way < 2 m)) by splitting(replicas = 100)",
        &[],
        "error[E0603]: outcomes cannot be split",
    );
    refused("check P(b) >= 0.5", &[], "error[E02");
    refused("check P(a) >= 0.5", &["--set", "x=1"], "--outcomes");
    refused("check P(a) >= 0.5", &["--launch", "local"], "--outcomes");
    let place = Place::new(&[("a.csv", csv)]);
    let said = place.call(&["check", "--outcomes", "a.csv"]);
    assert_eq!((said.code, said.err.contains("<SCENARIO>")), (Some(2), true), "{}", said.err);
}
