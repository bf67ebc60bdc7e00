//! The formats of recordings: one table, which reading, options and messages use.

use super::batch::Batch;
use super::cells::{cells, separator};
use super::csv::{is_person, read_columns};
use super::eth_biwi::read_table;
use super::jsonl::read_json_lines;
use super::line::LineError;
use super::observations::{read_identified, read_observations};
use super::parquet::read_parquet;
use super::pedpy::read_pedpy;
use super::plausible::Doubt;
use super::recording::{Recording, Velocity};
use super::sqlite::read_sqlite;
use super::trajnet::read_trajnet;

/// What a file does not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Frames per second of a table with frames.
    pub frames_per_second: Option<f64>,
    /// The trial of a table with several.
    pub trial: Option<u64>,
    /// The columns of a table without a header, with commas: `id,frame,x/cm,y/cm`.
    pub columns: Option<String>,
}

type Read<T> = fn(&str, &Reading) -> Result<T, Vec<LineError>>;

/// What reads a file.
#[derive(Clone, Copy, Debug)]
enum Reader {
    Text(Read<Recording>),
    Bytes(fn(&[u8], &Reading) -> Result<Recording, Vec<LineError>>),
}

/// A format of recordings.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its name in scenarios and options.
    pub name: &'static str,
    read: Reader,
    /// Whether its tables can have several trials.
    has_trials: bool,
    /// Reads batches whose people need no ids; `None` where all people have one.
    read_batches: Option<Read<Vec<Batch>>>,
    /// Whether a file with this first line that is not empty has the format.
    begins: fn(&str) -> bool,
}

/// All formats, in the order in which the first line of a file is tried.
static FORMATS: [Format; 8] = [
    Format {
        name: "parquet",
        read: Reader::Bytes(|bytes, reading| read_parquet(bytes, reading.trial)),
        has_trials: true,
        read_batches: None,
        begins: |line| line.starts_with("PAR1"),
    },
    Format {
        name: "sqlite",
        read: Reader::Bytes(|bytes, _| read_sqlite(bytes)),
        has_trials: false,
        read_batches: None,
        begins: |line| line.starts_with("SQLite format 3"),
    },
    Format {
        name: "jsonl",
        read: Reader::Text(|text, reading| read_json_lines(text, reading.trial)),
        has_trials: true,
        read_batches: None,
        begins: |line| line.starts_with('{') && line.contains("\"agent\":"),
    },
    Format {
        name: "eth_biwi",
        read: Reader::Text(|text, reading| read_table(text, reading.frames_per_second)),
        has_trials: false,
        read_batches: None,
        begins: |line| line.split_whitespace().filter(|field| field.parse::<f64>().is_ok()).count() == 8,
    },
    Format {
        name: "trajnet",
        read: Reader::Text(|text, reading| read_trajnet(text, reading.frames_per_second)),
        has_trials: false,
        read_batches: None,
        begins: |line| line.starts_with('{') && (line.contains("\"scene\"") || line.contains("\"track\"")),
    },
    Format {
        name: "csv",
        read: Reader::Text(read_columns),
        has_trials: true,
        read_batches: None,
        begins: |line| cells(line, separator(line)).any(|(_, name)| is_person(&name)),
    },
    Format {
        name: "pedpy",
        read: Reader::Text(|text, reading| read_pedpy(text, reading.frames_per_second)),
        has_trials: false,
        read_batches: None,
        begins: |line| line.starts_with('#') || (4..6).contains(&line.split_whitespace().count()),
    },
    Format {
        name: "observations",
        read: Reader::Text(|text, _| read_identified(text)),
        has_trials: false,
        read_batches: Some(|text, _| read_observations(text)),
        begins: |line| line.starts_with('{') && line.contains("\"seen\""),
    },
];

/// The format of tables whose columns can be named.
const COLUMNS: &str = "csv";

/// The formats whose files have times, so that they need no rate.
const TIMED: [&str; 4] = ["parquet", "sqlite", "jsonl", "observations"];

impl Format {
    /// All formats.
    pub fn all() -> &'static [Self] {
        &FORMATS
    }

    /// The format of that name.
    pub fn from_name(name: &str) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.name == name)
    }

    /// The format that the first line of a file shows.
    pub fn of(bytes: impl AsRef<[u8]>) -> Option<&'static Self> {
        let text = String::from_utf8_lossy(unmarked(bytes.as_ref()));
        let line = text.lines().map(str::trim).find(|line| !line.is_empty())?;
        FORMATS.iter().find(|format| (format.begins)(line))
    }

    /// Reads a recording, in which everybody has an id.
    ///
    /// # Errors
    /// All errors of the file, in the order of its lines.
    pub fn read(&self, bytes: impl AsRef<[u8]>, reading: &Reading) -> Result<Recording, Vec<LineError>> {
        self.check(reading)?;
        match self.read {
            Reader::Text(read) => read(text(bytes.as_ref())?, reading),
            Reader::Bytes(read) => read(bytes.as_ref(), reading),
        }
    }

    /// Whether the format has what is asked for.
    fn check(&self, reading: &Reading) -> Result<(), Vec<LineError>> {
        let said = match reading {
            Reading { columns: Some(_), .. } if self.name != COLUMNS => {
                "columns of its own: read it as `csv`"
            }
            Reading { trial: Some(_), .. } if !self.has_trials => "no trials to choose from",
            Reading { frames_per_second: Some(_), .. } if TIMED.contains(&self.name) => {
                "times, so it takes no number of frames per second"
            }
            _ => return Ok(()),
        };
        Err(vec![LineError::of_file(format!("`{}` has {said}", self.name))])
    }

    /// The implausible number of a recording with these velocities, if every agent has an id.
    pub fn doubt(&self, bytes: impl AsRef<[u8]>, reading: &Reading, velocity: Velocity) -> Option<Doubt> {
        self.read(bytes, reading).ok()?.with(velocity).doubt()
    }

    /// Reads batches of observations, with the recorded velocities or none.
    ///
    /// # Errors
    /// All errors of the file, in the order of its lines.
    pub fn read_batches(
        &self,
        bytes: impl AsRef<[u8]>,
        reading: &Reading,
        velocity: Velocity,
    ) -> Result<Vec<Batch>, Vec<LineError>> {
        let Some(read) = self.read_batches else {
            return Ok(self.read(bytes, reading)?.with(velocity).batches());
        };
        self.check(reading)?;
        let mut batches = read(text(bytes.as_ref())?, reading)?;
        if velocity == Velocity::Seen {
            batches.iter_mut().flat_map(|batch| &mut batch.seen).for_each(|one| one.velocity = None);
        }
        Ok(batches)
    }
}

/// A text without the mark of UTF-8 that some programs write first.
fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes)
}

fn text(bytes: &[u8]) -> Result<&str, Vec<LineError>> {
    std::str::from_utf8(unmarked(bytes)).map_err(|_| vec![LineError::of_file("the file is not UTF-8 text")])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_shows_the_format() {
        let lines = [
            ("jsonl", "{\"time\":0,\"trial\":0,\"agent\":\"1\",\"x\":0,\"y\":0,\"phone\":\"seen\"}"),
            ("eth_biwi", "\n 1.0e0 1 0 0 0 0 0 0\n"),
            ("trajnet", "{\"track\": {\"f\": 1, \"p\": 1, \"x\": 0, \"y\": 0}}\n{\"scene\": {\"fps\": 2}}"),
            ("csv", "\u{feff}time,id,x,y\n0,1,0,0\n"),
            ("pedpy", "# framerate: 25\n1 0 0 0\n"),
            ("observations", "{\"t\":0,\"seen\":[{\"x\":0,\"y\":0,\"id\":1}]}"),
        ];
        assert_eq!(
            lines.map(|(name, _)| name).to_vec(),
            Format::all().iter().map(|f| f.name).skip(2).collect::<Vec<_>>()
        );
        for (name, text) in lines {
            let format = Format::of(text).unwrap();
            assert_eq!(format.name, name);
            assert_eq!(Format::from_name(name).unwrap().name, name);
            let recording = format.read(text, &Reading::default()).unwrap();
            assert_eq!(recording.ids().collect::<Vec<_>>(), [1]);
            let batches = format.read_batches(text, &Reading::default(), Velocity::Seen).unwrap();
            assert_eq!(batches, recording.with(Velocity::Seen).batches());
        }
        assert!(Format::of("hello").is_none() && Format::of("").is_none());
    }
}
