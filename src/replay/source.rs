//! The file of the tracks that are replayed.

use crate::compile::{Files, Unread, is_series, reading_of};
use crate::data::tracks::{Batch, Format, LineError, Reading, Recording, Velocity};
use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// The file of tracks.
#[derive(Clone, Debug)]
pub struct TracksFile<'f> {
    /// Its format.
    pub format: &'static Format,
    /// The contents of all files of the scenario.
    pub files: &'f Files,
    /// The path, as written.
    pub path: &'f str,
    /// What the scenario says of it.
    pub reading: Reading,
    /// Where its path is written.
    pub place: Span,
}

impl TracksFile<'_> {
    /// The recording.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn recording(&self) -> Result<Recording, Diagnostic> {
        self.files.recording(self.path, self.format, &self.reading).map_err(|unread| match unread {
            Unread::Missing(reason) => error!(E0701, self.place, "{reason}"),
            Unread::Lines(errors) => self.wrong(&errors),
        })
    }

    /// The batches of observations; several files have those of their recording.
    ///
    /// # Errors
    /// The first thing that is wrong with them.
    pub fn batches(&self, velocity: Velocity) -> Result<Vec<Batch>, Diagnostic> {
        if is_series(self.path) {
            return Ok(self.recording()?.with(velocity).batches());
        }
        let bytes = self.files.get(self.path).map_err(|reason| error!(E0701, self.place, "{reason}"))?;
        self.format.read_batches(bytes, &self.reading, velocity).map_err(|errors| self.wrong(&errors))
    }

    fn wrong(&self, errors: &[LineError]) -> Diagnostic {
        let first = errors.first().map_or(String::new(), ToString::to_string);
        error!(E0702, self.place, "the recording cannot be read").label(first)
    }
}

/// The file of the tracks of a name.
///
/// # Errors
/// Where the scenario has no such tracks, they are a stream, or their file cannot be read.
pub fn source<'f>(
    file: &'f ScenarioFile,
    files: &'f Files,
    name: &str,
) -> Result<TracksFile<'f>, Diagnostic> {
    let wrong = |said: String, hint: String| Err(Diagnostic::placeless(Code::E0705, said).hint(hint));
    let tracks = file.items.iter().find_map(|item| match item {
        Item::Tracks { name: own, file, body } if own.name == name => Some((file, body)),
        _ => None,
    });
    let Some((Some((format, path)), body)) = tracks else {
        if tracks.is_some() {
            let hint = "remove `--tracks` and give the batches to the standard input of `smc advise`";
            let said = format!("`--tracks {name}`: `{name}` is a stream and has no file");
            return wrong(said, hint.to_owned());
        }
        let hint = format!("declare them in the scenario: `tracks {name} = eth_biwi \"obsmat.txt\"`");
        return wrong(format!("`--tracks {name}`: the scenario has no such recording"), hint);
    };
    let reading = reading_of(body)?;
    match Format::from_name(&format.name) {
        Some(format) => Ok(TracksFile { format, files, path: &path.value, reading, place: path.span }),
        None => {
            let said = format!("`{}` is no format of recordings", format.name);
            Err(error!(E0702, path.span, "{said}"))
        }
    }
}
