//! The call as it is typed: rules that hold for the options of all commands, and our own words for what is wrong.

use super::arguments::Arguments;
use super::values::parse_count;
use clap::builder::ValueParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, CommandFactory, FromArgMatches};
use std::any::TypeId;
use std::error::Error;
use std::ffi::OsString;
use std::num::{ParseFloatError, ParseIntError};

/// Options that are confused: one command has the first, another the second.
const CONFUSED: [&str; 2] = ["--replay", "--tracks"];

/// Reads the call.
pub(super) fn parse(call: Vec<OsString>) -> Result<Arguments, clap::Error> {
    let strange = call.iter().find(|word| word.to_str().is_none()).cloned();
    let mut command = ruled(Arguments::command());
    let found = command.try_get_matches_from_mut(call).and_then(|found| Arguments::from_arg_matches(&found));
    found.map_err(|mut error| match own_words(&error, strange) {
        Some(message) => clap::Error::raw(error.kind(), message + "\n").with_cmd(&command),
        None => {
            // The tip is to pass it as a value.
            error.remove(ContextKind::Suggested);
            let at = CONFUSED.iter().position(|name| text(&error, ContextKind::InvalidArg) == Some(*name));
            if let Some(at) = at {
                let meant = ContextValue::String(CONFUSED[1 - at].to_owned());
                error.insert(ContextKind::SuggestedArg, meant);
            }
            error
        }
    })
}

fn text(error: &clap::Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text),
        _ => None,
    }
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

/// The message, where that of the parser of the command line speaks of types of Rust or does not name the file.
fn own_words(error: &clap::Error, strange: Option<OsString>) -> Option<String> {
    if error.kind() == ErrorKind::InvalidUtf8 {
        return Some(format!(
            "the name `{}` is not UTF-8: rename the file, or link to it",
            strange?.display()
        ));
    }
    let (source, option) = (error.source()?, text(error, ContextKind::InvalidArg)?);
    let wanted = if source.is::<ParseIntError>() {
        "a whole number from 0".to_owned()
    } else if source.is::<ParseFloatError>() {
        "a number".to_owned()
    } else {
        let said = source.to_string();
        let (low, high) = said.split_once(" is not in ")?.1.split_once("..=")?;
        format!("a whole number from {low} to {high}")
    };
    Some(format!("`{option}` must be {wanted} (got `{}`)", text(error, ContextKind::InvalidValue)?))
}
