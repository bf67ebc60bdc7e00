//! The options of `smc gait`.

use crate::cli::values::{Print, TextFormat};
use crate::data::mocap::{Asf, Layout, Up, bvh_preset};
use crate::gait::model::Residuals;
use crate::gait::steps::Contact;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `smc gait`
#[derive(Debug, Subcommand)]
pub(in crate::cli) enum GaitCommand {
    /// Cut motion capture into steps: a report, a table or a picture.
    Steps(StepsCommand),
    /// Learn a gait from motion capture.
    Fit(FitCommand),
    /// Describe a learned gait.
    Show(ShowCommand),
    /// Draw steps from a learned gait, as a table.
    Sample(SampleCommand),
    /// Measure how well a gait predicts steps that it was not learned from.
    Score(ScoreCommand),
    /// Compare two sets of recorded or simulated walks.
    Compare(CompareCommand),
}

/// Motion capture, and how it is read.
#[derive(Args, Debug)]
pub(in crate::cli) struct Reading {
    /// Takes (`.bvh`, `.amc` with its `.asf` beside, `.csv` with positions) and tables of takes (`.csv` with the columns `file`,
    /// `clip`, `subject`, `fps`); `-` reads one of these tables from standard input.
    #[arg(required = true, value_name = "DATA")]
    pub(super) data: Vec<String>,
    /// Joints, unit and axes as in this data set; by default those that fit each file.
    #[arg(long, value_name = "NAME", value_parser = choice(Layout::presets()))]
    pub(super) source: Option<Layout>,
    /// Length that a coordinate of 1 stands for: `1cm`, `1in`, `0.0564m`.
    #[arg(long, value_name = "LENGTH", value_parser = parse_unit)]
    pub(super) unit: Option<f64>,
    /// Axis that points up.
    #[arg(long, value_name = "AXIS", value_parser = choice([("y", Up::Y), ("z", Up::Z)]))]
    pub(super) up: Option<Up>,
    /// Frames per second of files that do not state them.
    #[arg(long, value_name = "RATE")]
    pub(super) fps: Option<f64>,
    /// Joint in the middle of the hip.
    #[arg(long, value_name = "JOINT")]
    pub(super) root: Option<String>,
    /// Joints of the left ankle and toe: `LeftFoot,LeftToeBase`.
    #[arg(long, value_name = "ANKLE,TOE", value_parser = parse_foot)]
    pub(super) left: Option<[String; 2]>,
    /// Joints of the right ankle and toe.
    #[arg(long, value_name = "ANKLE,TOE", value_parser = parse_foot)]
    pub(super) right: Option<[String; 2]>,
    /// Number of frames at the begin of each take that are no motion.
    #[arg(long, value_name = "FRAMES")]
    pub(super) skip: Option<usize>,
    /// Position channels of BVH joints replace their offsets instead of being added to them.
    #[arg(long)]
    pub(super) replace_offsets: bool,
    /// Angles are in radians, not in degrees.
    #[arg(long)]
    pub(super) radians: bool,
    /// Rule for contact of a foot with the ground: its speed, or the adaptive thresholds of Agethen et al. (2018).
    #[arg(long, value_name = "RULE", default_value = "rest", value_parser = choice(Contact::NAMES))]
    pub(super) contact: Contact,
    /// Only steps of these subjects.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with = "except")]
    pub(super) subjects: Vec<String>,
    /// No steps of these subjects.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(super) except: Vec<String>,
}

impl Reading {
    /// The layout of a file with its text, and whether it is that of the file's own joints or extension.
    pub(super) fn layout(&self, file: &str, text: &str, skeleton: Option<&Asf>) -> Option<(Layout, bool)> {
        let preset =
            || bvh_preset(text).or_else(|| Layout::of_file(file, skeleton).map(|(_, layout)| layout));
        let mut layout = self.source.clone().or_else(preset)?;
        let own = layout.clone();
        layout.unit = self.unit.unwrap_or(layout.unit);
        layout.up = self.up.unwrap_or(layout.up);
        layout.fps = self.fps.or(layout.fps);
        layout.skip = self.skip.unwrap_or(layout.skip);
        layout.replace_offsets |= self.replace_offsets;
        layout.radians |= self.radians;
        layout.root = self.root.clone().unwrap_or(layout.root);
        layout.left = self.left.clone().unwrap_or(layout.left);
        layout.right = self.right.clone().unwrap_or(layout.right);
        let is_own = self.source.is_none() && layout == own;
        Some((layout, is_own))
    }
}

/// `smc gait steps`
#[derive(Args, Debug)]
pub(in crate::cli) struct StepsCommand {
    /// The data.
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = StepsFormat::Text)]
    pub(super) format: StepsFormat,
    /// How wide a picture is.
    #[command(flatten)]
    pub(super) print: Print,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

/// Formats of `smc gait steps`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum StepsFormat {
    /// For people: steps, length and cadence of each take, and what was dropped.
    Text,
    /// One row for each step.
    Csv,
    /// The root paths of all steps, aligned.
    Svg,
}

/// How a gait is learned.
#[derive(Args, Debug)]
pub(in crate::cli) struct Learning {
    /// Share of the variance that the components of a step hold.
    #[arg(long, default_value_t = 0.95, value_name = "SHARE")]
    pub(super) variance: f64,
    /// How steps vary about their mean: as after one of the 32 nearest recorded steps, or normally distributed.
    #[arg(long, value_name = "RULE", default_value = "nearest",
        value_parser = choice([("nearest", Residuals::Nearest), ("gaussian", Residuals::Gaussian)]))]
    pub(super) residuals: Residuals,
    /// Number of inducing points of the Gaussian process.
    #[arg(long, default_value_t = 128, value_name = "POINTS")]
    pub(super) sparse: usize,
    /// A Gaussian process of all steps, up to 2000 pairs for each foot.
    #[arg(long, conflicts_with = "sparse")]
    pub(super) exact: bool,
    /// A linear function instead of a Gaussian process, for comparison.
    #[arg(long, conflicts_with_all = ["sparse", "exact"])]
    pub(super) linear: bool,
    /// The model as Agethen et al. (2018) describe it, for comparison.
    #[arg(long, conflicts_with = "linear")]
    pub(super) as_published: bool,
}

/// `smc gait fit`
#[derive(Args, Debug)]
pub(in crate::cli) struct FitCommand {
    /// The data.
    #[command(flatten)]
    pub(super) reading: Reading,
    /// How it is learned.
    #[command(flatten)]
    pub(super) learning: Learning,
    /// Where the steps are from; kept in the file.
    #[arg(long, default_value = "", value_name = "TEXT")]
    pub(super) source_note: String,
    /// What their license asks for; kept in the file.
    #[arg(long, default_value = "", value_name = "TEXT")]
    pub(super) license: String,
    /// File to write.
    #[arg(short, long, value_name = "FILE.gait")]
    pub(super) output: PathBuf,
}

/// `smc gait show`
#[derive(Args, Debug)]
pub(in crate::cli) struct ShowCommand {
    /// The learned gait.
    #[arg(value_name = "FILE.gait")]
    pub(super) gait: String,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

/// `smc gait sample`
#[derive(Args, Debug)]
pub(in crate::cli) struct SampleCommand {
    /// The learned gait.
    #[arg(value_name = "FILE.gait")]
    pub(super) gait: String,
    /// Number of steps; each person makes twenty.
    #[arg(short = 'n', long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub(super) number: u32,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

/// `smc gait score`
#[derive(Args, Debug)]
pub(in crate::cli) struct ScoreCommand {
    /// The data; if the first file is a learned gait (`.gait`), the others were held out from it.
    #[command(flatten)]
    pub(super) reading: Reading,
    /// How gaits are learned from the other folds.
    #[command(flatten)]
    pub(super) learning: Learning,
    /// Without a learned gait: number of parts, by subject, of which each is held out once.
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub(super) folds: u16,
    /// Format of the scores.
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

/// `smc gait compare`
#[derive(Args, Debug)]
pub(in crate::cli) struct CompareCommand {
    /// The base (A), such as recorded walks: a CSV file with the columns `walk`, `t` (s), `x` and `y` (m), and perhaps
    /// `leg`; `-` for standard input.
    #[arg(value_name = "BASE.csv")]
    pub(super) base: String,
    /// The sets that are compared with it (B, C, ...), such as simulated walks; at most eight.
    #[arg(value_name = "CANDIDATE.csv", required = true, num_args = 1..=8)]
    pub(super) candidates: Vec<String>,
    /// Walks with the same name belong together: also test whether they differ (Wilcoxon).
    #[arg(long)]
    pub(super) paired: bool,
    /// With one candidate: also write the distance of each point to the nearest one of the other set.
    #[arg(long, value_name = "FILE.csv")]
    pub(super) points: Option<PathBuf>,
    /// Seed of permutations, resamples and halves.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Format of the comparison.
    #[arg(long, value_enum, default_value_t = WalksFormat::Text)]
    pub(super) format: WalksFormat,
    /// How wide a picture is.
    #[command(flatten)]
    pub(super) print: Print,
    /// A scenario whose barriers a picture shows.
    #[arg(long, value_name = "MODEL.scn")]
    pub(super) scene: Option<String>,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

/// Formats of `smc gait compare`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum WalksFormat {
    /// For people.
    Text,
    /// One object; see docs/schema/walks.schema.json.
    Json,
    /// All sets beside each other, each with its corridor of walks.
    Svg,
}

/// One of some values by its name.
fn choice<T: Clone + Send + Sync + 'static, const N: usize>(
    values: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    let names = PossibleValuesParser::new(values.each_ref().map(|(name, _)| *name));
    names.try_map(move |given| {
        let found = values.iter().find(|(name, _)| *name == given);
        found.map(|(_, value)| value.clone()).ok_or("unknown name")
    })
}

/// The ankle and the toe of a foot.
fn parse_foot(text: &str) -> Result<[String; 2], String> {
    let names = text.split_once(',').map(|(ankle, toe)| [ankle.trim().to_owned(), toe.trim().to_owned()]);
    let names = names.filter(|names| names.iter().all(|name| !name.is_empty() && !name.contains(',')));
    names.ok_or_else(|| format!("`{text}` must be two joints: `LeftFoot,LeftToeBase`"))
}

/// Metres in a unit of length.
fn parse_unit(text: &str) -> Result<f64, String> {
    const UNITS: [(&str, f64); 6] =
        [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("ft", 0.3048), ("m", 1.0), ("", 1.0)];
    let text = text.trim();
    let found = UNITS.iter().find_map(|(name, size)| {
        let value: f64 = text.strip_suffix(name)?.trim().parse().ok()?;
        Some(value * size).filter(|unit| *unit > 0.0 && unit.is_finite())
    });
    found.ok_or_else(|| format!("`{text}` must be a positive length such as `1cm` (mm, cm, in, ft, m)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_feet_are_read() {
        for (text, unit) in [("1cm", 0.01), ("1 in", 0.0254), ("0.0564", 0.0564), ("2m", 2.0), ("1mm", 1e-3)]
        {
            assert_eq!(parse_unit(text), Ok(unit));
        }
        for text in ["0cm", "cm", "1 parsec", "NaN", "-1m"] {
            assert!(parse_unit(text).is_err(), "{text}");
        }
        assert_eq!(parse_foot("a, b"), Ok(["a".to_owned(), "b".to_owned()]));
        assert!(parse_foot("a").is_err() && parse_foot("a,").is_err() && parse_foot("a,b,c").is_err());
    }
}
