//! The arguments of `smc plot`.

use crate::report::figure::Figure;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `smc plot`
#[derive(Args, Debug)]
pub(in crate::cli) struct PlotCommand {
    /// Results of `smc check --format json`, or `-` for standard input; for `calibration` those of `smc evaluate`.
    pub(super) results: String,
    /// What is drawn.
    #[arg(long, value_enum)]
    pub(super) figure: FigureName,
    /// Of several queries that could be drawn this one: the name of its property, or its number in writing order.
    #[arg(long, value_name = "NAME")]
    pub(super) only: Option<String>,
    /// The figure; standard output by default.
    #[arg(short, long, value_name = "FILE.svg")]
    pub(super) output: Option<PathBuf>,
}

/// Names of figures.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum FigureName {
    /// Results over a swept parameter.
    Sweep,
    /// Options of a ranking with their intervals.
    Ranking,
    /// The distribution function of a metric with its band.
    Distribution,
    /// How the evidence grew over the trials.
    Evidence,
    /// Predicted probabilities against what happened.
    Calibration,
}

impl FigureName {
    pub(super) const fn of(self) -> Figure {
        match self {
            Self::Sweep => Figure::Sweep,
            Self::Ranking => Figure::Ranking,
            Self::Distribution => Figure::Distribution,
            Self::Evidence => Figure::Evidence,
            Self::Calibration => Figure::Calibration,
        }
    }
}
