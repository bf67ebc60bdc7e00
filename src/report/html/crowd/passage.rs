//! Who crossed a line, over time: N(t), its mean and range over the traces, and the flow. A line is crossed as the
//! language's `crossings(L)` counts it, each person once; the ways between the states of a trace are straight.

use super::moments::place;
use super::plan::Figure;
use crate::engine::traces::{Motion, Trace};
use crate::kernel::is_crossed;
use crate::model::Line;
use crate::report::number::{brief, counted, plain, thousandths};
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;

/// Letters of a name.
const MOST_LETTERS: usize = 60;
/// Points of a curve.
const POINTS: u32 = 240;

/// The times at which somebody crossed a line for the first time, ascending, s.
fn crossings(line: &Line, motion: &Motion) -> Vec<f64> {
    let first = |track: &crate::engine::traces::Track| {
        let frames = track.first + 1..track.first + track.points.len();
        let crosses = |frame: &usize| {
            let ends = place(track, frame - 1).zip(place(track, *frame));
            ends.is_some_and(|(from, to)| is_crossed(&line.segment, from, to))
        };
        frames.into_iter().find(crosses).map(|frame| frame as f64 * motion.spacing)
    };
    let mut times: Vec<f64> = motion.tracks.iter().filter_map(first).collect();
    times.sort_by(f64::total_cmp);
    times
}

/// Crossings in each second between the first and the last one; none of fewer than two, or all at once.
pub(super) fn flow(times: &[f64]) -> Option<f64> {
    let (first, last) = (times.first()?, times.last()?);
    (last > first).then(|| (times.len() - 1) as f64 / (last - first))
}

/// `3.2 (1 to 5)`: mean and range.
pub(super) fn spread(numbers: &[f64], unit: &str) -> String {
    let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
    let [low, high] = range(numbers);
    let range = if low < high { format!(" ({} to {})", brief(low), brief(high)) } else { String::new() };
    format!("{}{unit}{range}", brief(mean))
}

fn range(numbers: &[f64]) -> [f64; 2] {
    let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    [low, numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

/// A name as it is shown: very long ones are cut.
fn brief_name(name: &str) -> String {
    let start: String = name.chars().take(MOST_LETTERS).collect();
    if start.len() < name.len() { format!("`{start}…`") } else { format!("`{start}`") }
}

/// The curve of a line.
pub(super) fn figure(line: &Line, traces: &[&Trace]) -> Figure {
    let times: Vec<Vec<f64>> = traces.iter().map(|trace| crossings(line, &trace.motion)).collect();
    let name = brief_name(&line.name);
    let all: Vec<f64> = times.iter().map(|times| times.len() as f64).collect();
    let mut caption = format!("Agents that have crossed {name}, N(t). By the end: {}", spread(&all, ""));
    let flows: Vec<f64> = times.iter().filter_map(|times| flow(times)).collect();
    if flows.is_empty() {
        caption += ". No trace has two crossings at different times, so there is no flow.";
    } else {
        caption += &format!("; flow from the first to the last crossing: {}", spread(&flows, " 1/s"));
        let width = line.segment.length();
        let wide: Vec<f64> = flows.iter().map(|flow| flow / width).collect();
        caption += &format!(", on {} m: {}.", plain(thousandths(width)), spread(&wide, " 1/(m s)"));
    }
    if traces.len() > 1 {
        let all = counted(traces.len() as u64, "trace");
        caption +=
            &format!(" Line: mean, band: range of {all}; a trace that was stopped keeps its last number.");
    }
    let end = traces.iter().map(|trace| trace.end).fold(0.0, f64::max);
    let most = all.iter().copied().fold(1.0, f64::max);
    let (x, y) = (Scale::linear([0.0, end]), Scale::linear([0.0, most]));
    let mut frame = Frame::new(["time (s)", "agents that have crossed"], x, y);
    let mut means = Vec::new();
    let mut ends = Vec::new();
    for k in 0..=POINTS {
        let time = end * f64::from(k) / f64::from(POINTS);
        let so_far = |times: &Vec<f64>| times.partition_point(|one| *one <= time) as f64;
        let now: Vec<f64> = times.iter().map(so_far).collect();
        means.push((time, now.iter().sum::<f64>() / now.len() as f64));
        let [low, high] = range(&now);
        ends.push((time, low, high));
    }
    if traces.len() > 1 {
        frame.band(&ends, 1);
    }
    frame.line(means, 3);
    let svg = Picture::charts(&format!("N(t) through {name}"), vec![frame]).part_of_page();
    Figure { caption, svg, is_wide: true }
}
