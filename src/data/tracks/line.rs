//! A fault in one line of a text table, and the fields of such a line.

use crate::base::geometry::Vec2;
use crate::base::visible::{shortened, visible};

/// An error of a line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct LineError {
    /// Line, from 1; 0 where the whole file is meant.
    pub line: usize,
    /// Character of the line at which the fault begins, from 1; `None` where the whole line is meant.
    pub column: Option<usize>,
    /// The error: one sentence, lower case, no full stop.
    pub message: String,
}

impl LineError {
    /// A fault of a whole line.
    pub fn whole(line: usize, message: impl Into<String>) -> Self {
        Self { line, column: None, message: shortened(message.into()) }
    }

    /// A fault that no line has alone.
    pub fn of_file(message: impl Into<String>) -> Self {
        Self::whole(0, message)
    }

    /// A fault at a character of a line.
    pub fn at(line: usize, column: usize, message: impl Into<String>) -> Self {
        Self { line, column: Some(column), message: shortened(message.into()) }
    }

    fn sentence(&self) -> String {
        match self.column {
            Some(column) => format!("line {}, column {column}: {}", self.line, self.message),
            None if self.line == 0 => self.message.clone(),
            None => format!("line {}: {}", self.line, self.message),
        }
    }
}

/// The blank-separated fields of a line, each with the character (from 1) at which it begins.
pub(in crate::data) fn fields(line: &str) -> impl Iterator<Item = (usize, &str)> {
    let start = line.as_ptr() as usize;
    let (mut counted, mut column) = (0, 1);
    line.split_whitespace().map(move |field| {
        let byte = field.as_ptr() as usize - start;
        column += line[counted..byte].chars().count();
        counted = byte;
        (column, field)
    })
}

/// A field for a message: quoted, and cut where it is long.
pub(in crate::data) fn quoted(field: &str) -> String {
    const LONGEST: usize = 24;
    let count = field.chars().count();
    if count <= LONGEST {
        return format!("`{}`", field.escape_debug());
    }
    // Names that begin alike differ in their ends.
    let head: String = field.chars().take(LONGEST / 2).collect();
    let tail: String = field.chars().skip(count - LONGEST / 2).collect();
    format!("`{}…{}`", head.escape_debug(), tail.escape_debug())
}

/// The finite number of a field.
///
/// # Errors
/// What is wrong with the field, to be put after it.
pub(in crate::data) fn number(field: &str) -> Result<f64, &'static str> {
    match field.parse::<f64>() {
        Err(_) => Err("is not a number"),
        Ok(value) if !value.is_finite() => Err("is not a finite number"),
        Ok(value) => Ok(value),
    }
}

/// Why a number is not a frame or an id: a whole number from 0 to 4294967295.
pub(in crate::data) fn whole_fault(value: f64) -> Option<&'static str> {
    if value < 0.0 {
        Some("is negative")
    } else if value.fract() != 0.0 {
        Some("is not a whole number")
    } else if value > f64::from(u32::MAX) {
        Some("is too large")
    } else {
        None
    }
}

/// The numbers in the first fields of a line, whose names are given; frames and ids are whole. Faults are added to the errors.
pub(super) fn numbers<const N: usize>(
    at: usize,
    line: &str,
    names: [&str; N],
    errors: &mut Vec<LineError>,
) -> [f64; N] {
    let mut values = [0.0; N];
    for (k, (column, field)) in fields(line).take(N).enumerate() {
        let found = number(field).and_then(|value| {
            values[k] = value;
            whole_fault(value).filter(|_| ["frame", "id"].contains(&names[k])).map_or(Ok(()), Err)
        });
        if let Err(fault) = found {
            errors.push(LineError::at(at, column, format!("{} {} {fault}", names[k], quoted(field))));
        }
    }
    values
}

/// A velocity of two members, if they are there.
pub(super) fn json_velocity(what: &str, x: Option<f64>, y: Option<f64>) -> Result<Option<Vec2>, String> {
    if x.is_some() != y.is_some() {
        return Err(format!("{what} must have both `vx` and `vy` or neither"));
    }
    Ok(x.zip(y).map(|(x, y)| Vec2::new(x, y)))
}

/// An error of JSON in one line, at its character: which member is wrong, and how it must be.
pub(super) fn json_fault(number: usize, line: &str, error: &serde_json::Error) -> LineError {
    let said = error.to_string();
    // The place is said by the error of the line.
    let said = said.split(" at line ").next().unwrap_or(&said);
    let before = line.as_bytes().get(..error.column().saturating_sub(1)).unwrap_or(line.as_bytes());
    let before = String::from_utf8_lossy(before);
    let cut = |text: &str| text.chars().take(60).collect::<String>();
    let message = match said.split_once(", expected ") {
        Some((found, wanted)) => {
            let quoted = before.rsplit_once("\":").and_then(|(start, _)| start.rsplit_once('"'));
            let subject = match quoted {
                Some((_, name)) if !wanted.starts_with("struct Line") => format!("`{}`", visible(name)),
                _ => "a line".to_owned(),
            };
            let found = found.split_once(": ").map(|(_, found)| format!(" (got {})", cut(found)));
            format!("{subject} must be {}{}", in_words(wanted), found.unwrap_or_default())
        }
        None if said.starts_with("expected") || error.is_eof() => {
            format!("the line is not JSON: {}", said.replace("ident", "value"))
        }
        None => said.to_owned(),
    };
    LineError::at(number, before.chars().count() + 1, message)
}

/// The form of a member, by the type that was expected.
fn in_words(wanted: &str) -> &str {
    match wanted {
        "u32" => "a whole number from 0 to 4294967295",
        "f64" => "a number",
        "a string" => "a text",
        "a sequence" => "a list",
        "an array of length 2" => "a list of corners [x, y]",
        _ if wanted.starts_with("struct Seen") => "a list of JSON objects",
        _ if wanted.starts_with("struct") => "a JSON object",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_know_where_they_begin() {
        let line = "  é 12\tx";
        let found: Vec<_> = fields(line).collect();
        assert_eq!(found, [(3, "é"), (5, "12"), (8, "x")]);
    }

    #[test]
    fn a_fault_says_its_place() {
        assert_eq!(LineError::at(3, 7, "no number").to_string(), "line 3, column 7: no number");
        assert_eq!(LineError::whole(3, "too short").to_string(), "line 3: too short");
        assert!(quoted(&"9".repeat(100)).chars().count() < 30);
    }
}
