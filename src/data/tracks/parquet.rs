//! Reader of traces as Apache Parquet, as `smc simulate --format parquet` writes them: the columns of
//! [`super::jsonl`], with `agent` as text. Errors count rows instead of lines.

use super::line::LineError;
use super::recording::Recording;

/// Reads a trial of a whole file. Rows of agents that are absent are passed over.
///
/// # Errors
/// The crate was built without the feature `parquet`.
#[cfg(not(feature = "parquet"))]
pub fn read_parquet(_: &[u8], _: Option<u64>) -> Result<Recording, Vec<LineError>> {
    let message = "this program was built without the feature `parquet`: build it with `--features parquet`";
    Err(vec![LineError::of_file(message)])
}

#[cfg(feature = "parquet")]
pub use with_feature::read_parquet;

#[cfg(feature = "parquet")]
mod with_feature {
    use super::{LineError, Recording};
    use crate::base::geometry::{Vec2, coordinate_fault};
    use crate::data::tracks::line::quoted;
    use crate::data::tracks::rows::{TimedRow, Traces};
    use bytes::Bytes;
    use parquet::errors::ParquetError;
    use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::{Field, Row};

    /// Most rows of a table: few bytes can claim any number.
    const MOST_ROWS: u64 = 1 << 26;
    /// The columns of who was where.
    const OWN: [&str; 8] = ["time", "trial", "agent", "x", "y", "vx", "vy", "present"];
    /// After so many errors the rest of the table is not read.
    const MOST_ERRORS: usize = 20;

    /// Reads a trial of a whole file. Rows of agents that are absent are passed over.
    ///
    /// # Errors
    /// What is no Parquet file or has no such columns, and every bad row, as a table of comma-separated values.
    pub fn read_parquet(bytes: &[u8], trial: Option<u64>) -> Result<Recording, Vec<LineError>> {
        // The crate `parquet` asserts what a damaged file breaks.
        std::panic::catch_unwind(|| read(bytes, trial))
            .unwrap_or_else(|_| Err(vec![LineError::of_file("the file is damaged")]))
    }

    fn read(bytes: &[u8], trial: Option<u64>) -> Result<Recording, Vec<LineError>> {
        let damaged = |error: ParquetError| vec![LineError::of_file(format!("the file is damaged: {error}"))];
        let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).map_err(damaged)?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let missing = ["time", "agent", "x", "y"]
            .into_iter()
            .filter(|name| schema.columns().iter().all(|column| column.name() != *name))
            .map(|name| LineError::of_file(format!("the table has no column `{name}`")));
        let mut errors: Vec<LineError> = missing.collect();
        if !errors.is_empty() {
            return Err(errors);
        }
        let groups = reader.metadata().row_groups();
        let is_inside = |column: &ColumnChunkMetaData| {
            let start = column.dictionary_page_offset().unwrap_or_else(|| column.data_page_offset());
            let end = start.checked_add(column.compressed_size());
            start >= 0 && end.is_some_and(|end| end >= start && end <= bytes.len() as i64)
        };
        if !groups.iter().flat_map(RowGroupMetaData::columns).all(is_inside) {
            return Err(vec![LineError::of_file("the file is damaged: a column lies outside of it")]);
        }
        let rows = groups.iter().map(|group| group.num_rows() as u64).fold(0, u64::saturating_add);
        if rows > MOST_ROWS {
            let message = format!("the file says that it has {rows} rows, more than {MOST_ROWS}");
            return Err(vec![LineError::of_file(message)]);
        }
        let mut traces = Traces::default();
        for (k, row) in reader.get_row_iter(None).map_err(damaged)?.enumerate() {
            // What comes after a damaged row is damaged too.
            let row = row.map_err(damaged)?;
            if let Err(message) = read_row(k + 1, &row, &mut traces) {
                errors.push(LineError::whole(k + 1, message));
            }
            if errors.len() >= MOST_ERRORS {
                return Err(errors);
            }
        }
        traces.recording(errors, trial)
    }

    fn read_row(line: usize, row: &Row, traces: &mut Traces) -> Result<(), String> {
        let field =
            |wanted: &str| row.get_column_iter().find(|(name, _)| *name == wanted).map(|(_, field)| field);
        if field("present") == Some(&Field::Bool(false)) {
            return Ok(());
        }
        let number = |name: &str| match field(name) {
            Some(Field::Double(number)) if number.is_finite() => Ok(*number),
            other => Err(format!("{name} must be a finite number (got {})", shown(other))),
        };
        let id = match field("agent") {
            Some(Field::Str(name)) => traces.place(name),
            other => return Err(format!("agent must be text (got {})", shown(other))),
        };
        let trial = match field("trial") {
            None => None,
            Some(Field::Long(trial)) if *trial >= 0 => Some(*trial as u64),
            other => return Err(format!("trial must be a whole number (got {})", shown(other))),
        };
        let position = Vec2::new(number("x")?, number("y")?);
        let has_velocity = field("vx").is_some() && field("vy").is_some();
        let velocity = if has_velocity { Some(Vec2::new(number("vx")?, number("vy")?)) } else { None };
        if let Some(fault) = coordinate_fault(position) {
            return Err(fault);
        }
        traces.push(trial, TimedRow { line, time: number("time")?, id, position, velocity });
        for (name, field) in row.get_column_iter().filter(|(name, _)| !OWN.contains(&name.as_str())) {
            let value = match field {
                Field::Double(value) => *value,
                Field::Float(value) => f64::from(*value),
                Field::Long(value) => *value as f64,
                Field::Int(value) => f64::from(*value),
                _ => continue,
            };
            traces.columns.push(name, line, value);
        }
        Ok(())
    }

    fn shown(field: Option<&Field>) -> String {
        field.map_or_else(|| "nothing".to_owned(), |field| quoted(&field.to_string()))
    }
}
