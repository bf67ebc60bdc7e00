//! Traces as CSV (RFC 4180, lines end with a line feed).
//!
//! `present` is 1 or 0. Infinite numbers are `inf` and `-inf`; what is absent or not a number is empty.

use super::row::{COLUMNS, Row};
use std::io::{self, Write};

/// Writes a header and all rows; returns their number.
///
/// # Errors
/// Errors of the writer, and a row whose signals do not match `signals`.
pub fn write_csv<'a>(
    out: impl Write,
    signals: &[&str],
    rows: impl IntoIterator<Item = Row<'a>>,
) -> io::Result<u64> {
    write(csv::Writer::from_writer(out), signals, rows).map_err(|error| match error.into_kind() {
        // The kind of the error distinguishes a closed pipe from other failures.
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    })
}

fn write<'a>(
    mut table: csv::Writer<impl Write>,
    signals: &[&str],
    rows: impl IntoIterator<Item = Row<'a>>,
) -> csv::Result<u64> {
    table.write_record(COLUMNS.iter().chain(signals))?;
    let mut count = 0;
    for row in rows {
        row.checked(signals)?;
        table.write_field(cell(Some(row.time)))?;
        table.write_field(row.trial.to_string())?;
        table.write_field(row.agent.as_bytes())?;
        for value in row.motion() {
            table.write_field(cell(value))?;
        }
        table.write_field(if row.present { "1" } else { "0" })?;
        for &value in row.signals.iter() {
            table.write_field(cell(Some(value)))?;
        }
        for word in &row.words {
            table.write_field(word)?;
        }
        table.write_record(None::<&[u8]>)?;
        count += 1;
    }
    table.flush()?;
    Ok(count)
}

fn cell(value: Option<f64>) -> String {
    match value {
        Some(value) if !value.is_nan() => value.to_string(),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::row::samples;
    use super::*;

    #[test]
    fn absent_people_have_empty_cells_and_names_are_quoted() {
        let mut out = Vec::new();
        assert_eq!(write_csv(&mut out, &["gap"], samples::rows()).unwrap(), 2);
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "time,trial,agent,x,y,vx,vy,speed,present,gap\n\
             0.02,3,oncoming[2],1.5,-0.25,0.3,0.4,0.5,1,inf\n\
             0.04,3,\"a, \"\"b\"\"\",,,,,,0,\n"
        );
    }

    #[test]
    fn a_row_that_does_not_fit_is_refused() {
        let error = write_csv(Vec::new(), &[], samples::rows()).unwrap_err();
        assert_eq!(error.to_string(), "a row has 1 signals where there are 0 names");
    }
}
