//! The file of the tracks that are replayed.

use crate::compile::Files;
use crate::data::tracks::Format;
use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Format and text of the tracks of a name, and where their path is written.
///
/// # Errors
/// Where the scenario has no such tracks, they are a stream, or their file cannot be read.
pub fn source<'f>(
    file: &ScenarioFile,
    files: &'f Files,
    name: &str,
) -> Result<(&'static Format, &'f str, Span), Diagnostic> {
    let wrong = |said: String, hint: String| Err(Diagnostic::placeless(Code::E0705, said).hint(hint));
    let tracks = file.items.iter().find_map(|item| match item {
        Item::Tracks { name: own, file, .. } if own.name == name => Some(file),
        _ => None,
    });
    let Some(Some((format, path))) = tracks else {
        if tracks == Some(&None) {
            let hint = "remove `--replay` and give the batches to the standard input of `smc advise`";
            let said = format!("`--replay {name}`: `{name}` is a stream and has no file");
            return wrong(said, hint.to_owned());
        }
        let hint = format!("declare them in the scenario: `tracks {name} = eth_biwi \"obsmat.txt\"`");
        return wrong(format!("`--replay {name}`: the scenario has no such recording"), hint);
    };
    let unreadable = |said: String| Diagnostic::error(Code::E0702, path.span, said);
    let bytes = files.get(&path.value).map_err(|reason| Diagnostic::error(Code::E0701, path.span, reason))?;
    let text = std::str::from_utf8(bytes).map_err(|_| unreadable("the file is not UTF-8 text".to_owned()))?;
    match Format::from_name(&format.name) {
        Some(format) => Ok((format, text, path.span)),
        None => Err(unreadable(format!("`{}` is no format of recordings", format.name))),
    }
}
