//! The manual and `smc explain` against the tables of the program.

use smc::model::BuiltIn;
use smc::model::function::{FUNCTIONS, Rule};
use smc::stats::PROCEDURES;
use smc::stats::Spec;
use smc::stats::spec::{Kind, Serves};
use std::fs::read_to_string;
use std::path::Path;
use std::process::Command;

fn text(path: &str) -> String {
    read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

fn explained(name: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_smc")).args(["explain", name]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{name}");
    String::from_utf8(output.stdout).unwrap()
}

/// What stands in code spans that begin with `by`: name and arguments.
fn named(text: &str) -> Vec<(&str, Vec<&str>)> {
    let spans = text.split('`').skip(1).step_by(2).filter_map(|span| span.strip_prefix("by "));
    spans
        .map(|span| {
            let (name, rest) = span.split_once('(').unwrap_or((span, ")"));
            let inside = rest.split(')').next().unwrap_or_default();
            (name, inside.split(", ").filter(|argument| !matches!(*argument, "" | "…")).collect())
        })
        .collect()
}

#[test]
fn the_manual_has_the_procedures_of_the_table_with_their_arguments() {
    let manual = text("docs/statistics.md");
    let named = named(&manual);
    for (name, arguments) in &named {
        let known: Vec<_> =
            PROCEDURES.iter().filter(|spec| spec.name == *name).flat_map(|spec| spec.arguments).collect();
        assert!(PROCEDURES.iter().any(|spec| spec.name == *name), "`by {name}` is in no table");
        for argument in arguments {
            let argument = argument.split(" = ").next().unwrap();
            assert!(known.iter().any(|one| one.name == argument), "`{name}` has no `{argument}`");
        }
    }
    for spec in PROCEDURES {
        assert!(named.iter().any(|(name, _)| *name == spec.name), "`by {}` is not in the manual", spec.name);
    }
}

#[test]
fn defaults_in_the_manual_are_those_of_the_table() {
    let manual = text("docs/statistics.md");
    let splitting = Spec::find("splitting", Serves::Probability).unwrap();
    let mut values: Vec<f64> = Vec::new();
    for argument in splitting.arguments {
        let Kind::Number { default, .. } = argument.kind else {
            values.push(0.05);
            continue;
        };
        let value = default(&values);
        assert!(manual.contains(&format!("{} = {value}", argument.name)), "{} = {value}", argument.name);
        values.push(value);
    }
}

#[test]
fn procedures_are_explained_from_the_table() {
    for spec in PROCEDURES {
        let page = explained(spec.name);
        assert!(page.contains(&spec.signature()) && page.contains(spec.guarantee), "{page}");
        assert!(spec.arguments.iter().all(|one| page.contains(&format!("\n  {}", one.name))), "{page}");
    }
}

/// The names of functions in code spans of a cell: `` `radius(a)`, `mass(a)` ``.
fn called(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).filter_map(|span| span.split_once('(')).map(|(name, _)| name).collect()
}

#[test]
fn functions_in_the_manual_are_those_of_the_table_with_their_units() {
    let manual = text("docs/properties.md");
    let section = manual.split("\n## ").find(|section| section.starts_with("Functions\n")).unwrap();
    let mut units = 0;
    for line in section.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        // A table of two columns says the unit in words.
        if cells.len() < 3 {
            continue;
        }
        let (names, given) = (called(cells[0]), cells[1].replace('²', "^2").replace("1/", "/"));
        for (at, name) in names.iter().enumerate() {
            let function = BuiltIn::find(name).unwrap_or_else(|| panic!("`{name}` is in no table"));
            let unit = given.split(", ").nth(at).or_else(|| given.split(", ").next()).unwrap();
            if let Rule::Always(dimension) = function.dimension {
                assert_eq!(dimension.to_string(), unit, "{name}");
                units += 1;
            }
        }
    }
    assert!(units >= 12, "{units}");
    for function in FUNCTIONS {
        let page = explained(function.name);
        assert!(page.contains(function.name) && page.len() > function.name.len() + 20, "{page}");
    }
}

#[test]
fn the_manual_names_every_command_that_writes_a_page() {
    let manual = text("docs/report.md");
    let help = |words: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_smc")).args(words).arg("--help").output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let all = help(&[]);
    let listed = all.split_once("Options:\n").unwrap().0;
    let names = listed.lines().filter_map(|line| line.strip_prefix("  ")?.split_whitespace().next());
    let with_pages: Vec<&str> = names.filter(|name| help(&[name]).contains("--report <FILE.html>")).collect();
    assert!(with_pages.len() >= 4, "{with_pages:?}");
    for name in with_pages {
        let call = format!("smc {name} ");
        assert!(manual.lines().any(|line| line.starts_with(&call) && line.contains(" --report ")), "{name}");
    }
}
