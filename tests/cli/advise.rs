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
moves user for 0.5 s { heading -30 deg; heading 0 deg; heading 30 deg; stop }
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
        ["advise", "models/square.scn", "properties/square.bltl", "--tracks", "here", "--total-trials"];
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

/// A choice for the worst case, at every cycle, by the file and by the call.
#[test]
fn advice_holds_under_every_model() {
    let scene = LIVE
        .replace("kind adult: sfm preset helbing2000 { noise = 0.05 m/s }", "kind adult: preset people")
        + "param people = smc1 in smc1, cfs2\n";
    let rank = RANK.replace("95 %", "95 % under every people");
    let input = r#"{"t":0,"seen":[{"x":0,"y":0,"id":2},{"x":2,"y":0,"id":3}]}
{"t":0.4,"seen":[{"x":0.4,"y":0,"id":2},{"x":1.8,"y":0,"id":3}]}
{"t":0.8,"seen":[{"x":0.8,"y":0,"id":2},{"x":1.6,"y":0,"id":3}]}
"#;
    let cycles = |scene: &str, rank: &str, words: &[&str]| {
        let place = Place::new(&[("a.scn", scene), ("a.bltl", rank)]);
        let said =
            place.fed(&[&["advise", "a.scn", "a.bltl", "--total-trials", "4000"], words].concat(), input);
        assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
        let cycles: Vec<Value> =
            lines(&said.out).into_iter().filter(|one| one["status"] == "advice").collect();
        assert_eq!(cycles.len(), 3, "{}", said.out);
        cycles
    };
    let by_file = cycles(&scene, &rank, &[]);
    let by_call = cycles(LIVE, RANK, &["--models", "smc1,cfs2"]);
    // Seen once, the user is taken to stand; from the second time on a choice can be certified.
    for (one, other) in by_file.iter().zip(&by_call).skip(1) {
        assert_eq!(
            (&one["certified"], &other["certified"]),
            (&true.into(), &true.into()),
            "{one:#}{other:#}"
        );
        assert!(one["move"].is_string() && other["move"].is_string(), "{one:#}{other:#}");
    }
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
fn everybody_in_turn_follows_and_a_table_tells_what_it_is_worth() {
    let said = square(&["40", "--follow", "--user", "all"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    for part in
        ["5 users of the recording\n", "\nleast distance (m) ", "\nway (m) ", " came nearer to somebody; "]
    {
        assert!(said.out.contains(part), "{part}\n{}", said.out);
    }
    assert_eq!(square(&["40", "--follow", "--user", "all", "-j", "1"]).out, said.out);
    for (words, wanted) in [
        (&["40", "--user", "all"][..], "compares advised with recorded walks"),
        (&["40", "--user", "all", "--follow", "--from", "19s"], "nobody is seen for 4 s"),
        (&["40", "--user", "every"], "is no id: write 367, or all"),
    ] {
        let said = square(words);
        assert!(said.code == Some(2) && said.err.contains(wanted), "{words:?}\n{}", said.err);
    }
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
fn a_batch_far_ahead_is_left_out_and_said_at_once() {
    let line = |t: f64, x: f64| format!("{{\"t\":{t},\"seen\":[{{\"x\":{x},\"y\":0,\"id\":2}}]}}\n");
    let input: String =
        (0..10).map(|k| line(if k == 3 { 1000.5 } else { f64::from(k) * 0.5 }, f64::from(k) * 0.5)).collect();
    let said = fed(&input, &[]);
    assert_eq!(statuses(&said.out), ["advice"; 9], "{}", said.err);
    let note = "a batch at 1000.5 s is 999.5 s after the last one and is left out";
    assert_eq!(said.err, format!("warning: line 4: {note}\n"));
    assert!(lines(&said.out)[3]["notes"].to_string().contains(note), "{}", said.out);
    // A clock that is set back is followed, with new traces.
    let input: String = (0..20).map(|k| line(f64::from(k % 10) * 0.5, f64::from(k) * 0.5)).collect();
    let said = fed(&input, &[]);
    assert_eq!(statuses(&said.out), ["advice"; 19], "{}", said.out);
    assert!(said.err.contains("line 12: the clock stays at 0.5 s and is followed"), "{}", said.err);
}

#[test]
fn a_person_who_is_reported_twice_is_one() {
    for (twice, people) in [
        (r#"{"x":8,"y":3},{"x":8,"y":3}"#, 2),
        (r#"{"x":8,"y":3}"#, 2),
        // At the place of the user's device.
        (r#"{"x":0,"y":0}"#, 1),
        // Two ids are two people, who are moved apart.
        (r#"{"x":0,"y":0,"id":9}"#, 2),
        (r#"{"x":8,"y":3,"id":8},{"x":8,"y":3,"id":9}"#, 3),
    ] {
        let input = format!("{{\"t\":0,\"seen\":[{{\"x\":0,\"y\":0,\"id\":2}},{twice}]}}\n");
        let said = fed(&input, &[]);
        let line = &lines(&said.out)[0];
        assert!(line["people"] == people && line["status"] != "late", "{twice}: {line}");
        let is_noted = line["notes"].to_string().contains(" place");
        assert_eq!(is_noted, twice != r#"{"x":8,"y":3}"#, "{line}");
    }
}

#[test]
fn many_people_are_answered_within_the_range_and_refused_without() {
    let crowd: String =
        (1..10_000).map(|k| format!(",{{\"x\":{},\"y\":{}}}", 2 * (k % 100), 2 * (k / 100))).collect();
    let input = format!("{{\"t\":0,\"seen\":[{{\"x\":0,\"y\":0,\"id\":2}}{crowd}]}}\n");
    let line = &lines(&fed(&input, &["--range", "5m"]).out)[0];
    assert_eq!((line["status"].as_str(), line["people"].as_u64()), (Some("advice"), Some(8)), "{line}");
    let line = &lines(&fed(&input, &[]).out)[0];
    assert_eq!(line["status"], "late");
    assert!(line["notes"].to_string().contains("10000 observations at a time, more than 2000"), "{line}");
}

#[test]
fn a_stream_without_lines_is_refused() {
    let mut long = format!("{{\"t\":0,\"seen\":[],\"more\":\"{}\"}}\n", "x".repeat(17 << 20));
    long.push_str("{\"t\":0.5,\"seen\":[{\"x\":0,\"y\":0,\"id\":2}]}\n");
    let said = fed(&long, &[]);
    assert_eq!(said.err, "warning: line 1: longer than 16 MB; the line is skipped\n");
    assert_eq!(statuses(&said.out), ["advice"]);
}

#[test]
fn messages_about_lines_name_the_member_and_its_form() {
    for (line, part) in [
        (
            r#"{"t":0,"seen":[{"x":0,"y":0,"id":"two"}]}"#,
            "`id` must be a whole number from 0 to 4294967295 (got string \"two\")",
        ),
        (r#"{"t":0,"seen":[{"x":0,"y":0,"id":-1}]}"#, "`id` must be a whole number"),
        (r#"{"t":0,"seen":[[1,2,3]]}"#, "`seen` must be a list of JSON objects"),
        (r#"{"t":0,"seen":"x"}"#, "`seen` must be a list (got string \"x\")"),
        (r#"{"t":"0","seen":[]}"#, "`t` must be a number"),
        ("[]", "a line must be a JSON object"),
        ("0.4,1,2", "a line must be a JSON object (got floating point `0.4`)"),
        ("not json", "the line is not JSON: expected value"),
        (r#"{"t":4.8"#, "the line is not JSON: EOF"),
    ] {
        let said = fed(&format!("{line}\n"), &[]).err;
        assert!(said.contains(part) && said.contains("write for example {\"t\":0.4"), "{line}\n{said}");
        for word in ["struct", "u32", "f64", "ident", "elements"] {
            assert!(!said.contains(word), "{said}");
        }
    }
    let marked = fed("\u{feff}{\"t\":0,\"seen\":[{\"x\":0,\"y\":0,\"id\":2}]}\n", &[]);
    assert_eq!((statuses(&marked.out), marked.err), (vec!["advice".to_owned()], String::new()));
}

#[test]
fn a_page_of_a_live_stream_needs_a_recording() {
    let said = fed("", &["--report", "a.html"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("`--tracks lidar --report a.html`"), "{}", said.err);
    assert!(said.err.contains("tracks lidar = observations \"obs.jsonl\""), "{}", said.err);
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
            "--tracks",
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
