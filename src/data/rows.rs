//! Traces that another program writes: a row for each state, or for each person in each state, as comma-separated values below
//! a line of heads, or as an object of JSON on each line.
//!
//! ```text
//! t,id,x,y,light             {"t": 0.1, "id": "a", "x": 1.5, "y": 2, "light": true}
//! 0.1,a,1.5,2,1
//! 0.2,,,,1                   nobody is there
//! ```

use super::outcomes::brief;
use serde_json::Value;
use std::borrow::Cow;

/// The columns that are read.
#[derive(Clone, Copy, Debug)]
pub struct Heads<'a> {
    /// The time.
    pub time: &'a str,
    /// Numbers of the state.
    pub numbers: &'a [String],
    /// Of a person the id, and where it is; empty where nobody is read.
    pub people: &'a [String],
}

/// A row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its line, from 1.
    pub line: u64,
    /// The time.
    pub time: f64,
    /// The numbers of the state.
    pub numbers: Vec<f64>,
    /// The id of a person and their numbers, unless the row says that nobody is there.
    pub person: Option<(String, Vec<f64>)>,
}

impl<'a> Heads<'a> {
    /// All columns: the time, the numbers, and those of people.
    fn all(&self) -> Vec<&'a str> {
        let rest = self.numbers.iter().chain(self.people).map(String::as_str);
        std::iter::once(self.time).chain(rest).collect()
    }

    /// Makes a row of the cells of its columns.
    fn row<'c>(&self, line: u64, cell: impl Fn(usize) -> Option<Cow<'c, str>>) -> Result<Row, String> {
        let text = |place: usize| cell(place).ok_or(place);
        let number = |place: usize| {
            let text = text(place)?;
            let number = match text.trim() {
                "true" | "True" => Some(1.0),
                "false" | "False" => Some(0.0),
                text => text.parse().ok().filter(|number: &f64| number.is_finite()),
            };
            number.ok_or(place)
        };
        let of_people = 1 + self.numbers.len();
        let person = || -> Result<_, usize> {
            if self.people.is_empty() {
                return Ok(None);
            }
            let id = text(of_people)?.trim().to_owned();
            let rest = of_people + 1..of_people + self.people.len();
            if id.is_empty() { Ok(None) } else { Ok(Some((id, rest.map(number).collect::<Result<_, _>>()?))) }
        };
        let row = || -> Result<_, usize> {
            let numbers = (1..of_people).map(number).collect::<Result<_, _>>()?;
            Ok(Row { line, time: number(0)?, numbers, person: person()? })
        };
        row().map_err(|place: usize| {
            let head = self.all()[place];
            match cell(place) {
                Some(text) => {
                    format!("line {line}: `{head}` is `{}`, which is no finite number", brief(&text))
                }
                None => format!("line {line}: there is no `{head}`"),
            }
        })
    }
}

/// Reads the rows of comma-separated values, one after the other, as long as `each` wants more.
///
/// # Errors
/// With the number of the line: columns that are missing, cells that are no numbers, and what `each` refuses.
pub fn csv(
    bytes: &[u8],
    heads: Heads<'_>,
    each: &mut dyn FnMut(Row) -> Result<bool, String>,
) -> Result<(), String> {
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).flexible(true).trim(csv::Trim::All).from_reader(bytes);
    let wrong = |error: csv::Error| match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "the output is not UTF-8 text".to_owned(),
        _ => error.to_string(),
    };
    let found = reader.headers().map_err(wrong)?.clone();
    let place = |wanted: &str| {
        let place = found.iter().position(|head| head.trim_start_matches('\u{feff}') == wanted);
        place.ok_or_else(|| match found.len() {
            0 => "the output is empty".to_owned(),
            _ => format!("there is no column `{wanted}`; the columns are {}", some(&found)),
        })
    };
    let places: Vec<usize> = heads.all().into_iter().map(place).collect::<Result<_, _>>()?;
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(wrong)? {
        let line = record.position().map_or(0, csv::Position::line);
        if !each(heads.row(line, |place| record.get(places[place]).map(Cow::Borrowed))?)? {
            break;
        }
    }
    Ok(())
}

/// The same for an object of JSON on each line.
///
/// # Errors
/// As for comma-separated values.
pub fn jsonl(
    bytes: &[u8],
    heads: Heads<'_>,
    each: &mut dyn FnMut(Row) -> Result<bool, String>,
) -> Result<(), String> {
    let all = heads.all();
    for (number, text) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let line = number as u64 + 1;
        if text.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        let value: Value =
            serde_json::from_slice(text).map_err(|error| format!("line {line} is no JSON: {error}"))?;
        let cell = |place: usize| {
            value.get(all[place]).map(|cell| match cell {
                Value::String(text) => Cow::Borrowed(text.as_str()),
                Value::Null => Cow::Borrowed(""),
                other => Cow::Owned(other.to_string()),
            })
        };
        if !each(heads.row(line, cell)?)? {
            break;
        }
    }
    Ok(())
}

/// The first of some names.
fn some(names: &csv::StringRecord) -> String {
    const MOST: usize = 8;
    let more = if names.len() > MOST { ", …" } else { "" };
    names.iter().take(MOST).map(brief).collect::<Vec<_>>().join(", ") + more
}
