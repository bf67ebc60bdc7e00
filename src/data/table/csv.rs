//! Traces as CSV (RFC 4180, lines end with a line feed).
//!
//! Truth values are 1 and 0. Infinite numbers are `inf` and `-inf`; what is missing is empty.

use super::column::Value;
use super::format::{Table, TraceFormat, Writer};
use std::borrow::Cow;
use std::io::{self, Write};

/// Comma-separated values.
pub const CSV: TraceFormat = TraceFormat {
    name: "csv",
    ending: "csv",
    meaning: "comma-separated values",
    is_of_one_trial: false,
    open: Some(|out, table| Ok(Box::new(Csv::new(out, table)?))),
};

struct Csv<W: Write>(csv::Writer<W>);

impl<W: Write> Csv<W> {
    fn new(out: W, table: &Table) -> io::Result<Self> {
        let mut rows = csv::Writer::from_writer(out);
        rows.write_record(table.columns.iter().map(|column| &column.name)).map_err(failed)?;
        Ok(Self(rows))
    }
}

/// The kind of the error distinguishes a closed pipe from other failures.
fn failed(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

impl<W: Write> Writer for Csv<W> {
    fn row(&mut self, row: &[Value<'_>]) -> io::Result<()> {
        for value in row {
            let cell: Cow<'_, str> = match value {
                Value::Number(number) if !number.is_nan() => number.to_string().into(),
                Value::Number(_) | Value::Missing => "".into(),
                Value::Whole(whole) => whole.to_string().into(),
                Value::Word(word) => Cow::Borrowed(word),
                Value::Truth(truth) => if *truth { "1" } else { "0" }.into(),
            };
            self.0.write_field(cell.as_bytes()).map_err(failed)?;
        }
        self.0.write_record(None::<&[u8]>).map_err(failed)
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{rows, table, text};
    use super::*;

    #[test]
    fn absent_people_have_empty_cells_and_names_are_quoted() {
        assert_eq!(
            text(&CSV, &table(), rows()),
            "time,trial,agent,x,y,vx,vy,present,gap,n,phone\n\
             0,3,\"cm,\"\"\n</script>\",1.5,-0.25,0.3,0.4,1,inf,-2,idle\n\
             0.1,3,\"cm,\"\"\n</script>\",,,,,0,,7,\n"
        );
    }
}
