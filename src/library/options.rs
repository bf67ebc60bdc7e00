//! How much a check may take, and what it asks.

use crate::compile::Study;
use crate::compile::nearest::nearest;
use crate::engine::{Budget, Fault, Threads, Within};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::trials::budget::DEFAULT_TRIALS;
use std::time::Duration;

/// Options of a check. Unless a timeout is set, results are a function of the texts, the seed and the numbers of trials.
#[derive(Clone, Debug)]
pub struct Options {
    pub(super) seed: u64,
    threads: Option<usize>,
    max_trials: u64,
    timeout: Option<Duration>,
    only: Vec<String>,
    pub(super) evidence: bool,
    within: Option<Within>,
}

impl Default for Options {
    /// Seed 0, all cores, at most a million trials a query, no timeout, all queries.
    fn default() -> Self {
        Self {
            seed: 0,
            threads: None,
            max_trials: DEFAULT_TRIALS,
            timeout: None,
            only: Vec::new(),
            evidence: false,
            within: None,
        }
    }
}

impl Options {
    /// Sets the seed of all random numbers.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Sets the number of threads, which never changes a result.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads: Some(threads), ..self }
    }

    /// Has each thread run its trials within something that gets it ready for drivers of your own, such as the state of an
    /// interpreter, which would else be made for each question.
    #[must_use]
    pub fn within(self, within: Within) -> Self {
        Self { within: Some(within), ..self }
    }

    /// Sets the largest number of trials of one query.
    #[must_use]
    pub fn max_trials(self, max_trials: u64) -> Self {
        Self { max_trials, ..self }
    }

    /// Sets the time for all queries together.
    #[must_use]
    pub fn timeout(self, timeout: Duration) -> Self {
        Self { timeout: Some(timeout), ..self }
    }

    /// Keeps how the evidence of each result grew, for figures.
    #[must_use]
    pub fn evidence(self, evidence: bool) -> Self {
        Self { evidence, ..self }
    }

    /// Asks only queries of this property, or of this number; may be called several times.
    #[must_use]
    pub fn only(mut self, query: impl Into<String>) -> Self {
        self.only.push(query.into());
        self
    }

    /// The budget of a check that begins now. Whoever holds it may interrupt the check.
    pub fn budget(&self) -> Budget {
        Budget::new(self.max_trials, self.timeout)
    }

    pub(super) fn executor(&self) -> Result<Threads, Fault> {
        let threads = Threads::new(self.threads).map_err(|error| Fault::Threads(error.to_string()))?;
        Ok(threads.within(self.within))
    }

    /// The numbers of the queries that are asked; empty for all.
    pub(super) fn chosen(&self, study: &Study) -> Result<Vec<usize>, Diagnostic> {
        chosen(study, &self.only)
    }
}

/// Numbers of the queries of some names or numbers.
///
/// # Errors
/// Where no query has that name or number.
pub fn chosen(study: &Study, only: &[String]) -> Result<Vec<usize>, Diagnostic> {
    let mut chosen = Vec::new();
    for wanted in only {
        let number = wanted.parse::<usize>().ok();
        let found: Vec<usize> = study
            .queries
            .iter()
            .filter(|q| Some(q.index) == number || q.name.as_deref() == Some(wanted.as_str()))
            .map(|q| q.index)
            .collect();
        if found.is_empty() {
            let mut names: Vec<&str> = study.queries.iter().filter_map(|q| q.name.as_deref()).collect();
            names.sort_unstable();
            names.dedup();
            let last = study.queries.iter().map(|q| q.index).max().unwrap_or(0);
            let near = nearest(wanted, names.iter().copied());
            let hint = match near {
                Some(near) => format!("did you mean `{near}`?"),
                None if names.is_empty() => format!("write a number from 0 to {last}"),
                None => {
                    format!("write a number from 0 to {last}, or one of the properties {}", names.join(", "))
                }
            };
            return Err(argument(
                match number {
                    Some(number) => format!("`--only {number}`: there is no query {number}"),
                    None => format!("`--only {wanted}`: no query is about `{wanted}`"),
                },
                hint,
            ));
        }
        chosen.extend(found);
    }
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

fn argument(title: String, hint: String) -> Diagnostic {
    Diagnostic::placeless(Code::E0705, title).hint(hint)
}
