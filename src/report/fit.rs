//! Fitted parameters: `smc fit`.
//!
//! Losses are printed as scores: of positions the mean logarithm of the density, 1/m^2, of which more is better; of properties the
//! Brier score, of which less is better.

use super::number::{brief, count, counted, estimated, plain};
use super::text::columns::table;
use crate::replay::fit::{Candidate, Comparison, Found, Generation};
use crate::stats::Estimate;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Version of the form of the JSON object.
const SCHEMA: u32 = 1;

/// Parameters fitted to a recording, and how.
#[derive(Clone, Debug)]
pub struct FittedModel {
    /// Name of the scenario's file.
    pub model: String,
    /// Name of the recording.
    pub recording: String,
    /// Which velocities were used.
    pub velocity: &'static str,
    /// Names of the files of properties; without any, positions were compared.
    pub properties: Vec<String>,
    /// The kind.
    pub kind: String,
    /// What the kind of the result starts from.
    pub base: String,
    /// Trials of each instant.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Time between instants, s.
    pub every: f64,
    /// Number of instants of persons.
    pub instants: u64,
    /// Confidence of intervals.
    pub confidence: f64,
    /// What the search found.
    pub found: Found,
    /// Another model, and the losses there.
    pub test: Option<(String, Option<Comparison>)>,
}

impl FittedModel {
    /// The sign that makes a score of a loss.
    fn sign(&self) -> f64 {
        if self.properties.is_empty() { -1.0 } else { 1.0 }
    }

    fn score(&self) -> &'static str {
        if self.properties.is_empty() { "mean log density (1/m^2)" } else { "Brier score" }
    }

    /// The declarations that a scenario needs.
    pub fn block(&self) -> String {
        let field = |one: &Candidate| one.parameter.field(one.value, brief);
        let (people, kind): (Vec<&Candidate>, Vec<&Candidate>) =
            self.found.parameters.iter().partition(|one| matches!(one.parameter.name(), "heading" | "speed"));
        let mut out = format!("kind fitted: {} {{\n", self.base);
        for one in kind {
            let _ = writeln!(out, "  {}", field(one));
        }
        out.push_str("}\n");
        if !people.is_empty() {
            let _ = writeln!(out, "// Fields of all people that start `from {}`:", self.recording);
            for one in people {
                let _ = writeln!(out, "//   {}", field(one));
            }
        }
        out
    }

    /// Compares two states of the model.
    fn comparison(&self, name: &str, of: &Comparison) -> Vec<String> {
        let sign = self.sign();
        vec![
            name.to_owned(),
            count(of.persons),
            brief(sign * of.before),
            estimated(&times(&of.after, sign), ""),
            estimated(&of.gain, ""),
        ]
    }

    /// Tables, and the declarations.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        let by = self.properties.join(", ");
        let by = if by.is_empty() { "positions after 1, 2 and 4.8 s".to_owned() } else { by };
        let Self { recording, velocity, model, kind, seed, .. } = self;
        let _ = writeln!(out, "{recording} ({velocity} velocities), {model}, kind {kind}, by {by}");
        let (instants, every) = (counted(self.instants, "instant"), plain(self.every));
        let (trials, candidates) =
            (counted(self.trials, "trial"), counted(self.found.candidates, "candidate"));
        let _ = writeln!(
            out,
            "{instants}, every {every} s; {trials} an instant, seed {seed}; {candidates} in {}\n",
            counted(self.found.generations.len() as u64, "generation"),
        );
        let row = |one: &Candidate| {
            let (unit, size) = one.parameter.unit();
            let ends = one.interval.map_or_else(
                || "-".to_owned(),
                |[low, high]| format!("[{}, {}]", brief(low / size), brief(high / size)),
            );
            vec![
                one.parameter.name().to_owned(),
                unit,
                brief(one.start / size),
                brief(one.value / size),
                ends,
            ]
        };
        let heads = ["parameter", "unit", "start", "fitted", "interval"];
        table(&mut out, "  ", &heads, self.found.parameters.iter().map(row));
        let _ = writeln!(out, "\n{}", self.score());
        let test = self.test.as_ref().map(|(name, of)| (name.as_str(), of));
        let named = [("fitted to", &self.found.fitted), ("held out", &self.found.held_out)];
        let named = named.into_iter().chain(test);
        let rows = named.filter_map(|(name, of)| Some(self.comparison(name, of.as_ref()?)));
        table(&mut out, "  ", &["persons", "number", "model", "fitted", "better by"], rows);
        let _ = writeln!(out, "\n{}", self.block());
        let level = plain(100.0 * self.confidence);
        let _ = writeln!(out, "Brackets: {level} % intervals (bootstrap over persons).");
        out
    }

    /// One object; `docs/schema/fit.schema.json` describes it.
    pub fn to_json(&self) -> String {
        let sign = self.sign();
        let parameter = |one: &Candidate| {
            let (unit, size) = one.parameter.unit();
            json!({
                "name": one.parameter.name(),
                "unit": unit,
                "start": one.start / size,
                "value": one.value / size,
                "interval": one.interval.map(|ends| ends.map(|end| end / size)),
            })
        };
        let comparison = |of: &Comparison| {
            json!({
                "persons": of.persons,
                "count": of.count,
                "model": sign * of.before,
                "fitted": times(&of.after, sign),
                "gain": of.gain,
            })
        };
        let generation = |one: &Generation| {
            let named = self.found.parameters.iter().zip(&one.values);
            let values: serde_json::Map<String, Value> = named
                .map(|(of, value)| (of.parameter.name().to_owned(), json!(value / of.parameter.unit().1)))
                .collect();
            json!({ "number": one.number, "best": sign * one.best, "mean": sign * one.mean, "reach": one.reach, "values": values })
        };
        let all = json!({
            "schema": SCHEMA,
            "model": self.model,
            "recording": self.recording,
            "velocity": self.velocity,
            "properties": self.properties,
            "kind": self.kind,
            "score": if self.properties.is_empty() { "log_density" } else { "brier" },
            "trials": self.trials,
            "seed": self.seed,
            "every": self.every,
            "instants": self.instants,
            "confidence": self.confidence,
            "parameters": self.found.parameters.iter().map(parameter).collect::<Vec<_>>(),
            "fitted": self.found.fitted.as_ref().map(comparison),
            "held_out": self.found.held_out.as_ref().map(comparison),
            "test": self.test.as_ref().map(|(model, of)| json!({
                "model": model,
                "score": of.as_ref().map(comparison),
            })),
            "candidates": self.found.candidates,
            "generations": self.found.generations.iter().map(generation).collect::<Vec<_>>(),
            "block": self.block(),
        });
        format!("{all:#}\n")
    }
}

/// One line of the log of a search.
pub fn generation(one: &Generation, names: &[&str], by_properties: bool) -> String {
    let sign = if by_properties { 1.0 } else { -1.0 };
    let values: Vec<String> =
        names.iter().zip(&one.values).map(|(name, value)| format!("{name} {}", brief(*value))).collect();
    format!(
        "generation {}: best {}, mean {}, spread {}; {}\n",
        one.number,
        brief(sign * one.best),
        brief(sign * one.mean),
        brief(one.reach),
        values.join(", ")
    )
}

/// An estimate times 1 or -1.
fn times(of: &Estimate, sign: f64) -> Estimate {
    let turn = |[low, high]: [f64; 2]| if sign < 0.0 { [-high, -low] } else { [low, high] };
    Estimate { value: sign * of.value, interval: of.interval.map(turn) }
}
