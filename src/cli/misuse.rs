//! The call as it is typed: rules that hold for the options of all commands, and what is wrong with a call.

use super::arguments::{Arguments, definition};
use super::complaint;
use super::inputs::with_scenario;
use super::terminal::Colors;
use super::values::{Destination, parse_count};
use super::{check, drift};
use crate::syntax::diagnostic::Diagnostic;
use clap::builder::ValueParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, FromArgMatches};
use std::any::TypeId;
use std::error::Error;
use std::ffi::OsString;
use std::num::{ParseFloatError, ParseIntError};

/// Reads the call. An error is a request for help, or is told in full.
pub(super) fn parse(call: Vec<OsString>) -> Result<Arguments, clap::Error> {
    let call = with_scenario(call);
    let words: Vec<String> = call.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let strange = call.iter().find(|word| word.to_str().is_none()).cloned();
    let found = ruled(definition()).try_get_matches_from_mut(call);
    found.and_then(|found| Arguments::from_arg_matches(&found)).inspect_err(|error| {
        // A call without a verb is answered by the help, too.
        if error.use_stderr() && error.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
            tell(&complaint(error, strange), &words);
        } else {
            let _ = error.print();
        }
    })
}

/// A minus may start the value of an option, and whole numbers may have an exponent.
fn ruled(command: Command) -> Command {
    let option = |arg: Arg| {
        let is_count = arg.get_value_parser().type_id() == TypeId::of::<u64>();
        let arg = if is_count { arg.value_parser(ValueParser::new(parse_count)) } else { arg };
        let is_option = arg.get_long().is_some() && arg.get_action().takes_values();
        if is_option { arg.allow_negative_numbers(true) } else { arg }
    };
    command.mut_args(option).mut_subcommands(ruled)
}

/// What is wrong with a call, and what to do.
fn complaint(error: &clap::Error, strange: Option<OsString>) -> Diagnostic {
    if let (ErrorKind::InvalidUtf8, Some(name)) = (error.kind(), strange) {
        let title = format!("the name `{}` is not UTF-8", name.display());
        return complaint::argument(title, "rename the file, or link to it");
    }
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    if let (Some(source), Some(option), Some(value)) =
        (error.source(), text(ContextKind::InvalidArg), text(ContextKind::InvalidValue))
    {
        return match wanted(source) {
            Some(wanted) => {
                let title = format!("`{option}` must be {wanted} (got `{value}`)");
                complaint::argument(title, format!("write {wanted}"))
            }
            None => complaint::argument(format!("`{option}` cannot be `{value}`"), source.to_string()),
        };
    }
    // The message, then perhaps tips and the usage, each after an empty line.
    let all = error.to_string();
    let mut parts = all.split("\n\n").map(|part| part.split_whitespace().collect::<Vec<_>>().join(" "));
    let title = parts.next().unwrap_or_default();
    // The tip to pass an unknown option as a value helps nobody.
    let is_help =
        |part: &String| !part.is_empty() && !part.contains("as a value") && !part.starts_with("For more");
    let hint = |part: String| match part.strip_prefix("Usage: ") {
        Some(usage) => format!("write `{usage}`"),
        None => part.trim_start_matches("tip: ").to_owned(),
    };
    let hints: Vec<String> = parts.filter(is_help).map(hint).collect();
    let hint = if hints.is_empty() { "`--help` shows how".to_owned() } else { hints.join("; ") };
    complaint::argument(title.trim_start_matches("error: "), hint)
}

/// What an option takes, where the parser of the command line speaks of types of Rust.
fn wanted(source: &(dyn Error + 'static)) -> Option<String> {
    if source.is::<ParseIntError>() {
        return Some("a whole number from 0".to_owned());
    }
    if source.is::<ParseFloatError>() {
        return Some("a number".to_owned());
    }
    let said = source.to_string();
    let (low, high) = said.split_once(" is not in ")?.1.split_once("..=")?;
    Some(format!("a whole number from {low} to {high}"))
}

/// Reports it, also in the format that the words of the call ask for, as far as it can be.
fn tell(error: &Diagnostic, words: &[String]) {
    complaint::tell(error, &[], Colors { out: false, err: false });
    let format = format_of(words);
    if words.iter().any(|word| word == "check" || word == "merge")
        && let Some(destination) = format.and_then(|text| text.parse::<Destination>().ok())
    {
        check::misused(destination.format, error);
    } else if words.iter().any(|word| word == "drift") && format == Some("json") {
        let _ = drift::print_error(error);
    }
}

/// The last format for standard output that words ask for.
fn format_of(words: &[String]) -> Option<&str> {
    let inline = words.iter().filter_map(|word| word.strip_prefix("--format="));
    let apart = words.windows(2).filter(|pair| pair[0] == "--format").map(|pair| pair[1].as_str());
    inline.chain(apart).rfind(|format| !format.contains('='))
}
