//! The arguments of `smc plot`.

use crate::report::figure::Figure;
use clap::Args;
use std::path::PathBuf;

/// `smc plot`
#[derive(Args, Debug)]
pub(in crate::cli) struct PlotCommand {
    /// Results of `smc check --format json`, or `-` for standard input; for `calibration` those of `smc evaluate`.
    pub(super) results: String,
    /// What is drawn.
    #[arg(long, value_enum)]
    pub(super) figure: Figure,
    /// Of several queries that could be drawn this one: the name of its property, or its number in writing order.
    #[arg(long, value_name = "NAME")]
    pub(super) only: Option<String>,
    /// The figure; standard output by default.
    #[arg(short, long, value_name = "FILE.svg")]
    pub(super) output: Option<PathBuf>,
}
