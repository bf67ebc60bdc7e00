//! Planted errors of meaning: the code, place, title and hint of each error, and that nothing else is said.
//!
//! A file of `refused/` holds cases: `==== name`, then sections. The text of `model.scn` stands before `base.scn`, so that
//! lines count from the planted text; `only model.scn` stands alone; `call` adds words to the command line. The library
//! examines each case, and some are shown whole. The program shows the first of each file, and those of which only the
//! engine finds what is wrong.

use smc::library::{Folder, Names, load, survey};
use smc::route::Ways;
use smc::syntax::diagnostic::{Diagnostic, Severity};
use smc::syntax::render::render;
use smc::syntax::source::Source;
use std::fmt::Write as _;
use std::process::{Command, Output};

/// Cases of a file that are shown whole.
const WHOLE: usize = 4;

#[derive(Default)]
struct Case<'t> {
    name: &'t str,
    scenario: String,
    alone: bool,
    properties: String,
    call: Vec<String>,
}

impl Case<'_> {
    /// The scenario and the properties, with the base.
    fn texts(&self, base: &str) -> [String; 2] {
        let scenario = if self.alone { self.scenario.clone() } else { format!("{}{base}", self.scenario) };
        let fine = "let unused = 1\n";
        let properties = if self.properties.is_empty() { fine } else { &self.properties };
        [scenario, properties.to_owned()]
    }
}

fn cases(text: &str) -> Vec<Case<'_>> {
    text.split("==== ")
        .filter(|part| !part.trim().is_empty())
        .map(|part| {
            let (name, source) = part.split_once('\n').unwrap();
            let mut case = Case { name, ..Case::default() };
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

/// What the program does with a case.
fn check(case: &Case<'_>, base: &str) -> Output {
    let directory = tempfile::tempdir().unwrap();
    let [scenario, properties] = case.texts(base);
    std::fs::write(directory.path().join("model.scn"), scenario).unwrap();
    std::fs::write(directory.path().join("prop.bltl"), properties).unwrap();
    Command::new(env!("CARGO_BIN_EXE_smc"))
        .args(["check", "model.scn", "prop.bltl", "--quiet", "--max-trials", "2"])
        .args(&case.call)
        .current_dir(directory.path())
        .output()
        .unwrap()
}

/// The texts of a case; no other file is there.
struct Texts([String; 2]);

impl Folder for Texts {
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let [scenario, properties] = &self.0;
        Ok(if name == "model.scn" { scenario } else { properties }.as_bytes().to_vec())
    }

    fn file(&mut self, _: &str) -> Result<Vec<u8>, String> {
        Err("there is no such file".to_owned())
    }
}

/// What the library says about a case, with the texts.
fn examine(case: &Case<'_>, base: &str) -> (Vec<Diagnostic>, Vec<Source>) {
    let settings: Vec<String> = case.call.iter().filter(|word| *word != "--set").cloned().collect();
    let properties = ["prop.bltl".to_owned()];
    let names = Names {
        scenario: "model.scn",
        properties: &properties,
        settings: &settings,
        setting: "--set",
        velocity: None,
        models: &[],
        calibration: None,
    };
    let mut inputs = load(names, &mut Texts(case.texts(base)));
    if let Some(study) = &mut inputs.study {
        inputs.diagnostics.extend(survey(study, &[], 0, &Ways::default()));
    }
    (inputs.diagnostics, inputs.sources)
}

/// An error in one line.
fn line(one: &Diagnostic, sources: &[Source]) -> String {
    let place = one.place.as_ref().map_or(String::new(), |place| {
        let source = &sources[usize::from(place.span.source.0)];
        let (line, column) = source.line_column(place.span.start);
        format!(" {}:{line}:{column}", source.name)
    });
    let hint = one.hint.as_ref().map_or(String::new(), |hint| format!(" | {hint}"));
    format!("{}{place} {}{hint}\n", one.code, one.title).replace("\n ", " ")
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
            let (mut table, mut whole) = (String::new(), String::new());
            for (place, case) in cases(&text).iter().enumerate() {
                let (found, sources) = examine(case, base);
                let _ = writeln!(table, "== {}", case.name);
                for one in &found {
                    assert_eq!(one.severity, Severity::Error, "{}\n{}", case.name, one.title);
                    table += &line(one, &sources);
                }
                let mut said = render(&found, &sources, false);
                // The engine finds what no text shows.
                if place == 0 || found.is_empty() {
                    let output = check(case, base);
                    assert_eq!(output.status.code(), Some(2), "{}", case.name);
                    assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{}", case.name);
                    let shown = String::from_utf8(output.stderr).unwrap();
                    assert!(shown.starts_with("error[E"), "{}\n{shown}", case.name);
                    assert!(!shown.contains("warning"), "{}\n{shown}", case.name);
                    assert!(found.is_empty() || shown.trim_end() == said.trim_end(), "{}\n{shown}", case.name);
                    said = shown;
                }
                if place < WHOLE || found.is_empty() {
                    let _ = writeln!(whole, "== {}\n{said}", case.name);
                }
                count += 1;
            }
            insta::assert_snapshot!("refusals", format!("{table}\n{whole}"));
        });
    });
    assert!(count > 100, "{count} cases");
}
