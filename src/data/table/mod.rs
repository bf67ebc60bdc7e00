//! Traces as tables with typed columns, in many formats.
//!
//! A format is a [`TraceFormat`]: a name and what opens its [`Writer`]. Rows are written as they come; only formats whose
//! files begin with a directory of the whole keep them until the end. Numbers have the fewest digits that give the same
//! double back. A new format is a file with its writer, and one line in [`FORMATS`].

mod column;
mod csv;
mod format;
mod json;
#[cfg(feature = "parquet")]
mod parquet;
mod pedpy;
#[cfg(feature = "sqlite")]
mod sqlite;
mod trajectory;
#[cfg(feature = "sqlite")]
mod walkable;

pub use self::csv::CSV;
pub use column::{Column, Kind, Value};
pub use format::{Open, Table, TraceFormat, Writer};

use std::io::{self, Write};

/// All formats.
pub static FORMATS: &[TraceFormat] = &[
    CSV,
    json::OBJECT,
    json::LINES,
    pedpy::PEDPY,
    #[cfg(feature = "parquet")]
    parquet::PARQUET,
    #[cfg(not(feature = "parquet"))]
    TraceFormat::left_out("parquet", "parquet"),
    #[cfg(feature = "sqlite")]
    sqlite::SQLITE,
    #[cfg(not(feature = "sqlite"))]
    TraceFormat::left_out("sqlite", "sqlite"),
];

/// Writes a table; returns the number of its rows.
///
/// # Errors
/// Errors of the file, what the format cannot hold, and a row that does not fit the columns.
pub fn write<'a>(
    format: &TraceFormat,
    out: &mut dyn Write,
    table: &Table,
    rows: impl IntoIterator<Item = Vec<Value<'a>>>,
) -> io::Result<u64> {
    let refuse = |message: String| io::Error::new(io::ErrorKind::InvalidInput, message);
    let open = format.open.ok_or_else(|| refuse(format!("the feature `{}` is off", format.name)))?;
    let mut writer = open(out, table)?;
    let mut count = 0;
    for row in rows {
        if row.len() != table.columns.len() {
            let (found, wanted) = (row.len(), table.columns.len());
            return Err(refuse(format!("a row has {found} values where there are {wanted} columns")));
        }
        if let Some((_, column)) =
            row.iter().zip(&table.columns).find(|(value, column)| !value.fits(column.kind))
        {
            return Err(refuse(format!("a value of column `{}` is of another kind", column.name)));
        }
        writer.row(&row)?;
        count += 1;
    }
    writer.finish()?;
    Ok(count)
}

#[cfg(test)]
mod samples;
