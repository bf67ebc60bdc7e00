//! Images of agents on a closed plane: those that someone near the end of a period feels behind it.
//!
//! They stand behind the agents in rows of their own, strip by strip. Of two opposite images one is listed, and an image
//! looks at nobody: so each pair is found once, by the agent of the two that has the other's image.

use super::Cells;
use super::reach::Reach;
use crate::base::geometry::Vec2;
use crate::base::lanes::LANES;
use crate::model::Periods;

/// Where the images of each cell start; each strip has one more for its end. Empty on an open plane.
#[derive(Clone, Debug, Default)]
pub(super) struct Images {
    start: Vec<u32>,
    /// All of them, with padding.
    first: usize,
}

impl Images {
    /// The images in the strip of an agent and those beside it that may be in reach.
    pub(super) fn near(
        &self,
        row: usize,
        strip: usize,
        columns: (usize, usize),
    ) -> impl Iterator<Item = (u32, u32)> {
        let rows = self.start.chunks_exact(row).skip(strip.saturating_sub(1));
        let spans = rows.take(if strip == 0 { 2 } else { 3 });
        spans.map(move |start| (start[columns.0], start[columns.1 + 1])).filter(|(from, to)| from < to)
    }
}

impl Cells {
    /// Puts the images behind the sorted agents.
    pub(super) fn add_images(&mut self, reach: &Reach, periods: &Periods) {
        self.images.start.clear();
        if periods.are_none() {
            return;
        }
        let Self { index, images, .. } = self;
        let grid = index.grid;
        let is_one_of_two = |way: &Vec2| way.y > 0.0 || (way.y == 0.0 && way.x > 0.0);
        let mut found = Vec::new();
        for way in periods.images().into_iter().filter(is_one_of_two) {
            for at in (0..grid.strips).flat_map(|strip| index.strip(strip)) {
                let p = Vec2::new(index.x[at], index.y[at]) + way;
                if periods.hold(p, reach.most) {
                    found.push(((grid.strip_of(p.y), grid.column_of(p.x), index.agent[at]), p, index.r[at]));
                }
            }
        }
        found.sort_by_key(|(cell, ..)| *cell);
        images.first = index.agent.len();
        let mut put = |agent: u32, p: Vec2, r: f64| {
            index.agent.push(agent);
            index.x.push(p.x);
            index.y.push(p.y);
            index.r.push(r);
            index.agent.len() as u32
        };
        let (mut end, mut next) = (images.first as u32, found.into_iter().peekable());
        for strip in 0..grid.strips {
            for column in 0..grid.columns {
                images.start.push(end);
                while let Some(((_, _, agent), p, r)) =
                    next.next_if(|((s, c, _), ..)| (*s, *c) == (strip, column))
                {
                    end = put(agent, p, r);
                }
            }
            images.start.push(end);
            for _ in 0..LANES {
                end = put(0, Vec2::new(grid.x, grid.y), f64::NEG_INFINITY);
            }
        }
        while !(end as usize).is_multiple_of(LANES) {
            end = put(0, Vec2::new(grid.x, grid.y), f64::NEG_INFINITY);
        }
    }

    /// The places of the images among the sorted agents, padding among them.
    pub(super) fn image_places(&self) -> std::ops::Range<usize> {
        let end = self.index.agent.len();
        if self.images.start.is_empty() { end..end } else { self.images.first..end }
    }
}
