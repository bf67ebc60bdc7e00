//! Names of formats of traces in options.

use crate::data::table::{FORMATS, TraceFormat};

/// The format of a name.
///
/// # Errors
/// A name that no format has, or one without which the program was built.
pub(in crate::cli) fn parse_trace_format(name: &str) -> Result<&'static TraceFormat, String> {
    let Some(format) = FORMATS.iter().find(|format| format.name == name) else {
        let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        return Err(format!("the formats are {}", names.join(", ")));
    };
    if format.open.is_none() {
        return Err(left_out(format));
    }
    Ok(format)
}

/// What to do where a format is not in this build.
pub(super) fn left_out(format: &TraceFormat) -> String {
    let name = format.name;
    format!("this program was built without the feature `{name}`: build it with `--features {name}`")
}
