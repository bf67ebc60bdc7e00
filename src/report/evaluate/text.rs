//! Evaluated predictions for people.

use super::{CONSTANT, Displacement, Evaluated, EvaluatedKind, EvaluatedProperty};
use crate::report::number::{count, counted, estimated, maybe_estimated, plain, thousandths};
use crate::report::text::columns::table;
use crate::stats::Estimate;
use std::fmt::Write as _;

/// Tables for each property, and one of distances.
pub fn to_text(report: &Evaluated) -> String {
    let mut out = String::new();
    let velocity = report.velocity.name();
    let files = report.properties.join(", ");
    let _ = writeln!(out, "{} ({velocity} velocities), {}, {files}", report.recording, report.model);
    let (instants, persons) = (counted(report.instants, "instant"), counted(report.persons, "person"));
    let [moving, every, horizon] = [report.moving, report.every, report.horizon].map(plain);
    let _ = writeln!(
        out,
        "{instants} of {persons} faster than {moving} m/s, every {every} s; horizon {horizon} s"
    );
    let _ = writeln!(out, "{} an instant, seed {}", counted(report.trials, "trial"), report.seed);
    for name in report.names() {
        let kinds: Vec<_> = report.of(name).collect();
        let _ = writeln!(out, "\n{name}");
        scores(&mut out, &kinds);
        for (kind, property) in &kinds {
            if let Some(skill) = property.quality.as_ref().and_then(|quality| quality.skill_over_other) {
                let _ = writeln!(out, "  {}: {}", kind.name, compared(&skill));
            }
        }
        terms(&mut out, &kinds);
    }
    distances(&mut out, &report.kinds);
    coverage(&mut out, &report.kinds);
    realism(&mut out, &report.kinds);
    let _ = writeln!(
        out,
        "\nBrier score: mean squared difference of probability and outcome; 0 is best.\n\
         Skill: 1 - Brier score / Brier score of the base rate; 1 is best, 0 is as good as the base rate.\n\
         Terms: Brier score = reliability - resolution + uncertainty + variance - 2 covariance, the last two in bins.\n\
         Brackets: {} % intervals (bootstrap over persons).",
        plain(100.0 * report.confidence)
    );
    out
}

/// How much better than the kind `constant`.
fn compared(skill: &Estimate) -> String {
    let percent = Estimate {
        value: 100.0 * skill.value,
        interval: skill.interval.map(|ends| ends.map(|end| 100.0 * end)),
    };
    let say = |found: &Estimate| format!("{} of the Brier score", estimated(found, " %"));
    match percent.interval {
        Some([low, high]) if high < 0.0 => {
            let worse = Estimate { value: -percent.value, interval: Some([-high, -low]) };
            format!("worse than {CONSTANT} by {}", say(&worse))
        }
        Some([low, _]) if low > 0.0 => format!("better than {CONSTANT} by {}", say(&percent)),
        Some(_) => format!("not clearly different from {CONSTANT}: {}", say(&percent)),
        None if percent.value < 0.0 => {
            let worse = Estimate { value: -percent.value, ..percent };
            format!("worse than {CONSTANT} by {}, without an interval", say(&worse))
        }
        None => format!("better than {CONSTANT} by {}, without an interval", say(&percent)),
    }
}

fn maybe(estimate: Option<Estimate>) -> String {
    maybe_estimated(estimate, "")
}

fn scores(out: &mut String, kinds: &[(&EvaluatedKind, &EvaluatedProperty)]) {
    let rows = kinds.iter().map(|(kind, property)| {
        let quality = property.quality.as_ref();
        vec![
            kind.name.clone(),
            count(quality.map_or(0, |quality| quality.score.count)),
            count(property.unresolved),
            maybe(quality.map(|quality| quality.brier)),
            maybe(quality.and_then(|quality| quality.skill)),
            maybe(quality.map(|quality| quality.calibration_error)),
        ]
    });
    let heads = ["kind", "predictions", "unresolved", "Brier score", "skill", "calibration error"];
    table(out, "  ", &heads, rows);
}

/// The row of a kind.
fn row(kind: &EvaluatedKind, numbers: impl IntoIterator<Item = String>) -> Vec<String> {
    std::iter::once(kind.name.clone()).chain(numbers).collect()
}

/// The terms of the Brier score.
fn terms(out: &mut String, kinds: &[(&EvaluatedKind, &EvaluatedProperty)]) {
    let rows = kinds.iter().filter_map(|(kind, property)| {
        let score = &property.quality.as_ref()?.score;
        let terms = [
            score.base_rate,
            score.reliability,
            score.resolution,
            score.uncertainty,
            score.within_bin_variance,
            score.within_bin_covariance,
        ];
        Some(row(kind, terms.map(|term| format!("{:.3}", thousandths(term)))))
    });
    let rows: Vec<_> = rows.collect();
    if !rows.is_empty() {
        let heads =
            ["terms", "base rate", "reliability", "resolution", "uncertainty", "variance", "covariance"];
        table(out, "  ", &heads, rows);
    }
}

/// Distances of predicted from walked paths.
fn distances(out: &mut String, kinds: &[EvaluatedKind]) {
    let Some(found) = kinds.iter().find_map(|kind| kind.displacement) else { return };
    let paths = counted(found.best_of, "path");
    let _ = writeln!(out, "\ndistances (m) of the mean path and of the best of {paths}");
    let rows = kinds.iter().filter_map(|kind| {
        let Displacement { mean_ade, mean_fde, best_ade, best_fde, collisions, .. } = kind.displacement?;
        Some(row(kind, [mean_ade, mean_fde, best_ade, best_fde, collisions].map(maybe)))
    });
    let heads = ["kind", "mean ADE", "mean FDE", "best ADE", "best FDE", "collision rate"];
    table(out, "  ", &heads, rows);
    let _ = writeln!(
        out,
        "  ADE: mean over all times; FDE: at the end; collision rate: share of paths that touch somebody"
    );
}

/// How many recorded positions are where they were predicted.
fn coverage(out: &mut String, kinds: &[EvaluatedKind]) {
    let rows = kinds.iter().flat_map(|kind| {
        let known = kind.coverage.iter().filter(|found| found.share.is_some());
        known.map(|found| row(kind, [plain(found.seconds), maybe(found.share), maybe(found.log_density)]))
    });
    let rows: Vec<_> = rows.collect();
    if !rows.is_empty() {
        let _ = writeln!(out, "\nrecorded positions in the 90 % region of the predicted ones");
        table(out, "  ", &["kind", "after s", "share", "log density"], rows);
        let _ =
            writeln!(out, "  log density: mean logarithm of the density of the predicted positions, 1/m^2");
    }
}

/// How likely the recorded motion is.
fn realism(out: &mut String, kinds: &[EvaluatedKind]) {
    let asked = kinds.iter().filter(|kind| !kind.realism.is_empty());
    let rows: Vec<_> =
        asked.map(|kind| row(kind, kind.realism.iter().map(|(_, found)| maybe(*found)))).collect();
    if !rows.is_empty() {
        let _ = writeln!(out, "\nmean log likelihood of the recorded motion among 32 trials; 0 is best");
        let heads = ["kind", "speed", "acceleration", "nearest", "time to collision", "contact"];
        table(out, "  ", &heads, rows);
    }
}
