//! `--keep`: only the trials in which the formula of a check is false, or true.

use super::choice::Keep;
use crate::cli::complaint;
use crate::cli::values::threads;
use crate::compile::Study;
use crate::compile::nearest::nearest;
use crate::compile::study::{Ask, MeasureKind, Query, Target};
use crate::engine::trials::executor::{Executor, Job};
use crate::engine::{Budget, Fault, PreparedWorld};
use crate::library;
use crate::syntax::diagnostic::Diagnostic;
use crate::trials::cell::{Item, Reading};

/// Trials that are judged at one time.
const ROUND: u64 = 4096;

/// How a message calls a query.
fn label(query: &Query) -> String {
    query.name.clone().unwrap_or_else(|| query.index.to_string())
}

impl Keep {
    /// What the check observes in each trial.
    ///
    /// # Errors
    /// Where no check `P(...)` has the name, several have it, or it is one of a sweep.
    pub(super) fn target(&self, study: &Study) -> Result<Target, Diagnostic> {
        let of = |query: &Query| match &query.ask {
            Ask::Check { measure, .. } if measure.kind == MeasureKind::Probability => Some(measure.target),
            _ => None,
        };
        let word = self.word();
        let is_meant = |query: &&Query| {
            self.name.as_ref().is_none_or(|name| {
                query.name.as_ref() == Some(name) || name.parse::<usize>().ok() == Some(query.index)
            })
        };
        let meant: Vec<&Query> = study.queries.iter().filter(is_meant).collect();
        let checks: Vec<&Query> = meant.iter().copied().filter(|query| of(query).is_some()).collect();
        let names = || {
            let all = study.queries.iter().filter(|query| of(query).is_some());
            let mut names: Vec<String> = all.map(label).collect();
            names.dedup();
            names
        };
        let known = || match names().as_slice() {
            [] => "write a query such as `check P(safe) >= 0.9` into a property file".to_owned(),
            names => format!("the checks of a probability are {}", names.join(", ")),
        };
        let Some(first) = checks.first() else {
            let title = match (&self.name, meant.first()) {
                (None, _) => format!("`--keep {word}` needs a check of a probability, and there is none"),
                (Some(name), Some(_)) => {
                    format!("`--keep {word}={name}`: query `{name}` is not a check of a probability")
                }
                (Some(name), None) => format!("`--keep {word}={name}`: no check is about `{name}`"),
            };
            let near = self.name.as_ref().filter(|_| meant.is_empty());
            let near =
                near.and_then(|name| Some(nearest(name, names().iter().map(String::as_str))?.to_owned()));
            return Err(complaint::argument(
                title,
                near.map_or_else(known, |near| format!("did you mean `{near}`?")),
            ));
        };
        if checks.iter().any(|query| query.index == first.index && of(query) != of(first)) {
            let title = format!("`--keep {word}`: the check has a result for each point of a sweep");
            return Err(complaint::argument(title, "write `--set name=value`"));
        }
        if checks.iter().any(|query| of(query) != of(first)) {
            let numbers: Vec<String> = checks.iter().map(|query| query.index.to_string()).collect();
            let (title, list) = match &self.name {
                Some(name) => (format!("several checks are about `{name}`"), numbers.join(", ")),
                None => (format!("there are {} checks of a probability", checks.len()), names().join(", ")),
            };
            let hint = format!("write `--keep {word}=NAME` with one of {list}");
            return Err(complaint::argument(title, hint));
        }
        of(first).ok_or_else(|| complaint::argument("there is no check", known()))
    }

    /// Judges trials, with an option of moves if one is followed: those that are kept, and how many are unresolved.
    ///
    /// # Errors
    /// Where the formula cannot be watched.
    pub(super) fn judge(
        &self,
        prepared: &PreparedWorld,
        column: usize,
        seed: u64,
        mut items: impl Iterator<Item = Item>,
    ) -> Result<(Vec<u64>, u64), Diagnostic> {
        let threads = threads(None)?;
        let (job, budget) = (Job::new(prepared, vec![column], seed), Budget::new(u64::MAX, None));
        let (mut kept, mut unresolved) = (Vec::new(), 0);
        loop {
            let round: Vec<Item> = items.by_ref().take(ROUND as usize).collect();
            if round.is_empty() {
                return Ok((kept, unresolved));
            }
            let cells = threads.run(&job, &round, &budget);
            let cells = cells.map_err(|_| library::refusal(&Fault::Unsuitable))?;
            for (item, cells) in round.iter().zip(cells.rows()) {
                match cells.and_then(|cells| cells.first()).map(|cell| cell.reading) {
                    Some(Reading::Truth(truth)) if truth == self.truth => kept.push(item.index),
                    Some(Reading::Truth(_)) => {}
                    _ => unresolved += 1,
                }
            }
        }
    }

    /// What was kept, in words.
    pub(super) fn told(&self, trials: u64, kept: usize, unresolved: u64) -> String {
        let word = self.word();
        format!("kept {kept} of {trials} trials: {word} in {kept}, unresolved in {unresolved}\n")
    }
}
