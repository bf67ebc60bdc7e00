//! Traces as JSON: lines with one object each, or one object with columns and rows.
//!
//! What is absent, infinite or not a number is `null`, as JSON has no other word for it.

use super::row::{COLUMNS, Row};
use std::io::{self, Write};

/// Writes one object per row and line; returns the number of rows.
///
/// # Errors
/// Errors of the writer, and a row whose signals do not match `signals`.
pub fn write_json_lines<'a>(
    mut out: impl Write,
    signals: &[&str],
    rows: impl IntoIterator<Item = Row<'a>>,
) -> io::Result<u64> {
    let mut keys = Vec::new();
    for name in COLUMNS.iter().chain(signals) {
        keys.push(serde_json::to_string(name)?);
    }
    let mut count = 0;
    for row in rows {
        row.checked(signals)?;
        for (k, value) in cells(&row)?.into_iter().enumerate() {
            write!(out, "{}{}:{value}", if k == 0 { '{' } else { ',' }, keys[k])?;
        }
        out.write_all(b"}\n")?;
        count += 1;
    }
    out.flush()?;
    Ok(count)
}

/// Writes one object, `{"schema": 1, "columns": [...], "rows": [[...], ...]}`, one row a line; returns the
/// number of rows.
///
/// # Errors
/// Errors of the writer, and a row whose signals do not match `signals`.
pub fn write_json<'a>(
    mut out: impl Write,
    signals: &[&str],
    rows: impl IntoIterator<Item = Row<'a>>,
) -> io::Result<u64> {
    let columns: Vec<&str> = COLUMNS.iter().chain(signals).copied().collect();
    write!(out, "{{\"schema\":1,\"columns\":{},\"rows\":[", serde_json::to_string(&columns)?)?;
    let mut count = 0;
    for row in rows {
        row.checked(signals)?;
        write!(out, "{}[{}]", if count == 0 { "\n" } else { ",\n" }, cells(&row)?.join(","))?;
        count += 1;
    }
    out.write_all(b"\n]}\n")?;
    out.flush()?;
    Ok(count)
}

fn cells(row: &Row<'_>) -> io::Result<Vec<String>> {
    let mut cells = vec![number(Some(row.time)), row.trial.to_string(), serde_json::to_string(&row.agent)?];
    cells.extend(row.motion().map(number));
    cells.push(row.present.to_string());
    cells.extend(row.signals.iter().map(|&value| number(Some(value))));
    for word in &row.words {
        cells.push(if word.is_empty() { "null".into() } else { serde_json::to_string(word)? });
    }
    Ok(cells)
}

fn number(value: Option<f64>) -> String {
    match value {
        Some(value) if value.is_finite() => value.to_string(),
        _ => "null".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::row::samples;
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn every_line_is_an_object() {
        let mut out = Vec::new();
        assert_eq!(write_json_lines(&mut out, &["gap"], samples::rows()).unwrap(), 2);
        let lines: Vec<Value> = out
            .split(|&b| b == b'\n')
            .filter(|l| !l.is_empty())
            .map(|l| serde_json::from_slice(l).unwrap())
            .collect();
        assert_eq!(
            lines[0],
            json!({"time": 0.02, "trial": 3, "agent": "oncoming[2]", "x": 1.5, "y": -0.25, "vx": 0.3, "vy": 0.4,
                   "speed": 0.5, "present": true, "gap": null})
        );
        assert_eq!(lines[1]["x"], Value::Null);
        assert_eq!(lines[1]["agent"], "a, \"b\"");
    }

    #[test]
    fn words_come_after_signals() {
        let mut row = samples::rows()[0].clone();
        row.words = vec!["looking", ""];
        let mut out = Vec::new();
        write_json_lines(&mut out, &["gap", "phone", "pace"], [row]).unwrap();
        let line: Value = serde_json::from_slice(&out).unwrap();
        assert_eq!((&line["phone"], &line["pace"]), (&json!("looking"), &Value::Null));
    }

    #[test]
    fn the_object_has_columns_and_rows() {
        let mut out = Vec::new();
        write_json(&mut out, &["gap"], samples::rows()).unwrap();
        let table: Value = serde_json::from_slice(&out).unwrap();
        assert_eq!(table["columns"][9], "gap");
        assert_eq!(table["rows"][0], json!([0.02, 3, "oncoming[2]", 1.5, -0.25, 0.3, 0.4, 0.5, true, null]));
        let mut empty = Vec::new();
        write_json(&mut empty, &[], []).unwrap();
        assert_eq!(serde_json::from_slice::<Value>(&empty).unwrap()["rows"], json!([]));
    }
}
