//! `smc fmt`: one layout for all files.

use super::arguments::{Format, Language};
use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, print, say, warn};
use crate::report::ExitCode as Exit;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::parse::decode;
use crate::syntax::print::{format_properties, format_scenario};
use crate::syntax::render::render;
use crate::syntax::source::{Source, SourceId};
use std::path::Path;

/// Runs the command.
pub(super) fn run(arguments: &Format, colors: Colors) -> Exit {
    let mut exit = Exit::Success;
    for (at, name) in arguments.files.iter().enumerate() {
        if name == "-" && arguments.files[..at].contains(name) {
            complaint::tell(&complaint::input("standard input can be read only once"), &[], colors);
            exit = Exit::Wrong;
            continue;
        }
        let language = match name.rsplit_once('.').map(|(_, ending)| ending) {
            _ if name == "-" => arguments.language,
            Some("scn") => Some(Language::Scn),
            Some("bltl") => Some(Language::Bltl),
            _ => {
                let error = format!("`{name}` is neither a scenario (.scn) nor a property file (.bltl)");
                let hint =
                    "use a name that ends in .scn or .bltl; for standard input write `-` and `--language`";
                complaint::tell(&complaint::argument(error, hint), &[], colors);
                exit = Exit::Wrong;
                continue;
            }
        };
        let bytes = match inputs::read(name) {
            Ok(bytes) => bytes,
            Err(reason) => {
                complaint::tell(&complaint::input(reason), &[], colors);
                exit = Exit::Wrong;
                continue;
            }
        };
        let fail = |diagnostics: &[Diagnostic], source: &Source| {
            say(&render(diagnostics, std::slice::from_ref(source), colors.err));
        };
        let source = match decode(SourceId(0), inputs::shown(name), &bytes) {
            Ok(source) => source,
            Err(found) => {
                fail(
                    &[found],
                    &Source::new(SourceId(0), inputs::shown(name), String::from_utf8_lossy(&bytes)),
                );
                exit = Exit::Wrong;
                continue;
            }
        };
        let formatted = match language {
            Some(Language::Scn) => format_scenario(&source),
            Some(Language::Bltl) => format_properties(&source),
            None => either(&source),
        };
        let text = match formatted {
            Ok(text) => text,
            Err(diagnostics) => {
                fail(&diagnostics, &source);
                exit = Exit::Wrong;
                continue;
            }
        };
        if arguments.check {
            if text != source.text {
                warn(&format!("{} is not formatted\n", inputs::shown(name)));
                exit = exit.worse(Exit::Violated);
            }
        } else if name == "-" {
            if let Err(error) = print(&text) {
                complaint::tell(&error, &[], colors);
                return Exit::Wrong;
            }
        } else if text != source.text
            && let Err(error) = output::save(Path::new(name), text.as_bytes())
        {
            complaint::tell(&error, &[], colors);
            exit = Exit::Wrong;
        }
    }
    exit
}

/// As whichever language the text is; where it is neither, the errors are those of the one that is read farther.
fn either(source: &Source) -> Result<String, Vec<Diagnostic>> {
    let read = |errors: &[Diagnostic]| {
        let first = errors.iter().filter_map(|d| d.place.as_ref()).map(|place| place.span.start).min();
        (first, std::cmp::Reverse(errors.len()))
    };
    match (format_scenario(source), format_properties(source)) {
        (Ok(text), _) | (Err(_), Ok(text)) => Ok(text),
        (Err(scenario), Err(properties)) if read(&properties) > read(&scenario) => Err(properties),
        (Err(scenario), Err(_)) => Err(scenario),
    }
}
