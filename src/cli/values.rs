//! What options of several commands have in common: the model, times, counts and shares.

use crate::base::random::MOST_TRIALS;
use crate::data::tracks::Velocity;
use crate::engine::{Fault, Threads};
use crate::library;
use crate::replay::Whose;
use crate::report::Format;
use crate::report::svg::picture::{Paper, Picture};
use crate::syntax::diagnostic::Diagnostic;
use clap::{Args, ValueEnum};
use std::num::NonZeroU64;
use std::path::PathBuf;
use std::str::FromStr;

/// A text or JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum TextFormat {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// How wide an SVG picture is.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(super) struct Print {
    /// Width of an SVG picture on paper, its letters 8 points high: `85mm`, `17cm`.
    #[arg(long, value_name = "LENGTH", value_parser = parse_width)]
    width: Option<f64>,
}

impl Print {
    /// The picture as a file.
    pub(super) fn svg(self, picture: &Picture) -> String {
        picture.svg(Paper { width: self.width })
    }
}

/// A width of paper, mm.
fn parse_width(text: &str) -> Result<f64, String> {
    let known = [("mm", 1.0), ("cm", 10.0), ("in", 25.4)];
    let number = known
        .iter()
        .find_map(|(unit, size)| Some(text.strip_suffix(unit)?.trim().parse::<f64>().ok()? * size));
    let width = number.filter(|mm| (40.0..=1000.0).contains(mm));
    width.ok_or_else(|| format!("`{text}` must be a width from 40mm to 1000mm: write `85mm` or `17cm`"))
}

/// The model, and the values set in it.
#[derive(Args, Clone, Debug, Default)]
pub(super) struct Model {
    /// Scenario file (`.scn`), or `-` for standard input.
    pub(super) scenario: String,
    /// Set a parameter, or sweep it: `density=0.8`, `density=0.1..0.8 by 0.1`, `n=2,4,8`, `density=0.1..10 by log 3`
    /// (three values a decade). A number without a unit takes that of the declared default.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub(super) set: Vec<String>,
    /// Also search this folder for recordings and imports. May be given several times.
    #[arg(long = "data", value_name = "DIR")]
    pub(super) data: Vec<PathBuf>,
    /// Ask everything with people of each of these presets, whatever the scenario says: `smc1,cfs2,helbing2000`.
    #[arg(long = "models", value_name = "PRESETS", value_delimiter = ',')]
    pub(super) models: Vec<String>,
    /// A file of `smc calibrate`: the laws of `heading = site` and `speed = site`, and beside each verdict about a calibrated property
    /// how often such verdicts were true.
    #[arg(long, value_name = "FILE")]
    pub(super) calibration: Option<String>,
    /// Let the program of a scenario run, which nothing but a trial ever does.
    #[arg(long)]
    pub(super) allow_run: bool,
    /// `seen`: velocities of recorded people are differences from their last positions; `recorded`: those of the file. Unless
    /// set, as the tracks say, or else recorded; `advise`, `evaluate` and `fit` take those that are seen.
    #[arg(long, value_name = "WHICH", value_parser = parse_velocity)]
    pub(super) velocity: Option<Velocity>,
}

/// How many threads a call has.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct Cores {
    /// Number of threads; all cores by default. Never changes a result.
    #[arg(short = 'j', long, value_parser = parse_threads)]
    pub(super) threads: Option<usize>,
}

/// How long a call may take.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct Limit {
    /// Time limit of the whole call, such as `50ms`, `2s`, `5min`; none by default. The search for witnesses of a check may
    /// exceed it by 25 %, at least 20 ms and at most a second.
    #[arg(long, value_parser = parse_duration)]
    pub(super) timeout: Option<std::time::Duration>,
}

/// Threads, so many or one for each core.
pub(super) fn threads(number: Option<usize>) -> Result<Threads, Diagnostic> {
    Threads::new(number).map_err(|error| library::refusal(&Fault::Threads(error.to_string())))
}

/// A probability, perhaps as a percentage.
pub(super) fn parse_share(text: &str) -> Result<f64, String> {
    let (digits, scale) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 100.0));
    let value: f64 = digits.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    let share = value / scale;
    if share > 0.0 && share < 1.0 {
        Ok(share)
    } else {
        Err("a probability must be between 0 and 1".to_owned())
    }
}

/// A number of outcomes.
pub(super) fn parse_quiet(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value > 1.0 && value < 1e300 { Ok(value) } else { Err("the number must be above 1".to_owned()) }
}

/// A whole number: `20000`, `2e4`.
pub(super) fn parse_count(text: &str) -> Result<u64, String> {
    let wrong = || format!("`{text}` is not a whole number from 0: write 10000 or 1e4");
    let exact = text.parse().ok();
    let rounded = || text.parse().ok().filter(|n: &f64| *n >= 0.0 && *n <= 9e15 && n.fract() == 0.0);
    exact.or_else(|| rounded().map(|n| n as u64)).ok_or_else(wrong)
}

/// A whole number from 1: `20000`, `2e4`.
pub(super) fn parse_positive(text: &str) -> Result<NonZeroU64, String> {
    let number = parse_count(text).ok().and_then(NonZeroU64::new);
    number.ok_or_else(|| format!("`{text}` is not a whole number from 1: write 10000 or 1e4"))
}

/// A number of trials: they are numbered from 0.
pub(super) fn parse_trials(text: &str) -> Result<NonZeroU64, String> {
    let number = parse_positive(text)?;
    let number = Some(number).filter(|number| number.get() <= MOST_TRIALS);
    number.ok_or_else(|| format!("write a number from 1 to {MOST_TRIALS}"))
}

/// A number of threads.
pub(super) fn parse_threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| "write a number from 1, or remove the option to use all cores".to_owned())
}

/// A number of rows or frames a second.
pub(super) fn parse_rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| *rate > 0.0 && *rate <= 1e6);
    rate.ok_or_else(|| "write a number a second, above 0 and at most 1e6, such as 120".to_owned())
}

/// A positive number.
pub(super) fn parse_above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "write a positive number".to_owned())
}

/// A whole number within limits.
pub(super) fn parse_within(text: &str, low: u32, high: u32) -> Result<u32, String> {
    let number = text.parse().ok().filter(|number| (low..=high).contains(number));
    number.ok_or_else(|| format!("write a whole number from {low} to {high}"))
}

/// A number of seconds, or a time with its unit.
pub(super) fn parse_moment(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) => Ok(seconds),
        Err(_) => parse_seconds(text),
    }
}

/// A time with its unit: `50ms`, `2s`, `1.5min`, `1h`.
fn parse_seconds(text: &str) -> Result<f64, String> {
    let split = text.find(|c: char| c.is_alphabetic()).unwrap_or(text.len());
    let (digits, unit) = text.split_at(split);
    let scale = match unit {
        "ms" => 1e-3,
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        "" if digits.parse::<f64>().is_ok() => {
            return Err(format!("the unit is missing: write {digits}s, {digits}ms or {digits}min"));
        }
        _ => return Err(format!("`{text}` is not a time: write 50ms, 2s, 5min or 1h")),
    };
    let value: f64 = digits.trim().parse().map_err(|_| format!("`{digits}` is not a number"))?;
    Ok(value * scale)
}

/// A positive duration with its unit.
pub(super) fn parse_duration(text: &str) -> Result<std::time::Duration, String> {
    let seconds = parse_seconds(text)?;
    if seconds >= 1e9 {
        return Err("a timeout must be shorter than 30 years; remove it for no limit".to_owned());
    }
    if seconds.is_nan() || seconds <= 0.0 {
        return Err("a timeout must be positive".to_owned());
    }
    Ok(std::time::Duration::from_secs_f64(seconds))
}

/// `seen` or `recorded`.
pub(super) fn parse_velocity(text: &str) -> Result<Velocity, String> {
    Velocity::from_name(text).ok_or_else(|| "write `seen` or `recorded`".to_owned())
}

// The place of one result of a call, as an option names it: a format, and perhaps a file.

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

/// An id, or `all`.
pub(super) fn parse_user(text: &str) -> Result<Whose, String> {
    match text {
        "all" => Ok(Whose::Everybody),
        _ => text.parse().map(Whose::Person).map_err(|_| format!("`{text}` is no id: write 367, or all")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_need_a_unit() {
        assert_eq!(parse_duration("50ms"), Ok(std::time::Duration::from_millis(50)));
        assert_eq!(parse_duration("1.5min"), Ok(std::time::Duration::from_secs(90)));
        assert!(parse_duration("50").is_err());
        assert!(parse_duration("0s").is_err());
        assert!(parse_duration("5 parsecs").is_err());
        assert_eq!(parse_moment("2s"), Ok(2.0));
        assert_eq!(parse_moment("-2.5"), Ok(-2.5));
        assert!(parse_moment("2x").is_err());
    }

    #[test]
    fn counts_are_whole() {
        for (text, count) in [("0", 0), ("1e4", 10_000), ("2.5e3", 2500), ("18446744073709551615", u64::MAX)]
        {
            assert_eq!(parse_count(text), Ok(count));
        }
        for text in ["1.5", "-1", "1e300", "NaN", "many", ""] {
            assert!(parse_count(text).is_err(), "{text}");
        }
    }
}
