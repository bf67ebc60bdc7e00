//! Heat maps: where people were, how densely they stood around each other, and where they touched, on a grid of square
//! cells.
//!
//! Seven shades from the map `viridis` stand for values. Their brightness goes one way, so that they can be told apart in
//! grey and by those who do not see some colours; the brightest is nearest to the paper.

use super::exits::leavers;
use super::moments::{Moment, place};
use super::plan::{Figure, Plan};
use crate::base::geometry::{Bounds, Vec2};
use crate::engine::traces::{Motion, Trace};
use crate::report::number::{brief, exponent, plain, power};
use std::fmt::Write as _;

/// Cells of a grid.
const MOST_CELLS: f64 = 9000.0;
/// Cells of the map of places of start: each needs several people.
const MOST_STARTS: f64 = 400.0;
/// Cells of a map that name their value.
const MOST_NAMED: usize = 1600;
/// Sides of cells, m; ten times as long after the last.
const SIDES: [f64; 3] = [0.2, 0.5, 1.0];
/// Shades of a map.
const SHADES: usize = 7;
/// This share of the cells has a shade of its own; the few above have the last one.
const TYPICAL: f64 = 0.98;

/// What is known of a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    /// Time of agents in it, and in it while they touch somebody, s.
    seconds: f64,
    touching: f64,
    /// Sum of densities around agents in it, and their number.
    density: f64,
    agents: f64,
    /// Sum of the times that it took from there to leave, s, and the number of those who left.
    leaving: f64,
    leavers: f64,
}

/// Square cells.
#[derive(Debug)]
struct Grid {
    low: Vec2,
    side: f64,
    columns: usize,
    cells: Vec<Cell>,
}

impl Grid {
    /// The finest grid of at most so many cells over some bounds.
    fn over(bounds: &Bounds, most: f64) -> Self {
        let powers = std::iter::successors(Some(1.0), |power| Some(10.0 * power)).take(9);
        let sides = powers.flat_map(|power: f64| SIDES.map(|side| side * power));
        let size = |side: f64| {
            let cells = |low: f64, high: f64| (high / side).floor() - (low / side).floor() + 1.0;
            [cells(bounds.low.x, bounds.high.x), cells(bounds.low.y, bounds.high.y)]
        };
        let fits = |side: &f64| size(*side).iter().product::<f64>() <= most;
        let side = sides.clone().find(fits).unwrap_or(f64::INFINITY);
        let [columns, rows] = size(side).map(|count| count.clamp(1.0, most) as usize);
        let low = bounds.low.map(|part| (part / side).floor() * side);
        Self { low, side, columns, cells: vec![Cell::default(); columns * rows] }
    }

    /// The cell of a place; none of a place on another level.
    fn at(&mut self, place: Vec2) -> Option<&mut Cell> {
        if place.x < self.low.x
            || place.y < self.low.y
            || place.x > self.low.x + self.columns as f64 * self.side
        {
            return None;
        }
        let [column, row] = [0, 1].map(|axis| ((place[axis] - self.low[axis]) / self.side) as usize);
        self.cells.get_mut(row * self.columns + column.min(self.columns - 1))
    }

    /// The agents of each frame of a motion.
    fn add(&mut self, motion: &Motion) {
        let widest = motion.tracks.iter().map(|track| track.radius).max().unwrap_or(0);
        for frame in 0..motion.frames {
            let here = motion.tracks.iter().filter_map(|track| Some((place(track, frame)?, track.radius)));
            let mut here: Vec<(Vec2, i32)> = here.collect();
            here.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x));
            let mut touches = vec![false; here.len()];
            for (k, (at, radius)) in here.iter().enumerate() {
                let reach = f64::from(radius + widest) / 1000.0;
                for (other, (to, other_radius)) in here.iter().enumerate().skip(k + 1) {
                    if to.x - at.x > reach {
                        break;
                    }
                    if (to - at).norm() <= f64::from(radius + other_radius) / 1000.0 {
                        (touches[k], touches[other]) = (true, true);
                    }
                }
            }
            for ((at, _), touches) in here.iter().zip(touches) {
                if let Some(cell) = self.at(*at) {
                    cell.seconds += motion.spacing;
                    cell.touching += if touches { motion.spacing } else { 0.0 };
                }
            }
        }
    }
}

/// The maps of some traces of one scene; none of contact where nobody touches, and of recordings, which have no bodies.
pub(super) fn figures(plan: &Plan, traces: &[&Trace], moments: &[Moment]) -> Vec<Figure> {
    let mut grid = Grid::over(plan.walked(), MOST_CELLS);
    for trace in traces {
        grid.add(&trace.motion);
    }
    for (at, area) in moments.iter().flat_map(|moment| &moment.people) {
        if let (Some(cell), true) = (grid.at(*at), *area > 0.0) {
            cell.density += 1.0 / area;
            cell.agents += 1.0;
        }
    }
    if traces.iter().any(|trace| trace.recording.is_some()) {
        grid.cells.iter_mut().for_each(|cell| cell.touching = 0.0);
    }
    let time: f64 = traces.iter().map(|trace| trace.motion.frames as f64 * trace.motion.spacing).sum();
    let scale = 1.0 / (grid.side * grid.side * time);
    let side = plain(grid.side);
    let map = |title: &str, unit: &str, said: &str, value: &dyn Fn(&Cell) -> f64| {
        let title = &on_level(title, plan);
        let svg = drawn(plan, &grid, (title, unit), value)?;
        Some(Figure { caption: format!("{title}: {said} Cells of {side} m."), svg, is_wide: plan.is_wide() })
    };
    let maps = [
        map(
            "Presence",
            "agent-seconds per m² and second",
            "the time that agents spent in a cell, by its area and the time of all traces.",
            &|cell| cell.seconds * scale,
        ),
        map(
            "Density",
            "agents/m²",
            "the mean of 1 / area of the Voronoi cell of the agents that were there, once a second.",
            &|cell| if cell.agents > 0.0 { cell.density / cell.agents } else { 0.0 },
        ),
        map(
            "Contact",
            "share of time in contact",
            "of the time that agents spent in a cell, the share in which they touched another agent.",
            &|cell| if cell.seconds > 0.0 { cell.touching / cell.seconds } else { 0.0 },
        ),
    ];
    maps.into_iter().flatten().chain(time_to_leave(plan, traces)).collect()
}

/// The map of the time that it took to leave, by place of start; none where nobody leaves.
fn time_to_leave(plan: &Plan, traces: &[&Trace]) -> Option<Figure> {
    let mut grid = Grid::over(plan.walked(), MOST_STARTS);
    for leaver in traces.iter().flat_map(|trace| leavers(trace)) {
        if let Some(cell) = grid.at(leaver.from) {
            cell.leaving += leaver.took;
            cell.leavers += 1.0;
        }
    }
    let mean = |cell: &Cell| if cell.leavers > 0.0 { cell.leaving / cell.leavers } else { 0.0 };
    let title = on_level("Time to leave", plan);
    let svg = drawn(plan, &grid, (&title, "s"), &mean)?;
    let caption = format!(
        "{title}: the mean time of those who started in a cell and left. Cells of {} m.",
        plain(grid.side)
    );
    Some(Figure { caption, svg, is_wide: plan.is_wide() })
}

/// A title, with the level or the stairs.
fn on_level(title: &str, plan: &Plan) -> String {
    if plan.name.is_empty() { title.to_owned() } else { format!("{title} on {}", plan.name) }
}

/// A round width of a shade, such that all shades reach a number.
fn width(top: f64) -> f64 {
    let least = top / SHADES as f64;
    let power = power(exponent(least));
    let round = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].map(|part| part * power);
    // A number such as 1.5 is not exact times a power of ten.
    round.into_iter().find(|width| *width >= least * (1.0 - 1e-9)).unwrap_or(least)
}

fn drawn(
    plan: &Plan,
    grid: &Grid,
    (title, unit): (&str, &str),
    value: &dyn Fn(&Cell) -> f64,
) -> Option<String> {
    let values: Vec<f64> = grid.cells.iter().map(value).collect();
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| *value > 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let most = *sorted.last()?;
    let is_named = sorted.len() <= MOST_NAMED;
    let typical = sorted[((sorted.len() - 1) as f64 * TYPICAL) as usize];
    let width = width(typical);
    let mut cells = String::new();
    let shade = |value: f64| match value {
        value if value > 0.0 => ((value / width * (1.0 - 1e-9)) as usize).min(SHADES - 1) + 1,
        _ => 0,
    };
    // Cells of one shade in a row are one rectangle where there is no room for their values.
    let runs = values.chunks(grid.columns).enumerate().flat_map(|(row, values)| {
        let runs = values.chunk_by(|a, b| !is_named && shade(*a) == shade(*b));
        runs.scan(0, move |column, run| {
            *column += run.len();
            Some((row, *column - run.len(), run))
        })
    });
    for (row, column, run) in runs.filter(|(.., run)| run[0] > 0.0) {
        let (value, shade, wide) = (&run[0], shade(run[0]), run.len());
        let title = if is_named { format!("<title>{}</title>", brief(*value)) } else { String::new() };
        let _ = writeln!(
            cells,
            "<rect class=\"h{shade}\" x=\"{column}\" y=\"{row}\" width=\"{wide}\" height=\"1\">{title}</rect>"
        );
    }
    let mut legend = String::new();
    for k in 0..=SHADES {
        let x = f64::from(k as u32) * plan.shade();
        if k < SHADES {
            let (shade, wide) = (k + 1, plan.shade());
            let _ = write!(
                legend,
                "<rect class=\"h{shade}\" x=\"{x:.1}\" y=\"0\" width=\"{wide:.1}\" height=\"10\"/>"
            );
        }
        // Long numbers would touch.
        if plan.is_wide() || k % 2 == 0 {
            let number = plain((width * k as f64 * 1e9).round() / 1e9);
            let _ = write!(legend, "<text class=\"tick\" x=\"{x:.1}\" y=\"22\">{number}</text>");
        }
    }
    let above =
        if most > SHADES as f64 * width { format!(", at most {}", brief(most)) } else { String::new() };
    let _ = writeln!(legend, "<text class=\"tick first\" x=\"-10\" y=\"38\">{unit}{above}</text>");
    Some(plan.finish(title, (grid.low, grid.side), &cells, &legend))
}
