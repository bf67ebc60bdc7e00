//! Speed against density: a dot for each second of each trace. The density is that of the area that people occupy: their
//! number over the area of all their cells.

use super::figure::Figure;
use super::moments::Moment;
use crate::report::number::count;
use crate::report::svg::frame::{Frame, part_of_page};
use crate::report::svg::scale::Scale;

/// Dots of a figure.
const MOST_DOTS: usize = 2000;

/// The figure; none where nobody is seen for a second.
pub(super) fn figure(moments: &[Moment]) -> Option<Figure> {
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
    let shown = if every > 1 {
        format!(" Of {} dots, one in {every} is shown.", count(all.len() as u64))
    } else {
        String::new()
    };
    let caption = format!(
        "Speed against density. Each dot is one second of a trace: the number of agents over the area of all their \
         Voronoi cells (at most 1 m around each, cut at walls and obstacles), and the mean speed of the agents over \
         that second, along straight lines.{shown}"
    );
    Some(Figure { caption, svg: part_of_page("Speed against density", vec![frame]), is_wide: true })
}
