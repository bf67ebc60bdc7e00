//! Mistakes of people who come from other tools, and plain slips: the message about each names its place, its cause
//! and what to write. Each of the three is a point; what a file of `mistakes/` expects was written before the messages.
//!
//! A file holds cases: `==== name`, then a head, then sections. The head names the base (`base die`; the hall of
//! `refused/base.scn` without it), the place (`at file:line:column`), a phrase of the cause (looked for in the title
//! and beside marks) and a phrase of what to write (looked for in all that is said, the quoted source left out).
//! `---- model.scn` stands before the base, `---- only model.scn` alone.

use std::fmt::Write as _;
use std::process::Command;

#[derive(Default)]
struct Mistake<'t> {
    name: &'t str,
    base: &'t str,
    place: &'t str,
    cause: &'t str,
    remedy: &'t str,
    call: &'t str,
    scenario: String,
    properties: String,
}

fn mistakes(text: &str) -> Vec<Mistake<'_>> {
    text.split("==== ")
        .filter(|part| !part.trim().is_empty())
        .map(|part| {
            let (name, source) = part.split_once('\n').unwrap();
            let mut case = Mistake { name, base: include_str!("refused/base.scn"), ..Mistake::default() };
            let mut section = "";
            for line in source.lines() {
                if let Some(head) = line.strip_prefix("---- ") {
                    section = head;
                    if section == "only model.scn" {
                        case.base = "";
                    }
                    continue;
                }
                match section {
                    "" => {
                        let (key, value) = line.split_once(' ').unwrap();
                        match key {
                            "base" if value == "die" => case.base = include_str!("../models/die.scn"),
                            "base" if value == "queue" => case.base = include_str!("../models/queue.scn"),
                            "at" => case.place = value,
                            "cause" => case.cause = value,
                            "write" => case.remedy = value,
                            "call" => case.call = value,
                            _ => panic!("{name}: {line}"),
                        }
                    }
                    "prop.bltl" => case.properties.extend([line, "\n"]),
                    _ => case.scenario.extend([line, "\n"]),
                }
            }
            case
        })
        .collect()
}

/// What `smc` says about a mistake.
fn said(case: &Mistake<'_>) -> String {
    let directory = tempfile::tempdir().unwrap();
    let properties = if case.properties.is_empty() { NOTHING } else { &case.properties };
    std::fs::write(directory.path().join("model.scn"), format!("{}{}", case.scenario, case.base)).unwrap();
    std::fs::write(directory.path().join("prop.bltl"), properties).unwrap();
    let plain = "check model.scn prop.bltl --quiet --max-trials 2";
    let call = if case.call.is_empty() { plain } else { case.call };
    let output = Command::new(env!("CARGO_BIN_EXE_smc"))
        .args(call.split(' '))
        .current_dir(directory.path())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{}\n{said}", case.name);
    said
}

/// What a report says, in its order: title, places, what stands beside marks, hints; quoted lines are left out.
fn parts(said: &str) -> (String, String, String) {
    let (mut cause, mut places, mut remedy) = (String::new(), String::new(), String::new());
    for line in said.lines() {
        let mark = line.trim_start();
        let is_mark = mark
            .strip_prefix('|')
            .is_some_and(|rest| rest.trim_start_matches([' ', '|', '_']).starts_with(['^', '-']));
        if mark.starts_with("error") {
            cause.extend([mark, "\n"]);
        } else if let Some(place) = mark.strip_prefix("--> ") {
            places.extend([place, "\n"]);
        } else if is_mark {
            cause.extend([mark.trim_start_matches([' ', '|', '_', '^', '-']), "\n"]);
        } else if !mark.starts_with(|c: char| c.is_ascii_digit() || c == '|') {
            remedy.extend([mark, "\n"]);
        }
    }
    (cause, places, remedy)
}

/// Stands in the place of a property file that a case does not need.
const NOTHING: &str = "let unused = 1\n";

/// All files of mistakes.
const FILES: [&str; 7] = [
    include_str!("mistakes/logic.case"),
    include_str!("mistakes/newcomers.case"),
    include_str!("mistakes/prism.case"),
    include_str!("mistakes/python.case"),
    include_str!("mistakes/slips.case"),
    include_str!("mistakes/tools.case"),
    include_str!("mistakes/uppaal.case"),
];

/// The scenario and the property file of each mistake in files, for other ways to show errors.
pub(crate) fn every_mistake() -> Vec<(String, String)> {
    let cases = FILES.iter().flat_map(|text| mistakes(text)).filter(|case| case.call.is_empty());
    let properties = |case: &Mistake<'_>| {
        if case.properties.is_empty() { NOTHING.to_owned() } else { case.properties.clone() }
    };
    cases.map(|case| (format!("{}{}", case.scenario, case.base), properties(&case))).collect()
}

#[test]
fn a_message_names_place_cause_and_remedy() {
    let (mut points, mut count, mut poor) = (0_u32, 0_u32, String::new());
    for case in FILES.iter().flat_map(|text| mistakes(text)) {
        let said = said(&case);
        let errors = said.lines().filter(|line| line.starts_with("error")).count();
        assert_eq!(errors, 1, "{}\n{said}", case.name);
        let (cause, places, remedy) = parts(&said);
        let is_placed = places.lines().next() == Some(case.place) || cause.contains(case.place);
        let scored =
            [is_placed, cause.contains(case.cause), format!("{cause}{remedy}").contains(case.remedy)];
        let score = scored.into_iter().map(u32::from).sum::<u32>();
        if score < 3 {
            let _ = write!(poor, "==== {} {scored:?}\n{said}", case.name);
        }
        points += score;
        count += 1;
    }
    println!("{points} points for {count} mistakes\n{poor}");
    assert!(count >= 80, "{count} mistakes");
    assert!(f64::from(points) >= 2.8 * f64::from(count), "{points} points for {count} mistakes\n{poor}");
}
