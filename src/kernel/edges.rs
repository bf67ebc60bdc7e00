//! The edges of a wall or polygon: the nearest point of them, and what is inside.
//!
//! Edges stand in groups with a rectangle around each. A group is passed over where its rectangle shows, with a
//! margin far above what rounding can do, that none of its edges counts. So a coastline of thousands of
//! edges gives the same bits as a look at each of them.

use super::vector::{Doubles, Part, Truths, larger, smaller};
use crate::base::geometry::{Bounds, Segment, Vec2};
use crate::base::lanes::Mask;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Edges of a group.
const GROUP: usize = 16;

/// A straight piece.
#[derive(Clone, Copy, Debug)]
struct Edge {
    a: Vec2,
    along: Vec2,
    /// One over the squared length; 0 for a point.
    inverse_square: f64,
    b: Vec2,
    /// Abscissa gained per ordinate, for the crossing test.
    slope: f64,
}

impl Edge {
    fn new(segment: Segment) -> Self {
        let along = segment.b - segment.a;
        let square = along.dot(&along);
        Self {
            a: segment.a,
            along,
            inverse_square: if square > 0.0 { 1.0 / square } else { 0.0 },
            b: segment.b,
            slope: if along.y == 0.0 { 0.0 } else { along.x / along.y },
        }
    }
}

/// Edges in groups.
#[derive(Clone, Debug)]
pub(super) struct Edges {
    list: Vec<Edge>,
    /// The rectangles around the groups; none where there is one group only.
    groups: Vec<Bounds>,
    /// Square of far more than rounding can do to a distance, m^2.
    slack: f64,
}

/// Squared distance from a rectangle.
#[inline(always)]
pub(super) fn squared_distance<S: Simd>(
    part: Part<S>,
    bounds: &Bounds,
    x: Doubles<S>,
    y: Doubles<S>,
) -> Doubles<S> {
    let beside = larger::<S>(larger::<S>(part.c(bounds.low.x) - x, x - part.c(bounds.high.x)), part.c(0.0));
    let above = larger::<S>(larger::<S>(part.c(bounds.low.y) - y, y - part.c(bounds.high.y)), part.c(0.0));
    beside * beside + above * above
}

impl Edges {
    /// Of some segments, in their order.
    pub(super) fn new(segments: impl Iterator<Item = Segment>) -> Self {
        let segments: Vec<Segment> = segments.collect();
        let around = |group: &[Segment]| Bounds::around(group.iter().flat_map(|s| [s.a, s.b]));
        let extent = around(&segments).map_or(0.0, |all| (all.high - all.low).norm());
        let groups = if segments.len() > GROUP {
            segments.chunks(GROUP).filter_map(around).collect()
        } else {
            Vec::new()
        };
        Self {
            list: segments.into_iter().map(Edge::new).collect(),
            groups,
            slack: (1e-8 * extent) * (1e-8 * extent),
        }
    }

    /// Its segments.
    pub(super) fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        self.list.iter().map(|edge| Segment::new(edge.a, edge.b))
    }

    /// The edges of each group, and its rectangle.
    fn groups(&self) -> impl Iterator<Item = (&[Edge], Option<&Bounds>)> {
        self.list.chunks(GROUP).enumerate().map(|(k, edges)| (edges, self.groups.get(k)))
    }

    /// Vectors from the nearest point to each of eight places. The first of several that are equally near.
    #[inline(always)]
    pub(super) fn nearest<S: Simd>(
        &self,
        part: Part<S>,
        x: Doubles<S>,
        y: Doubles<S>,
    ) -> (Doubles<S>, Doubles<S>) {
        let (mut best, mut bx, mut by) = (part.c(f64::INFINITY), part.c(0.0), part.c(0.0));
        for (edges, bounds) in self.groups() {
            if let Some(bounds) = bounds {
                let limit = best * part.c(1.0 + 1e-6) + part.c(self.slack);
                if squared_distance(part, bounds, x, y).simd_gt(limit).all_true() {
                    continue;
                }
            }
            for e in edges {
                let (px, py) = (x - part.c(e.a.x), y - part.c(e.a.y));
                let share = (px * part.c(e.along.x) + py * part.c(e.along.y)) * part.c(e.inverse_square);
                let share = smaller::<S>(larger::<S>(share, part.c(0.0)), part.c(1.0));
                let (dx, dy) = (px - share * part.c(e.along.x), py - share * part.c(e.along.y));
                let square = dx * dx + dy * dy;
                let closer = square.simd_lt(best);
                best = closer.select(square, best);
                bx = closer.select(dx, bx);
                by = closer.select(dy, by);
            }
        }
        (bx, by)
    }

    /// Even-odd rule over all edges, so that the holes of a polygon are outside.
    #[inline(always)]
    pub(super) fn inside<S: Simd>(&self, part: Part<S>, x: Doubles<S>, y: Doubles<S>) -> Truths<S> {
        let mut inside = part.mask(Mask::NONE);
        for (edges, bounds) in self.groups() {
            if let Some(bounds) = bounds {
                // Exactly where no edge of the group has its ends on different sides.
                let passes = y.simd_lt(part.c(bounds.low.y)) | y.simd_ge(part.c(bounds.high.y));
                if passes.all_true() {
                    continue;
                }
            }
            for e in edges {
                let straddles = part.c(e.a.y).simd_gt(y) ^ part.c(e.b.y).simd_gt(y);
                let left = x.simd_lt(part.c(e.a.x) + (y - part.c(e.a.y)) * part.c(e.slope));
                inside ^= straddles & left;
            }
        }
        inside
    }

    /// Vector from the nearest point to one place, with the operations of `nearest`.
    pub(super) fn nearest_to(&self, p: Vec2) -> Vec2 {
        let mut best = (f64::INFINITY, Vec2::zeros());
        for (edges, bounds) in self.groups() {
            if let Some(bounds) = bounds {
                let beyond = (bounds.low - p).sup(&(p - bounds.high)).sup(&Vec2::zeros());
                if beyond.dot(&beyond) > best.0 * (1.0 + 1e-6) + self.slack {
                    continue;
                }
            }
            for e in edges {
                let from = p - e.a;
                let share = from.dot(&e.along) * e.inverse_square;
                let share = if share > 0.0 { share } else { 0.0 };
                let share = if share < 1.0 { share } else { 1.0 };
                let d = from - e.along * share;
                let square = d.dot(&d);
                if square < best.0 {
                    best = (square, d);
                }
            }
        }
        best.1
    }

    /// Whether one place is inside, as `inside` has it.
    pub(super) fn surround(&self, p: Vec2) -> bool {
        let mut inside = false;
        for (edges, bounds) in self.groups() {
            if bounds.is_some_and(|bounds| p.y < bounds.low.y || p.y >= bounds.high.y) {
                continue;
            }
            for e in edges {
                if (e.a.y > p.y) != (e.b.y > p.y) && p.x < e.a.x + (p.y - e.a.y) * e.slope {
                    inside = !inside;
                }
            }
        }
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::super::vector::parts;
    use super::*;
    use crate::base::lanes::Lanes;
    use fearless_simd::{Level, dispatch};

    #[inline(always)]
    fn eight<S: Simd>(simd: S, edges: &Edges, x: &Lanes, y: &Lanes) -> ([Lanes; 2], u8) {
        let (mut out, mut within) = ([Lanes::ZERO; 2], 0);
        for part in parts(simd) {
            let (x, y) = (part.load(x), part.load(y));
            let (dx, dy) = edges.nearest(part, x, y);
            part.store(dx, &mut out[0]);
            part.store(dy, &mut out[1]);
            within |= part.bits(edges.inside(part, x, y)).0;
        }
        (out, within)
    }

    #[test]
    fn passing_over_groups_changes_no_bit() {
        // A ragged ring of many edges, far from the origin too, against the same edges without rectangles.
        for (count, shift) in [(17, 0.0), (300, 0.0), (2_000, 4e5)] {
            let corner = |k: i32| {
                let turn = f64::from(k % count) / f64::from(count);
                let (sin, cos) = crate::base::math::sin_cos_turn(turn);
                let far = 6.0 + f64::from(k % count * 37 % 11) * 0.2;
                Vec2::new(shift + far * cos, far * sin)
            };
            let grouped = Edges::new((0..count).map(|k| Segment::new(corner(k), corner(k + 1))));
            assert!(!grouped.groups.is_empty());
            let plain = Edges { groups: Vec::new(), ..grouped.clone() };
            for k in 0..400 {
                let mut x = Lanes::splat(shift + f64::from(k % 20) - 10.0);
                let mut y = Lanes::splat(f64::from(k / 20) - 10.0);
                for lane in 0..8 {
                    x.0[lane] += lane as f64 * 0.11;
                    y.0[lane] -= lane as f64 * 0.07;
                }
                // And exactly on a corner.
                (x.0[0], y.0[0]) = (corner(k % count).x, corner(k % count).y);
                let found = dispatch!(Level::new(), simd => eight(simd, &grouped, &x, &y));
                let wanted = dispatch!(Level::new(), simd => eight(simd, &plain, &x, &y));
                assert_eq!(found, wanted);
                for lane in 0..8 {
                    let p = Vec2::new(x.0[lane], y.0[lane]);
                    assert_eq!(grouped.nearest_to(p), plain.nearest_to(p));
                    assert_eq!(grouped.nearest_to(p), Vec2::new(found.0[0].0[lane], found.0[1].0[lane]));
                    assert_eq!(grouped.surround(p), plain.surround(p));
                    assert_eq!(grouped.surround(p), found.1 >> lane & 1 == 1);
                }
            }
        }
    }
}
