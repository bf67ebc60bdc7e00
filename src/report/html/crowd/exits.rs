//! People who left the scene before a trace ended: by which region, how many, how fast, and how long it took from their places of
//! start.

use super::moments::place;
use super::passage::{flow, spread};
use crate::base::geometry::Vec2;
use crate::engine::traces::Trace;
use crate::model::Scene;
use crate::report::html::table::Table;

/// Somebody who leaves at most so far from a region leaves by it, m.
const BESIDE: f64 = 1.0;

/// Somebody who left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaver {
    /// The first place, m.
    pub(super) from: Vec2,
    /// The last place, m.
    to: Vec2,
    /// When this person left, s.
    at: f64,
    /// The time from the first to the last moment, s.
    pub(super) took: f64,
}

/// Everybody who left in a trace; nobody in a recording, where people are just not seen any more.
pub(super) fn leavers(trace: &Trace) -> Vec<Leaver> {
    let motion = &trace.motion;
    let leaver = |track: &crate::engine::traces::Track| {
        let last = (track.first + track.points.len()).checked_sub(1)?;
        let (from, to) = (place(track, track.first)?, place(track, last)?);
        let (at, took) = (last as f64, (last - track.first) as f64);
        let has_left = last + 1 < motion.frames && trace.recording.is_none();
        has_left.then_some(Leaver { from, to, at: at * motion.spacing, took: took * motion.spacing })
    };
    motion.tracks.iter().filter_map(leaver).collect()
}

/// The region by which somebody left.
fn exit<'s>(scene: &'s Scene, leaver: &Leaver) -> &'s str {
    let regions = scene
        .regions
        .iter()
        .filter(|region| region.is_declared())
        .map(|region| (region.shape.distance(leaver.to), region.name.as_str()));
    let beside = regions.filter(|(distance, _)| *distance <= BESIDE);
    beside.min_by(|a, b| a.0.total_cmp(&b.0)).map_or("elsewhere", |(_, name)| name)
}

/// A row for each exit: its name, persons, flow from the first to the last one, and when the last one left; means with ranges over
/// the traces.
pub(super) fn table(traces: &[&Trace]) -> Table {
    let scene = &traces[0].scenario.scene;
    let left: Vec<Vec<Leaver>> = traces.iter().map(|trace| leavers(trace)).collect();
    let mut names: Vec<&str> = left.iter().flatten().map(|leaver| exit(scene, leaver)).collect();
    names.sort_unstable();
    names.dedup();
    let row = |name: &str| {
        let times = left.iter().map(|left| {
            let here = left.iter().filter(|leaver| exit(scene, leaver) == name).map(|leaver| leaver.at);
            let mut times: Vec<f64> = here.collect();
            times.sort_by(f64::total_cmp);
            times
        });
        let times: Vec<Vec<f64>> = times.collect();
        let persons: Vec<f64> = times.iter().map(|times| times.len() as f64).collect();
        let flows: Vec<f64> = times.iter().filter_map(|times| flow(times)).collect();
        let last: Vec<f64> = times.iter().filter_map(|times| times.last().copied()).collect();
        let flow = if flows.is_empty() { String::new() } else { spread(&flows, "") };
        vec![name.to_owned(), spread(&persons, ""), flow, spread(&last, "")]
    };
    Table {
        title: "Exits".into(),
        columns: vec!["left by", "persons", "flow (1/s)", "last (s)"],
        rows: names.into_iter().map(row).collect(),
        ..Table::default()
    }
}
