//! Predicted probabilities of properties against what recorded people did: `smc evaluate`.

#[cfg(test)]
mod tests;
mod text;

use super::figure;
use super::figure::{Figure, Flaw};
use crate::data::tracks::Velocity;
use crate::report::number::plain;
use crate::report::svg::picture::Picture;
use crate::stats::{Estimate, Quality};
use serde_json::{Value, json};
use std::io;
pub use text::to_text;

/// The kind with which others are compared: people who keep their velocity.
pub const CONSTANT: &str = "constant";

/// The reliability diagrams, which `smc plot --figure calibration` draws, too.
///
/// # Errors
/// Nothing was evaluated.
pub fn to_svg(report: &Evaluated) -> Result<Picture, Flaw> {
    figure::draw(Figure::Calibration, &value(report), None)
}

/// Predictions for a recording, and how they were made.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluated {
    /// Name of the scenario's file.
    pub model: String,
    /// Names of the files of properties.
    pub properties: Vec<String>,
    /// Name of the recording.
    pub recording: String,
    /// Which velocities were used.
    pub velocity: Velocity,
    /// Trials of each instant.
    pub trials: u64,
    /// Seed of the trials and resamples.
    pub seed: u64,
    /// Time between instants, s.
    pub every: f64,
    /// A person counts as moving above this speed, m/s.
    pub moving: f64,
    /// Predicted time, s.
    pub horizon: f64,
    /// Confidence of intervals.
    pub confidence: f64,
    /// Number of instants of persons.
    pub instants: u64,
    /// Number of persons.
    pub persons: u64,
    /// The kinds, in order.
    pub kinds: Vec<EvaluatedKind>,
}

/// Predictions of one kind of agent.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluatedKind {
    /// Its name.
    pub name: String,
    /// The properties, in order.
    pub properties: Vec<EvaluatedProperty>,
    /// How far predicted paths are from walked ones, if it was asked for.
    pub displacement: Option<Displacement>,
    /// How well recorded positions fit predicted ones, after some times.
    pub coverage: Vec<Coverage>,
    /// The mean logarithm of the likelihood of what was recorded, number by number, if it was asked for.
    pub realism: Vec<(&'static str, Option<Estimate>)>,
}

/// Recorded positions among those that trials predict.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Coverage {
    /// After how many seconds.
    pub seconds: f64,
    /// Share of recorded positions in the 90 % region of the predicted ones.
    pub share: Option<Estimate>,
    /// Mean logarithm of the density, 1/m^2, of the normal law of the predicted positions at the recorded ones.
    pub log_density: Option<Estimate>,
}

/// Predictions of one property by one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluatedProperty {
    /// Its name.
    pub name: String,
    /// Number of instants at which the recording does not show whether it happened.
    pub unresolved: u64,
    /// Quality of the predictions, also over those of the kind `constant`; `None` without predictions.
    pub quality: Option<Quality>,
}

/// Distances of predicted paths from the walked one, m, and touches; each `None` where nothing was predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// Mean distance of the mean path over all times.
    pub mean_ade: Option<Estimate>,
    /// Distance of the end of the mean path.
    pub mean_fde: Option<Estimate>,
    /// Number of paths of which the best is taken.
    pub best_of: u64,
    /// Least mean distance of so many paths.
    pub best_ade: Option<Estimate>,
    /// Least distance of the ends of so many paths.
    pub best_fde: Option<Estimate>,
    /// Share of predicted paths that touch a recorded person.
    pub collisions: Option<Estimate>,
}

impl Evaluated {
    /// Names of the properties, in the order in which kinds have them.
    fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for property in self.kinds.iter().flat_map(|kind| &kind.properties) {
            if !names.contains(&property.name.as_str()) {
                names.push(property.name.as_str());
            }
        }
        names
    }

    /// What each kind predicts of a property.
    fn of<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (&'a EvaluatedKind, &'a EvaluatedProperty)> {
        self.kinds.iter().filter_map(move |kind| {
            let property = kind.properties.iter().find(|property| property.name == name)?;
            Some((kind, property))
        })
    }
}

// The bins of evaluated predictions as CSV.

/// `kind,property,bin,count,low,high,mean,share`, one row a bin, from 1.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(out: impl io::Write, report: &Evaluated) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["kind", "property", "bin", "count", "low", "high", "mean", "share"])?;
    for kind in &report.kinds {
        for property in &kind.properties {
            let bins = property.quality.iter().flat_map(|quality| &quality.score.bins);
            for (number, bin) in (1_u32..).zip(bins) {
                let counts = [number.to_string(), bin.count.to_string()];
                let numbers = [bin.low, bin.high, bin.mean, bin.share].map(plain);
                let names = [&kind.name, &property.name];
                table.write_record(names.into_iter().chain(&counts).chain(&numbers))?;
            }
        }
    }
    table.flush()
}

// Evaluated predictions as one JSON object; `docs/schema/evaluate.schema.json` describes it.

/// Version of the form of this object.
const SCHEMA: u32 = 1;

/// Files, options, and each property of each kind.
pub fn to_json(report: &Evaluated) -> String {
    format!("{:#}\n", value(report))
}

/// The same as a value.
fn value(report: &Evaluated) -> Value {
    json!({
        "schema": SCHEMA,
        "model": report.model,
        "properties": report.properties,
        "recording": report.recording,
        "velocity": report.velocity.name(),
        "trials": report.trials,
        "seed": report.seed,
        "every": report.every,
        "moving": report.moving,
        "horizon": report.horizon,
        "confidence": report.confidence,
        "instants": report.instants,
        "persons": report.persons,
        "kinds": report.kinds.iter().map(kind).collect::<Vec<_>>(),
    })
}

fn kind(kind: &EvaluatedKind) -> Value {
    json!({
        "name": kind.name,
        "properties": kind.properties.iter().map(property).collect::<Vec<_>>(),
        "displacement": kind.displacement.as_ref().map(displacement),
        "coverage": kind.coverage,
        "realism": kind.realism.iter().map(|(name, found)| ((*name).to_owned(), json!(found))).collect::<serde_json::Map<_, _>>(),
    })
}

fn property(property: &EvaluatedProperty) -> Value {
    let quality = property.quality.as_ref();
    let score = quality.map(|quality| &quality.score);
    json!({
        "name": property.name,
        "predictions": score.map_or(0, |score| score.count),
        "unresolved": property.unresolved,
        "base_rate": score.map(|score| score.base_rate),
        "brier": quality.map(|quality| quality.brier),
        "reliability": score.map(|score| score.reliability),
        "resolution": score.map(|score| score.resolution),
        "uncertainty": score.map(|score| score.uncertainty),
        "within_bin_variance": score.map(|score| score.within_bin_variance),
        "within_bin_covariance": score.map(|score| score.within_bin_covariance),
        "calibration_error": quality.map(|quality| quality.calibration_error),
        "skill": quality.and_then(|quality| quality.skill),
        "skill_over_constant": quality.and_then(|quality| quality.skill_over_other),
        "bins": score.map_or(&[][..], |score| &score.bins),
        "histogram": score.map_or([0; 10], |score| score.histogram),
    })
}

fn displacement(found: &Displacement) -> Value {
    json!({
        "mean_path": { "ade": found.mean_ade, "fde": found.mean_fde },
        "best_of": found.best_of,
        "best_path": { "ade": found.best_ade, "fde": found.best_fde },
        "collision_rate": found.collisions,
    })
}
