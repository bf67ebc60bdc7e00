//! The options of `smc path`.

use crate::cli::values::{Limit, Print, parse_moment, parse_within};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `smc path`
#[derive(Args, Debug)]
pub(in crate::cli) struct PathCommand {
    /// Scenario file (`.scn`); without one, `--shape` or `--waypoints` gives the path.
    pub(in crate::cli) scenario: Option<String>,
    /// The time that the call may take.
    #[command(flatten)]
    pub(in crate::cli) limit: Limit,
    /// Set a parameter: `width=2`.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub(in crate::cli) set: Vec<String>,
    /// Also search this folder for recordings and imports.
    #[arg(long = "data", value_name = "DIR")]
    pub(in crate::cli) data: Vec<PathBuf>,
    /// Only this walker: `people[1]`.
    #[arg(long, value_name = "NAME")]
    pub(in crate::cli) agent: Option<String>,
    /// Index of the trial in which the walkers start.
    #[arg(long, default_value_t = 0, value_name = "INDEX")]
    pub(in crate::cli) trial: u64,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(in crate::cli) seed: u64,
    /// Also write a self-contained HTML page that plays the trial, once for each path.
    #[arg(long, value_name = "FILE.html", requires = "scenario")]
    pub(in crate::cli) report: Option<PathBuf>,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = PathFormat::Text)]
    pub(in crate::cli) format: PathFormat,
    /// What an SVG picture shows.
    #[arg(long, value_enum, default_value_t = Figure::Map)]
    pub(in crate::cli) figure: Figure,
    /// How wide it is.
    #[command(flatten)]
    pub(in crate::cli) print: Print,
    /// Also draw on the map where the walkers are planned to be at these times: `3s,6s`.
    #[arg(long, value_name = "TIMES", value_delimiter = ',', value_parser = parse_moment)]
    pub(in crate::cli) at: Vec<f64>,
    /// Time between rows of a table: `0.1s`.
    #[arg(long, default_value = "0.1s", value_name = "TIME", value_parser = parse_step)]
    pub(in crate::cli) dt: f64,
    /// A path by its shape: `L10 A45/7` is a line of 10 m and an arc of 45 degrees with a radius of 7 m; a minus turns right.
    #[arg(long, value_name = "SHAPE")]
    pub(in crate::cli) shape: Option<String>,
    /// A path through way points: a CSV file with the columns `x` and `y`, m.
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) waypoints: Option<PathBuf>,
    /// Largest turning radius at way points.
    #[arg(long, default_value = "1.5m", value_name = "LENGTH", value_parser = parse_length)]
    pub(in crate::cli) corner: f64,
    /// Arcs at way points take at most half of each edge, as in the paper; else all of the first and the last one.
    #[arg(long, requires = "waypoints")]
    pub(in crate::cli) half_edges: bool,
    /// Largest speed along a shape.
    #[arg(long, default_value = "1.5m/s", value_name = "SPEED", value_parser = parse_speed)]
    pub(in crate::cli) speed: f64,
    /// Largest acceleration along a shape; across it, too, without `--across`.
    #[arg(long, default_value = "0.8m/s^2", value_name = "ACCELERATION", value_parser = parse_acceleration)]
    pub(in crate::cli) acceleration: f64,
    /// Largest acceleration across a shape.
    #[arg(long, value_name = "ACCELERATION", value_parser = parse_acceleration)]
    pub(in crate::cli) across: Option<f64>,
    /// Speed at the start of a shape.
    #[arg(long, default_value = "0m/s", value_name = "SPEED", value_parser = parse_speed)]
    pub(in crate::cli) start_speed: f64,
    /// Speed at its end.
    #[arg(long, default_value = "0m/s", value_name = "SPEED", value_parser = parse_speed)]
    pub(in crate::cli) end_speed: f64,
    /// In how many pieces, 2 to 64, the acceleration of a drawn profile is constant (m0); else 4.2 for 10 m, or with
    /// `--by printed` 2 to 10 drawn anew for each.
    #[arg(long, value_name = "N", value_parser = |text: &str| parse_within(text, 2, 64))]
    pub(in crate::cli) pieces: Option<u32>,
    /// Number of profiles that are drawn along a shape, at most 10000.
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = |text: &str| parse_within(text, 0, 10_000))]
    pub(in crate::cli) profiles: u32,
    /// How they are drawn.
    #[arg(long, value_enum, default_value_t = SpeedLaw::Varied)]
    pub(in crate::cli) by: SpeedLaw,
    /// How long each of them takes, if that is long enough.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(in crate::cli) duration: Option<f64>,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
}

/// Formats of `smc path`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum PathFormat {
    /// For people.
    Text,
    /// Roadmap, paths and profiles.
    Json,
    /// One row for each time step.
    Csv,
    /// A picture.
    Svg,
}

/// Pictures of `smc path`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Figure {
    /// The scene, the roadmap and the paths.
    Map,
    /// Speed over place, with the limit curve and the feasible region.
    Phase,
    /// Speed and acceleration over time.
    Speed,
}

/// How profiles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum SpeedLaw {
    /// Around the preferred speed.
    Varied,
    /// From all legal profiles.
    Uniform,
    /// By the algorithm of Li, Li and Ge as printed, for comparison.
    Printed,
}

/// A number with one of some units; without a unit, in the first.
fn parse_quantity(text: &str, units: &[(&str, f64)]) -> Result<f64, String> {
    let text = text.trim();
    let split = text.find(|c: char| c.is_alphabetic() && c != 'e').unwrap_or(text.len());
    let (digits, unit) = text.split_at(split);
    let names: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
    let size =
        units.iter().find(|(name, _)| *name == unit.trim()).or(units.first().filter(|_| unit.is_empty()));
    let value = digits.trim().parse::<f64>().ok().filter(|value| *value >= 0.0 && value.is_finite());
    match (value, size) {
        (Some(value), Some((_, size))) => Ok(value * size),
        _ => Err(format!("`{text}` must be a number of at least 0 in {}", names.join(" or "))),
    }
}

fn parse_length(text: &str) -> Result<f64, String> {
    parse_quantity(text, &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)])
}

fn parse_speed(text: &str) -> Result<f64, String> {
    parse_quantity(text, &[("m/s", 1.0), ("km/h", 1.0 / 3.6)])
}

fn parse_acceleration(text: &str) -> Result<f64, String> {
    parse_quantity(text, &[("m/s^2", 1.0)])
}

/// A positive time.
fn parse_step(text: &str) -> Result<f64, String> {
    match parse_moment(text)? {
        step if step > 0.0 && step.is_finite() => Ok(step),
        _ => Err(format!("`{text}` must be a positive time")),
    }
}
