//! JSON by its schema, `JUnit`, annotations of GitHub, the page of charts.

use crate::program::{Place, SMALL, at_root, recordings};
use std::path::Path;

pub(crate) fn validated(json: &serde_json::Value) {
    let schema = include_str!("../../docs/schema/verdict.schema.json");
    let schema = serde_json::from_str(schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> =
        validator.iter_errors(json).map(|e| format!("{e} at {}", e.instance_path)).collect();
    assert!(errors.is_empty(), "{}\n{json:#}", errors.join("\n"));
}

#[test]
fn the_json_of_every_model_keeps_the_schema() {
    let mut seen = 0;
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("models")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "scn") {
            continue;
        }
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let (model, properties) = (format!("models/{stem}.scn"), format!("properties/{stem}.bltl"));
        let mut words = vec!["check", &model, &properties, "-q", "--format", "json", "--max-trials", "20"];
        let data;
        if std::fs::read_to_string(&path).unwrap().contains("tracks ") {
            let Some(found) = recordings() else { continue };
            data = found;
            words.extend(["--data", data.to_str().unwrap()]);
        }
        let said = at_root(&words);
        assert!(matches!(said.code, Some(0 | 1 | 3 | 4)), "{stem}\n{}", said.err);
        let json = said.json();
        assert!(!json["results"].as_array().unwrap().is_empty());
        validated(&json);
        seen += 1;
    }
    assert!(seen > 0);
}

#[test]
fn a_sweep_and_unresolved_trials_keep_the_schema() {
    let place = Place::new(&[
        ("a.scn", SMALL),
        (
            "a.bltl",
            "check P(F<=1 s (mean(speed(a) for a in crowd) > 0.1 m/s)) >= 0.5\nestimate Q(0.5, time_until(contact(user)))\n",
        ),
    ]);
    let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "30"];
    let json = place.call(&[&words[..], &["--set", "density=0..0.4 by 0.2"]].concat()).json();
    assert_eq!(json["results"].as_array().unwrap().len(), 6);
    validated(&json);
}

#[test]
fn formats_for_machines_and_people() {
    let place = Place::new(&[
        ("a.scn", SMALL),
        (
            "a.bltl",
            "property p = F<=1 s contact(user)\ncheck P(p) >= 0.9\nestimate P(p) by fixed(trials = 9)\n",
        ),
    ]);
    let call = |format: &str| place.call(&["check", "a.scn", "a.bltl", "-q", "--format", format]);
    let junit = call("junit");
    assert_eq!(junit.code, Some(1));
    assert!(junit.out.starts_with("<?xml") && junit.out.contains("<failure"), "{}", junit.out);
    assert!(junit.out.contains("tests=\""));
    let github = call("github");
    assert!(github.out.contains("::error file=a.bltl,line=2"), "{}", github.out);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--report", "r.html"]);
    let page = std::fs::read_to_string(place.path("r.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") || page.starts_with("<!doctype html>"));
    assert!(!page.contains("http://") && !page.contains("src=\"https"), "the page stands alone");
    assert!(!said.out.contains('\u{1b}'), "no colours in a pipe");
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--color", "always"]);
    assert!(said.out.contains('\u{1b}'));
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--report", "none/r.html"]);
    assert_eq!(said.code, Some(2), "a report that cannot be written is an error");
    assert!(said.out.contains("violated"), "the results are printed all the same");
}

#[test]
fn several_formats_in_one_call() {
    let place = Place::new(&[
        ("a.scn", SMALL),
        ("a.bltl", "estimate P(F<=1 s contact(user)) by fixed(trials = 9)\n"),
    ]);
    let call = |words: &[&str]| {
        place.call(&[&["check", "a.scn", "a.bltl", "-q", "--set", "density=0..0.4 by 0.2"], words].concat())
    };
    let said = call(&["--format", "json=a.json", "--format", "csv=a.csv", "--brief"]);
    assert_eq!((said.code, said.out.lines().count()), (Some(0), 3), "{}{}", said.out, said.err);
    let file = |name: &str| std::fs::read_to_string(place.path(name)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&file("a.json")).unwrap();
    validated(&json);
    // Each number of the table is that of the object.
    let mut table = csv::Reader::from_reader(std::io::Cursor::new(file("a.csv")));
    let heads = table.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 3);
    for (row, result) in rows.iter().zip(json["results"].as_array().unwrap()) {
        for name in ["estimate", "low", "high", "trials", "successes"] {
            assert_eq!(row[column(name)].parse::<f64>().unwrap(), result[name].as_f64().unwrap(), "{name}");
        }
        let density = &result["settings"]["density"]["value"];
        assert_eq!(row[column("density (/m^2)")].parse::<f64>().unwrap(), density.as_f64().unwrap());
    }
    // Text is what people get beside a file.
    assert!(call(&["--format", "csv=a.csv"]).out.contains("replay:"));
    for (words, reason) in [
        (["--format", "json", "--format", "csv"], "two formats are for standard output"),
        (["--format", "json", "--format", "brief"], "two formats are for standard output"),
        (["--format", "json=a", "--format", "csv=a"], "two results are to be written to `a`"),
        (["--format", "csv=a", "--report", "a"], "two results are to be written to `a`"),
        (["--format", "csv=a.scn", "--format", "json"], "would overwrite the input `a.scn`"),
        (["--format", "csv=", "--format", "json"], "the name of the file is missing"),
        (
            ["--format", "xml", "--format", "json"],
            "the formats are text, verbose, brief, csv, json, junit, github",
        ),
        (["--format", "csv=none/a", "--format", "json"], "`none/a` cannot be written"),
    ] {
        let said = call(&words);
        assert!(said.code == Some(2) && said.err.contains(reason), "{words:?}: {}", said.err);
    }
}

#[test]
fn no_two_columns_of_a_table_have_one_name() {
    let place = Place::new(&[
        ("a.scn", &format!("{SMALL}\nparam steps = 2 in 1 .. 3\nparam delta = 2 in 1 .. 3\n")),
        ("a.bltl", "estimate Q(0.5, time_until(contact(user))) by fixed(trials = 4)\n"),
    ]);
    let words =
        ["check", "a.scn", "a.bltl", "-q", "--format", "csv", "--set", "steps=1,2", "--set", "delta=1,2"];
    let said = place.call(&words);
    let header: Vec<&str> = said.out.lines().next().unwrap().split(',').collect();
    let names: std::collections::BTreeSet<&str> = header.iter().copied().collect();
    assert_eq!(names.len(), header.len(), "{header:?}");
    for name in ["trials", "method trials", "steps", "set steps", "delta", "set delta"] {
        assert!(names.contains(name), "{name}: {header:?}");
    }
    assert!(said.out.lines().skip(1).all(|row| row.split(',').count() >= header.len()), "{}", said.out);
}

#[test]
fn times_are_not_below_zero_and_figures_have_a_name() {
    let place = Place::new(&[
        ("a.scn", SMALL),
        (
            "a.bltl",
            "estimate Q(0.1, 0.5, time_until(contact(user))) by fixed(trials = 4)\n\
             estimate Q(0.5, time_until(contact(user)) - 1 s) by fixed(trials = 4)\n\
             estimate Q(0.5, 2 * max<=1 s time_to_collision(user, crowd[1])) by fixed(trials = 4)\n\
             check Q(0.9, time_until(contact(user))) >= 0.5 s\n",
        ),
    ]);
    let words = ["check", "a.scn", "a.bltl", "-q"];
    let json = place.call(&[&words[..], &["--format", "json"]].concat()).json();
    let results = json["results"].as_array().unwrap();
    let low = |k: usize| results[k]["low"].as_f64();
    assert_eq!([low(0), low(1), low(3)], [Some(0.0), Some(0.0), Some(0.0)], "{json:#}");
    assert_eq!(low(2), None, "a difference of times may be negative");
    for result in &results[..2] {
        assert_eq!(result["distribution"]["quantiles"][0]["low"], 0.0, "{result}");
        // That a time is not below 0 is no finding.
        assert_eq!(result["certifies"], "", "{result}");
    }
    let brief = place.call(&[&words[..], &["--brief"]].concat()).out;
    assert!(brief.contains("  P(time_until(contact(user)) < 0.5 s): "), "{brief}");
}
