//! `smc advise` from the outside: lines, threads, streams that are late, repeated or broken, and calls that are wrong.

use crate::program::{Place, Said, at_root, recordings};
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::Stdio;

/// A user who is observed.
const LIVE: &str = "horizon = 1 s
step = 0.1 s
tracks here = stream
kind adult: sfm preset helbing2000 { noise = 0.05 m/s }
agent user: adult from here at 0 s id 2
agents others: adult from here at 0 s except 2
moves user for 0.5 s { heading -30 deg  heading 0 deg  heading 30 deg  stop }
";
const RANK: &str = "property clear = G<=1 s (forall a in others: distance(user, a) > 0.5 m)
property onward = F<=1 s (travelled(user) > 0.5 m)
rank moves of user by P(clear & onward) within 0.1 confidence 95 %
";

fn live() -> Place {
    Place::new(&[("a.scn", LIVE), ("a.bltl", RANK)])
}

fn fed(input: &str, words: &[&str]) -> Said {
    live().fed(&[&["advise", "a.scn", "a.bltl", "--total-trials", "60"], words].concat(), input)
}

/// The lines without the times that they took.
fn lines(out: &str) -> Vec<Value> {
    let line = |line: &str| {
        let mut value: Value = serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}\n{line}"));
        value.as_object_mut().unwrap().remove("used_ms");
        value
    };
    out.lines().map(line).collect()
}

fn statuses(out: &str) -> Vec<String> {
    lines(out).iter().map(|line| line["status"].as_str().unwrap().to_owned()).collect()
}

fn square(words: &[&str]) -> Said {
    let call =
        ["advise", "models/square.scn", "properties/square.bltl", "--replay", "here", "--total-trials"];
    at_root(&[&call[..], words].concat())
}

#[test]
fn a_replay_gives_the_same_bytes_with_any_number_of_threads() {
    let said = square(&["2000", "-j", "1"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    let one = lines(&said.out);
    for threads in ["2", "8"] {
        assert_eq!(lines(&square(&["2000", "-j", threads]).out), one, "{threads} threads");
    }
    let text: Vec<String> = one.iter().map(ToString::to_string).collect();
    insta::assert_snapshot!("advise_square", text.join("\n"));
}

#[test]
fn every_line_fits_the_schema() {
    let schema: Value = serde_json::from_str(include_str!("../../docs/schema/advice.schema.json")).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    let validator = jsonschema::validator_for(&schema).unwrap();
    let out = square(&["200", "--follow"]).out;
    assert_eq!(out.lines().count(), 52, "a line for each batch, and the end");
    for line in out.lines() {
        assert!(validator.is_valid(&serde_json::from_str(line).unwrap()), "{line}");
    }
    assert_eq!(statuses(&out).last().unwrap(), "end");
}

#[test]
fn bad_late_and_repeated_lines_are_left_out() {
    let input = r#"{"t":0,"seen":[{"x":0,"y":0,"id":2}]}
{"t":0.4,"seen":[{"x":0.4,"y":0,"id":2},{"x":3,"y":0}]}
rubbish
{"t":0.4,"seen":[]}
{"t":0.2,"seen":[]}

{"t":0.8,"seen":[],"field":[[0,0]]}
{"t":0.8,"seen":[{"x":0.8,"y":0,"id":2}]}
"#;
    let said = fed(input, &[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("line 3, column 1") && said.err.contains("line 7: `field`"), "{}", said.err);
    let lines = lines(&said.out);
    assert_eq!(lines.len(), 3);
    assert_eq!(lines[2]["notes"].as_array().unwrap().len(), 2, "{}", lines[2]);
    let strict = fed(input, &["--strict"]);
    assert_eq!(strict.code, Some(2));
    assert!(strict.err.contains("line 3, column 1"), "{}", strict.err);
}

#[test]
fn an_unseen_user_is_projected_then_lost_and_an_empty_scene_is_blind() {
    let input = r#"{"t":0,"seen":[{"x":0,"y":0,"id":2}]}
{"t":0.4,"seen":[{"x":0.4,"y":0,"id":2}]}
{"t":1.2,"seen":[{"x":9,"y":9}]}
{"t":2.8,"seen":[{"x":9,"y":9}]}
{"t":5.2,"seen":[]}
"#;
    let said = fed(input, &[]);
    assert_eq!(statuses(&said.out)[2..], ["advice", "lost", "blind"], "{}", said.out);
    assert!(lines(&said.out)[2]["notes"].to_string().contains("last seen at 0.4 s"), "{}", said.out);
}

#[test]
fn sensors_that_always_come_in_one_order_are_joined() {
    let input: String = (0..5)
        .map(|k| {
            let (t, x) = (f64::from(k) * 0.5, f64::from(k) * 0.5);
            format!(
                "{{\"t\":{t},\"sensor\":\"a\",\"seen\":[{{\"x\":9,\"y\":9}}]}}\n\
                 {{\"t\":{t},\"sensor\":\"b\",\"seen\":[{{\"x\":{x},\"y\":0,\"id\":2}}]}}\n"
            )
        })
        .collect();
    let said = fed(&input, &[]);
    assert_eq!(statuses(&said.out), ["lost", "advice", "advice", "advice", "advice"], "{}", said.out);
}

#[test]
fn a_long_stream_is_answered_line_by_line() {
    let input: String = (0..2000)
        .map(|k| format!("{{\"t\":{},\"seen\":[{{\"x\":{},\"y\":0,\"id\":2}}]}}\n", k, k % 20))
        .collect();
    let said = fed(&input, &[]);
    assert_eq!(said.out.lines().count(), 2000);
}

#[test]
fn a_reader_that_goes_away_ends_the_stream() {
    let place = live();
    let mut child = place
        .command(&["advise", "a.scn", "a.bltl", "--total-trials", "20"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    writeln!(input, "{{\"t\":0,\"seen\":[{{\"x\":0,\"y\":0,\"id\":2}}]}}").unwrap();
    let mut line = String::new();
    output.read_line(&mut line).unwrap();
    assert!(line.contains("\"cycle\":0"), "the line is flushed at once: {line}");
    drop(output);
    for t in 1..20 {
        if writeln!(input, "{{\"t\":{t},\"seen\":[]}}").is_err() {
            break;
        }
    }
    drop(input);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn calls_that_make_no_sense_are_refused() {
    let place = live();
    let said = place.call(&["check", "a.scn", "a.bltl"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("smc advise"), "{}", said.err);
    let still = LIVE.lines().filter(|line| !line.starts_with("moves")).collect::<Vec<_>>().join("\n");
    place.write("still.scn", still.as_bytes());
    let said = place.call(&["advise", "still.scn", "a.bltl"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("no moves to advise"), "{}", said.err);
    for (words, part) in [
        (&["200", "--user", "99"][..], "person 99 is not in the recording"),
        (&["200", "--from", "30s"], "from 0 s to 20 s"),
    ] {
        let said = square(words);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}");
        assert!(said.err.contains(part), "{}", said.err);
    }
}

#[test]
fn both_planners_of_the_paper_answer_on_the_hotel_recording() {
    let Some(data) = recordings() else { return };
    for name in ["hotel-any", "hotel-groups"] {
        let (model, properties) = (format!("models/{name}.scn"), format!("properties/{name}.bltl"));
        let said = at_root(&[
            "advise",
            &model,
            &properties,
            "--data",
            data.to_str().unwrap(),
            "--replay",
            "hotel",
            "--from",
            "646.8s",
            "--to",
            "648s",
            "--total-trials",
            "200",
        ]);
        assert_eq!(statuses(&said.out), ["advice"; 4], "{name}\n{}", said.err);
    }
}
