//! Workflow commands of GitHub: one annotation per finding, at the line of the query.
//!
//! A violated `check` is an error, an undecided one and every warning is a warning; a notice sums up.
//! Values are escaped as the runner unescapes them: `%`, line ends, and in properties `:` and `,` too.

use super::phrase::{asked, certified, one_line};
use super::{exit_code, text};
use crate::engine::outcome::{CallResult, Failure, Finding, QueryResult, Verdict};
use std::fmt::Write as _;

/// The annotations of a run, one a line.
pub fn render(run: &CallResult) -> String {
    let mut page = String::new();
    for result in &run.results {
        let at = if result.asked.file.is_empty() || !is_file(&result.asked.file) {
            String::new()
        } else {
            format!("file={},line={},", property(&result.asked.file), result.asked.line)
        };
        let mut annotate = |level: &str, title: &str, message: &str| {
            let _ = writeln!(page, "::{level} {at}title={}::{}", property(title), data(message));
        };
        match result.verdict {
            Some(Verdict::Violated) => annotate("error", "violated", &finding(result)),
            Some(Verdict::Undecided) => annotate("warning", "undecided", &finding(result)),
            Some(Verdict::Satisfied) | None => {}
        }
        for warning in &result.warnings {
            annotate("warning", "smc", &format!("{}: {warning}", one_line(&result.asked.text)));
        }
    }
    for finding in &run.diagnostics {
        page.push_str(&annotation(finding));
    }
    for warning in &run.warnings {
        let _ = writeln!(page, "::warning title=smc::{}", data(warning));
    }
    match &run.failure {
        Some(Failure::Bug(message)) => {
            let _ = writeln!(page, "::error title=bug in smc::{}", data(message));
        }
        // Those of the front end are annotated one by one.
        Some(failure) if !run.diagnostics.iter().any(|finding| finding.error) => {
            let _ = writeln!(page, "::error title=smc::{}", data(&failure.message()));
        }
        _ => {}
    }
    let parts: Vec<String> = text::tally(run).into_iter().map(|(n, word, _)| format!("{n} {word}")).collect();
    let summary = format!(
        "{}: {}{}; exit code {}\n{}",
        run.scenario,
        if parts.is_empty() { "no results".to_owned() } else { parts.join(", ") },
        if run.interrupted { "; interrupted" } else { "" },
        exit_code(run).code(),
        run.replay
    );
    let _ = writeln!(page, "::notice title=smc::{}", data(&summary));
    page
}

/// Standard input and the words of the call are no files that an annotation could stand in.
fn is_file(name: &str) -> bool {
    !name.starts_with(['-', '<'])
}

/// An error or warning of the front end, at its place.
fn annotation(finding: &Finding) -> String {
    let level = if finding.error { "error" } else { "warning" };
    let at = finding.spot.as_ref().filter(|spot| is_file(&spot.file)).map_or(String::new(), |spot| {
        let (start, end) = (spot.start, spot.end);
        // The columns of a mark over several lines would be read as those of its first.
        let columns = if start.0 == end.0 {
            format!(",col={},endColumn={}", start.1, end.1)
        } else {
            format!(",endLine={},col={}", end.0, start.1)
        };
        format!("file={},line={}{columns},", property(&spot.file), start.0)
    });
    let mut message = match &finding.spot {
        Some(spot) if at.is_empty() => format!("{}: {}", spot.file, finding.message),
        _ => finding.message.clone(),
    };
    if !finding.label.is_empty() {
        let _ = write!(message, ": {}", finding.label);
    }
    if let Some(hint) = &finding.hint {
        let _ = write!(message, "\nhint: {hint}");
    }
    format!("::{level} {at}title={}::{}\n", property(&finding.code), data(&message))
}

fn finding(result: &QueryResult) -> String {
    let mut said = asked(result);
    let statement = certified(result);
    if !statement.is_empty() {
        let _ = write!(said, "\ncertified: {statement}");
    }
    let _ = write!(said, "\n{}", text::counts(result));
    for witness in &result.witnesses {
        let word = text::shown(witness.shows, result.of.is_some());
        let _ = write!(said, "\n{word} in trial {}: {}\n  {}", witness.trial, witness.what, witness.command);
    }
    said
}

fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_escaped() {
        assert_eq!(data("95 %\r\n::error"), "95 %25%0D%0A::error");
        assert_eq!(property("a:b,c%"), "a%3Ab%2Cc%25");
    }
}
