//! Walks of simulated agents, leg by leg, as tables, traces and a picture: `smc walk`.

use crate::base::geometry::Vec2;
use crate::data::table::{CSV, Column, Kind, Table, Value, write};
use crate::gait::Foot;
use crate::model::Scenario;
use crate::report::json::joined;
use crate::report::number::count;
use crate::report::svg::picture::Picture;
use crate::report::svg::{Drawing, Ink, plan};
use crate::stats::twosample::Summary;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io;
use std::io::Write;

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
    fn row(&self, trials: u64) -> serde_json::Value {
        let count = self.walks.len() as u64;
        let known = json!({
            "agent": self.agent,
            "leg": self.number,
            "from": self.ends[0],
            "to": self.ends[1],
            "walks": count,
            "unfinished": trials - count,
        });
        let numbers = |(name, [median, q1, q3, iqr]): (&str, [f64; 4])| {
            let named = [("median", median), ("q1", q1), ("q3", q3), ("iqr", iqr)];
            named.map(|(what, number)| (format!("{name}_{what}"), json!(number)))
        };
        let measures = ["length_m", "time_s", "steps"].into_iter().zip(self.numbers()).flat_map(numbers);
        joined([known, serde_json::Value::Object(measures.collect())])
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
    let cell = |value: serde_json::Value| match value {
        serde_json::Value::Null => String::new(),
        serde_json::Value::String(text) => text,
        number => number.to_string(),
    };
    for (k, leg) in walked.legs.iter().enumerate() {
        let serde_json::Value::Object(row) = leg.row(walked.trials) else { continue };
        if k == 0 {
            table.write_record(row.keys())?;
        }
        table.write_record(row.into_iter().map(|(_, value)| cell(value)))?;
    }
    table.flush()
}

// A picture of many walks: all of them as thin lines, and cells that are the darker the more walks pass them.

/// Side of a cell, m.
const SIDE: f64 = 0.1;

/// Points of a drawn walk are at least so far apart, m.
const APART: f64 = 0.05;

fn cell(p: Vec2) -> (i64, i64) {
    ((p.x / SIDE).floor() as i64, (p.y / SIDE).floor() as i64)
}

/// The points of a walk that are drawn.
fn thinned(points: &[Vec2]) -> Vec<Vec2> {
    let mut drawn: Vec<Vec2> = Vec::new();
    for point in points {
        if drawn.last().is_none_or(|last| (point - last).norm() >= APART) {
            drawn.push(*point);
        }
    }
    drawn.extend(points.last());
    drawn
}

/// Walks as thin lines over cells, the darker the more walks pass them; how many pass the darkest.
pub(super) fn corridor(drawing: &mut Drawing, walks: &[Vec<Vec2>]) -> u64 {
    let mut passed = BTreeMap::<(i64, i64), u64>::new();
    for walk in walks {
        for cell in walk.iter().map(|point| cell(*point)).collect::<BTreeSet<_>>() {
            *passed.entry(cell).or_default() += 1;
        }
    }
    let most = passed.values().copied().max().unwrap_or(1);
    for ((x, y), walks) in passed {
        drawing.cell(Vec2::new(x as f64, y as f64) * SIDE, SIDE, walks as f64 / most as f64);
    }
    for walk in walks.iter().filter(|walk| walk.len() > 1) {
        drawing.line(&thinned(walk), Ink::WALK);
    }
    most
}

/// The picture.
pub fn draw(scenario: &Scenario, walked: &Walked) -> Picture {
    let walks = walked.legs.iter().flat_map(|leg| &leg.walks);
    let walks: Vec<Vec<Vec2>> =
        walks.map(|walk| walk.places.iter().map(|place| place.position).collect()).collect();
    let mut drawing = plan::drawn(scenario, walks.iter().flatten().copied());
    let most = corridor(&mut drawing, &walks);
    plan::name_places(&mut drawing, scenario);
    let (all, most) = (count(walks.len() as u64), count(most));
    drawing.note(&format!("{all} walks; cells of {SIDE} m, up to {most} in one"));
    Picture::plan(if walked.title.is_empty() { "walks" } else { &walked.title }, drawing)
}

// Traces of walks as `smc gait compare` reads them, at any rate: between two states the line between them.

/// Rows nearer to the end of a walk than this give way to the end, s.
const NEAR: f64 = 1e-5;

/// The columns: time from the beginning of the leg, direction from +x to the left.
const COLUMNS: [(&str, Kind); 8] = [
    ("walk", Kind::Word),
    ("leg", Kind::Word),
    ("t", Kind::Number("s")),
    ("x", Kind::Number("m")),
    ("y", Kind::Number("m")),
    ("heading", Kind::Number("deg")),
    ("foot", Kind::Word),
    ("step", Kind::Whole),
];

/// `walk,leg,t,x,y,heading,foot,step` at so many rows a second and at the end of each leg, times and places to 1e-5.
/// Walks that take no time are left out; their number is returned.
///
/// # Errors
/// Errors of the writer.
pub fn write_traces(out: &mut dyn Write, walked: &Walked, rate: f64) -> io::Result<u64> {
    let columns = COLUMNS.map(|(name, kind)| Column::new(name, kind)).to_vec();
    let is_alone = walked.agents().count() == 1;
    let walks = || walked.legs.iter().flat_map(|leg| leg.walks.iter().map(move |walk| (leg, walk)));
    let lasts = |places: &[Place]| walked.dt * places.len().saturating_sub(1) as f64;
    let rows = walks().filter(|(_, walk)| lasts(&walk.places) > 0.0).flat_map(|(leg, walk)| {
        let name =
            |number: u64| if is_alone { number.to_string() } else { format!("{} {number}", leg.agent) };
        let names = [name(walk.trial), name(leg.number as u64)];
        let end = lasts(&walk.places);
        let times = (0_u64..).map(move |k| k as f64 / rate).take_while(move |t| *t < end - NEAR).chain([end]);
        times.map(move |t| {
            let names = names.clone().map(|name| Value::Word(name.into()));
            names.into_iter().chain(row(&walk.places, t, walked.dt)).collect()
        })
    });
    write(&CSV, out, &Table { columns, ..Table::default() }, rows)?;
    Ok(walks().filter(|(_, walk)| lasts(&walk.places) <= 0.0).count() as u64)
}

/// What is after the names: time, place, direction and step.
fn row(places: &[Place], t: f64, dt: f64) -> [Value<'static>; 6] {
    let before = ((t / dt) as usize).min(places.len() - 2);
    let (a, b) = (places[before], places[before + 1]);
    let at = a.position + (b.position - a.position) * (t / dt - before as f64);
    // The quotient of whole numbers is the double nearest to the decimal.
    let rounded = |number: f64, steps: f64| Value::Number((number * steps).round() / steps);
    let (foot, step) = match a.step {
        Some((foot, step)) => {
            let foot = if foot == Foot::Left { "left" } else { "right" };
            (Value::Word(foot.into()), Value::Whole(i64::from(step)))
        }
        None => (Value::Missing, Value::Missing),
    };
    [rounded(t, 1e5), rounded(at.x, 1e5), rounded(at.y, 1e5), rounded(a.heading, 1e2), foot, step]
}
