//! Inferred traces and groups as a page: tables of counts and scores, and a player in which groups have colours.

use super::InferredFile;
use crate::base::math::median;
use crate::engine::outcome::CallResult;
use crate::engine::traces::{Traces, Walk, recorded};
use crate::model::Scene;
use crate::perception::Inference;
use crate::report::html::{Page, Table};
use crate::report::number::{brief, count};
use crate::syntax::source::Source;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The page. The player has the walls and regions of a scene.
pub fn to_page<'a>(report: &InferredFile, scene: Scene, sources: &'a [Source]) -> Page<'a> {
    let found = report.inference;
    let trace = recorded(report.file, scene, &traces(found));
    Page {
        run: CallResult::of(format!("Traces and groups of {}", report.file), report.options.key.seed),
        sources,
        tables: [counts(found)].into_iter().chain(scores(found)).collect(),
        traces: Traces { list: trace.into_iter().collect(), left_out: 0 },
        without_crowd: false,
    }
}

/// For people: the same tables.
pub fn to_text(report: &InferredFile) -> String {
    let found = report.inference;
    let mut out = format!("{}, {} velocities\n", report.file, report.velocity.name());
    for table in [counts(found)].into_iter().chain(scores(found)) {
        let _ = writeln!(out, "\n{}", table.title);
        for row in &table.rows {
            let _ = writeln!(out, "  {:<48} {}", row[0], row[1..].join("  "));
        }
    }
    out
}

/// The traces, each with the groups of several members that it was in.
pub fn traces(found: &Inference) -> Vec<Walk> {
    let mut walks: BTreeMap<u64, Walk> = BTreeMap::new();
    for one in &found.traces {
        let points = one.trace.points.iter().map(|point| (point.time, point.position)).collect();
        let name = format!("trace[{}]", one.trace.number);
        walks.insert(one.trace.number, Walk { name, points, groups: Vec::new() });
    }
    for instant in found.points.chunk_by(|a, b| a.point.time == b.point.time) {
        let mut members: BTreeMap<u64, u64> = BTreeMap::new();
        for one in instant {
            *members.entry(one.group).or_default() += 1;
        }
        for one in instant {
            let group = Some(one.group).filter(|group| members[group] > 1);
            if let Some(walk) = walks.get_mut(&one.trace)
                && walk.groups.last().map(|(_, group)| *group) != Some(group)
            {
                walk.groups.push((one.point.time, group));
            }
        }
    }
    walks.into_values().collect()
}

fn row(name: &str, value: String) -> Vec<String> {
    vec![name.to_owned(), value]
}

fn counts(found: &Inference) -> Table {
    let lengths = found.traces.iter().map(|one| one.trace.end().time - one.trace.since);
    let middle = median(lengths).unwrap_or(0.0);
    let joint = found.groups.iter().filter(|group| group.members.len() > 1).count();
    let largest = found.groups.iter().map(|group| group.members.len()).max().unwrap_or(0);
    let whole = |number: usize| count(number as u64);
    Table {
        title: "Traces and groups".to_owned(),
        note: "Members of a group are all who were in it at some time.".to_owned(),
        columns: vec!["of the recording", "number"],
        rows: vec![
            row("observations in traces", whole(found.points.len())),
            row("contiguous intervals", whole(found.intervals.len())),
            row("traces", whole(found.traces.len())),
            row("median duration of a trace", format!("{} s", brief(middle))),
            row("groups", whole(found.groups.len())),
            row("groups of several members", whole(joint)),
            row("members of the largest group", whole(largest)),
        ],
    }
}

/// None where there is nothing to agree with.
fn scores(found: &Inference) -> Option<Table> {
    let mut rows = Vec::new();
    let whole = |number: usize| count(number as u64);
    let percent = |share: f64| format!("{} %", brief(100.0 * share));
    if let Some(score) = found.tracks {
        rows.extend([
            row("people with an id", whole(score.tracks)),
            row("people whose observations are all in one trace", whole(score.unsplit)),
            row("changes of the trace of a person", whole(score.switches)),
            row("IDF1", percent(score.idf1)),
            row("traces of several people", whole(score.joins)),
            row("of these, of people who were there at one time", whole(score.wrong_joins)),
        ]);
    }
    if let Some(score) = found.score {
        rows.extend([
            row("annotated groups", whole(score.annotated)),
            row("annotated groups that were together most of the time", whole(score.together)),
            row("annotated groups that were always together", whole(score.always)),
            row("share of the time together", percent(score.share)),
            row("precision of pairs in a group", percent(score.precision)),
            row("recall of pairs in a group", percent(score.recall)),
        ]);
    }
    let title = "Agreement with the ids and groups of the recording".to_owned();
    let table = Table { title, note: String::new(), columns: vec!["score", "value"], rows };
    (!table.rows.is_empty()).then_some(table)
}
