//! Outcomes of trials that ran elsewhere, from a table of comma-separated values with the columns `trial`, `query` and
//! `value`: trial after trial, each with what it came to for each query.
//!
//! ```text
//! trial,query,value
//! 0,arrived,true
//! 0,way,12.5 m
//! 1,arrived,false
//! 1,way,            a trial may lack a value, or have NaN: it is unresolved there
//! ```

use super::outcomes::cells;

/// What a trial came to for a query.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// `true` or `false`.
    Truth(bool),
    /// A number, and its unit as written.
    Number(f64, String),
    /// Nothing: an empty cell, or NaN.
    Nothing,
}

impl Outcome {
    /// Reads a cell.
    fn read(text: &str) -> Option<Self> {
        match text {
            "" => return Some(Self::Nothing),
            "true" | "True" => return Some(Self::Truth(true)),
            "false" | "False" => return Some(Self::Truth(false)),
            _ => {}
        }
        let (number, unit) = text.split_once(' ').unwrap_or((text, ""));
        let number: f64 = number.parse().ok()?;
        if number.is_nan() {
            return Some(Self::Nothing);
        }
        number.is_finite().then(|| Self::Number(number, unit.trim().to_owned()))
    }
}

/// The outcomes of a trial, by query.
pub type Outcomes = Vec<(String, Outcome)>;

/// A row: line, trial, query and outcome.
type Row = (u64, u64, String, Outcome);

/// The trials of a table, from its lines.
#[derive(Debug)]
pub struct Trials<L> {
    lines: L,
    line: u64,
    /// Places of the three columns, once the heads were read.
    places: Option<[usize; 3]>,
    /// The first row of the next trial.
    ahead: Option<Row>,
    last: Option<u64>,
}

impl<L: Iterator<Item = Result<String, String>>> Trials<L> {
    /// From the first line on.
    pub const fn new(lines: L) -> Self {
        Self { lines, line: 0, places: None, ahead: None, last: None }
    }

    /// The number of the next trial and its outcomes, by query; `None` after the last one.
    ///
    /// # Errors
    /// With the number of the line: a row that cannot be read, trials that do not follow each other, two outcomes of one
    /// query in a trial.
    pub fn next_trial(&mut self) -> Result<Option<(u64, Outcomes)>, String> {
        let Some((line, trial, query, outcome)) = (match self.ahead.take() {
            Some(row) => Some(row),
            None => self.row()?,
        }) else {
            return Ok(None);
        };
        if let Some(last) = self.last
            && last.checked_add(1) != Some(trial)
        {
            let why = if trial > last { "trials are missing between them" } else { "trials must ascend" };
            return Err(format!("line {line}: trial {trial} follows trial {last}; {why}"));
        }
        self.last = Some(trial);
        let mut found = vec![(query, outcome)];
        while let Some(row) = self.row()? {
            if row.1 != trial {
                self.ahead = Some(row);
                break;
            }
            let (line, _, query, outcome) = row;
            if found.iter().any(|(known, _)| *known == query) {
                return Err(format!("line {line}: trial {trial} has a second outcome of `{query}`"));
            }
            found.push((query, outcome));
        }
        Ok(Some((trial, found)))
    }

    /// The next row that is neither empty nor a comment.
    fn row(&mut self) -> Result<Option<Row>, String> {
        loop {
            let Some(text) = self.lines.next().transpose()? else { return Ok(None) };
            self.line += 1;
            let text = text.trim().trim_start_matches('\u{feff}');
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            let cells = cells(text);
            let fail = |what: String| Err(format!("line {}: {what}", self.line));
            let Some(places) = self.places else {
                let place = |head: &str| cells.iter().position(|cell| *cell == head);
                let heads = ["trial", "query", "value"].map(|head| place(head).ok_or(head));
                if let Some(Err(head)) = heads.iter().find(|head| head.is_err()) {
                    return fail(format!("the table has no column `{head}`"));
                }
                self.places = Some(heads.map(Result::unwrap_or_default));
                continue;
            };
            let [trial, query, value] = places.map(|place| cells.get(place).copied());
            let (Some(trial), Some(query), Some(value)) = (trial, query, value) else {
                return fail(format!("{} cells are too few", cells.len()));
            };
            let Ok(number) = trial.parse() else {
                return fail(format!("`{trial}` is not the number of a trial"));
            };
            let Some(outcome) = Outcome::read(value) else {
                return fail(format!(
                    "`{value}` is neither true, false nor a finite number, perhaps with a unit"
                ));
            };
            return Ok(Some((self.line, number, query.to_owned(), outcome)));
        }
    }
}
