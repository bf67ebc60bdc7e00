//! Traces as Apache Parquet: numbers are `DOUBLE`, whole numbers `INT64`, words `UTF8` and truth values `BOOLEAN`; each may be
//! missing. The metadata of the file have `scenario`, `seed`, `version` and, as a JSON object by column, `units`.

use super::column::{Column, Kind, Value};
use super::format::{Table, TraceFormat, Writer};
use ::parquet::basic::{LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::types::Type;
use std::io::{self, Write};
use std::mem::take;
use std::sync::Arc;

/// Rows of a group, which are in memory at one time.
const GROUP: usize = 1 << 16;

/// Parquet.
pub(super) const PARQUET: TraceFormat = TraceFormat {
    name: "parquet",
    ending: "parquet",
    meaning: "Apache Parquet with typed columns",
    is_of_one_trial: false,
    open: Some(|out, table| Ok(Box::new(Parquet::new(out, table)?))),
};

/// The values of a column since the last group, and for each row whether there is one.
struct Cells {
    values: Values,
    levels: Vec<i16>,
}

enum Values {
    Number(Vec<f64>),
    Whole(Vec<i64>),
    Word(Vec<ByteArray>),
    Truth(Vec<bool>),
}

impl Cells {
    fn new(kind: Kind) -> Self {
        let values = match kind {
            Kind::Number(_) => Values::Number(Vec::new()),
            Kind::Whole => Values::Whole(Vec::new()),
            Kind::Word => Values::Word(Vec::new()),
            Kind::Truth => Values::Truth(Vec::new()),
        };
        Self { values, levels: Vec::new() }
    }

    fn push(&mut self, value: &Value<'_>) {
        match (&mut self.values, value) {
            (Values::Number(list), Value::Number(number)) if !number.is_nan() => list.push(*number),
            (Values::Whole(list), Value::Whole(whole)) => list.push(*whole),
            (Values::Word(list), Value::Word(word)) => list.push(ByteArray::from(word.as_ref())),
            (Values::Truth(list), Value::Truth(truth)) => list.push(*truth),
            _ => return self.levels.push(0),
        }
        self.levels.push(1);
    }

    fn write(&mut self, column: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let levels = Some(self.levels.as_slice());
        match &mut self.values {
            Values::Number(list) => column.typed::<DoubleType>().write_batch(&take(list), levels, None)?,
            Values::Whole(list) => column.typed::<Int64Type>().write_batch(&take(list), levels, None)?,
            Values::Word(list) => column.typed::<ByteArrayType>().write_batch(&take(list), levels, None)?,
            Values::Truth(list) => column.typed::<BoolType>().write_batch(&take(list), levels, None)?,
        };
        self.levels.clear();
        Ok(())
    }
}

/// Groups are made in memory, and handed on when they are complete.
struct Parquet<W> {
    out: W,
    file: SerializedFileWriter<Vec<u8>>,
    cells: Vec<Cells>,
    rows: usize,
}

impl<W: Write> Parquet<W> {
    fn new(out: W, table: &Table) -> io::Result<Self> {
        let column = |column: &Column| {
            let (physical, logical) = match column.kind {
                Kind::Number(_) => (Physical::DOUBLE, None),
                Kind::Whole => (Physical::INT64, None),
                Kind::Word => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
                Kind::Truth => (Physical::BOOLEAN, None),
            };
            let build = Type::primitive_type_builder(&column.name, physical);
            build.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build().map(Arc::new)
        };
        let columns = table.columns.iter().map(column).collect::<Result<Vec<_>, _>>().map_err(failed)?;
        let schema = Type::group_type_builder("traces").with_fields(columns).build().map_err(failed)?;
        let units: serde_json::Map<String, serde_json::Value> = (table.columns.iter())
            .filter(|column| !column.unit().is_empty())
            .map(|column| (column.name.clone(), column.unit().into()))
            .collect();
        let about = [
            ("scenario", table.scenario.clone()),
            ("seed", table.seed.to_string()),
            ("version", table.version.clone()),
            ("units", serde_json::to_string(&units)?),
        ];
        let about = about.map(|(key, value)| KeyValue::new(key.to_owned(), value)).to_vec();
        let properties = WriterProperties::builder()
            .set_created_by(format!("smc version {}", table.version))
            .set_key_value_metadata(Some(about))
            .build();
        let file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties));
        let cells = table.columns.iter().map(|column| Cells::new(column.kind)).collect();
        Ok(Self { out, file: file.map_err(failed)?, cells, rows: 0 })
    }

    /// Ends a group of rows.
    fn group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        for cells in &mut self.cells {
            let Some(mut column) = group.next_column()? else { break };
            cells.write(&mut column)?;
            column.close()?;
        }
        group.close()?;
        self.rows = 0;
        self.file.flush()?;
        Ok(())
    }

    /// Hands on what is complete. The places of groups count what has been written, not what is kept.
    fn hand_on(&mut self) -> io::Result<()> {
        let made = take(self.file.inner_mut());
        self.out.write_all(&made)
    }
}

fn failed(error: ParquetError) -> io::Error {
    io::Error::other(error)
}

impl<W: Write> Writer for Parquet<W> {
    fn row(&mut self, row: &[Value<'_>]) -> io::Result<()> {
        for (cells, value) in self.cells.iter_mut().zip(row) {
            cells.push(value);
        }
        self.rows += 1;
        if self.rows < GROUP {
            return Ok(());
        }
        self.group().map_err(failed)?;
        self.hand_on()
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        if self.rows > 0 {
            self.group().map_err(failed)?;
        }
        self.file.finish().map_err(failed)?;
        self.hand_on()?;
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{HOSTILE, bytes, rows, table};
    use super::*;
    use ::bytes::Bytes;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::Field;

    #[test]
    fn columns_are_typed_and_the_metadata_say_what_they_are_about() {
        let file = bytes(&PARQUET, &table(), rows()).unwrap();
        let reader = SerializedFileReader::new(Bytes::from(file)).unwrap();
        let rows: Vec<Vec<(String, Field)>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(name, f)| (name.clone(), f.clone())).collect())
            .collect();
        let values = |row: usize| rows[row].iter().map(|(_, field)| field.clone()).collect::<Vec<_>>();
        let (double, null) = (Field::Double, Field::Null);
        let (name, idle) = (Field::Str(HOSTILE.into()), Field::Str("idle".into()));
        assert_eq!(
            values(0),
            [
                double(0.0),
                Field::Long(3),
                name,
                double(1.5),
                double(-0.25),
                double(0.3),
                double(0.4),
                Field::Bool(true),
                double(f64::INFINITY),
                Field::Long(-2),
                idle
            ]
        );
        assert_eq!(values(1)[3..7], [null.clone(), null.clone(), null.clone(), null]);
        let about = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
        let of = |key: &str| about.iter().find(|one| one.key == key).unwrap().value.clone().unwrap();
        assert_eq!((of("scenario"), of("seed"), of("version")), (HOSTILE.into(), "7".into(), "0.1.0".into()));
        let units: serde_json::Value = serde_json::from_str(&of("units")).unwrap();
        assert_eq!((&units["vx"], &units["gap"]), (&"m/s".into(), &serde_json::Value::Null));
    }

    #[test]
    fn groups_follow_each_other() {
        let mut many = Vec::new();
        for k in 0..GROUP + 5 {
            let mut row = rows()[0].clone();
            row[0] = Value::Number(k as f64);
            many.push(row);
        }
        let file = bytes(&PARQUET, &table(), many).unwrap();
        let reader = SerializedFileReader::new(Bytes::from(file)).unwrap();
        assert_eq!(reader.metadata().num_row_groups(), 2);
        let last = reader.get_row_iter(None).unwrap().last().unwrap().unwrap();
        assert_eq!(last.get_column_iter().next().unwrap().1, &Field::Double((GROUP + 4) as f64));
    }
}
