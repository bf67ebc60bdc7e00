//! `smc gait fit` and `smc gait score`.

use super::arguments::{FitCommand, Learning, Reading, ScoreCommand};
use super::takes::Takes;
use super::{Stop, open, told};
use crate::base::visible::visible;
use crate::cli::terminal::{Colors, print};
use crate::cli::values::TextFormat;
use crate::cli::{complaint, output};
use crate::gait::RecordedStep;
use crate::gait::model::{self, FitError, Method, Options, Scores, Warning};
use crate::report::gait as reports;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::collections::BTreeSet;
use std::path::Path;

impl Learning {
    fn options(&self) -> Options {
        let method = match (self.exact, self.linear) {
            (true, _) => Method::Exact,
            (_, true) => Method::Linear,
            _ => Method::Sparse,
        };
        Options {
            variance: self.variance,
            residuals: self.residuals,
            method,
            inducing: self.sparse,
            as_published: self.as_published,
            ..Options::default()
        }
    }
}

fn unfitted(error: &FitError) -> Diagnostic {
    let hint = match error {
        FitError::Variance(_) => return complaint::argument(error.to_string(), "write `--variance 0.95`"),
        FitError::Inducing(_) => return complaint::argument(error.to_string(), "write `--sparse 128`"),
        FitError::TooFewPairs { .. } | FitError::OneSided { .. } => {
            "add takes; a pair is two steps of one take, one after the other"
        }
        FitError::NotFinite { .. } => "remove the take",
        FitError::NoVariation(_) | FitError::Singular(_) => "add takes of other walks",
    };
    Diagnostic::placeless(Code::E0722, error.to_string()).hint(hint)
}

fn warn(warnings: &[Warning], colors: Colors) {
    let one = |warning: &Warning| {
        let found = Diagnostic::placeless(Code::W0721, warning.to_string());
        Diagnostic { severity: Severity::Warning, ..found }
    };
    if !warnings.is_empty() {
        complaint::tell_all(&warnings.iter().map(one).collect::<Vec<_>>(), &[], colors);
    }
}

/// Learns a gait and writes its file.
pub(super) fn fit(command: &FitCommand, colors: Colors) -> Result<(), Stop> {
    let takes = Takes::read(&command.reading);
    told(&takes, colors)?;
    output::guard(Some(&command.output), &takes.paths)?;
    let (source, license) = (command.source_note.clone(), command.license.clone());
    let options = Options { source, license, ..command.learning.options() };
    let (gait, warnings) = model::fit(&takes.steps(), &options).map_err(|error| unfitted(&error))?;
    warn(&warnings, colors);
    let text = gait.to_json().map_err(|error| complaint::output(error.to_string()))?;
    output::save(&command.output, text.as_bytes())?;
    Ok(print(&visible(&reports::to_text(&gait.show())))?)
}

/// Scores of a gait for data that was held out, or of gaits that are learned from all folds but one.
pub(super) fn score(command: &ScoreCommand, colors: Colors) -> Result<(), Stop> {
    let known = |file: &String| Path::new(file).extension().is_some_and(|kind| kind == "gait");
    let scores = match command.reading.data.split_first() {
        Some((first, held_out)) if known(first) => {
            if held_out.is_empty() {
                let hint = "write the files that were held out after the gait";
                return Err(complaint::argument("there is nothing to score the gait with", hint).into());
            }
            let gait = open(first)?;
            let steps = recorded(&command.reading, held_out, colors)?;
            vec![("held out".to_owned(), model::score(&gait, &steps))]
        }
        _ => cross_validated(command, &recorded(&command.reading, &command.reading.data, colors)?)?,
    };
    if scores.iter().all(|(_, scores)| scores.pairs == 0) {
        let title = "the data that was held out has no two steps one after the other";
        return Err(Diagnostic::placeless(Code::E0722, title).hint("add takes").into());
    }
    let text = match command.format {
        TextFormat::Text => reports::scores_to_text(&scores),
        TextFormat::Json => reports::scores_to_json(&scores),
    };
    Ok(print(&text)?)
}

fn recorded(reading: &Reading, data: &[String], colors: Colors) -> Result<Vec<RecordedStep>, Stop> {
    let takes = Takes::read_all(reading, data);
    told(&takes, colors)?;
    Ok(takes.steps())
}

fn cross_validated(command: &ScoreCommand, steps: &[RecordedStep]) -> Result<Vec<(String, Scores)>, Stop> {
    let subjects: BTreeSet<&str> = steps.iter().map(|step| step.subject.as_str()).collect();
    let count = usize::from(command.folds).min(subjects.len());
    if count < 2 {
        let hint =
            "add takes of other subjects, or give a learned gait first and data that was held out after it";
        return Err(complaint::argument("folds by subject need at least two subjects (got 1)", hint).into());
    }
    let fold = model::folds(steps, count, true);
    let part = |held: usize, inside: bool| -> Vec<RecordedStep> {
        steps
            .iter()
            .zip(&fold)
            .filter(|(_, f)| (**f == held) == inside)
            .map(|(step, _)| step.clone())
            .collect()
    };
    let one = |held: usize| {
        let (gait, _) = model::fit(&part(held, false), &command.learning.options())?;
        Ok((format!("fold {}", held + 1), model::score(&gait, &part(held, true))))
    };
    Ok((0..count).map(one).collect::<Result<_, FitError>>().map_err(|error| unfitted(&error))?)
}
