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
#[cfg(test)]
mod samples;
#[cfg(feature = "sqlite")]
mod sqlite;
mod trajectory;
#[cfg(feature = "sqlite")]
mod walkable;

pub use self::csv::CSV;
pub use column::{Column, Kind, Value};
pub use format::{Open, Table, TraceFormat, Writer};
use std::io;
use std::io::Write;
use trajectory::Trajectory;

/// All formats.
pub static FORMATS: &[TraceFormat] = &[
    CSV,
    json::OBJECT,
    json::LINES,
    PEDPY,
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

// Trajectories as text of `PedPy` and `JuPedSim`: comments with the frame rate and the unit, then rows `id frame x y` in
// metres.
//
// `PedPy` finds the rate and the unit in all comments at the beginning (`load_trajectory_from_txt`), so no text of a user is
// written there: a title `walk in cm` would change the unit.

/// The text format.
const PEDPY: TraceFormat = TraceFormat {
    name: "pedpy",
    ending: "txt",
    meaning: "trajectories as text that PedPy and JuPedSim read, one trial",
    is_of_one_trial: true,
    open: Some(|out, table| Ok(Box::new(Text::new(out, table)?))),
};

struct Text<W> {
    out: W,
    trajectory: Trajectory,
}

impl<W: Write> Text<W> {
    fn new(mut out: W, table: &Table) -> io::Result<Self> {
        let trajectory = Trajectory::new(table)?;
        writeln!(out, "# framerate: {}", 1.0 / table.interval)?;
        writeln!(out, "# smc {}, seed {}", table.version, table.seed)?;
        writeln!(out, "# id frame x/m y/m")?;
        Ok(Self { out, trajectory })
    }
}

impl<W: Write> Writer for Text<W> {
    fn row(&mut self, row: &[Value<'_>]) -> io::Result<()> {
        let Some(point) = self.trajectory.point(row)? else { return Ok(()) };
        writeln!(self.out, "{} {} {} {}", point.id, point.frame, point.position.x, point.position.y)
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::samples::{bytes, rows, table, text};
    use super::*;

    #[test]
    fn comments_have_the_rate_and_the_unit_and_no_names() {
        let mut more = rows();
        more.extend(rows());
        more[2][0] = Value::Number(0.2);
        more[2][2] = Value::Word("b".into());
        assert_eq!(
            text(&PEDPY, &table(), more),
            "# framerate: 10\n# smc 0.1.0, seed 7\n# id frame x/m y/m\n1 0 1.5 -0.25\n2 2 1.5 -0.25\n"
        );
    }

    #[test]
    fn a_second_trial_and_a_table_without_frames_are_refused() {
        let mut two = rows();
        two[1][1] = Value::Whole(4);
        assert_eq!(bytes(&PEDPY, &table(), two).unwrap_err().to_string(), "the format holds one trial");
        let jumps = Table { interval: 0.0, ..table() };
        assert!(bytes(&PEDPY, &jumps, rows()).unwrap_err().to_string().contains("always the same"));
        let states = Table { columns: table().columns[..3].to_vec(), ..table() };
        assert!(bytes(&PEDPY, &states, Vec::new()).unwrap_err().to_string().contains("no column `x`"));
    }
}
