//! The data of the player as JSON: positions as differences from frame to frame.

use super::scene::scene;
use crate::engine::outcome::CallResult;
use crate::engine::traces::{Bar, PlannedWay, Shown, Trace, Track};
use crate::report::number::count;
use crate::report::phrase::{one_line, settings};
use crate::report::text;
use serde::Serialize;
use serde_json::Value;
use std::sync::Arc;

/// All that the player shows.
#[derive(Debug, Serialize)]
pub(super) struct Data<'t> {
    scenes: Vec<Value>,
    traces: Vec<Motion<'t>>,
    pub(super) entries: Vec<Entry<'t>>,
}

/// The agents of a trace.
#[derive(Debug, Serialize)]
struct Motion<'t> {
    scene: usize,
    trial: u64,
    /// The option of moves that is followed.
    option: Option<&'t str>,
    spacing: f64,
    frames: usize,
    end: f64,
    tracks: &'t [Track],
    plans: &'t [PlannedWay],
    /// Groups that change: the first frame, the agent, the group.
    memberships: Vec<(usize, usize, Option<u64>)>,
}

/// What can be chosen: a trace as one of a result.
#[derive(Debug, Default, Serialize)]
pub(super) struct Entry<'t> {
    trace: usize,
    /// Of which result it is; it is listed with the others of it.
    #[serde(skip)]
    pub(super) result: Option<usize>,
    /// The trial and what it shows.
    #[serde(skip)]
    pub(super) trial: u64,
    #[serde(skip)]
    pub(super) shows: Option<crate::engine::outcome::Shows>,
    pub(super) group: String,
    pub(super) label: String,
    /// When it was decided.
    decided: Option<f64>,
    moment: Option<String>,
    what: String,
    agents: Vec<String>,
    command: String,
    bars: &'t [Bar],
}

impl<'t> Data<'t> {
    /// The data of some traces of a run.
    pub(super) fn of(run: &CallResult, traces: &'t [Trace]) -> Self {
        let mut known: Vec<&Arc<crate::model::Scenario>> = Vec::new();
        let mut data = Self { scenes: Vec::new(), traces: Vec::new(), entries: Vec::new() };
        for (number, trace) in traces.iter().enumerate() {
            let scene = known.iter().position(|one| Arc::ptr_eq(one, &trace.scenario)).unwrap_or_else(|| {
                known.push(&trace.scenario);
                data.scenes.push(scene(&trace.scenario));
                known.len() - 1
            });
            data.traces.push(motion(scene, trace));
            if trace.shows.is_empty() {
                // A trial that belongs to no result.
                let label = named(trace);
                data.entries.push(Entry { trace: number, trial: trace.trial, label, ..Entry::default() });
            }
            data.entries.extend(trace.shows.iter().map(|shown| entry(run, number, trace, shown)));
        }
        // One list for each result, in the order of the page.
        data.entries.sort_by_key(|entry| entry.result.map(|k| (run.results[k].asked.index, k)));
        data
    }
}

fn motion(scene: usize, trace: &Trace) -> Motion<'_> {
    let motion = &trace.motion;
    Motion {
        scene,
        trial: trace.trial,
        option: trace.option.as_deref(),
        spacing: motion.spacing,
        frames: motion.frames,
        end: trace.end,
        tracks: &motion.tracks,
        plans: &motion.plans,
        memberships: motion.memberships.iter().map(|one| (one.first, one.agent, one.group)).collect(),
    }
}

/// `trial 17`, `trial 17, stop`, `recording`
fn named(trace: &Trace) -> String {
    if let Some(recording) = &trace.recording {
        return recording.clone();
    }
    let option = trace.option.as_ref().map_or(String::new(), |option| format!(", {option}"));
    format!("trial {}{option}", count(trace.trial))
}

fn entry<'t>(run: &CallResult, number: usize, trace: &'t Trace, shown: &'t Shown) -> Entry<'t> {
    let result = &run.results[shown.result];
    let with = settings(result);
    let group = if with.is_empty() { String::new() } else { format!(" ({with})") };
    let label = if shown.label.is_empty() { String::new() } else { format!("{}: ", shown.label) };
    let outcome = match (shown.shows, &shown.witness) {
        (Some(shows), _) => text::shown(shows, result.of.is_some()).to_owned(),
        (None, Some(witness)) => witness.value.map_or(String::new(), |value| {
            format!("{} {}", crate::report::number::brief(value), result.unit).trim_end().to_owned()
        }),
        (None, None) => "unresolved".to_owned(),
    };
    let name = if shown.label.is_empty() { named(trace) } else { format!("trial {}", count(trace.trial)) };
    let witness = shown.witness.as_ref();
    Entry {
        trace: number,
        result: Some(shown.result),
        trial: trace.trial,
        shows: shown.shows,
        group: format!("{}{group}", one_line(&result.asked.text)),
        label: format!("{label}{name} {outcome}").trim_end().to_owned(),
        decided: witness.map(|one| one.time),
        moment: witness.map(|one| text::moment(one.time, one.unit)),
        what: witness.map_or(String::new(), |one| one.what.clone()),
        agents: witness.map_or_else(Vec::new, |one| one.agents.clone()),
        command: witness.map_or(String::new(), |one| one.command.clone()),
        bars: &shown.bars,
    }
}
