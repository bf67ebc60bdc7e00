//! What a check has found.

use super::diagnostics::Diagnostics;
use crate::engine::outcome::{CallResult, QueryResult, Verdict};
use crate::report::{ExitCode, Format, Palette, exit_code, render};
use serde::{Serialize, Serializer};
use std::fmt;

/// The results of a check.
#[derive(Clone, Debug)]
pub struct Report {
    run: CallResult,
    warnings: Diagnostics,
}

impl fmt::Display for Report {
    /// As `smc check` prints it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.run.fmt(f)
    }
}

impl Serialize for Report {
    /// As `--format json` writes it.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.run.serialize(serializer)
    }
}

impl Report {
    pub(super) fn new(run: CallResult, warnings: Diagnostics) -> Self {
        Self { run, warnings }
    }

    /// The results in the order of the queries; a swept query has one for each point.
    pub fn results(&self) -> &[QueryResult] {
        &self.run.results
    }

    /// Whether every `check` is satisfied and every other query got what it asks.
    pub fn is_satisfied(&self) -> bool {
        exit_code(&self.run) == ExitCode::Success
    }

    /// The verdict of all checks together: violated before undecided before satisfied; `None` without a check.
    pub fn verdict(&self) -> Option<Verdict> {
        let verdicts = self.run.results.iter().filter_map(|result| result.verdict);
        verdicts.max_by_key(|verdict| match verdict {
            Verdict::Satisfied => 0,
            Verdict::Undecided => 1,
            Verdict::Violated => 2,
        })
    }

    /// Warnings about the texts.
    pub fn warnings(&self) -> &Diagnostics {
        &self.warnings
    }

    /// Everything that the run has computed, with what ended it early.
    pub fn run(&self) -> &CallResult {
        &self.run
    }

    /// The report in one of the formats of the command line.
    pub fn render(&self, format: Format) -> String {
        render(&self.run, format, Palette::PLAIN)
    }
}
