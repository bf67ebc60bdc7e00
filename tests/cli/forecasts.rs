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

#[test]
fn a_forecast_is_of_the_right_size() {
    let place = place();
    for name in ["die", "leader"] {
        let (model, properties) = (format!("{name}.scn"), format!("{name}.bltl"));
        let call = ["check", &model, &properties, "--format", "json", "-q"];
        let forecast = place.call(&[&call[..], &["--forecast"]].concat());
        assert_eq!(forecast.code, Some(0));
        let told = trials(&forecast.json()["forecast"]);
        let ran = trials(&place.call(&call).json()["results"]);
        assert_eq!(told.len(), ran.len());
        // From 8 to 16 trials a share is known to a tenth or two: that is what a forecast can be off by.
        for (told, ran) in told.iter().zip(&ran) {
            assert!(*told < 40.0 * ran && *ran < 40.0 * told, "{name}: {told} forecast, {ran} consumed");
        }
        let near = told.iter().zip(&ran).filter(|(told, ran)| **told < 4.0 * **ran && **ran < 4.0 * **told);
        assert!(2 * near.count() > told.len(), "{name}: {told:?} forecast, {ran:?} consumed");
    }
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
    assert!(text.lines().count() == 3 && text.lines().last().unwrap().contains(" in all;"), "{text}");
}

#[test]
fn a_rehearsal_leaves_no_trace() {
    let place = place();
    let results = |words: &[&str]| {
        let call = ["check", "leader.scn", "leader.bltl", "--format", "json", "-q"];
        let mut json = place.call(&[&call[..], words].concat()).json();
        for result in json["results"].as_array_mut().unwrap() {
            result.as_object_mut().unwrap().remove("elapsed_s");
        }
        json["results"].to_string()
    };
    // With a deadline there is no rehearsal.
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
