//! `smc check --outcomes`: the queries of property files about outcomes that exist already.
//!
//! The names in the column `query` are names in the property files. So the table stands for a scenario in which nothing
//! changes, with a variable for each name; its text is written here, and what trials came to replaces the variables.

use super::complaint;
use super::inputs::{self, shown};
use crate::base::digest::Digest;
use crate::compile::Study;
use crate::compile::study::Ask;
use crate::data::trials::{Outcome, Outcomes as Row, Trials};
use crate::engine::outcome::CallResult;
use crate::engine::{Fault, Outcomes, Threads};
use crate::library::{self, Inputs};
use crate::model::Scenario;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::keywords::keyword;
use crate::syntax::parse::parse_value;
use crate::syntax::source::{Source, SourceId};
use std::collections::VecDeque;

/// Trials that are read at most to learn whether a name stands for a number or a truth value.
const LOOK_AHEAD: usize = 1000;
/// Trials that are asked for at a time: of a stream few, so that it may end as soon as a verdict is known.
const OF_A_FILE: usize = 1 << 10;
const OF_A_STREAM: usize = 1 << 4;

/// The lines of a table.
type Lines = Box<dyn Iterator<Item = Result<String, String>> + Send>;

/// A table of outcomes, of which the first trials were read.
pub(super) struct Given {
    /// As the call names it.
    name: String,
    trials: Trials<Lines>,
    read: VecDeque<(u64, Row)>,
    /// The names, each with its first outcome.
    names: Row,
}

/// What is wrong with a table.
fn wrong(name: &str, reason: &str) -> Diagnostic {
    Diagnostic::placeless(Code::E0707, format!("{}: {reason}", shown(name))).hint(
        "write a table with the columns `trial`, `query` and `value`, and the trials one after the other",
    )
}

/// Whether it can be a name in a property file.
fn is_name(text: &str) -> bool {
    let starts = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    starts && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && keyword(text).is_none()
}

impl Given {
    /// Opens a table; `-` is standard input.
    pub(super) fn open(name: &str) -> Result<Self, Diagnostic> {
        let lines = inputs::lines(name).map_err(complaint::input)?;
        let lines = lines.map(|line| {
            let line = line.map_err(|error| format!("cannot be read: {error}"))?;
            String::from_utf8(line).map_err(|_| "not UTF-8 text".to_owned())
        });
        let trials = Trials::new(Box::new(lines) as Lines);
        let mut given = Self { name: name.to_owned(), trials, read: VecDeque::new(), names: Row::new() };
        let is_unknown = |names: &Row| names.iter().any(|(_, outcome)| *outcome == Outcome::Nothing);
        while given.read.len() < LOOK_AHEAD && (given.read.is_empty() || is_unknown(&given.names)) {
            let next = given.trials.next_trial().map_err(|reason| wrong(name, &reason))?;
            let Some((number, row)) = next else { break };
            if given.read.is_empty() {
                given.names.clone_from(&row);
            }
            for (query, first) in given.names.iter_mut().filter(|(_, first)| *first == Outcome::Nothing) {
                let outcome = row.iter().find(|(known, _)| known == query);
                *first = outcome.map_or(Outcome::Nothing, |(_, outcome)| outcome.clone());
            }
            given.read.push_back((number, row));
        }
        if given.read.is_empty() {
            return Err(wrong(name, "there are no outcomes"));
        }
        if let Some((query, _)) = given.names.iter().find(|(query, _)| !is_name(query)) {
            let hint = "write a word of letters, digits and `_` that is not a keyword in the column `query`";
            return Err(wrong(name, &format!("`{query}` cannot be a name in a property file")).hint(hint));
        }
        let units = given.names.iter().filter_map(|(_, first)| match first {
            Outcome::Number(_, unit) if !unit.is_empty() => Some(unit),
            _ => None,
        });
        for unit in units {
            let source = Source::new(SourceId(0), shown(name), format!("1 {unit}"));
            if parse_value(&source).is_err() {
                return Err(wrong(name, &format!("`{unit}` is not a unit")));
            }
        }
        Ok(given)
    }

    /// Nobody wrote the text of the scenario, so its warnings say nothing; the digest is that of the table, if it is a file.
    pub(super) fn own(&self, inputs: &mut Inputs) {
        let source =
            inputs.sources.iter().find(|source| source.name == shown(&self.name)).map(|source| source.id);
        inputs.diagnostics.retain(|one| {
            let own = one.place.as_ref().is_some_and(|place| Some(place.span.source) == source);
            !own || one.severity == Severity::Error
        });
        let print = if self.name == "-" { None } else { inputs::read(&self.name).ok() };
        inputs.prints.retain_mut(|(name, known)| match (&print, name == shown(&self.name)) {
            (_, false) => true,
            (Some(bytes), true) => {
                *known = Digest::of(bytes);
                true
            }
            (None, true) => false,
        });
    }

    /// Says in each query what it is given.
    ///
    /// # Errors
    /// For a query that needs a model.
    pub(super) fn settle(&self, study: &mut Study) -> Result<(), Diagnostic> {
        for query in &mut study.queries {
            if let Ask::Estimate { level: Some(_), .. } = query.ask {
                let hint = "estimate it without `by splitting`, which starts trials again from their states";
                return Err(Diagnostic::error(Code::E0603, query.span, "outcomes cannot be split").hint(hint));
            }
            query.given = Some(format!("the outcomes of {}, if they are independent", shown(&self.name)));
        }
        Ok(())
    }

    /// Runs queries over the outcomes, where the variables of the compiled scenario say how much a unit is.
    pub(super) fn run(
        self,
        scenario: &Scenario,
        threads: &Threads,
        work: impl FnOnce(&Outcomes<'_>) -> Result<CallResult, Fault>,
    ) -> Result<CallResult, Vec<Diagnostic>> {
        let name = self.name.clone();
        let outcomes = self.outcomes(scenario, threads);
        let run = work(&outcomes).map_err(|fault| library::refusals(&fault))?;
        if let Some(reason) = outcomes.error() {
            return Err(vec![wrong(&name, &reason)]);
        }
        Ok(run)
    }

    /// The scenario that the table stands for. A number with a unit is one of it, so that the first value says how much that is.
    pub(super) fn scenario(&self) -> String {
        let mut process = "outcome".to_owned();
        while self.names.iter().any(|(name, _)| *name == process) {
            process.push('_');
        }
        let (mut variables, mut names) = (String::new(), String::new());
        for (name, first) in &self.names {
            let value = match first {
                Outcome::Truth(_) => "false".to_owned(),
                Outcome::Number(_, unit) => format!("1 {unit}"),
                Outcome::Nothing => "1".to_owned(),
            };
            variables += &format!("  var {name} = {value}\n");
            names += &format!("let {name} = {process}.{name}\n");
        }
        let title = shown(&self.name).replace(['"', '\\', '\n'], "");
        format!("scenario \"{title}\"\nhorizon = 1 step\nprocess {process} {{\n{variables}}}\n{names}")
    }

    /// The outcomes for the engine, where the variables of the compiled scenario say how much a unit is.
    fn outcomes<'a>(self, scenario: &Scenario, threads: &'a Threads) -> Outcomes<'a> {
        let Self { name, mut trials, mut read, names } = self;
        let factors: Vec<f64> =
            scenario.processes.variables.iter().map(|variable| variable.initial).collect();
        let width = if name == "-" { OF_A_STREAM } else { OF_A_FILE };
        let next = move || {
            let next = match read.pop_front() {
                None => trials.next_trial()?,
                known => known,
            };
            let Some((number, row)) = next else { return Ok(None) };
            let mut values = vec![f64::NAN; names.len()];
            for (query, outcome) in row {
                let Some(place) = names.iter().position(|(known, _)| *known == query) else {
                    return Err(format!(
                        "trial {number} has an outcome of `{query}`, and the first trial has none"
                    ));
                };
                values[place] = match (&names[place].1, outcome) {
                    (_, Outcome::Nothing) => f64::NAN,
                    (Outcome::Truth(_), Outcome::Truth(truth)) => f64::from(u8::from(truth)),
                    (Outcome::Number(_, unit), Outcome::Number(value, own)) if *unit == own => {
                        value * factors[place]
                    }
                    (Outcome::Nothing, Outcome::Number(value, own)) if own.is_empty() => value,
                    (first, other) => {
                        return Err(format!(
                            "trial {number}: `{query}` is {}, and in the first trial {}",
                            said(&other),
                            said(first)
                        ));
                    }
                };
            }
            Ok(Some(values))
        };
        Outcomes::new(Box::new(next), width, threads)
    }
}

/// An outcome in words.
fn said(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Truth(_) => "a truth value".to_owned(),
        Outcome::Number(_, unit) if unit.is_empty() => "a number without a unit".to_owned(),
        Outcome::Number(_, unit) => format!("a number in {unit}"),
        Outcome::Nothing => "nothing".to_owned(),
    }
}
