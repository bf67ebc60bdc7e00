//! Exit codes, budgets, settings, interruption, a closed pipe.

use crate::program::{Place, SMALL, Said};
use serde_json::json;
use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Command, Stdio};
use std::time::Duration;

const PROPERTIES: &str = "\
property near = F<=3 s (min(distance(user, a) for a in crowd) < 2 m)
property far = G<=3 s (forall a in crowd: distance(user, a) > 50 m)
check P(near) >= 0.2
check P(far) >= 0.5
estimate E(min<=2 s (speed(user))) in 0 m/s .. 3 m/s
";

fn small(properties: &str) -> Place {
    Place::new(&[("a.scn", SMALL), ("a.bltl", properties)])
}

fn checked(properties: &str, words: &[&str]) -> Said {
    small(properties).call(&[&["check", "a.scn", "a.bltl", "-q"], words].concat())
}

#[test]
fn exit_codes_say_what_was_found() {
    let near = "property near = F<=3 s (min(distance(user, a) for a in crowd) < 2 m)\n";
    let code = |query: &str, words: &[&str]| checked(&format!("{near}{query}"), words).code;
    assert_eq!(code("check P(near) >= 0.2", &[]), Some(0));
    assert_eq!(code("check P(near) <= 0.2", &[]), Some(1));
    assert_eq!(code("check P(naer) <= 0.2", &[]), Some(2));
    assert_eq!(code("check P(near) >= 0.2", &["--max-trials", "2"]), Some(3));
    assert_eq!(code("estimate P(near) within 0.1", &[]), Some(0), "nothing to decide");
    assert_eq!(code("", &[]), Some(0));
    // What a deadline left without a trial is replayed like this.
    assert_eq!(code("check P(near) >= 0.2", &["--max-trials", "0"]), Some(3));
    // Violated comes before undecided.
    let both = "check P(near) <= 0.2\ncheck P(near) >= 0.999";
    assert_eq!(code(both, &["--max-trials", "60"]), Some(1));
    for words in [&["--threads", "0"][..], &["--only", "nobody"], &["--timeout", "5"]] {
        assert_eq!(code("check P(near) >= 0.2", words), Some(2), "{words:?}");
    }
    assert_eq!(small("").call(&["chek"]).code, Some(2));
    assert_eq!(small("").call(&["--help"]).code, Some(0));
}

#[test]
fn only_chooses_queries_by_name_and_number() {
    let said = checked(PROPERTIES, &["--format", "json", "--only", "far"]);
    let json = said.json();
    let results = json["results"].as_array().unwrap();
    assert_eq!(results.len(), 1);
    assert_eq!((&results[0]["index"], &results[0]["name"]), (&1.into(), &"far".into()));
    let said = checked(PROPERTIES, &["--format", "json", "--only", "2", "--only", "0"]);
    let indices: Vec<_> =
        said.json()["results"].as_array().unwrap().iter().map(|r| r["index"].clone()).collect();
    assert_eq!(indices, [0, 2]);
    let said = checked(PROPERTIES, &["--only", "naer"]);
    assert!(said.err.contains("did you mean `near`?"), "{}", said.err);
}

#[test]
fn settings_and_sweeps() {
    let query = "estimate E(count(a in crowd) at end) in 0 .. 100 by fixed(trials = 2)\n";
    let number = |words: &[&str]| {
        let json = checked(query, &[&["--format", "json"], words].concat()).json();
        let results = json["results"].as_array().unwrap().clone();
        results.iter().map(|r| (r["settings"].clone(), r["estimate"].as_f64().unwrap())).collect::<Vec<_>>()
    };
    assert_eq!(number(&[])[0].1, 3.0);
    assert_eq!(number(&["--set", "density=0.4"])[0].1, 6.0, "a bare number takes the declared unit");
    assert_eq!(number(&["--set", "density=0.4 /m^2"])[0].1, 6.0);
    let swept = number(&["--set", "density=0.2..0.4 by 0.1"]);
    assert_eq!(swept.iter().map(|r| r.1).collect::<Vec<_>>(), [3.0, 5.0, 6.0]);
    assert_eq!(swept[1].0["density"], json!({ "value": 0.3, "unit": "/m^2" }));
}

#[test]
fn at_a_deadline_what_is_known_is_certified() {
    let place = small("rank moves of user by P(F<=3 s contact(user)) within 0.001 confidence 95 %\n");
    let said = place.call(&["check", "a.scn", "a.bltl", "--format", "json", "--timeout", "50ms"]);
    let result = said.json()["results"][0].clone();
    assert_eq!((said.code, &result["stopped_by"]), (Some(4), &"deadline".into()));
    assert!(result["gap"].as_f64().unwrap() > 0.0);
    assert!(result["choice"].is_string());
}

#[test]
fn an_interruption_prints_what_is_known() {
    let place = small("check P(F<=3 s contact(user)) >= 0.3 by sprt(indifference = 0.00001)\n");
    let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "900000000"];
    let child = place.command(&words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(700));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["interrupted"], true);
    assert_eq!(json["results"][0]["stopped_by"], "interrupt");
    assert_eq!(json["results"][0]["verdict"], "undecided");
    assert!(json["results"][0]["trials"].as_u64().unwrap() > 0);
}

#[test]
fn a_closed_pipe_is_no_error() {
    let place = small(PROPERTIES);
    for words in [
        &["simulate", "a.scn", "--trials", "200"][..],
        &["explain"],
        &["check", "a.scn", "a.bltl", "-q", "--max-trials", "5"],
    ] {
        let mut child = place.command(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut first = String::new();
        let mut out = BufReader::with_capacity(16, child.stdout.take().unwrap());
        out.read_line(&mut first).unwrap();
        drop(out);
        let mut err = String::new();
        child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
        let code = child.wait().unwrap().code();
        assert_eq!(err, "", "{words:?}");
        // What was found still counts for a check.
        assert!(code == Some(0) || words[0] == "check" && code == Some(3), "{words:?} {code:?}");
    }
}

#[test]
fn help_for_shells_and_manuals() {
    let place = small("check P(F<=3 s contact(user)) >= 0.5\n");
    for shell in ["bash", "zsh", "fish"] {
        let said = place.call(&["completions", shell]);
        assert!(said.code == Some(0) && said.out.contains("simulate"), "{shell}");
    }
    let said = place.call(&["man", "pages"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(place.path("pages/smc.1").is_file() && place.path("pages/smc-check.1").is_file());
    let said = place.call(&["show", "a.scn", "a.bltl", "--set", "density=0.4"]);
    assert_eq!(said.code, Some(0));
    for words in ["horizon 4 s", "200 steps", "region hall", "Agents: 7", "mass 80 kg"] {
        assert!(said.out.contains(words), "{words}\n{}", said.out);
    }
}

#[test]
fn warnings_point_at_families_that_are_left_and_formulas_that_never_change() {
    let said = checked(
        "family confidence 95 %\n\
         estimate P(F<=1 s contact(user)) within 0.3 confidence 90 %\n\
         check P(F<=1 s contact(user)) >= 0.5 by sprt(alpha = 0.01, beta = 0.01, indifference = 0.1)\n\
         check P(G<=1 s (1 m < 2 m)) >= 0.5\n",
        &[],
    );
    assert_eq!(said.err.matches("warning[W0601]: the query leaves its family").count(), 2, "{}", said.err);
    assert_eq!(
        said.err.matches("warning[W0501]: the formula has the same value in every trial").count(),
        1,
        "{}",
        said.err
    );
    // In a sweep with the point of which it is said.
    let said = checked(
        "check P(F<=1 s (contact(user) | density > 0.15 /m^2)) >= 0.5\n",
        &["--set", "density=0.1..0.2 by 0.1"],
    );
    let warning = "warning[W0501]: the formula has the same value in every trial (with density = 0.2 /m^2)";
    assert_eq!(said.err.matches(warning).count(), 1, "{}", said.err);
}

#[test]
fn calls_that_would_do_nothing_are_refused() {
    let place = small("check P(F<=3 s contact(user)) >= 0.5\nestimate P(F<=3 s contact(user)) within 0.1\n");
    for (words, said) in [
        (&["simulate", "a.scn", "--every", "0"][..], "`0` is not a whole number from 1"),
        (&["simulate", "a.scn", "--trials", "0"], "`0` is not a whole number from 1"),
        (&["simulate", "a.scn", "--trial", "281474976710656"], "numbered from 0 to 281474976710655"),
        (&["simulate", "a.scn", "--until", "4.5"], "the horizon of the scenario is 4 s"),
        (&["simulate", "a.scn", "--until", "-1"], "must be a time that is not negative"),
        (&["simulate", "a.scn", "--until", "nan"], "must be a time that is not negative"),
        (&["simulate", "a.scn", "--data", "nowhere"], "`--data nowhere` does not exist"),
        (&["check", "a.scn", "a.bltl", "--data", "a.bltl"], "`--data a.bltl` is not a directory"),
        (&["check", "a.scn", "a.bltl", "--only", "2"], "there is no query 2"),
    ] {
        let found = place.call(words);
        assert_eq!((found.code, found.out.as_str()), (Some(2), ""), "{words:?}");
        assert!(found.err.contains(said), "{words:?}\n{}", found.err);
    }
    assert_eq!(place.call(&["simulate", "a.scn", "--until", "4"]).code, Some(0));
}

#[test]
fn a_file_that_asks_nothing_is_warned_of() {
    for properties in ["property p = F<=3 s contact(user)\n", "// later\n"] {
        let said = small(properties).call(&["check", "a.scn", "a.bltl"]);
        assert_eq!(said.code, Some(0));
        assert!(said.err.contains("warning[W0602]: the property files contain no query"), "{}", said.err);
    }
    let place = small("property p = F<=3 s contact(user)\n");
    std::fs::write(place.path("b.bltl"), "check P(F<=3 s contact(user)) >= 0.5\n").unwrap();
    let said = place.call(&["check", "a.scn", "a.bltl", "b.bltl", "--max-trials", "2", "-q"]);
    assert!(!said.err.contains("W0602"), "{}", said.err);
}

#[test]
fn more_threads_than_help_are_not_started() {
    let place = small("check P(F<=3 s contact(user)) >= 0.5\n");
    let call = |threads: &str| {
        place.call(&[
            "check",
            "a.scn",
            "a.bltl",
            "-q",
            "--format",
            "json",
            "--max-trials",
            "40",
            "-j",
            threads,
        ])
    };
    let (few, many) = (call("1"), call("100000"));
    assert_eq!(few.err, "");
    assert!(many.err.contains("threads are not faster on this machine"), "{}", many.err);
    for field in ["trials", "successes", "verdict"] {
        assert_eq!(few.json()["results"][0][field], many.json()["results"][0][field]);
    }
}

#[test]
fn what_a_procedure_refuses_has_a_code_and_a_place() {
    for query in [
        "estimate P(F<=3 s contact(user)) within 0.6",
        "estimate P(F<=3 s contact(user)) by okamoto(epsilon = 0.6, delta = 0.05)",
        "estimate E(speed(user) at 1 s) in 0 m/s .. 3 m/s within 4 m/s",
    ] {
        let said = checked(&format!("let a = 1\n{query}\n"), &[]);
        assert_eq!(said.code, Some(2), "{query}");
        assert!(said.err.starts_with("error[E0604]: ") && said.err.contains("a.bltl:2:"), "{}", said.err);
    }
}

#[test]
fn the_command_of_a_witness_sets_each_parameter_once() {
    let query = "estimate P(F<=3 s contact(user)) within 0.3 under density = 0.5 /m^2\n";
    let place = small(query);
    for set in ["density=0.1", "density=0.1..0.3 by 0.1"] {
        let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--set", set, "--format", "json"]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        let json = said.json();
        let command = json["results"][0]["witnesses"][0]["command"].as_str().unwrap().to_owned();
        assert_eq!(command.matches("density=").count(), 1, "{command}");
        let words: Vec<String> = command.split(" --").map(|part| part.replace('\'', "")).collect();
        let mut call = vec!["simulate", "a.scn"];
        let options: Vec<String> = words[1..].iter().map(|part| format!("--{part}")).collect();
        let split: Vec<(&str, &str)> = options.iter().filter_map(|part| part.split_once(' ')).collect();
        call.extend(split.iter().flat_map(|(name, value)| [*name, *value]));
        let shown = place.call(&call);
        assert_eq!(shown.code, Some(0), "{command}\n{}", shown.err);
    }
}
