//! Learned gaits and their scores, as text and JSON: `smc gait fit`, `show` and `score`.

use super::number::counted;
use crate::gait::model::{Coverage, FootSummary, Residuals, Scores, Summary};
use serde::Serialize;
use serde_json::json;
use std::fmt::Write as _;

fn list(numbers: &[f64], digits: usize) -> String {
    numbers.iter().map(|x| format!("{x:.digits$}")).collect::<Vec<_>>().join(", ")
}

/// For people.
pub fn to_text(gait: &Summary) -> String {
    let mut out = String::new();
    for (name, text) in [("source", &gait.source), ("license", &gait.license)] {
        if !text.is_empty() {
            let _ = writeln!(out, "{name:<12} {text}");
        }
    }
    let residuals = match (gait.as_published, gait.residuals) {
        (true, _) => "as published",
        (_, Residuals::Nearest) => "residuals of the nearest steps",
        (_, Residuals::Gaussian) => "normal residuals",
    };
    let steps: usize = gait.subjects.iter().map(|(_, steps)| steps).sum();
    let (people, steps) = (counted(gait.subjects.len() as u64, "subject"), counted(steps as u64, "step"));
    let _ = writeln!(out, "{:<12} {residuals}", "model");
    let _ = writeln!(out, "{:<12} {people}, {steps} between other steps", "learned from");
    for (name, steps) in &gait.subjects {
        let _ = writeln!(out, "  {name:<20} {steps:>6}");
    }
    let _ = writeln!(out, "variance           within  between people");
    for (name, shares) in
        [("length", gait.length), ("duration", gait.duration), ("all columns", gait.columns)]
    {
        let _ =
            writeln!(out, "  {name:<14} {:>6.1} % {:>6.1} %", 100.0 * shares.within, 100.0 * shares.between);
    }
    for (name, foot) in ["left", "right"].into_iter().zip(&gait.feet) {
        side(&mut out, name, foot);
    }
    out
}

fn side(out: &mut String, name: &str, foot: &FootSummary) {
    let _ = writeln!(out, "after a step with the {name} foot");
    let mut row = |name: &str, text: String| _ = writeln!(out, "  {name:<20} {text}");
    row("pairs", foot.pairs.to_string());
    row("first steps", foot.first_steps.to_string());
    let shares: Vec<f64> = foot.explained.iter().map(|share| 100.0 * share).collect();
    let held: f64 = shares.iter().take(foot.components).sum();
    let components = format!("{} hold {held:.1} % of the variance ({})", foot.components, list(&shares, 1));
    row("components", components);
    if !foot.length_scales.is_empty() {
        row("length scales", list(&foot.length_scales, 2));
        row("noise / signal", format!("{:.3}", foot.noise));
        row("points", foot.points.to_string());
    }
    row("variances", list(&foot.variances, 3));
    if let Some(likelihood) = foot.log_likelihood {
        row("log likelihood", format!("{likelihood:.4} for each number"));
    }
}

/// For programs.
pub fn to_json(gait: &impl Serialize) -> String {
    serde_json::to_string_pretty(gait).unwrap_or_default() + "\n"
}

/// Scores of all parts, each by its number of pairs.
fn mean(scores: &[(String, Scores)]) -> Scores {
    let pairs: usize = scores.iter().map(|(_, s)| s.pairs).sum();
    let mean = |of: fn(&Scores) -> f64| {
        scores.iter().map(|(_, s)| s.pairs as f64 * of(s)).sum::<f64>() / pairs.max(1) as f64
    };
    let coverage = Coverage {
        length: mean(|s| s.coverage.length),
        turn: mean(|s| s.coverage.turn),
        duration: mean(|s| s.coverage.duration),
    };
    let left_out = scores.iter().map(|(_, s)| s.left_out).sum();
    Scores { pairs, left_out, nlpd: mean(|s| s.nlpd), crps: mean(|s| s.crps), coverage }
}

/// For people: a row for each part and, if there are several, one for all.
pub fn scores_to_text(scores: &[(String, Scores)]) -> String {
    let mut out = format!(
        "{:<10} {:>6} {:>9} {:>7} {:>7}   coverage of 90 % intervals\n{:<10} {:>6} {:>9} {:>7} {:>7}   {:>8} {:>8} {:>8}\n",
        "", "", "", "", "", "", "pairs", "left out", "NLPD", "CRPS", "length", "turn", "duration"
    );
    let all = (scores.len() > 1).then(|| ("all".to_owned(), mean(scores)));
    for (name, s) in scores.iter().chain(&all) {
        let Coverage { length, turn, duration } = s.coverage;
        let [a, b, c] = [length, turn, duration].map(|share| format!("{:.1} %", 100.0 * share));
        let _ = writeln!(
            out,
            "{name:<10} {:>6} {:>9} {:>7.3} {:>7.3}   {a:>8} {b:>8} {c:>8}",
            s.pairs, s.left_out, s.nlpd, s.crps
        );
    }
    out
}

/// For programs.
pub fn scores_to_json(scores: &[(String, Scores)]) -> String {
    let parts: Vec<_> =
        scores.iter().map(|(name, scores)| json!({ "part": name, "scores": scores })).collect();
    to_json(&json!({ "parts": parts, "all": mean(scores) }))
}
