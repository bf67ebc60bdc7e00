//! `smc drift`: alarms at once, exit codes, columns, errors with their line.

use crate::program::Place;
use smc::stats::Cusum;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

const RATES: [&str; 4] = ["--before", "95%", "--after", "0.85"];

/// So many successes, then every third outcome a failure.
fn outcomes(good: usize, bad: usize) -> Vec<bool> {
    (0..good).map(|k| k % 40 != 39).chain((0..bad).map(|k| k % 3 != 0)).collect()
}

fn alarms(outcomes: &[bool]) -> Vec<u64> {
    let mut cusum = Cusum::new(0.95, 0.85, 1000f64.ln()).unwrap();
    let at = |(k, success): (usize, &bool)| cusum.observe(*success).then_some(k as u64 + 1);
    outcomes.iter().enumerate().filter_map(at).collect()
}

#[test]
fn alarms_are_those_of_the_sum() {
    let all = outcomes(300, 200);
    let lines: String = all.iter().map(|s| if *s { "1\n" } else { "false\n" }).collect();
    let table: String = std::iter::once("time,arrived\n".to_owned())
        .chain(all.iter().enumerate().map(|(k, s)| format!("{k},{s}\n")))
        .collect();
    let place = Place::new(&[("a.txt", lines.as_str()), ("a.csv", table.as_str())]);
    let wanted = alarms(&all);
    assert!(wanted.len() > 2 && wanted[0] > 300);
    for words in [vec!["a.txt"], vec!["a.csv", "--column", "arrived"], vec!["a.csv", "--column", "2"]] {
        let mut call = vec!["drift"];
        call.extend(words);
        call.extend(RATES);
        call.extend(["--format", "json"]);
        let said = place.call(&call);
        assert_eq!(said.code, Some(1), "{}", said.err);
        let objects: Vec<serde_json::Value> =
            said.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let (summary, each) = objects.split_last().unwrap();
        let found: Vec<u64> = each.iter().map(|o| o["alarm"].as_u64().unwrap()).collect();
        assert_eq!(found, wanted);
        assert_eq!((&summary["alarms"], &summary["outcomes"]), (&serde_json::json!(wanted), &500.into()));
        assert!((summary["mean_to_false_alarm_at_least"].as_f64().unwrap() - 1000.0).abs() < 1e-9);
        assert!(summary["certifies"].as_str().unwrap().contains("at least 1000 outcomes"));
    }
    let mut call = vec!["drift", "a.txt", "--first", "--false-alarm", "1000"];
    call.extend(RATES);
    let said = place.call(&call);
    assert!(said.out.starts_with(&format!("alarm after outcome {} ", wanted[0])), "{}", said.out);
    assert!(said.out.contains("\n1 alarm, after outcome"), "{}", said.out);
}

#[test]
fn without_a_change_it_is_quiet_and_wrong_input_has_a_place() {
    let place = Place::new(&[("fine", "1\n1\n0\n1\n"), ("wrong", "1\n\n2\n")]);
    let call = |words: &[&str]| {
        let mut call = vec!["drift"];
        call.extend(words);
        call.extend(RATES);
        place.call(&call)
    };
    let quiet = call(&["fine"]);
    assert_eq!((quiet.code, quiet.out.contains("no alarm")), (Some(0), true), "{}", quiet.err);
    let wrong = call(&["wrong"]);
    assert_eq!(wrong.code, Some(2));
    assert!(wrong.err.contains("wrong: line 3: `2` is not an outcome"), "{}", wrong.err);
    assert_eq!(call(&["missing"]).code, Some(2));
    assert_eq!(call(&["fine", "--column", "0"]).code, Some(2));
    let same = place.call(&["drift", "fine", "--before", "0.9", "--after", "0.9"]);
    assert_eq!((same.code, same.out.as_str()), (Some(2), ""));
}

#[test]
fn a_stream_is_answered_at_once() {
    let place = Place::new(&[]);
    let mut call = vec!["drift", "-"];
    call.extend(RATES);
    let mut child = place.command(&call).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap()).lines();
    input.write_all("0\n".repeat(20).as_bytes()).unwrap();
    input.flush().unwrap();
    // The input is still open.
    assert_eq!(output.next().unwrap().unwrap(), "alarm after outcome 7 (line 7)");
    drop(input);
    assert!(output.any(|line| line.unwrap().contains("certified: while P is 0.95")));
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

#[test]
fn input_of_another_kind_is_named() {
    let place = Place::new(&[("words", "hello world\nfoo\n"), ("empty", ""), ("comments", "# only\n\n")]);
    place.write("binary", &[0x7f, b'E', b'L', b'F', 0xff, 0, 1, b'\n']);
    place.write("late", b"1\n0\n\xff\n");
    place.write("long", format!("{}\n", "x".repeat(10_000)).as_bytes());
    for (file, said) in [
        ("words", "words: line 1: `hello world` is not an outcome"),
        ("empty", "empty contains no outcome"),
        ("comments", "comments contains no outcome"),
        ("binary", "binary: line 1: not UTF-8 text"),
        ("late", "late: line 3: not UTF-8 text"),
        ("long", "x…` is not an outcome"),
    ] {
        let found = place.call(&["drift", file, "--before", "95%", "--after", "0.85"]);
        assert_eq!((found.code, found.out.as_str()), (Some(2), ""), "{file}");
        assert!(found.err.contains(said) && found.err.len() < 200, "{}", found.err);
    }
}
