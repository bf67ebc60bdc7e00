//! Outcomes line by line: `0` and `1`, `false` and `true`, or a column of a table of comma-separated values.

/// Where the outcome stands in a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Column {
    /// The line is the outcome.
    Line,
    /// In the column of this number, from 1. A first line in which it is no outcome is taken for the heads.
    Number(usize),
    /// In the column of this head; the first line holds the heads.
    Head(String),
}

/// The cells of a line; a comma between quotes parts nothing.
pub(super) fn cells(line: &str) -> Vec<&str> {
    let mut quoted = false;
    let parts = line.split(move |c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    });
    parts.map(|cell| cell.trim().trim_matches('"')).collect()
}

/// Reads outcomes from successive lines.
#[derive(Clone, Debug)]
pub struct Outcomes {
    column: Column,
    /// Place of the column, from 0, once it is known.
    place: Option<usize>,
    lines: u64,
}

impl Outcomes {
    /// From the first line on.
    pub const fn new(column: Column) -> Self {
        Self { column, place: None, lines: 0 }
    }

    /// The outcome in the next line; `None` in an empty line, a comment (`#`) and the heads.
    ///
    /// # Errors
    /// With the number of the line, where there is no outcome in it.
    pub fn read(&mut self, line: &str) -> Result<Option<bool>, String> {
        self.lines += 1;
        // A byte-order mark may open the stream.
        let line = if self.lines == 1 { line.trim_start_matches('\u{feff}') } else { line }.trim();
        if line.is_empty() || line.starts_with('#') {
            return Ok(None);
        }
        let fail = |what: String| Err(format!("line {}: {what}", self.lines));
        let cells = cells(line);
        let heads = self.place.is_none();
        if self.column == Column::Line && cells.len() > 1 {
            return fail("the table has several columns: choose one with `--column`".to_owned());
        }
        let place = match (&self.column, self.place) {
            (_, Some(place)) => place,
            (Column::Line, None) => {
                self.place = Some(0);
                0
            }
            (Column::Number(number), None) => {
                let place = number.saturating_sub(1);
                self.place = Some(place);
                place
            }
            (Column::Head(head), None) => {
                let Some(place) = cells.iter().position(|cell| cell == head) else {
                    return fail(format!(
                        "there is no column `{head}`; the columns are {}",
                        cells.join(", ")
                    ));
                };
                self.place = Some(place);
                return Ok(None);
            }
        };
        match cells.get(place).map(|cell| outcome(cell)) {
            Some(Some(outcome)) => Ok(Some(outcome)),
            Some(None) if heads && matches!(self.column, Column::Number(_)) => Ok(None),
            Some(None) => fail(format!("`{}` is not an outcome", brief(cells[place]))),
            None => fail(format!("there is no column {}; the table has {}", place + 1, cells.len())),
        }
    }

    /// Lines read.
    pub const fn lines(&self) -> u64 {
        self.lines
    }
}

/// The beginning of what stands in a cell, fit to be printed.
pub(super) fn brief(cell: &str) -> String {
    const MOST: usize = 40;
    let start: String = cell.chars().take(MOST).flat_map(char::escape_debug).collect();
    if cell.chars().nth(MOST).is_some() { start + "…" } else { start }
}

fn outcome(cell: &str) -> Option<bool> {
    match cell.to_ascii_lowercase().as_str() {
        "1" | "true" => Some(true),
        "0" | "false" => Some(false),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(column: Column, lines: &[&str]) -> Vec<Result<Option<bool>, String>> {
        let mut outcomes = Outcomes::new(column);
        lines.iter().map(|line| outcomes.read(line)).collect()
    }

    #[test]
    fn a_line_is_an_outcome() {
        let read = all(Column::Line, &["1", " true ", "", "# so", "0", "False", "2"]);
        let fine: Vec<_> = read[..6].iter().map(|r| r.clone().unwrap()).collect();
        assert_eq!(fine, [Some(true), Some(true), None, None, Some(false), Some(false)]);
        assert_eq!(read[6], Err("line 7: `2` is not an outcome".to_owned()));
        assert!(all(Column::Line, &["1,0"])[0].as_ref().unwrap_err().contains("--column"));
    }

    #[test]
    fn a_column_by_head_or_number() {
        let lines = ["time,arrived", "0.5,1", "\"0.7\",\"false\""];
        let expected = [Ok(None), Ok(Some(true)), Ok(Some(false))];
        assert_eq!(all(Column::Head("arrived".to_owned()), &lines), expected);
        assert_eq!(all(Column::Number(2), &lines), expected);
        assert_eq!(all(Column::Number(2), &lines[1..]), expected[1..]);
        let wrong = all(Column::Head("arived".to_owned()), &lines);
        assert!(wrong[0].as_ref().unwrap_err().contains("time, arrived"));
        assert!(all(Column::Number(3), &lines[1..])[0].is_err());
    }
}
