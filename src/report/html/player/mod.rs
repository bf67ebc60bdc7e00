//! The player of a page: the traces behind the results, drawn in the browser.

mod data;
mod scene;

use crate::engine::outcome::{CallResult, Shows, Witness};
use crate::engine::traces::{Trace, Traces, Track};
use crate::report::number::{counted, plain};
use data::Data;
use std::collections::BTreeSet;

/// What the template needs of the player.
#[derive(Clone, Debug)]
pub(super) struct Player {
    /// The data, safe inside a script element.
    pub(super) json: String,
    /// What is shown and what is left out.
    pub(super) note: String,
    /// The entries of each result, with their numbers.
    pub(super) groups: Vec<(String, Vec<(usize, String)>)>,
    /// By number: place of the result, trial, what it shows.
    entries: Vec<(Option<usize>, u64, Option<Shows>)>,
}

impl Player {
    /// The player of some traces; `None` without any.
    pub(super) fn of(run: &CallResult, traces: Traces) -> Option<Self> {
        let Traces { mut list, mut left_out } = traces;
        let numbers = list.iter().map(|one| one.scenario.agents.len().max(one.motion.tracks.len()));
        let numbers = numbers.max().unwrap_or(0);
        let thinned = thin(&mut list, MOST_BYTES, |list| json(&Data::of(run, list)).len());
        if list.is_empty() {
            return None;
        }
        left_out += thinned.traces;
        let mut spacings: Vec<f64> =
            list.iter().map(|trace| trace.motion.spacing).filter(|s| *s > 0.0).collect();
        spacings.sort_by(f64::total_cmp);
        spacings.dedup();
        let unit = list[0].unit();
        let each = match spacings.as_slice() {
            [] => "The truth of the atoms is shown at each change.".to_owned(),
            _ if list.iter().all(|trace| trace.motion.tracks.is_empty()) => "No agent is present.".to_owned(),
            [one] => format!("States every {} {unit}, positions to 1 mm.", plain(*one)),
            [first, .., last] => {
                let [first, last] = [*first, *last].map(plain);
                format!("States every {first} {unit} to every {last} {unit}, positions to 1 mm.")
            }
        };
        let mut note = each;
        if thinned.every > 0 {
            let (all, every) = (counted(numbers as u64, "agent"), thinned.every);
            note += &format!(" Of up to {all}, one in {every} is shown, with those that decided.");
        }
        if left_out > 0 {
            note += &format!(" Left out: {}; a page holds 2 MB.", counted(left_out as u64, "trace"));
        }
        let data = Data::of(run, &list);
        let mut groups: Vec<(String, Vec<(usize, String)>)> = Vec::new();
        for (number, entry) in data.entries.iter().enumerate() {
            let label = (number, entry.label.clone());
            match groups.last_mut().filter(|(group, _)| *group == entry.group) {
                Some((_, labels)) => labels.push(label),
                None => groups.push((entry.group.clone(), vec![label])),
            }
        }
        let entries = data.entries.iter().map(|entry| (entry.result, entry.trial, entry.shows)).collect();
        Some(Self { json: json(&data), note, groups, entries })
    }

    /// The number of a witness of a result, if it is there.
    pub(super) fn number(&self, result: usize, witness: &Witness) -> Option<usize> {
        let wanted = (Some(result), witness.trial, Some(witness.shows));
        self.entries.iter().position(|entry| *entry == wanted)
    }
}

/// Data as JSON in which nothing ends a script element.
fn json(data: &Data) -> String {
    serde_json::to_string(data).unwrap_or_default().replace('<', "\\u003c")
}

// Traces made small enough for a page.

/// Most bytes of the data of a page.
const MOST_BYTES: usize = 2_000_000;
/// Frames lie at most so far apart while there are other means, s.
const COARSE: f64 = 0.75;
/// So many agents are shown while there are other means.
const FEW: usize = 400;

/// What was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Thinned {
    /// Of so many agents those are shown whose number is a multiple of this, besides those who decided; 0 where all are.
    every: usize,
    /// Traces.
    traces: usize,
}

/// Makes traces smaller until `size` of them is small enough: frames first, then agents, then whole traces from the last on.
fn thin(traces: &mut Vec<Trace>, most: usize, size: impl Fn(&[Trace]) -> usize) -> Thinned {
    let mut thinned = Thinned::default();
    while size(traces) > most && !traces.is_empty() {
        let finest = traces.iter().map(|trace| trace.motion.spacing).fold(f64::INFINITY, f64::min);
        let crowd = traces.iter().map(|trace| trace.motion.tracks.len()).max().unwrap_or(0);
        if finest < COARSE {
            for trace in traces.iter_mut().filter(|trace| trace.motion.spacing <= finest) {
                trace.motion.halve();
            }
        } else if crowd > FEW {
            thinned.every = 2 * thinned.every.max(1);
            for trace in traces.iter_mut() {
                keep(trace, thinned.every);
            }
        } else if traces.len() > 1 {
            traces.pop();
            thinned.traces += 1;
        } else if traces[0].motion.frames > 2 {
            traces[0].motion.halve();
        } else {
            // What remains is the texts of atoms: nothing more can be dropped but the whole.
            thinned.traces += traces.len();
            traces.clear();
        }
    }
    thinned
}

/// Of the agents of a trace keeps some, and all who decided or whose name is not one of many.
fn keep(trace: &mut Trace, every: usize) {
    let decided: BTreeSet<String> = {
        let witnesses = trace.shows.iter().filter_map(|shown| shown.witness.as_ref());
        witnesses.flat_map(|witness| witness.agents.iter().cloned()).collect()
    };
    let is_kept = |track: &Track| {
        track.agent.is_multiple_of(every) || !track.name.ends_with(']') || decided.contains(&track.name)
    };
    trace.motion.keep(is_kept);
}
