//! Forecasts: told before sampling, near what happens, without a trace in results.

use crate::program::{Place, SMALL};
use serde_json::Value;
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;

const FILES: [&str; 4] =
    ["models/die.scn", "properties/die.bltl", "models/leader.scn", "properties/leader.bltl"];

fn place() -> Place {
    let place = Place::new(&[]);
    for file in FILES {
        let name = file.rsplit('/').next().unwrap();
        place.write(name, &std::fs::read(format!("{}/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap());
    }
    place
}

fn trials(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|q| q["trials"].as_f64().unwrap()).collect()
}

/// Of how many queries of a model the number of trials lay in the range that was forecast, and of how many not.
fn foretold(place: &Place, name: &str, seed: u32, words: &[&str]) -> Vec<String> {
    let (model, properties, seed) = (format!("{name}.scn"), format!("{name}.bltl"), seed.to_string());
    let call = ["check", &model, &properties, "--format", "json", "-q", "--seed", &seed];
    let call = [&call[..], words].concat();
    let told = place.call(&[&call[..], &["--forecast"]].concat());
    assert_eq!(told.code, Some(0), "{}", told.err);
    let told = told.json()["forecast"].as_array().unwrap().clone();
    let ran = place.call(&call).json()["results"].as_array().unwrap().clone();
    let paths = |result: &Value| result["splitting"]["paths"].as_f64().unwrap_or(0.0);
    let mut lines = Vec::new();
    for told in &told {
        // Results are in the order of the queries, forecasts in that of the groups that answer them.
        let same = |one: &&Value| one["query"] == told["query"] && one["settings"] == told["settings"];
        let ran = ran.iter().find(same).unwrap();
        let number = ran["trials"].as_f64().unwrap() + paths(ran);
        let (least, most) = (told["least"].as_f64().unwrap(), told["most"].as_f64().unwrap());
        let word = if (least..=most).contains(&number) { "inside" } else { "outside" };
        lines.push(format!("{word} {name} {seed}: {least} .. {most}, {number}: {}", told["query"]));
    }
    lines
}

fn mostly_inside(lines: &[String]) {
    let inside = lines.iter().filter(|line| line.starts_with("inside")).count();
    assert!(10 * inside >= 9 * lines.len(), "{inside} of {}:\n{}", lines.len(), lines.join("\n"));
}

#[test]
fn nine_of_ten_forecasts_hold() {
    let place = place();
    let seeds = (0..3).flat_map(|seed| ["die", "leader"].map(|name| (name, seed)));
    let lines: Vec<String> = seeds.flat_map(|(name, seed)| foretold(&place, name, seed, &[])).collect();
    mostly_inside(&lines);
}

#[test]
#[ignore = "takes all models at twenty seeds"]
fn nine_of_ten_forecasts_of_all_models_hold() {
    let place = Place::new(&[]);
    let mut names = Vec::new();
    for folder in ["models", "properties"] {
        for file in std::fs::read_dir(format!("{}/{folder}", env!("CARGO_MANIFEST_DIR"))).unwrap() {
            let path = file.unwrap().path();
            place.write(path.file_name().unwrap().to_str().unwrap(), &std::fs::read(&path).unwrap());
            names.extend(
                path.file_stem().filter(|_| folder == "models").map(|s| s.to_str().unwrap().to_owned()),
            );
        }
    }
    names.sort();
    // The hotel needs recordings.
    names.retain(|name| name != "hotel");
    let seeds = (0..20).flat_map(|seed| names.iter().map(move |name| (name, seed)));
    let lines: Vec<String> =
        seeds.flat_map(|(name, seed)| foretold(&place, name, seed, &["--max-trials", "20000"])).collect();
    mostly_inside(&lines);
}

#[test]
fn planned_numbers_are_told_exactly() {
    let place = Place::new(&[("a.scn", SMALL)]);
    let queries = "property near = F<=3 s (min(distance(user, a) for a in crowd) < 2 m)\n\
        estimate P(near) by okamoto(epsilon = 0.05, delta = 0.05)\n\
        estimate Q(0.5, max<=1 s (speed(user)))\n";
    place.write("a.bltl", queries.as_bytes());
    let said = place.call(&["check", "a.scn", "a.bltl", "--forecast", "--format", "json"]);
    assert_eq!(trials(&said.json()["forecast"]), [740.0, 1000.0]);
    let schema = serde_json::from_str(include_str!("../../docs/schema/forecast.schema.json")).unwrap();
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&said.json()), "{}", said.out);
    let text = place.call(&["check", "a.scn", "a.bltl", "--forecast"]).out;
    assert!(text.starts_with("forecast: about 740 trials, "), "{text}");
    assert!(text.lines().count() == 3 && text.lines().last().unwrap().contains(" in total;"), "{text}");
}

#[test]
fn a_pilot_leaves_no_trace() {
    let place = place();
    let results = |words: &[&str]| {
        let call = ["check", "leader.scn", "leader.bltl", "--format", "json", "-q"];
        let mut json = place.call(&[&call[..], words].concat()).json();
        for result in json["results"].as_array_mut().unwrap() {
            result.as_object_mut().unwrap().remove("elapsed_s");
        }
        json["results"].to_string()
    };
    // With a deadline there is no pilot.
    assert_eq!(results(&[]), results(&["--timeout", "10min"]));
    assert_eq!(results(&["--max-trials", "3"]), results(&["--max-trials", "3", "--timeout", "10min"]));
}

#[test]
fn a_forecast_is_no_result_of_a_test() {
    for format in ["junit", "github"] {
        let said = place().call(&["check", "die.scn", "die.bltl", "-q", "--forecast", "--format", format]);
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(
            said.err.starts_with("error[E0705]") && said.out.contains("E0705"),
            "{} {}",
            said.err,
            said.out
        );
    }
}

#[test]
fn a_long_call_begins_with_its_forecast() {
    let place = Place::new(&[("a.scn", SMALL)]);
    place.write("a.bltl", b"estimate P(F<=3 s (speed(user) > 1.2 m/s)) within 0.0002 confidence 99 %\n");
    let mut command = place.command(&["check", "a.scn", "a.bltl"]);
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(line.starts_with("forecast: about ") && line.contains(" trials, about "), "{line}");
}
