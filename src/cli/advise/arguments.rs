//! The options of `smc advise`.

use crate::cli::values::{Model, parse_count, parse_duration, parse_moment, parse_velocity};
use crate::data::tracks::Velocity;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// `smc advise`
#[derive(Args, Debug)]
pub(in crate::cli) struct AdviseCommand {
    /// The model; its moves belong to the user.
    #[command(flatten)]
    pub(in crate::cli) model: Model,
    /// Property files (`.bltl`); the first ranking of moves is asked in each cycle.
    #[arg(required = true)]
    pub(in crate::cli) properties: Vec<String>,
    /// Ask this ranking: the name of its property, or its number in writing order, starting at 0.
    #[arg(long, value_name = "NAME")]
    pub(in crate::cli) only: Option<String>,
    /// Replay these tracks of the model instead of reading batches from standard input.
    #[arg(long, value_name = "TRACKS")]
    pub(in crate::cli) replay: Option<String>,
    /// First time of the replay; the beginning by default.
    #[arg(long, value_name = "TIME", requires = "replay", value_parser = parse_moment)]
    pub(in crate::cli) from: Option<f64>,
    /// Last time of the replay; the end by default.
    #[arg(long, value_name = "TIME", requires = "replay", value_parser = parse_moment)]
    pub(in crate::cli) to: Option<f64>,
    /// Withhold the ids of all people but the user.
    #[arg(long, requires = "replay")]
    pub(in crate::cli) anonymous: bool,
    /// Let the user walk as advised instead of as recorded, and compare both at the end.
    #[arg(long, requires = "replay")]
    pub(in crate::cli) follow: bool,
    /// Also write a self-contained HTML page that plays the recording, with the advice of each cycle.
    #[arg(long, value_name = "FILE.html")]
    pub(in crate::cli) report: Option<PathBuf>,
    /// Id of the user, instead of the id in the model.
    #[arg(long, value_name = "ID")]
    pub(in crate::cli) user: Option<u32>,
    /// Leave out people who are farther from the user than this, in metres: `12m`.
    #[arg(long, value_name = "LENGTH", value_parser = parse_length)]
    pub(in crate::cli) range: Option<f64>,
    /// Velocities: `seen` (the difference from the last position) or `recorded` (as observed).
    #[arg(long, value_name = "WHICH", default_value = "seen", value_parser = parse_velocity)]
    pub(in crate::cli) velocity: Velocity,
    /// Time from a complete batch to its advice, such as `100ms`. What is certified by then is said.
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub(in crate::cli) deadline: Option<Duration>,
    /// Largest number of trials of a cycle. Without a deadline, the advice then depends on nothing but the inputs.
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub(in crate::cli) total_trials: Option<u64>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(in crate::cli) seed: u64,
    /// Number of threads; all cores by default. Never changes a result.
    #[arg(short = 'j', long)]
    pub(in crate::cli) threads: Option<usize>,
    /// Stop at the first line that cannot be read.
    #[arg(long)]
    pub(in crate::cli) strict: bool,
}

/// A length in metres: `12m`, `12`.
fn parse_length(text: &str) -> Result<f64, String> {
    let digits = text.strip_suffix('m').unwrap_or(text).trim();
    match digits.parse::<f64>() {
        Ok(length) if length > 0.0 => Ok(length),
        Ok(_) => Err("a range must be positive".to_owned()),
        Err(_) => Err(format!("`{text}` is not a length: write 12m")),
    }
}
