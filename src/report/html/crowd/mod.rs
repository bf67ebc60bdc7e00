//! Crowds on a page, from the traces that are kept for its player: heat maps, exits, N(t) through lines, speed against
//! density. All are drawn when the page is made.

mod dense;
mod exits;
mod heat;
mod moments;
mod passage;
mod plan;
#[cfg(test)]
mod tests;

use crate::base::tick::Clock;
use crate::engine::outcome::CallResult;
use crate::engine::traces::Trace;
use crate::kernel::Voronoi;
use crate::model::Scene;
use crate::report::html::table::Table;
use crate::report::number::{count, counted, duration};
use crate::report::phrase::settings;
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;
use moments::Moment;
pub(in crate::report::html) use plan::Figure;
use plan::Plan;
use std::sync::Arc;

/// So many agents in a trace are a crowd.
const CROWD: usize = 8;
/// So many scenes of a sweep, and so many lines of a scene, are shown.
const MOST_SCENES: usize = 2;
const MOST_LINES: usize = 8;
/// So many levels and stairs have heat maps of their own.
const MOST_ISLANDS: usize = 4;

/// The figures of one scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Crowd {
    /// The values of parameters; empty where there is one scene.
    pub(super) head: String,
    /// Which traces they are from, and what is left out.
    pub(super) note: String,
    /// The exits by which people left, and the places at which they stood close; those without a row are left out.
    pub(super) tables: Vec<Table>,
    pub(super) figures: Vec<Figure>,
}

/// The figures of the traces of a run, scene by scene, and what is left out.
pub(super) fn crowds(run: &CallResult, traces: &[Trace]) -> (Vec<Crowd>, String) {
    let mut scenes: Vec<Vec<&Trace>> = Vec::new();
    for trace in traces {
        if !matches!(trace.scenario.clock, Clock::Stepped(_)) || trace.motion.tracks.is_empty() {
            continue;
        }
        match scenes.iter_mut().find(|scene| Arc::ptr_eq(&scene[0].scenario, &trace.scenario)) {
            Some(scene) => scene.push(trace),
            None => scenes.push(vec![trace]),
        }
    }
    scenes.retain(|traces| is_crowd(traces) || !traces[0].scenario.scene.lines.is_empty());
    let left_out = scenes.len().saturating_sub(MOST_SCENES);
    let mut shown: Vec<Crowd> =
        scenes.iter().take(MOST_SCENES).filter_map(|traces| crowd(run, traces)).collect();
    if scenes.len() == 1 {
        for one in &mut shown {
            one.head.clear();
        }
    }
    let left_out = match left_out as u64 {
        0 => String::new(),
        scenes => format!("Left out: the figures of {}.", counted(scenes, "scene")),
    };
    (shown, left_out)
}

fn is_crowd(traces: &[&Trace]) -> bool {
    traces.iter().any(|trace| trace.motion.tracks.len() >= CROWD)
}

fn crowd(run: &CallResult, traces: &[&Trace]) -> Option<Crowd> {
    let scene = &traces[0].scenario.scene;
    let whole = Plan::of(scene, None, traces)?;
    let (mut figures, mut tables, mut unmapped) = (Vec::new(), Vec::new(), 0);
    let lines = scene.lines.iter().take(MOST_LINES).map(|line| passage::figure(line, traces));
    if is_crowd(traces) {
        let moments = moments::moments(&Voronoi::new(scene), traces.iter().map(|trace| &trace.motion));
        let (plans, others) = plans(scene, whole, traces, &moments);
        figures.extend(plans.iter().flat_map(|plan| heat::figures(plan, traces, &moments)));
        unmapped = others;
        figures.extend(lines);
        figures.extend(speed_density(&moments));
        tables = vec![exits::table(traces), dense::table(scene, &moments, traces.len())];
    } else {
        figures.extend(lines);
    }
    let seconds = duration(traces.iter().map(|trace| trace.end).sum());
    let mut note = format!("From {} of the player, {seconds} in all.", counted(traces.len() as u64, "trace"));
    let shown = traces.iter().find_map(|trace| trace.shows.first());
    if shown.is_some() {
        note += " They were kept for what they show, and are no random sample.";
    }
    let more = scene.lines.len().saturating_sub(MOST_LINES);
    if more > 0 {
        note += &format!(" Left out: {}.", counted(more as u64, "line"));
    }
    if unmapped > 0 {
        let all = scene.storeys.islands.len();
        note += &format!(" Left out: the maps of {unmapped} of {all} levels and stairs, with fewer people.");
    }
    let result = shown.and_then(|shown| run.results.get(shown.result));
    if tables.last().is_some_and(|dense| dense.rows.is_empty()) {
        note += &format!(" Nowhere did two or more people stand closer than {} per m².", dense::CLOSE);
    }
    tables.retain(|table| !table.rows.is_empty());
    Some(Crowd { head: result.map_or(String::new(), settings), note, tables, figures })
}

/// The plans that have heat maps: of the whole scene, or of the levels and stairs on which people spent the most time; and how
/// many others people were on.
fn plans(scene: &Scene, whole: Plan, traces: &[&Trace], moments: &[Moment]) -> (Vec<Plan>, usize) {
    let storeys = &scene.storeys;
    if storeys.are_none() {
        return (vec![whole], 0);
    }
    let mut seconds = vec![0.0; storeys.islands.len()];
    for moment in moments {
        for (at, _) in &moment.people {
            seconds[storeys.island_at(*at)] += moment.seconds;
        }
    }
    let mut shown: Vec<usize> = (0..seconds.len()).filter(|island| seconds[*island] > 0.0).collect();
    shown.sort_by(|a, b| seconds[*b].total_cmp(&seconds[*a]));
    let others = shown.split_off(shown.len().min(MOST_ISLANDS)).len();
    shown.sort_unstable();
    let plans = shown.into_iter().filter_map(|island| Plan::of(scene, Some(island), traces));
    (plans.collect(), others)
}

// Speed against density: a dot for each second of each trace. The density is that of the area that people occupy: their
// number over the area of all their cells.

/// Dots of a diagram of speed and density.
const MOST_DOTS: usize = 2000;

/// The diagram; none where nobody is seen for a second.
fn speed_density(moments: &[Moment]) -> Option<Figure> {
    let dot = |moment: &Moment| {
        let area: f64 = moment.people.iter().map(|(_, area)| area).sum();
        Some((moment.people.len() as f64 / area, moment.speed?)).filter(|(density, _)| density.is_finite())
    };
    let all: Vec<(f64, f64)> = moments.iter().filter_map(dot).collect();
    let every = all.len().div_ceil(MOST_DOTS).max(1);
    let dots: Vec<(f64, f64)> = all.iter().copied().step_by(every).collect();
    if dots.is_empty() {
        return None;
    }
    let x = Scale::linear(dots.iter().map(|dot| dot.0).chain([0.0]));
    let y = Scale::linear(dots.iter().map(|dot| dot.1).chain([0.0]));
    let mut frame = Frame::new(["density (agents/m²)", "mean speed (m/s)"], x, y);
    frame.cloud(dots, 1);
    let shown = match every {
        1 => String::new(),
        _ => format!(" Of {} dots, one in {every} is shown.", count(all.len() as u64)),
    };
    let caption = format!(
        "Speed against density. Each dot is one second of a trace: the number of agents over the area of all their \
         Voronoi cells (at most 1 m around each, cut at walls and obstacles), and the mean speed of the agents over \
         that second, along straight lines.{shown}"
    );
    let svg = Picture::charts("Speed against density", vec![frame]).part_of_page();
    Some(Figure { caption, svg, is_wide: true })
}
