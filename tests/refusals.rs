//! Planted errors of meaning: what `smc check` says about each, at which place, and that it says no more.
//!
//! A file of `refused/` holds cases: `==== name`, then sections. What is planted in `model.scn` stands before
//! `base.scn`, so that lines count from the planted text; `only model.scn` stands alone; `call` adds words to
//! the command line.

use std::fmt::Write as _;
use std::process::{Command, Output};

#[derive(Default)]
struct Case<'t> {
    name: &'t str,
    source: &'t str,
    scenario: String,
    alone: bool,
    properties: String,
    call: Vec<String>,
}

fn cases(text: &str) -> Vec<Case<'_>> {
    text.split("==== ")
        .filter(|part| !part.trim().is_empty())
        .map(|part| {
            let (name, source) = part.split_once('\n').unwrap();
            let mut case = Case { name, source, ..Case::default() };
            let mut section = "";
            for line in source.lines() {
                if let Some(head) = line.strip_prefix("---- ") {
                    section = head;
                    case.alone |= head == "only model.scn";
                    if let Some(call) = head.strip_prefix("call ") {
                        case.call = call.split(' ').map(|word| word.replace('~', " ")).collect();
                    }
                    continue;
                }
                let target = match section {
                    "model.scn" | "only model.scn" => &mut case.scenario,
                    "prop.bltl" => &mut case.properties,
                    _ => panic!("a line outside a section: {line}"),
                };
                target.push_str(line);
                target.push('\n');
            }
            case
        })
        .collect()
}

fn check(case: &Case<'_>, base: &str) -> Output {
    let directory = tempfile::tempdir().unwrap();
    let scenario = if case.alone { case.scenario.clone() } else { format!("{}{base}", case.scenario) };
    let fine = "let unused = 1\n";
    let properties = if case.properties.is_empty() { fine } else { &case.properties };
    std::fs::write(directory.path().join("model.scn"), scenario).unwrap();
    std::fs::write(directory.path().join("prop.bltl"), properties).unwrap();
    Command::new(env!("CARGO_BIN_EXE_smc"))
        .args(["check", "model.scn", "prop.bltl", "--quiet", "--max-trials", "2"])
        .args(&case.call)
        .current_dir(directory.path())
        .output()
        .unwrap()
}

#[test]
fn the_base_alone_is_accepted() {
    let base = include_str!("refused/base.scn");
    let properties = "check P(F<=1 s contact(user)) >= 0.5\n".to_owned();
    let output = check(&Case { properties, ..Case::default() }, base);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_ne!(output.status.code(), Some(2));
}

#[test]
fn planted_errors_are_refused_where_they_are() {
    let base = include_str!("refused/base.scn");
    let mut count = 0;
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::glob!("refused/*.case", |path| {
            let text = std::fs::read_to_string(path).unwrap();
            let mut shown = String::new();
            for case in cases(&text) {
                let output = check(&case, base);
                let said = String::from_utf8(output.stderr).unwrap();
                assert_eq!(output.status.code(), Some(2), "{}\n{said}", case.name);
                assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{}", case.name);
                assert!(said.starts_with("error[E"), "{}\n{said}", case.name);
                assert!(!said.contains("warning"), "{}\n{said}", case.name);
                let _ = write!(shown, "==== {}\n{}\n{said}", case.name, case.source);
                count += 1;
            }
            insta::assert_snapshot!("refusals", shown);
        });
    });
    assert!(count > 100, "{count} cases");
}
