//! Walks of simulated agents, leg by leg, as tables, traces and a picture: `smc walk`.

mod picture;
mod traces;

pub use picture::draw;
pub use traces::write_traces;

use super::number::{count, counted};
use crate::base::geometry::Vec2;
use crate::gait::Foot;
use crate::stats::twosample::Summary;
use serde_json::{Value, json};
use std::fmt::Write as _;

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
    fn summaries(&self) -> [Summary; 3] {
        [0, 1, 2].map(|k| Summary::of(&self.walks.iter().map(|walk| walk.measures[k]).collect::<Vec<_>>()))
    }

    /// Trials in which it did not end.
    fn unfinished(&self, of: &Walked) -> u64 {
        of.trials - self.walks.len() as u64
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
    for legs in walked.agents() {
        let names: Vec<String> =
            legs.iter().map(|leg| format!("{} {} -> {}", leg.number, leg.ends[0], leg.ends[1])).collect();
        let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0).max(4);
        let trials = counted(walked.trials, "trial");
        let _ = writeln!(out, "{}: {trials}, seed {}\n", legs[0].agent, walked.seed);
        let mut row = |name: &str, cells: [&str; 7]| {
            let cells: String = cells.iter().map(|cell| format!(" {cell:>10}")).collect();
            let _ = writeln!(out, "  {name:<width$}{cells}");
        };
        row("", ["", "", "length (m)", "", "time (s)", "", "steps"]);
        row("leg", ["walks", "unfinished", "median", "IQR", "median", "IQR", "median"]);
        for (leg, name) in legs.iter().zip(&names) {
            let [length, time, steps] = leg.summaries();
            let cell = |value: f64| if value.is_nan() { "-".to_owned() } else { format!("{value:.3}") };
            let steps =
                if leg.steps && !leg.walks.is_empty() { steps.median.to_string() } else { "-".into() };
            let cells = [
                count(leg.walks.len() as u64),
                count(leg.unfinished(walked)),
                cell(length.median),
                cell(length.iqr()),
                cell(time.median),
                cell(time.iqr()),
                steps,
            ];
            row(name, cells.each_ref().map(String::as_str));
        }
        out.push('\n');
    }
    if walked.no_way > 0 {
        let _ = writeln!(out, "No way to a goal in {}.", counted(walked.no_way, "trial"));
    }
    if let Some((trial, reason)) = walked.broken.first() {
        let trials = counted(walked.broken.len() as u64, "trial");
        let _ = writeln!(out, "Broken off: {trials}, first trial {trial}: {reason}");
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

/// One object; `docs/schema/legs.schema.json` describes it.
pub fn to_json(walked: &Walked) -> String {
    let summary = |s: Summary| json!({ "median": s.median, "quartiles": [s.low_quartile, s.high_quartile], "iqr": s.iqr(), "mean": s.mean });
    let leg = |leg: &WalkedLeg| {
        let [length, time, steps] = leg.summaries();
        json!({
            "leg": leg.number,
            "from": leg.ends[0],
            "to": leg.ends[1],
            "walks": leg.walks.len(),
            "unfinished": leg.unfinished(walked),
            "length_m": summary(length),
            "time_s": summary(time),
            "steps": if leg.steps { summary(steps) } else { Value::Null },
        })
    };
    let agents = walked
        .agents()
        .map(|legs| json!({ "agent": legs[0].agent, "legs": legs.iter().map(leg).collect::<Vec<_>>() }));
    let broken = walked.broken.iter().map(|(trial, reason)| json!({ "trial": trial, "reason": reason }));
    let all = json!({
        "schema": 1,
        "scenario": walked.title,
        "trials": walked.trials,
        "seed": walked.seed,
        "agents": agents.collect::<Vec<_>>(),
        "trials_without_way": walked.no_way,
        "trials_broken_off": broken.collect::<Vec<_>>(),
    });
    format!("{all:#}\n")
}

/// One row for each leg.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(out: impl std::io::Write, walked: &Walked) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let of = |name: &str| ["median", "q1", "q3", "iqr"].map(|what| format!("{name}_{what}"));
    let heads = ["agent", "leg", "from", "to", "walks", "unfinished"].map(str::to_owned);
    table.write_record(
        heads.into_iter().chain(["length_m", "time_s", "steps"].iter().flat_map(|name| of(name))),
    )?;
    for leg in &walked.legs {
        let [from, to] = leg.ends.clone();
        let (walks, unfinished) = (leg.walks.len().to_string(), leg.unfinished(walked).to_string());
        let known = [leg.agent.clone(), leg.number.to_string(), from, to, walks, unfinished];
        let numbers = leg.summaries().into_iter().enumerate().flat_map(|(k, s)| {
            // What is undefined has no number.
            let cell = |value: f64| {
                if value.is_nan() || k == 2 && !leg.steps { String::new() } else { value.to_string() }
            };
            [s.median, s.low_quartile, s.high_quartile, s.iqr()].map(cell)
        });
        table.write_record(known.into_iter().chain(numbers))?;
    }
    table.flush()
}
