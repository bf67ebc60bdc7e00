//! Speed against density: a dot for each second of each trace. The density is that of the area that people occupy: their
//! number over the area of all their cells.

use super::figure::Figure;
use super::moments::Moment;
use crate::base::geometry::Vec2;
use crate::report::html::axes::Axes;
use crate::report::html::chart::Axis;
use crate::report::number::count;

/// Dots of a figure.
const MOST_DOTS: usize = 2000;

/// The figure; none where nobody is seen for a second.
pub(super) fn figure(moments: &[Moment]) -> Option<Figure> {
    let dot = |moment: &Moment| {
        let area: f64 = moment.people.iter().map(|(_, area)| area).sum();
        Some(Vec2::new(moment.people.len() as f64 / area, moment.speed?)).filter(|dot| dot.x.is_finite())
    };
    let all: Vec<Vec2> = moments.iter().filter_map(dot).collect();
    let every = all.len().div_ceil(MOST_DOTS).max(1);
    let dots: Vec<Vec2> = all.iter().copied().step_by(every).collect();
    if dots.is_empty() {
        return None;
    }
    let axis = |k: usize| Axis::around(dots.iter().map(|dot| dot[k]).chain([0.0]), false);
    let mut axes = Axes::new((axis(0), "density (agents/m²)"), (axis(1), "mean speed (m/s)"));
    axes.dots(dots.iter().copied());
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
    Some(Figure { caption, svg: axes.finish("Speed against density"), is_wide: true })
}
