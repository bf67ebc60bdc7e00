//! Walks of simulated agents, leg by leg, as tables, traces and a picture: `smc walk`.

mod picture;
mod traces;

pub use picture::draw;
pub use traces::write_traces;

use crate::base::geometry::Vec2;
use crate::gait::Foot;
use crate::stats::twosample::Summary;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::io;

/// An agent in one state of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Where it is, m.
    pub position: Vec2,
    /// Direction in which it moves or has moved last, degrees from +x to the left.
    pub heading: f64,
    /// The foot that swings and the number of the step on the leg, from 1, or those of the last step.
    pub step: Option<(Foot, u32)>,
}

/// A walk on a leg.
#[derive(Clone, Debug, PartialEq)]
pub struct LegWalk {
    /// The trial.
    pub trial: u64,
    /// Length, m, time, s, and number of steps.
    pub measures: [f64; 3],
    /// The places in all states, if they were asked for.
    pub places: Vec<Place>,
}

/// All walks on a leg of the route of an agent.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkedLeg {
    /// The agent.
    pub agent: String,
    /// Whether it steps.
    pub steps: bool,
    /// The number of the leg on the route, from 1.
    pub number: usize,
    /// Where it begins and ends, by name.
    pub ends: [String; 2],
    /// The walks that ended, in order of trials.
    pub walks: Vec<LegWalk>,
}

/// What a number of trials gave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walked {
    /// Title of the scenario.
    pub title: String,
    /// Number of trials.
    pub trials: u64,
    /// Seed of the trials.
    pub seed: u64,
    /// Time between states, s.
    pub dt: f64,
    /// The legs of one agent after those of another.
    pub legs: Vec<WalkedLeg>,
    /// Trials in which an agent had no way to a goal.
    pub no_way: u64,
    /// Trials that did not start or ended early, and the reason in each.
    pub broken: Vec<(u64, String)>,
}

impl WalkedLeg {
    /// Median, quartiles and interquartile range of length, time and steps; NaN where there are none.
    fn numbers(&self) -> [[f64; 4]; 3] {
        [0, 1, 2].map(|k| {
            let has = k < 2 || self.steps;
            let values: Vec<f64> = self.walks.iter().filter(|_| has).map(|walk| walk.measures[k]).collect();
            let s = Summary::of(&values);
            [s.median, s.low_quartile, s.high_quartile, s.iqr()]
        })
    }

    /// The row of a table, with the names of its columns; null where there is no number.
    fn row(&self, trials: u64) -> Map<String, Value> {
        let [from, to] = &self.ends;
        let count = self.walks.len() as u64;
        let names = ["agent", "leg", "from", "to", "walks", "unfinished"];
        let known = [
            json!(self.agent),
            json!(self.number),
            json!(from),
            json!(to),
            json!(count),
            json!(trials - count),
        ];
        let mut row: Map<_, _> = names.map(str::to_owned).into_iter().zip(known).collect();
        for (name, numbers) in ["length_m", "time_s", "steps"].into_iter().zip(self.numbers()) {
            for (what, number) in ["median", "q1", "q3", "iqr"].into_iter().zip(numbers) {
                row.insert(format!("{name}_{what}"), json!(number));
            }
        }
        row
    }
}

impl Walked {
    /// The agents and their legs.
    fn agents(&self) -> impl Iterator<Item = &[WalkedLeg]> {
        self.legs.chunk_by(|a, b| a.agent == b.agent)
    }
}

/// For people.
pub fn to_text(walked: &Walked) -> String {
    let mut out = String::new();
    let name = |leg: &WalkedLeg| format!("{} {} -> {}", leg.number, leg.ends[0], leg.ends[1]);
    let width = walked.legs.iter().map(|leg| name(leg).chars().count()).max().unwrap_or(0);
    let mut line = |name: &str, cells: &[String]| {
        let cells: String = cells.iter().map(|cell| format!(" {cell:>10}")).collect();
        let _ = writeln!(out, "{}", format!("{name:<width$}{cells}").trim_end());
    };
    let heads = |words: &str| words.split(',').map(str::to_owned).collect::<Vec<_>>();
    for (k, legs) in walked.agents().enumerate() {
        if k > 0 {
            line("", &[]);
        }
        line(&legs[0].agent, &heads(",,length (m),,time (s),,steps"));
        line("leg", &heads("walks,unfinished,median,IQR,median,IQR,median"));
        for leg in legs {
            let [[length, .., lengths], [time, .., times], [steps, ..]] = leg.numbers();
            let count = leg.walks.len() as u64;
            let mut cells = vec![count.to_string(), (walked.trials - count).to_string()];
            let shown = |value: f64| if value.is_nan() { "-".to_owned() } else { format!("{value:.3}") };
            cells.extend([length, lengths, time, times].map(shown));
            cells.push(if steps.is_nan() { "-".to_owned() } else { steps.to_string() });
            line(&name(leg), &cells);
        }
    }
    out
}

/// One object; `docs/schema/legs.schema.json` describes it.
pub fn to_json(walked: &Walked) -> String {
    let broken = walked.broken.iter().map(|(trial, reason)| json!({ "trial": trial, "reason": reason }));
    let all = json!({
        "schema": 1,
        "scenario": walked.title,
        "trials": walked.trials,
        "seed": walked.seed,
        "legs": walked.legs.iter().map(|leg| leg.row(walked.trials)).collect::<Vec<_>>(),
        "trials_without_way": walked.no_way,
        "trials_broken_off": broken.collect::<Vec<_>>(),
    });
    format!("{all:#}\n")
}

/// One row for each leg.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(out: impl io::Write, walked: &Walked) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let cell = |value: Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text,
        number => number.to_string(),
    };
    let rows: Vec<Map<String, Value>> = walked.legs.iter().map(|leg| leg.row(walked.trials)).collect();
    if let Some(first) = rows.first() {
        table.write_record(first.keys())?;
    }
    for row in rows {
        table.write_record(row.into_iter().map(|(_, value)| cell(value)))?;
    }
    table.flush()
}
