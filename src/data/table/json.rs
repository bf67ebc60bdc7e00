//! Traces as JSON: lines with one object each, or one object with columns and rows.
//!
//! What is missing or infinite is `null`, as JSON has no other word for it.

use super::column::{Column, Value};
use super::format::{Table, TraceFormat, Writer};
use std::io::{self, Write};

/// One object with columns, their units, and rows:
/// `{"schema": 1, "scenario": …, "seed": …, "version": …, "columns": [...], "units": [...], "rows": [[...], ...]}`.
pub(super) const OBJECT: TraceFormat = TraceFormat {
    name: "json",
    ending: "json",
    meaning: "one JSON object with columns and rows",
    is_of_one_trial: false,
    open: Some(|out, table| Ok(Box::new(Object::new(out, table)?))),
};

/// One object a line.
pub(super) const LINES: TraceFormat = TraceFormat {
    name: "jsonl",
    ending: "jsonl",
    meaning: "JSON lines: one object a row",
    is_of_one_trial: false,
    open: Some(|out, table| Ok(Box::new(Lines::new(out, table)?))),
};

struct Object<W> {
    out: W,
    is_first: bool,
}

impl<W: Write> Object<W> {
    fn new(mut out: W, table: &Table) -> io::Result<Self> {
        let (scenario, version) =
            (serde_json::to_string(&table.scenario)?, serde_json::to_string(&table.version)?);
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        let units: Vec<&str> = table.columns.iter().map(Column::unit).collect();
        let (names, units) = (serde_json::to_string(&names)?, serde_json::to_string(&units)?);
        write!(out, "{{\"schema\":1,\"scenario\":{scenario},\"seed\":{},\"version\":{version},", table.seed)?;
        write!(out, "\"columns\":{names},\"units\":{units},\"rows\":[")?;
        Ok(Self { out, is_first: true })
    }
}

impl<W: Write> Writer for Object<W> {
    fn row(&mut self, row: &[Value<'_>]) -> io::Result<()> {
        let cells = row.iter().map(cell).collect::<Result<Vec<_>, _>>()?;
        let before = if std::mem::take(&mut self.is_first) { "\n" } else { ",\n" };
        write!(self.out, "{before}[{}]", cells.join(","))
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.write_all(b"\n]}\n")?;
        self.out.flush()
    }
}

struct Lines<W> {
    out: W,
    keys: Vec<String>,
}

impl<W: Write> Lines<W> {
    fn new(out: W, table: &Table) -> io::Result<Self> {
        let keys = table.columns.iter().map(|column| serde_json::to_string(&column.name));
        Ok(Self { out, keys: keys.collect::<Result<_, _>>()? })
    }
}

impl<W: Write> Writer for Lines<W> {
    fn row(&mut self, row: &[Value<'_>]) -> io::Result<()> {
        for (k, (key, value)) in self.keys.iter().zip(row).enumerate() {
            write!(self.out, "{}{key}:{}", if k == 0 { '{' } else { ',' }, cell(value)?)?;
        }
        self.out.write_all(b"}\n")
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}

fn cell(value: &Value<'_>) -> serde_json::Result<String> {
    Ok(match value {
        Value::Number(number) if number.is_finite() => number.to_string(),
        Value::Number(_) | Value::Missing => "null".to_owned(),
        Value::Whole(whole) => whole.to_string(),
        Value::Word(word) => serde_json::to_string(word)?,
        Value::Truth(truth) => truth.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::samples::{HOSTILE, rows, table, text};
    use super::*;
    use serde_json::{Value as Json, json};

    #[test]
    fn every_line_is_an_object() {
        let text = text(&LINES, &table(), rows());
        let lines: Vec<Json> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(
            lines[0],
            json!({"time": 0, "trial": 3, "agent": HOSTILE, "x": 1.5, "y": -0.25, "vx": 0.3, "vy": 0.4,
                   "present": true, "gap": null, "n": -2, "phone": "idle"})
        );
        assert_eq!((&lines[1]["x"], &lines[1]["phone"]), (&Json::Null, &Json::Null));
    }

    #[test]
    fn the_object_has_columns_with_units_and_rows() {
        let object: Json = serde_json::from_str(&text(&OBJECT, &table(), rows())).unwrap();
        assert_eq!((&object["columns"][3], &object["units"][3]), (&json!("x"), &json!("m")));
        assert_eq!((&object["scenario"], &object["seed"]), (&json!(HOSTILE), &json!(7)));
        assert_eq!(object["rows"][0], json!([0, 3, HOSTILE, 1.5, -0.25, 0.3, 0.4, true, null, -2, "idle"]));
        let empty: Json = serde_json::from_str(&text(&OBJECT, &table(), Vec::new())).unwrap();
        assert_eq!(empty["rows"], json!([]));
    }
}
