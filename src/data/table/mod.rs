//! Traces as tables with typed columns, in many formats.
//!
//! A format is a [`TraceFormat`]: a name and what opens its [`Writer`]. Rows are written as they come; only formats whose
//! files begin with a directory of the whole keep them until the end. Numbers have the fewest digits that give the same
//! double back. A new format is a file with its writer, and one line in [`FORMATS`].

mod column;
mod csv;
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

use crate::base::geometry::{Segment, Shape};
use std::io::{self, Write};

/// All formats.
pub static FORMATS: [TraceFormat; 6] = [
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

/// Writes the rows of one table.
pub trait Writer {
    /// The next row: one value for each column of the table, of its kind.
    ///
    /// # Errors
    /// Errors of the file, and what the format cannot hold.
    fn row(&mut self, row: &[Value<'_>]) -> io::Result<()>;

    /// The table is complete.
    ///
    /// # Errors
    /// Errors of the file.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// Opens the writer of a table, which writes its head.
pub type Open = for<'w> fn(&'w mut dyn Write, &'w Table) -> io::Result<Box<dyn Writer + 'w>>;

/// A format of traces.
#[derive(Clone, Copy, Debug)]
pub struct TraceFormat {
    /// Its name in options.
    pub name: &'static str,
    /// How names of its files end, without the dot.
    pub ending: &'static str,
    /// What it is, in a line.
    pub meaning: &'static str,
    /// Whether it holds positions of agents in frames of one trial and nothing else.
    pub is_of_one_trial: bool,
    /// `None` where the crate was built without the feature of this name.
    pub open: Option<Open>,
}

impl TraceFormat {
    /// A format without which the crate was built. The feature has its name.
    #[allow(dead_code, reason = "with all features no format is left out")]
    const fn left_out(name: &'static str, ending: &'static str) -> Self {
        Self {
            name,
            ending,
            meaning: "not in this build: the feature of this name is off",
            is_of_one_trial: false,
            open: None,
        }
    }
}

/// What a table is about, and what is in its columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The columns, no two of one name.
    pub columns: Vec<Column>,
    /// Title of the scenario, any text.
    pub scenario: String,
    /// Seed of the trials.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// Time between two rows of an agent, s; 0 where it varies.
    pub interval: f64,
    /// What blocks agents: walls without an inside.
    pub walls: Vec<Segment>,
    /// What blocks agents: solid shapes.
    pub solids: Vec<Shape>,
}

impl Table {
    /// Place of the column of a name.
    fn place(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }
}

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
