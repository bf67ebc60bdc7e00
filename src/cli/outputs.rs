//! Where the results of a call go, and in which formats: one to standard output, each of the others into a file.

use super::destination::Destination;
use super::{complaint, output};
use crate::report::Format;
use crate::syntax::diagnostic::Diagnostic;
use std::path::{Path, PathBuf};

/// Format of what a call prints, and the files that it writes.
#[derive(Clone, Debug)]
pub(super) struct Outputs {
    pub(super) screen: Format,
    pub(super) files: Vec<(Format, PathBuf)>,
    /// The page of charts and traces.
    pub(super) page: Option<PathBuf>,
}

impl Outputs {
    /// As the options of a call say.
    ///
    /// # Errors
    /// Two formats want standard output or one file, or a file is one that the call reads.
    pub(super) fn new(
        chosen: &[Destination],
        is_brief: bool,
        page: Option<&Path>,
        inputs: &[PathBuf],
    ) -> Result<Self, Diagnostic> {
        let printed = chosen.iter().filter(|destination| destination.file.is_none()).map(|one| one.format);
        let mut printed = printed.chain(is_brief.then_some(Format::Brief));
        let screen = printed.next().unwrap_or(Format::Text);
        if printed.next().is_some() {
            return Err(complaint::argument(
                "two formats are for standard output",
                "write one of them into a file: `--format json=results.json`",
            ));
        }
        let files = chosen.iter().filter_map(|one| Some((one.format, one.file.clone()?)));
        let files: Vec<_> = files.collect();
        let names: Vec<Option<&Path>> =
            files.iter().map(|(_, file)| Some(file.as_path())).chain([page]).collect();
        output::guard_all(&names, inputs)?;
        Ok(Self { screen, files, page: page.map(Path::to_owned) })
    }
}
