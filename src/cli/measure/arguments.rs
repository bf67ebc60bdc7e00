//! The options of `smc measure`.

use crate::cli::recording::Recorded;
use crate::cli::values::{parse_above_zero, parse_moment};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `smc measure`
#[derive(Args, Debug)]
pub(in crate::cli) struct MeasureCommand {
    /// Recording, or `-` for standard input; with `*` in its name (in quotes) all files that match are one recording.
    pub(super) tracks: String,
    /// Scenario (`.scn`) whose regions, lines and walls are those of the place.
    pub(super) scenario: Option<String>,
    /// A number of a state to measure in each frame, as in property files. May be given several times; without any, those of
    /// all regions and lines.
    #[arg(long = "number", value_name = "NUMBER")]
    pub(super) number: Vec<String>,
    /// Window of the flows.
    #[arg(long, value_name = "TIME", default_value = "10s", value_parser = parse_moment)]
    pub(super) window: f64,
    /// Radius of bodies, for times to collision and post-encroachment times, m.
    #[arg(long, value_name = "METRES", default_value = "0.2", value_parser = parse_above_zero)]
    pub(super) radius: f64,
    /// Deceleration that a person can reach, for the brake threat, m/s².
    #[arg(long, value_name = "NUMBER", default_value = "2", value_parser = parse_above_zero)]
    pub(super) brake: f64,
    /// First time.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(super) from: Option<f64>,
    /// Last time.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(super) to: Option<f64>,
    /// Value of a parameter of the scenario: `NAME=VALUE`.
    #[arg(long, value_name = "NAME=VALUE", requires = "scenario")]
    pub(super) set: Vec<String>,
    /// Also search this folder for imports of the scenario. May be given several times.
    #[arg(long = "data", value_name = "DIR", requires = "scenario")]
    pub(super) data: Vec<PathBuf>,
    /// How the recording is read.
    #[command(flatten)]
    pub(super) recorded: Recorded,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = MeasureFormat::Text)]
    pub(super) format: MeasureFormat,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Also write a self-contained HTML page: the numbers, a player, heat maps, N(t) of each line, speed against density.
    #[arg(long, value_name = "FILE.html")]
    pub(super) report: Option<PathBuf>,
}

/// Formats of `smc measure`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MeasureFormat {
    /// For people: a summary of each number.
    Text,
    /// The same as one object.
    Json,
    /// A row for each frame.
    Csv,
    /// A line for each frame.
    Jsonl,
    /// A row for each frame, in columns.
    Parquet,
}
