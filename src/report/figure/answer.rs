//! The results of a file that `smc check --format json` has written, as figures need them.

use super::flaw::Flaw;
use serde_json::Value;

/// The schema of results that is read.
pub(super) const SCHEMA: u64 = 3;

/// What a figure needs of a query, and what to write so that a file has it.
pub(super) type Needed = (&'static str, &'static str);

/// The results of a file about one query; several under several settings.
pub(super) struct Answer<'v> {
    /// The query.
    pub(super) query: &'v str,
    /// Its results.
    pub(super) results: Vec<&'v Value>,
}

impl<'v> Answer<'v> {
    /// What a file says about the only query that has what a figure needs, or about the one that is named.
    ///
    /// # Errors
    /// The file is no results of this version, none of its queries has what is needed, or several have.
    pub(super) fn of(
        file: &'v Value,
        only: Option<&str>,
        (needed, hint): Needed,
        fits: impl Fn(&[&Value]) -> bool,
    ) -> Result<Self, Flaw> {
        let schema = file["schema"].as_u64();
        let Some(all) = file["results"].as_array().filter(|_| schema == Some(SCHEMA)) else {
            let found = schema.map_or_else(|| "no schema of results".to_owned(), |n| format!("schema {n}"));
            return Err(Flaw::new(
                format!("the file has {found}; this figure needs results of schema {SCHEMA}"),
                "make the file with `smc check … --format json=results.json` of this version",
            ));
        };
        let mut answers: Vec<Self> = Vec::new();
        for result in all {
            let query = result["query"].as_str().unwrap_or_default();
            match answers.iter_mut().find(|answer| answer.results[0]["index"] == result["index"]) {
                Some(answer) => answer.results.push(result),
                None => answers.push(Self { query, results: vec![result] }),
            }
        }
        let is_named = |answer: &Self| {
            let one = answer.results[0];
            only.is_none_or(|only| {
                one["name"].as_str() == Some(only) || only.parse() == Ok(number(&one["index"]))
            })
        };
        answers.retain(is_named);
        if let (Some(only), true) = (only, answers.is_empty()) {
            let names: Vec<String> = all.iter().map(name_of).collect();
            return Err(Flaw::new(
                format!("the file has no query `{only}`"),
                format!("write one of {}", listed(names)),
            ));
        }
        answers.retain(|answer| fits(&answer.results));
        match answers.len() {
            0 => Err(Flaw::new(format!("no query of the file has {needed}"), hint)),
            1 => Ok(answers.remove(0)),
            _ => {
                let one = |answer: &Self| {
                    let first = answer.results[0];
                    format!("{} ({})", first["index"], name_of(first))
                };
                let all: Vec<String> = answers.iter().map(one).collect();
                Err(Flaw::new(
                    format!("several queries of the file have {needed}"),
                    format!("choose one by its number with `--only`: {}", all.join(", ")),
                ))
            }
        }
    }

    /// What its figures are.
    pub(super) fn axis(&self) -> String {
        let unit = self.results[0]["unit"].as_str().unwrap_or_default();
        if unit.is_empty() { "probability".to_owned() } else { with_unit("value", unit) }
    }
}

/// What an axis has, with its unit.
pub(super) fn with_unit(what: &str, unit: &str) -> String {
    if unit.is_empty() { what.to_owned() } else { format!("{what} ({unit})") }
}

fn name_of(result: &Value) -> String {
    result["name"].as_str().map_or_else(|| result["index"].to_string(), str::to_owned)
}

fn listed(mut names: Vec<String>) -> String {
    names.dedup();
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A number; not one where the file has none.
pub(super) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Low end, estimate and high end. An end that the file does not have is infinite.
pub(super) fn interval(value: &Value) -> [f64; 3] {
    let end = |key: &str, infinite| value[key].as_f64().unwrap_or(infinite);
    [end("low", f64::NEG_INFINITY), number(&value["estimate"]), end("high", f64::INFINITY)]
}
