//! Evaluated predictions as one JSON object; `docs/schema/evaluate.schema.json` describes it.

use super::{Coverage, Displacement, Evaluated, EvaluatedKind, EvaluatedProperty};
use serde_json::{Value, json};

/// Version of the form of this object.
const SCHEMA: u32 = 1;

/// Files, options, and each property of each kind.
pub fn to_json(report: &Evaluated) -> String {
    format!("{:#}\n", value(report))
}

/// The same as a value.
pub(super) fn value(report: &Evaluated) -> Value {
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
        "coverage": kind.coverage.iter().map(coverage).collect::<Vec<_>>(),
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

fn coverage(found: &Coverage) -> Value {
    json!({ "seconds": found.seconds, "share": found.share, "log_density": found.log_density })
}

fn displacement(found: &Displacement) -> Value {
    json!({
        "mean_path": { "ade": found.mean_ade, "fde": found.mean_fde },
        "best_of": found.best_of,
        "best_path": { "ade": found.best_ade, "fde": found.best_fde },
        "collision_rate": found.collisions,
    })
}
