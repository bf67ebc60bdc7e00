//! A file of people who were recorded, as `smc infer` and `smc measure` read it.

use super::values::{parse_rate, parse_velocity};
use super::{complaint, inputs};
use crate::data::tracks::{Format, LineError, Reading, Velocity};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use clap::Args;

/// Bad lines of a file that are shown.
const SHOWN: usize = 10;

/// How a recording is read.
#[derive(Args, Debug)]
pub(super) struct Recorded {
    /// Format of the recording; by default what its first line shows.
    #[arg(long = "input", value_name = "FORMAT", value_parser = parse_format)]
    input: Option<&'static Format>,
    /// The columns of a table without a header, with commas: `id,frame,x/cm,y/cm`.
    #[arg(long, value_name = "NAMES")]
    columns: Option<String>,
    /// Frames per second of a table with frames.
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    fps: Option<f64>,
    /// The trial of a table with several.
    #[arg(long, value_name = "N")]
    trial: Option<u64>,
    /// Velocities: `recorded` (as observed) or `seen` (the difference from the last position).
    #[arg(long, value_name = "WHICH", default_value = "recorded", value_parser = parse_velocity)]
    pub(super) velocity: Velocity,
}

impl Recorded {
    /// The bytes of a file, its format, and how it is read.
    pub(super) fn open(&self, file: &str) -> Result<(Vec<u8>, &'static Format, Reading), Vec<Diagnostic>> {
        let bytes = inputs::read(file).map_err(complaint::input)?;
        if bytes.trim_ascii().is_empty() {
            let said = format!("`{}` is empty", inputs::shown(file));
            return Err(Diagnostic::placeless(Code::E0702, said).into());
        }
        // A table without a header shows nothing.
        let named = self.columns.as_ref().and_then(|_| Format::from_name("csv"));
        let Some(format) = self.input.or(named).or_else(|| Format::of(&bytes)) else {
            let said = format!("`{}` is in no known format", inputs::shown(file));
            return Err(Diagnostic::placeless(Code::E0702, said).hint("name it with `--input`").into());
        };
        let Self { fps, trial, columns, .. } = self;
        let reading = Reading { frames_per_second: *fps, trial: *trial, columns: columns.clone() };
        Ok((bytes, format, reading))
    }
}

/// A file in which nobody is.
pub(super) fn empty(file: &str) -> Diagnostic {
    let said = format!("`{}` contains no observation", inputs::shown(file));
    Diagnostic::placeless(Code::E0702, said)
}

/// What is wrong with a file, line by line.
pub(super) fn bad_lines(file: &str, errors: &[LineError]) -> Vec<Diagnostic> {
    let file = inputs::shown(file);
    let shown = errors.iter().take(SHOWN);
    let mut found: Vec<Diagnostic> =
        shown.map(|error| Diagnostic::placeless(Code::E0702, format!("`{file}`, {error}"))).collect();
    if errors.len() > SHOWN {
        let more = format!("`{file}` has {} more errors", errors.len() - SHOWN);
        found.push(Diagnostic::placeless(Code::E0702, more));
    }
    found
}

fn parse_format(text: &str) -> Result<&'static Format, String> {
    let names: Vec<&str> = Format::all().iter().map(|format| format.name).collect();
    Format::from_name(text).ok_or_else(|| format!("the formats are {}", names.join(", ")))
}
