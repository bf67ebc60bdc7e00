//! `JUnit` XML: one suite per property file, one test case per result.
//!
//! A violated `check` is a failure. An undecided one is an error, so an undecided result never passes as green.
//! Other queries pass with their numbers as output.

use super::palette::Palette;
use super::phrase::{asked, certified};
use super::text;
use crate::base::visible::visible;
use crate::engine::outcome::{CallResult, Finding, QueryResult, Verdict};
use askama::Template;

/// A test case that did not pass: the element that says so, the type and the message in it, and its text.
struct Fault {
    element: &'static str,
    kind: String,
    message: String,
    text: String,
}

/// A test case, and of a result: the seconds and the text of the report.
struct Case {
    name: String,
    result: Option<(String, String)>,
    fault: Option<Fault>,
}

/// The test cases of a file. Results have properties and a time.
struct Suite<'a> {
    name: &'a str,
    properties: Vec<(&'static str, &'a str)>,
    time: Option<String>,
    cases: Vec<Case>,
}

#[derive(Template)]
#[template(path = "junit.xml")]
struct Document<'a> {
    scenario: &'a str,
    time: String,
    suites: Vec<Suite<'a>>,
}

impl Suite<'_> {
    /// The number of cases with an element; of all without one.
    fn count(&self, element: &str) -> usize {
        let is_counted = |case: &&Case| {
            element.is_empty() || case.fault.as_ref().is_some_and(|fault| fault.element == element)
        };
        self.cases.iter().filter(is_counted).count()
    }
}

impl Document<'_> {
    fn count(&self, element: &str) -> usize {
        self.suites.iter().map(|suite| suite.count(element)).sum()
    }
}

/// The report of a run, ending with a line end.
pub fn render(run: &CallResult) -> String {
    let seed = run.seed.to_string();
    let mut suites: Vec<Suite<'_>> = Vec::new();
    for file in text::by_query(&run.results).chunk_by(|a, b| a.asked.file == b.asked.file) {
        let name = file.first().map_or("", |result| result.asked.file.as_str());
        let mut properties = vec![("seed", seed.as_str()), ("version", run.version.as_str())];
        // An attribute holds no line breaks: each command is one property.
        properties.extend(run.replay.lines().map(|command| ("replay", command)));
        suites.push(Suite {
            name: if name.is_empty() { run.scenario.as_str() } else { name },
            properties,
            time: Some(seconds(file.iter().map(|result| result.elapsed_s).sum())),
            cases: file.iter().map(|result| case(result)).collect(),
        });
    }
    let errors: Vec<&Finding> = run.diagnostics.iter().filter(|finding| finding.error).collect();
    let failed = |kind: &str, message: String| vec![error("run".to_owned(), kind, message, String::new())];
    let stopped = if !errors.is_empty() {
        errors.into_iter().map(refused).collect()
    } else if let Some(failure) = &run.failure {
        failed(if failure.is_bug() { "bug" } else { "input" }, failure.message())
    } else if run.interrupted {
        failed("interrupted", "interrupted before all queries were complete".to_owned())
    } else {
        Vec::new()
    };
    if !stopped.is_empty() {
        suites.push(Suite { name: "smc", properties: Vec::new(), time: None, cases: stopped });
    }
    let document = Document { scenario: &run.scenario, time: seconds(run.elapsed_s), suites };
    // Writing into memory does not fail. XML cannot hold all characters.
    visible(&document.render().unwrap_or_default()).into_owned() + "\n"
}

fn error(name: String, kind: &str, message: String, text: String) -> Case {
    Case { name, result: None, fault: Some(Fault { element: "error", kind: kind.to_owned(), message, text }) }
}

/// A test case for an error of the front end.
fn refused(finding: &Finding) -> Case {
    let hint = finding.hint.as_ref().map_or(String::new(), |hint| format!("\nhint: {hint}"));
    let text = format!("{}{hint}", finding.line());
    error(finding.line(), finding.code.as_str(), finding.message.clone(), text)
}

fn case(result: &QueryResult) -> Case {
    let statement = match certified(result) {
        empty if empty.is_empty() => "nothing is certified".to_owned(),
        statement => statement,
    };
    let bad = |element, word: &str| {
        let message = format!("{word}: {statement}");
        Some(Fault { element, kind: word.to_owned(), message, text: String::new() })
    };
    let fault = match result.verdict {
        Some(Verdict::Violated) => bad("failure", "violated"),
        Some(Verdict::Undecided) => bad("error", "undecided"),
        Some(Verdict::Satisfied) | None => None,
    };
    let text = text::block(result, Palette::PLAIN);
    Case { name: asked(result), result: Some((seconds(result.elapsed_s), text)), fault }
}

/// Seconds with three decimals.
fn seconds(s: f64) -> String {
    format!("{:.3}", s.max(0.0))
}
