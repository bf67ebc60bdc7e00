//! The file of the tracks that are replayed.

use crate::compile::{Files, reading_of};
use crate::data::tracks::{Format, Reading};
use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// The file of tracks.
#[derive(Clone, Copy, Debug)]
pub struct TracksFile<'f> {
    /// Its format.
    pub format: &'static Format,
    /// What is in it.
    pub bytes: &'f [u8],
    /// What the scenario says of it.
    pub reading: Reading,
    /// Where its path is written.
    pub place: Span,
}

/// The file of the tracks of a name.
///
/// # Errors
/// Where the scenario has no such tracks, they are a stream, or their file cannot be read.
pub fn source<'f>(file: &ScenarioFile, files: &'f Files, name: &str) -> Result<TracksFile<'f>, Diagnostic> {
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
    let bytes = files.get(&path.value).map_err(|reason| error!(E0701, path.span, "{reason}"))?;
    let reading = reading_of(body)?;
    match Format::from_name(&format.name) {
        Some(format) => Ok(TracksFile { format, bytes, reading, place: path.span }),
        None => {
            let said = format!("`{}` is no format of recordings", format.name);
            Err(error!(E0702, path.span, "{said}"))
        }
    }
}
