//! `JUnit` XML: one suite per property file, one test case per result.
//!
//! A violated `check` is a failure. An undecided one is an error, so an undecided result never passes as green.
//! Other queries pass with their numbers as output.

use super::palette::Palette;
use super::phrase::{certified, one_line, settings};
use super::text;
use crate::base::visible::visible;
use crate::engine::outcome::{CallResult, Finding, QueryResult, Verdict};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use std::io;

/// A test case that did not pass: the element that says so, the type and the message in it, and its text.
struct Fault {
    element: &'static str,
    kind: String,
    message: String,
    text: Option<String>,
}

/// A test case, and of a result: the scenario, the seconds and the text of the report.
struct Case<'a> {
    name: String,
    result: Option<(&'a str, String, String)>,
    fault: Option<Fault>,
}

/// The test cases of a file. Results have properties and a time.
struct Suite<'a> {
    name: &'a str,
    properties: Vec<(&'static str, &'a str)>,
    time: Option<String>,
    cases: Vec<Case<'a>>,
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
            cases: file.iter().map(|result| case(run, result)).collect(),
        });
    }
    let errors: Vec<&Finding> = run.diagnostics.iter().filter(|finding| finding.error).collect();
    if !errors.is_empty() {
        suites.push(stopped(errors.into_iter().map(refused).collect()));
    } else if let Some(failure) = &run.failure {
        let kind = if failure.is_bug() { "bug" } else { "input" };
        suites.push(stopped(vec![error("run".to_owned(), kind, failure.message(), None)]));
    } else if run.interrupted {
        let message = "interrupted before all queries were complete".to_owned();
        suites.push(stopped(vec![error("run".to_owned(), "interrupted", message, None)]));
    }
    // Writing into memory does not fail.
    let written = document(run, &suites).unwrap_or_default();
    String::from_utf8(written).unwrap_or_default()
}

fn stopped(cases: Vec<Case<'_>>) -> Suite<'_> {
    Suite { name: "smc", properties: Vec::new(), time: None, cases }
}

fn error<'a>(name: String, kind: &str, message: String, text: Option<String>) -> Case<'a> {
    Case { name, result: None, fault: Some(Fault { element: "error", kind: kind.to_owned(), message, text }) }
}

/// A test case for an error of the front end.
fn refused<'a>(finding: &Finding) -> Case<'a> {
    let hint = finding.hint.as_ref().map_or(String::new(), |hint| format!("\nhint: {hint}"));
    error(
        finding.line(),
        finding.code.as_str(),
        finding.message.clone(),
        Some(format!("{}{hint}", finding.line())),
    )
}

fn case<'a>(run: &'a CallResult, result: &QueryResult) -> Case<'a> {
    let statement = match certified(result) {
        empty if empty.is_empty() => "nothing is certified".to_owned(),
        statement => statement,
    };
    let bad = |element, word: &str| {
        Some(Fault { element, kind: word.to_owned(), message: format!("{word}: {statement}"), text: None })
    };
    let fault = match result.verdict {
        Some(Verdict::Violated) => bad("failure", "violated"),
        Some(Verdict::Undecided) => bad("error", "undecided"),
        Some(Verdict::Satisfied) | None => None,
    };
    let mut name = one_line(&result.asked.text);
    let with = settings(result);
    if !with.is_empty() {
        name = format!("{name} where {with}");
    }
    let output = text::block(result, Palette::PLAIN);
    Case { name, result: Some((run.scenario.as_str(), seconds(result.elapsed_s), output)), fault }
}

fn document(run: &CallResult, suites: &[Suite<'_>]) -> io::Result<Vec<u8>> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 4);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let count = |element: Option<&str>| -> String {
        let of = |suite: &Suite<'_>| suite.cases.iter().filter(|case| counts(case, element)).count();
        suites.iter().map(of).sum::<usize>().to_string()
    };
    let element = writer.create_element("testsuites").with_attributes([
        ("name", shown(&format!("smc {}", run.scenario)).as_str()),
        ("tests", &count(None)),
        ("skipped", "0"),
        ("failures", &count(Some("failure"))),
        ("errors", &count(Some("error"))),
        ("time", &seconds(run.elapsed_s)),
    ]);
    element.write_inner_content(|writer| suites.iter().try_for_each(|suite| write_suite(writer, suite)))?;
    writer.write_indent()?;
    Ok(writer.into_inner())
}

fn write_suite(writer: &mut Writer<Vec<u8>>, suite: &Suite<'_>) -> io::Result<()> {
    let count = |element| suite.cases.iter().filter(|case| counts(case, element)).count().to_string();
    let mut element = writer.create_element("testsuite").with_attributes([
        ("name", shown(suite.name).as_str()),
        ("tests", &count(None)),
        ("skipped", "0"),
        ("errors", &count(Some("error"))),
        ("failures", &count(Some("failure"))),
    ]);
    if let Some(time) = &suite.time {
        element = element.with_attribute(("time", time.as_str()));
    }
    element.write_inner_content(|writer| {
        if !suite.properties.is_empty() {
            writer.create_element("properties").write_inner_content(|writer| {
                suite.properties.iter().try_for_each(|(name, value)| {
                    let pair = [("name", *name), ("value", &shown(value))];
                    writer.create_element("property").with_attributes(pair).write_empty().map(drop)
                })
            })?;
        }
        suite.cases.iter().try_for_each(|case| write_case(writer, case))
    })?;
    Ok(())
}

fn write_case(writer: &mut Writer<Vec<u8>>, case: &Case<'_>) -> io::Result<()> {
    let mut element = writer.create_element("testcase").with_attribute(("name", shown(&case.name).as_str()));
    if let Some((scenario, time, _)) = &case.result {
        element = element.with_attributes([("classname", shown(scenario).as_str()), ("time", time)]);
    }
    element.write_inner_content(|writer| {
        if let Some(fault) = &case.fault {
            let attributes = [("message", shown(&fault.message)), ("type", fault.kind.clone())];
            let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
            let element = writer.create_element(fault.element).with_attributes(attributes);
            match &fault.text {
                Some(text) => element.write_text_content(BytesText::new(&shown(text)))?,
                None => element.write_empty()?,
            };
        }
        if let Some((.., output)) = &case.result {
            writer.create_element("system-out").write_text_content(BytesText::new(&shown(output)))?;
        }
        Ok(())
    })?;
    Ok(())
}

/// Whether a case counts among those with this element; all do without one.
fn counts(case: &Case<'_>, element: Option<&str>) -> bool {
    element.is_none_or(|element| case.fault.as_ref().is_some_and(|fault| fault.element == element))
}

/// A text without the characters that XML cannot hold.
fn shown(text: &str) -> String {
    visible(text).into_owned()
}

/// Seconds with three decimals.
fn seconds(s: f64) -> String {
    format!("{:.3}", s.max(0.0))
}
