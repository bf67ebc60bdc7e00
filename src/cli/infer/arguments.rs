//! The options of `smc infer`.

use crate::cli::recording::Recorded;
use crate::cli::values::{Print, parse_above_zero, parse_moment};
use crate::perception::Padding;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `smc infer`
#[derive(Args, Debug)]
pub(in crate::cli) struct InferCommand {
    /// Recording or table of observations, or `-` for standard input.
    pub(super) tracks: String,
    /// How the recording is read.
    #[command(flatten)]
    pub(super) recorded: Recorded,
    /// First time.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(super) from: Option<f64>,
    /// Last time.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(super) to: Option<f64>,
    /// Withhold the ids, and use them for the scores alone.
    #[arg(long)]
    pub(super) anonymous: bool,
    /// Annotated groups, one line each, with which the inferred ones are compared.
    #[arg(long, value_name = "FILE")]
    pub(super) annotated: Option<String>,
    /// How observations and traces of unequal number are assigned.
    #[arg(long, value_enum, default_value_t = Padding::Gated)]
    pub(super) padding: Padding,
    /// How traces are projected to the time of an observation.
    #[arg(long, value_enum, default_value_t = MotionModel::Constant)]
    pub(super) motion: MotionModel,
    /// With the social force: a kind of the scene, or a preset; `smc1` by default.
    #[arg(long, value_name = "NAME")]
    pub(super) kind: Option<String>,
    /// With the social force: a scenario (`.scn`) whose walls and obstacles people avoid.
    #[arg(long, value_name = "MODEL")]
    pub(super) scene: Option<String>,
    /// Also search this folder for recordings and imports of the scene. May be given several times.
    #[arg(long = "data", value_name = "DIR", requires = "scene")]
    pub(super) data: Vec<PathBuf>,
    /// Longest time of a projection.
    #[arg(long, value_name = "TIME", default_value = "2s", value_parser = parse_moment)]
    pub(super) projection: f64,
    /// Largest distance of an observation from the projection of its trace, m.
    #[arg(long, value_name = "METRES", default_value = "0.9", value_parser = parse_above_zero)]
    pub(super) threshold: f64,
    /// Largest distance of a member from the centroid of its group, m.
    #[arg(long, value_name = "METRES", default_value = "0.5", value_parser = parse_above_zero)]
    pub(super) cohesion: f64,
    /// What positions and velocities are divided by in groups.
    #[arg(long, num_args = 2, value_names = ["POSITION", "VELOCITY"], default_values = ["2", "1"], value_parser = parse_above_zero)]
    pub(super) discount: Vec<f64>,
    /// Seed of the clustering.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = InferFormat::Text)]
    pub(super) format: InferFormat,
    /// How wide a picture is.
    #[command(flatten)]
    pub(super) print: Print,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Also write a self-contained HTML page that plays the traces and groups.
    #[arg(long, value_name = "FILE.html")]
    pub(super) report: Option<PathBuf>,
}

/// `--motion`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MotionModel {
    /// Everybody keeps the velocity.
    Constant,
    /// Everybody stands.
    Standing,
    /// People react to each other and to the scene, by the social force model.
    SocialForce,
}

/// Formats of `smc infer`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum InferFormat {
    /// For people: counts and scores.
    Text,
    /// One object; see docs/schema/infer.schema.json.
    Json,
    /// One row for each observation: `time,trace,group,x,y,vx,vy,id`.
    Csv,
    /// A picture of traces and groups.
    Svg,
}
