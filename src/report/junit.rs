//! `JUnit` XML: one suite per property file, one test case per result.
//!
//! A violated `check` is a failure. An undecided one is an error, so an undecided result never passes as green.
//! Other queries pass with their numbers as output.

use super::palette::Palette;
use super::phrase::{certified, one_line, settings};
use super::text;
use crate::engine::outcome::{CallResult, Finding, QueryResult, Verdict};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use std::time::Duration;

/// The report of a run, ending with a line end.
pub fn render(run: &CallResult) -> String {
    let mut report = Report::new(format!("smc {}", run.scenario));
    report.set_time(seconds(run.elapsed_s));
    for file in text::by_query(&run.results).chunk_by(|a, b| a.asked.file == b.asked.file) {
        let name = file.first().map_or("", |result| result.asked.file.as_str());
        let mut suite = TestSuite::new(if name.is_empty() { run.scenario.as_str() } else { name });
        suite.add_property(("seed", run.seed.to_string().as_str()));
        suite.add_property(("version", run.version.as_str()));
        // An attribute holds no line breaks: each command is one property.
        for command in run.replay.lines() {
            suite.add_property(("replay", command));
        }
        suite.set_time(seconds(file.iter().map(|result| result.elapsed_s).sum()));
        for result in file {
            suite.add_test_case(case(run, result));
        }
        report.add_test_suite(suite);
    }
    let errors: Vec<&Finding> = run.diagnostics.iter().filter(|finding| finding.error).collect();
    if !errors.is_empty() {
        report.add_test_suite(refused(&errors));
    } else if let Some(failure) = &run.failure {
        let kind = if failure.is_bug() { "bug" } else { "input" };
        report.add_test_suite(stopped("run", kind, &failure.message()));
    } else if run.interrupted {
        report.add_test_suite(stopped("run", "interrupted", "interrupted before all queries were complete"));
    }
    // Writing into memory fails only for what XML cannot hold, and the crate drops that from every string.
    let mut text = report.to_string().unwrap_or_default();
    if !text.ends_with('\n') {
        text.push('\n');
    }
    text
}

fn stopped(name: &str, kind: &str, message: &str) -> TestSuite {
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
    status.set_type(kind).set_message(message);
    let mut suite = TestSuite::new("smc");
    suite.add_test_case(TestCase::new(name, status));
    suite
}

/// A test case for each error of the front end.
fn refused(errors: &[&Finding]) -> TestSuite {
    let mut suite = TestSuite::new("smc");
    for finding in errors {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
        let hint = finding.hint.as_ref().map_or(String::new(), |hint| format!("\nhint: {hint}"));
        status.set_type(finding.code.as_str()).set_message(finding.message.as_str());
        status.set_description(format!("{}{hint}", finding.line()));
        suite.add_test_case(TestCase::new(finding.line(), status));
    }
    suite
}

fn case(run: &CallResult, result: &QueryResult) -> TestCase {
    let statement = match certified(result) {
        empty if empty.is_empty() => "nothing is certified".to_owned(),
        statement => statement,
    };
    let bad = |kind, word: &str| {
        let mut status = TestCaseStatus::non_success(kind);
        status.set_type(word).set_message(format!("{word}: {statement}"));
        status
    };
    let status = match result.verdict {
        Some(Verdict::Violated) => bad(NonSuccessKind::Failure, "violated"),
        Some(Verdict::Undecided) => bad(NonSuccessKind::Error, "undecided"),
        Some(Verdict::Satisfied) | None => TestCaseStatus::success(),
    };
    let mut name = one_line(&result.asked.text);
    let with = settings(result);
    if !with.is_empty() {
        name = format!("{name} where {with}");
    }
    let mut case = TestCase::new(name, status);
    case.set_classname(run.scenario.as_str());
    case.set_time(seconds(result.elapsed_s));
    case.set_system_out(text::block(result, Palette::PLAIN));
    case
}

/// A duration that cannot fail, whatever the number.
fn seconds(s: f64) -> Duration {
    Duration::try_from_secs_f64(s).unwrap_or_default()
}
