//! Verdicts of models and properties of the same name, as snapshots; and what must not change them: threads,
//! other queries, a longer budget. Trials that diverge are held by every interval.

use crate::program::{Place, SMALL, at_root, recordings, timeless};
use serde_json::Value;
use smc::base::fingerprint::Fingerprint;

fn verdicts(stem: &str, words: &[&str]) -> Option<Value> {
    let (model, properties) = (format!("models/{stem}.scn"), format!("properties/{stem}.bltl"));
    let mut call = vec!["check", &model, &properties, "-q", "--format", "json"];
    let data;
    if std::fs::read_to_string(&model).unwrap().contains("= eth_biwi ") {
        data = recordings()?;
        call.extend(["--data", data.to_str().unwrap()]);
    }
    call.extend(words);
    let said = at_root(&call);
    assert!(matches!(said.code, Some(0 | 1 | 3 | 4)), "{}", said.err);
    let mut json = said.json();
    timeless(&mut json);
    Some(json)
}

/// A number in a line: short, with its unit.
fn number(value: &Value) -> String {
    value.as_f64().map_or_else(|| "-".to_owned(), |value| format!("{value:.6}"))
}

/// A result in one line: its query, what came of it, and the fingerprint of its whole JSON, in which no byte may change.
fn line(result: &Value) -> String {
    let word = |field: &str| result[field].as_str().unwrap_or("-").to_owned();
    let settings = result["settings"].as_object().unwrap().iter();
    let settings = settings.map(|(name, value)| format!(" {name}={}", value["value"]));
    let witnesses = result["witnesses"].as_array().unwrap().iter();
    let witnesses = witnesses
        .map(|one| format!(" {} {} at {}", one["shows"].as_str().unwrap(), one["trial"], one["time"]));
    let unit = result["unit"].as_str().map_or(String::new(), |unit| format!(" {unit}"));
    let choice = result["choice"].as_str().map_or(String::new(), |choice| format!(" chosen: {choice}"));
    format!(
        "{}{}\n  {} {} [{}, {}]{unit}, {} trials, {} ({}/{}/{}){choice}{} {}\n",
        word("query"),
        settings.collect::<String>(),
        word("verdict"),
        number(&result["estimate"]),
        number(&result["low"]),
        number(&result["high"]),
        result["trials"],
        word("stopped_by"),
        result["successes"],
        result["failures"],
        result["unresolved"],
        witnesses.collect::<String>(),
        print(result),
    )
}

/// The fingerprint of a JSON, where the place of the recordings is none of it.
fn print(json: &Value) -> String {
    let text = json.to_string();
    let text = match recordings() {
        Some(data) if text.contains("--data ") => text.replace(data.to_str().unwrap(), "DATA"),
        _ => text,
    };
    Fingerprint::of(text.as_bytes()).to_string().replace("fnv1a64:", "")
}

/// Queries with their verdicts, and the fingerprint of what stands beside them.
fn table(mut json: Value) -> String {
    let results = json["results"].take();
    let lines: String = results.as_array().unwrap().iter().map(line).collect();
    format!("{} {}\n{lines}", json["scenario"].as_str().unwrap(), print(&json))
}

#[test]
fn every_model_and_its_properties() {
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::glob!("../models", "*.scn", |path| {
            let stem = path.file_stem().unwrap().to_str().unwrap();
            if let Some(json) = verdicts(stem, &["--max-trials", "100"]) {
                insta::assert_snapshot!("verdicts", table(json));
            }
        });
    });
}

#[test]
fn threads_change_no_byte() {
    for stem in ["corridor", "hotel", "hotel-groups", "distracted", "plaza", "station", "workplace"] {
        let run = |threads: &str| verdicts(stem, &["--max-trials", "60", "--threads", threads]);
        let one = run("1").map(|json| json.to_string());
        assert_eq!(run("2").map(|json| json.to_string()), one);
        assert_eq!(run("8").map(|json| json.to_string()), one);
    }
}

#[test]
fn queries_do_not_disturb_one_another() {
    let together = verdicts("corridor", &["--max-trials", "60"]).unwrap();
    for (index, result) in together["results"].as_array().unwrap().iter().enumerate() {
        let number = result["index"].to_string();
        let alone = verdicts("corridor", &["--max-trials", "60", "--only", &number]).unwrap();
        assert_eq!(alone["results"].as_array().unwrap().len(), 1);
        assert_eq!(alone["results"][0].to_string(), result.to_string(), "query {index}");
    }
}

#[test]
fn a_longer_budget_leaves_what_was_decided() {
    let properties = "\
property near = F<=3 s (min(distance(user, a) for a in crowd) < 2 m)
check P(near) >= 0.2
check P(near) >= 0.95
check P(F<=2 s contact(user)) <= 0.9 by sprt(indifference = 0.05)
estimate P(near) within 0.2
";
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", properties)]);
    let run = |most: &str| {
        let mut json =
            place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", most]).json();
        timeless(&mut json);
        json["results"].as_array().unwrap().clone()
    };
    let (short, long) = (run("150"), run("3000"));
    let mut decided = 0;
    for (short, long) in short.iter().zip(&long) {
        if short["stopped_by"] != "cap" {
            decided += 1;
            for field in
                ["verdict", "trials", "successes", "estimate", "low", "high", "certifies", "witnesses"]
            {
                assert_eq!(short[field], long[field], "{field}");
            }
        }
    }
    assert!(decided >= 2, "{decided}");
}

/// One trial in ten drives somebody to a speed that no human reaches.
const DIVERGING: &str = r#"scenario "One in ten diverges"
horizon = 4 s
step = 0.02 s
kind adult: sfm preset helbing2000 { noise = 0.05 m/s }
agent wild: adult {
  at = (2, 2)
  speed = choice(1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1e9 m/s)
  route = (60, 2)
}
"#;

#[test]
fn diverging_trials_are_held_by_every_interval() {
    let properties = "\
property onward = F<=4 s (travelled(wild) > 2 m)
estimate P(onward) by fixed(trials = 1000)
check P(onward) >= 0.95
check P(onward) <= 0.95
check P(onward) >= 0.5
estimate E(max<=2 s (speed(wild))) in 0 m/s .. 3 m/s by fixed(trials = 1000)
";
    let place = Place::new(&[("a.scn", DIVERGING), ("a.bltl", properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "3000"]);
    assert_eq!(said.code, Some(3), "{}", said.err);
    let json = said.json();
    let results = json["results"].as_array().unwrap();
    let number = |at: usize, field: &str| results[at][field].as_f64().unwrap();
    let unresolved = number(0, "unresolved") / number(0, "trials");
    assert!((0.07..0.13).contains(&unresolved), "about one in ten: {unresolved}");
    // Both readings: all of them failures, all of them successes.
    assert!(number(0, "low") < number(0, "successes") / 1000.0);
    assert!(number(0, "high") > (number(0, "successes") + number(0, "unresolved")) / 1000.0 - 1e-12);
    assert!(number(0, "high") - number(0, "low") > unresolved);
    // The threshold lies between the readings: nobody may decide, whichever way one asks.
    for at in [1, 2] {
        assert_eq!(results[at]["verdict"], "undecided", "{}", results[at]);
        assert!(number(at, "low") < 0.9 && number(at, "high") > 0.95);
    }
    assert_eq!(results[3]["verdict"], "satisfied", "far from the threshold both readings agree");
    // A mean takes the ends of its range.
    let share = number(4, "unresolved") / number(4, "trials");
    assert!(number(4, "high") - number(4, "low") > 3.0 * share, "{}", results[4]);
    let warnings = results[0]["warnings"].to_string();
    assert!(warnings.contains("smaller step") && warnings.contains("--trial "), "{warnings}");
    let first = warnings.split("--trial ").nth(1).unwrap();
    let first = first.split(|c: char| !c.is_ascii_digit()).next().unwrap();
    let shown = place.call(&["simulate", "a.scn", "--trial", first]);
    assert!(shown.err.contains(&format!("trial {first} diverged at ")), "{}", shown.err);
}

#[test]
fn no_shipped_scenario_draws_a_warning() {
    let everything = "estimate P(F<=0 s true) within 0.4\n";
    let place = Place::new(&[("any.bltl", everything)]);
    let any = place.path("any.bltl");
    let data = recordings();
    let mut count = 0;
    for pattern in ["models", "validation", "examples/advise", "examples/cookbook", "examples/evaluate"] {
        for entry in
            std::fs::read_dir(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(pattern)).unwrap()
        {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let Some(stem) = name.strip_suffix(".scn") else { continue };
            let model = format!("{pattern}/{name}");
            let text = std::fs::read_to_string(&model).unwrap();
            // The laws of a site come from a calibration, and the recording of the street from a trial, which are made first.
            let is_later = ["= stream", "= site", "\"street.csv\"", "\"square.jsonl\""]
                .iter()
                .any(|word| text.contains(word));
            if text.contains("= eth_biwi ") && data.is_none() || is_later {
                continue;
            }
            let beside = [format!("{pattern}/{stem}.bltl"), format!("properties/{stem}.bltl")];
            let own = beside.iter().find(|path| std::path::Path::new(path).exists());
            let properties = own.map_or(any.to_str().unwrap(), String::as_str);
            let mut words = vec!["check", &model, properties, "--forecast"];
            words.extend(data.iter().flat_map(|data| ["--data", data.to_str().unwrap()]));
            let said = at_root(&words);
            // What a property file lacks or says in vain is no matter of the scenario.
            let about =
                said.err.lines().filter(|line| line.starts_with("warning[") || line.starts_with("error["));
            let about: Vec<_> =
                about.filter(|line| !["W0501", "W0602"].iter().any(|code| line.contains(code))).collect();
            assert!(about.is_empty(), "{model}: {about:?}");
            count += 1;
        }
    }
    assert!(count > 40, "{count}");
}
