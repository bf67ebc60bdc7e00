//! Where one result of a call goes, as an option names it: a format, and perhaps a file.

use crate::report::Format;
use clap::ValueEnum;
use std::path::PathBuf;
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

/// Formats of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum OutputFormat {
    /// For people.
    Text,
    /// One line a query.
    Brief,
    /// A table: one row a result, an option of a ranking, a side of a comparison.
    Csv,
    /// One object; see docs/schema/verdict.schema.json.
    Json,
    /// For continuous integration: `JUnit` XML.
    #[value(help = "For continuous integration: JUnit XML")]
    Junit,
    /// Annotations of GitHub workflows.
    Github,
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
