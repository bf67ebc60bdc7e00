//! What a format of traces is, and the table that it writes.

use super::column::{Column, Value};
use crate::base::geometry::{Segment, Shape};
use std::io::{self, Write};

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
    pub(super) const fn left_out(name: &'static str, ending: &'static str) -> Self {
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
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }
}
