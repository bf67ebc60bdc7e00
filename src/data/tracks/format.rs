//! The formats of recordings: one table, which reading, options and messages use.

use super::batch::Batch;
use super::csv::read_csv;
use super::eth_biwi::read_eth_biwi;
use super::line::LineError;
use super::observations::{read_identified, read_observations};
use super::pedpy::read_pedpy;
use super::recording::{Recording, Velocity};
use super::trajnet::read_trajnet;

/// What a file does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Frames per second of a table with frames.
    pub frames_per_second: Option<f64>,
}

type Read<T> = fn(&str, &Reading) -> Result<T, Vec<LineError>>;

/// A format of recordings.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its name in scenarios and options.
    pub name: &'static str,
    read: Read<Recording>,
    /// Reads batches whose people need no ids; `None` where all people have one.
    read_batches: Option<Read<Vec<Batch>>>,
    /// Whether a file with this first line that is not empty has the format.
    begins: fn(&str) -> bool,
}

/// All formats, in the order in which the first line of a file is tried.
static FORMATS: [Format; 5] = [
    Format {
        name: "eth_biwi",
        read: |text, _| read_eth_biwi(text),
        read_batches: None,
        begins: |line| line.split_whitespace().filter(|field| field.parse::<f64>().is_ok()).count() == 8,
    },
    Format {
        name: "trajnet",
        read: |text, _| read_trajnet(text),
        read_batches: None,
        begins: |line| line.starts_with('{') && (line.contains("\"scene\"") || line.contains("\"track\"")),
    },
    Format {
        name: "csv",
        read: |text, reading| read_csv(text, reading.frames_per_second),
        read_batches: None,
        begins: |line| line.split(',').any(|name| name.trim_start_matches('\u{feff}').trim() == "id"),
    },
    Format {
        name: "pedpy",
        read: |text, _| read_pedpy(text),
        read_batches: None,
        begins: |line| line.starts_with('#') || (4..6).contains(&line.split_whitespace().count()),
    },
    Format {
        name: "observations",
        read: |text, _| read_identified(text),
        read_batches: Some(|text, _| read_observations(text)),
        begins: |line| line.starts_with('{') && line.contains("\"seen\""),
    },
];

impl Format {
    /// All formats.
    pub fn all() -> &'static [Self] {
        &FORMATS
    }

    /// The format of that name.
    pub fn from_name(name: &str) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.name == name)
    }

    /// The format that the first line of a text shows.
    pub fn of(text: &str) -> Option<&'static Self> {
        let line = text.lines().map(str::trim).find(|line| !line.is_empty())?;
        FORMATS.iter().find(|format| (format.begins)(line))
    }

    /// Reads a recording, in which everybody has an id.
    ///
    /// # Errors
    /// All errors of the text, in the order of its lines.
    pub fn read(&self, text: &str, reading: &Reading) -> Result<Recording, Vec<LineError>> {
        (self.read)(text, reading)
    }

    /// Reads batches of observations, with the recorded velocities or none.
    ///
    /// # Errors
    /// All errors of the text, in the order of its lines.
    pub fn read_batches(
        &self,
        text: &str,
        reading: &Reading,
        velocity: Velocity,
    ) -> Result<Vec<Batch>, Vec<LineError>> {
        let Some(read) = self.read_batches else {
            return Ok(self.read(text, reading)?.with(velocity).batches());
        };
        let mut batches = read(text, reading)?;
        if velocity == Velocity::Seen {
            batches.iter_mut().flat_map(|batch| &mut batch.seen).for_each(|one| one.velocity = None);
        }
        Ok(batches)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_shows_the_format() {
        let lines = [
            ("eth_biwi", "\n 1.0e0 1 0 0 0 0 0 0\n"),
            ("trajnet", "{\"track\": {\"f\": 1, \"p\": 1, \"x\": 0, \"y\": 0}}\n{\"scene\": {\"fps\": 2}}"),
            ("csv", "\u{feff}time,id,x,y\n0,1,0,0\n"),
            ("pedpy", "# framerate: 25\n1 0 0 0\n"),
            ("observations", "{\"t\":0,\"seen\":[{\"x\":0,\"y\":0,\"id\":1}]}"),
        ];
        assert_eq!(
            lines.map(|(name, _)| name).to_vec(),
            Format::all().iter().map(|f| f.name).collect::<Vec<_>>()
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
