//! Predicted probabilities of properties against what recorded people did: `smc evaluate`.

mod csv;
mod json;
mod text;

pub use csv::write_csv;
pub use json::to_json;
pub use text::to_text;

use super::figure::{self, Figure, Flaw};
use crate::data::tracks::Velocity;
use crate::stats::{Estimate, Quality};

/// The kind with which others are compared: people who keep their velocity.
pub const CONSTANT: &str = "constant";

/// The reliability diagrams, which `smc plot --figure calibration` draws, too.
///
/// # Errors
/// Nothing was evaluated.
pub fn to_svg(report: &Evaluated) -> Result<String, Flaw> {
    figure::draw(Figure::Calibration, &json::value(report), None)
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
#[derive(Clone, Copy, Debug, PartialEq)]
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

#[cfg(test)]
mod tests;
