//! Reader of a table of takes: a CSV with columns `file`, `clip`, `subject` and `fps`, one row per take.

use super::pose::number;
use super::positions::{field, good, table};
use crate::data::tracks::LineError;
use std::collections::BTreeMap;

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct TakeRow {
    /// Line of the table.
    pub line: usize,
    /// The file, relative to the table.
    pub file: String,
    /// The clip within the file; empty if the file has one take.
    pub clip: String,
    /// The person who was recorded; may be empty.
    pub subject: String,
    /// Frames per second, if stated.
    pub fps: Option<f64>,
    /// A name that no other row has: the clip or the name of the file, with its folders if that name is not unique.
    pub name: String,
}

/// The name of a file without its folders and its extension.
pub(super) fn stem(file: &str) -> &str {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// Reads a table of takes. Other columns are ignored.
///
/// # Errors
/// Missing columns, and each row whose number of fields, file or rate is wrong or which is there twice.
pub fn read_take_table(text: &str) -> Result<Vec<TakeRow>, Vec<LineError>> {
    let columns = ["file", "clip", "subject", "fps"].map(str::to_owned);
    let (mut reader, at) = table(text, &columns).map_err(|error| vec![error])?;
    let (mut rows, mut errors, mut counts) = (Vec::new(), Vec::new(), BTreeMap::new());
    let mut seen = BTreeMap::new();
    for row in reader.records() {
        let Some(row) = good(row, &mut errors) else { continue };
        let [file, clip, subject] = [at[0], at[1], at[2]].map(|k| row[k].to_owned());
        let (line, rate) = field(&row, at[3]);
        let fps = if rate.1.is_empty() { Ok(None) } else { number(line, rate).map(Some) };
        if file.is_empty() {
            errors.push(LineError::whole(line, "the row has no file"));
        } else if let Some(first) = seen.insert((file.clone(), clip.clone()), line) {
            errors.push(LineError::whole(line, format!("the row names the same take as line {first}")));
        }
        let name = if clip.is_empty() { stem(&file).to_owned() } else { clip.clone() };
        *counts.entry(name.clone()).or_insert(0) += 1;
        match fps {
            Ok(fps) => rows.push(TakeRow { line, file, clip, subject, fps, name }),
            Err(error) => errors.push(error),
        }
    }
    for row in rows.iter_mut().filter(|row| counts.get(&row.name).is_some_and(|count| *count > 1)) {
        row.name = if row.clip.is_empty() { row.file.clone() } else { format!("{}:{}", row.file, row.clip) };
    }
    if rows.is_empty() && errors.is_empty() {
        errors.push(LineError::of_file("the table has no takes"));
    }
    if errors.is_empty() { Ok(rows) } else { Err(errors) }
}
