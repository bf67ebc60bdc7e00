//! Where the results of a call go, and in which formats: one to standard output, each of the others into a file.

use super::arguments::OutputFormat;
use super::{complaint, output};
use crate::report::Format;
use crate::syntax::diagnostic::Diagnostic;
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// `json`, or `json=FILE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Destination {
    pub(super) format: OutputFormat,
    pub(super) file: Option<PathBuf>,
}

impl FromStr for Destination {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, file) = text.split_once('=').map_or((text, None), |(name, file)| (name, Some(file)));
        let format = OutputFormat::from_str(name, false).map_err(|_| {
            let names = OutputFormat::value_variants().iter().filter_map(ValueEnum::to_possible_value);
            let names: Vec<String> = names.map(|value| value.get_name().to_owned()).collect();
            format!("the formats are {}; for a file write `json=FILE`", names.join(", "))
        })?;
        if file.is_some_and(str::is_empty) {
            return Err(format!("the name of the file is missing: write `{name}=FILE`"));
        }
        Ok(Self { format, file: file.map(PathBuf::from) })
    }
}

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
        let printed =
            chosen.iter().filter(|destination| destination.file.is_none()).map(|one| one.format.of());
        let mut printed = printed.chain(is_brief.then_some(Format::Brief));
        let screen = printed.next().unwrap_or(Format::Text);
        if printed.next().is_some() {
            return Err(complaint::argument(
                "two formats are for standard output",
                "write one of them into a file: `--format json=results.json`",
            ));
        }
        let files = chosen.iter().filter_map(|one| Some((one.format.of(), one.file.clone()?)));
        let files: Vec<_> = files.collect();
        let names: Vec<&Path> = files.iter().map(|(_, file)| file.as_path()).chain(page).collect();
        for (at, file) in names.iter().enumerate() {
            if names[..at].iter().any(|other| other == file || output::is_same(other, file)) {
                let title = format!("two results are to be written to `{}`", file.display());
                return Err(complaint::argument(title, "write each of them to a file of its own"));
            }
            output::guard(Some(file), inputs)?;
        }
        Ok(Self { screen, files, page: page.map(Path::to_owned) })
    }
}

impl OutputFormat {
    /// The format of the report.
    pub(super) const fn of(self) -> Format {
        match self {
            Self::Text => Format::Text,
            Self::Brief => Format::Brief,
            Self::Json => Format::Json,
            Self::Csv => Format::Csv,
            Self::Junit => Format::Junit,
            Self::Github => Format::Github,
        }
    }
}
