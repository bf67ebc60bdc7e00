//! The options of `smc walk`.

use crate::cli::values::{Limit, Model};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `smc walk`
#[derive(Args, Debug)]
pub(in crate::cli) struct WalkCommand {
    /// The model.
    #[command(flatten)]
    pub(in crate::cli) model: Model,
    /// The time that the call may take.
    #[command(flatten)]
    pub(in crate::cli) limit: Limit,
    /// Only this agent: `worker`, `people[1]`; all agents with a route by default. May be given several times.
    #[arg(long, value_name = "NAME")]
    pub(in crate::cli) agent: Vec<String>,
    /// Number of trials.
    #[arg(short = 'n', long, default_value_t = 100, value_name = "N")]
    pub(in crate::cli) trials: u64,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(in crate::cli) seed: u64,
    /// Number of threads; all cores by default. Never changes a result.
    #[arg(short = 'j', long)]
    pub(in crate::cli) threads: Option<usize>,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = WalkFormat::Text)]
    pub(in crate::cli) format: WalkFormat,
    /// Rows of a trace for each second.
    #[arg(long, default_value_t = 120.0, value_name = "RATE")]
    pub(in crate::cli) fps: f64,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
    /// Also write a self-contained HTML page that plays the first eight trials.
    #[arg(long, value_name = "FILE.html")]
    pub(in crate::cli) report: Option<PathBuf>,
}

/// Formats of `smc walk`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum WalkFormat {
    /// For people.
    Text,
    /// One object; see docs/schema/legs.schema.json.
    Json,
    /// One row for each leg.
    Csv,
    /// One row for each place of each walk: `walk,leg,t,x,y,heading,foot,step`.
    Traces,
    /// A picture of all walks.
    Svg,
}
