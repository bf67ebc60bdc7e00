//! The options of `smc monitor`, `smc evaluate` and `smc fit`.

use crate::cli::values::{
    Cores, Model, Print, TextFormat, parse_count, parse_duration, parse_moment, parse_share, parse_user,
};
use crate::replay::{Beyond, Whose};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// What both have in common.
#[derive(Args, Debug)]
pub(in crate::cli) struct Replayed {
    /// The model; its people are in the tracks that are replayed.
    #[command(flatten)]
    pub(super) model: Model,
    /// Property files (`.bltl`); their named formulas are asked, their queries are not.
    #[arg(required = true)]
    pub(super) properties: Vec<String>,
    /// Tracks of the model.
    #[arg(long, alias = "replay", value_name = "TRACKS")]
    pub(super) tracks: String,
    /// Time between two instants; the step of the recording by default.
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub(super) every: Option<Duration>,
    #[command(flatten)]
    pub(super) span: Span,
}

/// Which times are used, and how.
#[derive(Args, Clone, Debug)]
pub(in crate::cli) struct Span {
    /// First time; the beginning by default.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(super) from: Option<f64>,
    /// Last time; the end by default.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(super) to: Option<f64>,
    /// Confidence of intervals, by bootstrap over persons.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = parse_share)]
    pub(super) confidence: f64,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Threads.
    #[command(flatten)]
    pub(super) cores: Cores,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

impl Span {
    /// The first and the last time, s.
    pub(super) fn between(&self) -> (f64, f64) {
        (self.from.unwrap_or(f64::NEG_INFINITY), self.to.unwrap_or(f64::INFINITY))
    }
}

/// `smc monitor`
#[derive(Args, Debug)]
pub(in crate::cli) struct MonitorCommand {
    #[command(flatten)]
    pub(super) replayed: Replayed,
    /// Whose instants: an id, or `all` for everybody in turn; by default the user of the model.
    #[arg(long, value_name = "ID", value_parser = parse_user)]
    pub(super) user: Option<Whose>,
    /// What is taken of others after the end of their tracks.
    #[arg(long, value_enum, default_value_t = Beyond::Unresolved)]
    pub(super) beyond: Beyond,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = MonitorFormat::Text)]
    pub(super) format: MonitorFormat,
}

/// `smc evaluate`
#[derive(Args, Debug)]
pub(in crate::cli) struct EvaluateCommand {
    #[command(flatten)]
    pub(super) replayed: Replayed,
    /// Kinds that are compared: kinds of the model, presets, `constant` (nobody changes the velocity) or `langevin` (it only
    /// fluctuates); by default the kind of the user and `constant`, with `--realism` also `langevin`.
    #[arg(long, value_name = "KIND,…", value_delimiter = ',')]
    pub(super) kinds: Vec<String>,
    /// Also score how likely the recorded speeds, accelerations, distances, times to collision and contacts are among 32 trials.
    #[arg(long)]
    pub(super) realism: bool,
    /// Trials of each instant.
    #[arg(long, value_name = "N", default_value = "200", value_parser = parse_count)]
    pub(super) trials: u64,
    /// Whose instants: an id, or `all` for everybody in turn.
    #[arg(long, value_name = "ID", default_value = "all", value_parser = parse_user)]
    pub(super) user: Whose,
    /// Whoever was recorded slower than this, in m/s, is left out.
    #[arg(long, value_name = "SPEED", default_value_t = 0.5)]
    pub(super) speed: f64,
    /// What is taken of others after the end of their tracks.
    #[arg(long, value_enum, default_value_t = Beyond::Onward)]
    pub(super) beyond: Beyond,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = EvaluateFormat::Text)]
    pub(super) format: EvaluateFormat,
    /// How wide a picture is.
    #[command(flatten)]
    pub(super) print: Print,
}

/// `smc calibrate`
#[derive(Args, Debug)]
pub(in crate::cli) struct CalibrateCommand {
    /// The model; its people are in the tracks.
    #[command(flatten)]
    pub(super) model: Model,
    /// Property files (`.bltl`); their named formulas are calibrated, their queries are not asked.
    #[arg(required = true)]
    pub(super) properties: Vec<String>,
    /// Tracks of the model.
    #[arg(long, value_name = "TRACKS")]
    pub(super) tracks: String,
    /// Name of the site; that of the tracks by default.
    #[arg(long, value_name = "NAME")]
    pub(super) site: Option<String>,
    /// When people were recorded there, as verdicts say it.
    #[arg(long, value_name = "DATE")]
    pub(super) date: Option<String>,
    /// How many persons calibrate at most, the first by time; later ones test. At most two thirds do.
    #[arg(long, value_name = "N", default_value = "80", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) persons: u32,
    #[command(flatten)]
    pub(super) span: Span,
    /// Trials of each person.
    #[arg(long, value_name = "N", default_value = "200", value_parser = clap::value_parser!(u32).range(20..=1_000_000))]
    pub(super) trials: u32,
    /// Whoever was recorded slower than this, in m/s, is left out.
    #[arg(long, value_name = "SPEED", default_value_t = 0.5)]
    pub(super) speed: f64,
    /// Also write a page with the tables.
    #[arg(long, value_name = "FILE.html")]
    pub(super) report: Option<PathBuf>,
    /// Format of what is printed; `-o` writes the calibration in any case.
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

/// `smc fit`
#[derive(Args, Debug)]
pub(in crate::cli) struct FitCommand {
    /// The model; its people are in the tracks.
    #[command(flatten)]
    pub(super) model: Model,
    /// Tracks of the model.
    #[arg(long, value_name = "TRACKS")]
    pub(super) tracks: String,
    /// What is fitted: parameters of the kind such as `A`, `tau` and `noise`, and `heading` and `speed`, the standard deviations
    /// of the laws `recorded + normal(0 deg, S)` and `recorded * normal(1, S)`. A search begins at the values of the model.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', required = true)]
    pub(super) parameters: Vec<String>,
    /// Property files: minimise the Brier score of their properties, instead of maximising the density of recorded positions.
    #[arg(long, value_name = "PROPERTIES")]
    pub(super) by: Vec<String>,
    /// The kind: one of the model or a preset; by default that of the user. All people have it.
    #[arg(long, value_name = "KIND")]
    pub(super) kind: Option<String>,
    /// Time between two instants.
    #[arg(long, value_name = "TIME", default_value = "2s", value_parser = parse_duration)]
    pub(super) every: Duration,
    #[command(flatten)]
    pub(super) span: Span,
    /// Trials of each instant.
    #[arg(long, value_name = "N", default_value = "24", value_parser = clap::value_parser!(u32).range(5..=100_000))]
    pub(super) trials: u32,
    /// Largest number of generations of the search.
    #[arg(long, value_name = "N", default_value = "25", value_parser = parse_count)]
    pub(super) generations: u64,
    /// Candidates of a generation; 4 + 3 ln n for n parameters by default.
    #[arg(long, value_name = "N", value_parser = parse_population)]
    pub(super) population: Option<usize>,
    /// Share of the persons that the search does not read; the result is scored on them.
    #[arg(long, value_name = "SHARE", default_value = "25%", value_parser = parse_share)]
    pub(super) held_out: f64,
    /// Also score the result with this model and the recording of its people.
    #[arg(long, value_name = "SCENARIO")]
    pub(super) test: Option<String>,
    /// Whoever was recorded slower than this, in m/s, is left out.
    #[arg(long, value_name = "SPEED", default_value_t = 0.5)]
    pub(super) speed: f64,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = FitFormat::Text)]
    pub(super) format: FitFormat,
    /// Write no log of the generations on standard error.
    #[arg(short, long)]
    pub(super) quiet: bool,
}

impl FitCommand {
    /// What it has in common with the others.
    pub(super) fn replayed(&self) -> Replayed {
        Replayed {
            model: self.model.clone(),
            properties: self.by.clone(),
            tracks: self.tracks.clone(),
            every: Some(self.every),
            span: self.span.clone(),
        }
    }
}

/// Formats of `smc fit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FitFormat {
    /// Tables, and the declarations for a scenario.
    Text,
    /// One object; see docs/schema/fit.schema.json.
    Json,
}

fn parse_population(text: &str) -> Result<usize, String> {
    let count: usize = text.parse().map_err(|_| format!("`{text}` is not a whole number"))?;
    if (4..=10_000).contains(&count) {
        Ok(count)
    } else {
        Err("a generation has 4 to 10000 candidates".to_owned())
    }
}

/// Formats of `smc monitor`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MonitorFormat {
    /// A table.
    Text,
    /// One object; see docs/schema/monitor.schema.json.
    Json,
    /// One row for each instant: `time,person`, and a column for each property.
    Csv,
}

/// Formats of `smc evaluate`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum EvaluateFormat {
    /// Tables.
    Text,
    /// One object; see docs/schema/evaluate.schema.json.
    Json,
    /// One row for each bin of predicted probabilities.
    Csv,
    /// A reliability diagram.
    Svg,
}
