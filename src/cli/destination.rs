//! Where one result of a call goes, as an option names it: a format, and perhaps a file.

use crate::report::Format;
use clap::ValueEnum;
use std::path::PathBuf;
use std::str::FromStr;

/// `json`, or `json=FILE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Destination {
    pub(super) format: Format,
    pub(super) file: Option<PathBuf>,
}

impl FromStr for Destination {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, file) = text.split_once('=').map_or((text, None), |(name, file)| (name, Some(file)));
        let format = <Format as ValueEnum>::from_str(name, false).map_err(|_| {
            let names = Format::value_variants().iter().filter_map(ValueEnum::to_possible_value);
            let names: Vec<String> = names.map(|value| value.get_name().to_owned()).collect();
            format!("the formats are {}; for a file write `json=FILE`", names.join(", "))
        })?;
        if file.is_some_and(str::is_empty) {
            return Err(format!("the name of the file is missing: write `{name}=FILE`"));
        }
        Ok(Self { format, file: file.map(PathBuf::from) })
    }
}
