//! The barriers of a scene together: which may be near, and which of them repels where they meet.
//!
//! A barrier repels from its nearest point (see `barrier`). Where that point lies on or in another barrier which is
//! nearer, or as near and declared before, the other one has the say. So it does not matter whether a wall is
//! drawn as one chain or in pieces, a corner outside counts once, an end that another barrier hides is not felt, and
//! in the corner of two faces both push. The nearest of all barriers is always felt.

use super::barrier::{Nearest, Surface};
use super::nearby::Nearby;
use super::vector::{Doubles, Part};
use crate::base::geometry::{Bounds, Segment, Vec2, cross};
use crate::base::lanes::Mask;
use crate::model::Barrier;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A point this close to a barrier lies on it, m: nobody slips through, whatever is drawn so.
const ON: f64 = 1e-3;

/// Where a surface meets another one.
#[derive(Clone, Debug, PartialEq)]
struct Joint {
    /// The other one.
    other: u32,
    /// A rectangle around all points of the surface that lie on or in the other one.
    around: Bounds,
}

/// The surfaces of the barriers of a scene, in their order; those without a piece have none.
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    list: Vec<Surface>,
    /// Where each of them meets others.
    joints: Vec<Vec<Joint>>,
    /// Which may be near.
    pub(super) nearby: Nearby,
}

impl Surfaces {
    /// Of a scene.
    pub(super) fn new(barriers: &[Barrier]) -> Self {
        let list: Vec<Surface> = barriers.iter().filter_map(Surface::new).collect();
        let nearby = Nearby::new(&list.iter().map(|surface| surface.bounds).collect::<Vec<_>>());
        let joints = (0..list.len()).map(|k| joints(&list, k, &nearby)).collect();
        Self { list, joints, nearby }
    }

    /// Whether there is none.
    pub(super) const fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// One after the other.
    #[cfg(test)]
    pub(super) fn iter(&self) -> impl Iterator<Item = &Surface> {
        self.list.iter()
    }

    /// One of them.
    #[inline(always)]
    pub(super) fn at(&self, index: u32) -> &Surface {
        &self.list[index as usize]
    }

    /// Distances at which a surface is felt at eight places, from its nearest points: infinite where another one has
    /// the say.
    #[inline(always)]
    pub(super) fn felt<S: Simd>(
        &self,
        index: u32,
        part: Part<S>,
        (x, y): (Doubles<S>, Doubles<S>),
        nearest: &Nearest<S>,
    ) -> Doubles<S> {
        let joints = &self.joints[index as usize];
        if joints.is_empty() {
            return nearest.distance;
        }
        let (fx, fy) = (x - nearest.nx * nearest.distance, y - nearest.ny * nearest.distance);
        let mut silent = part.mask(Mask::NONE);
        for Joint { other, around } in joints {
            let here = fx.simd_ge(part.c(around.low.x))
                & fx.simd_le(part.c(around.high.x))
                & fy.simd_ge(part.c(around.low.y))
                & fy.simd_le(part.c(around.high.y));
            if !here.any_true() {
                continue;
            }
            let surface = self.at(*other);
            let distance = surface.nearest(part, x, y).distance;
            let nearer = if *other < index {
                distance.simd_le(nearest.distance)
            } else {
                distance.simd_lt(nearest.distance)
            };
            let nearer = here & nearer;
            if nearer.any_true() {
                silent |= nearer & surface.nearest(part, fx, fy).distance.simd_le(part.c(ON));
            }
        }
        silent.select(part.c(f64::INFINITY), nearest.distance)
    }

    /// The nearest point of a surface to one place: unit vector away from the surface, and signed distance as `felt`
    /// has it.
    pub(super) fn felt_at(&self, index: u32, p: Vec2) -> (Vec2, f64) {
        let (normal, distance) = self.at(index).nearest_to(p);
        let joints = &self.joints[index as usize];
        if joints.is_empty() {
            return (normal, distance);
        }
        let foot = p - normal * distance;
        let silent = joints.iter().any(|Joint { other, around }| {
            let surface = self.at(*other);
            let nearer = || {
                let from_other = surface.nearest_to(p).1;
                from_other < distance || (*other < index && from_other == distance)
            };
            contains(around, foot) && nearer() && surface.nearest_to(foot).1 <= ON
        });
        (normal, if silent { f64::INFINITY } else { distance })
    }
}

fn contains(around: &Bounds, p: Vec2) -> bool {
    around.low.x <= p.x && p.x <= around.high.x && around.low.y <= p.y && p.y <= around.high.y
}

/// What two rectangles share, a little larger; `None` where they are apart.
fn overlap(a: &Bounds, b: &Bounds) -> Option<Bounds> {
    let more = Vec2::repeat(2.0 * ON);
    let shared = Bounds { low: a.low.sup(&b.low) - more, high: a.high.inf(&b.high) + more };
    (shared.low.x <= shared.high.x && shared.low.y <= shared.high.y).then_some(shared)
}

fn hull(a: Option<Bounds>, b: Bounds) -> Bounds {
    a.map_or(b, |a| Bounds { low: a.low.inf(&b.low), high: a.high.sup(&b.high) })
}

/// Where a surface meets the others.
fn joints(list: &[Surface], index: usize, nearby: &Nearby) -> Vec<Joint> {
    let own = &list[index];
    let mut room = Vec::new();
    let around = overlap(&own.bounds, &own.bounds).unwrap_or(own.bounds);
    let near = nearby.find(&around, &mut room);
    let joint = |&other: &u32| {
        let apart = other as usize == index;
        let around = if apart { None } else { meeting(own, &list[other as usize]) };
        around.map(|around| Joint { other, around })
    };
    near.iter().filter_map(joint).collect()
}

/// A rectangle around all points of a surface that lie on or in another one.
fn meeting(own: &Surface, other: &Surface) -> Option<Bounds> {
    let shared = overlap(&own.bounds, &other.bounds)?;
    if own.edges().next().is_none() || other.edges().next().is_none() {
        // A disc.
        return Some(shared);
    }
    let meets = |s: &Segment| overlap(&around(s), &shared).is_some();
    let others: Vec<Segment> = other.edges().filter(meets).collect();
    // Two outlines of thousands of edges may lie on each other.
    let nearby = Nearby::new(&others.iter().map(around).collect::<Vec<_>>());
    let mut room = Vec::new();
    let mut meeting = None;
    for piece in own.edges().filter(meets) {
        let hidden = other.surrounds(piece.a) || other.surrounds(piece.b);
        let whole = hidden.then(|| overlap(&around(&piece), &other.bounds)).flatten();
        let reach = overlap(&around(&piece), &around(&piece)).unwrap_or(shared);
        let near = nearby.find(&reach, &mut room).iter().map(|&k| &others[k as usize]);
        for shared in near.filter_map(|other| close(&piece, other)).chain(whole) {
            meeting = Some(hull(meeting, shared));
        }
    }
    meeting
}

fn around(s: &Segment) -> Bounds {
    Bounds { low: s.a.inf(&s.b), high: s.a.sup(&s.b) }
}

/// A rectangle around all points of a piece that are as near to another one as `ON`.
fn close(piece: &Segment, other: &Segment) -> Option<Bounds> {
    let shared = overlap(&around(piece), &around(other))?;
    // The share of the piece on which the line through the other one is near; of parallels all or nothing.
    let (along, across) = (piece.b - piece.a, other.b - other.a);
    let length = across.norm();
    if length == 0.0 || along.norm() == 0.0 {
        return Some(shared);
    }
    let reach = 2.0 * ON * length + 1e-9 * (length + along.norm()) * (piece.a.norm() + other.a.norm() + 1.0);
    let (from, slope) = (cross(across, piece.a - other.a), cross(across, along));
    let (mut first, mut last) = (0.0, 1.0);
    if slope.abs() > 1e-12 * length * along.norm() {
        let ends = [(-reach - from) / slope, (reach - from) / slope];
        let (low, high) = if ends[0] < ends[1] { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
        first = if low > first { low } else { first };
        last = if high < last { high } else { last };
    } else if from.abs() > reach {
        return None;
    }
    let near = Segment::new(piece.a + along * first, piece.a + along * last);
    if first <= last { overlap(&around(&near), &shared) } else { None }
}

#[cfg(test)]
mod tests {
    use super::super::vector::parts;
    use super::*;
    use crate::base::geometry::{Polygon, Shape, rotated};
    use crate::base::lanes::Lanes;
    use crate::model::Obstacle;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    fn p(x: f64, y: f64) -> Vec2 {
        Vec2::new(x, y)
    }

    fn barrier(obstacle: Obstacle) -> Barrier {
        Barrier { name: String::new(), obstacle }
    }

    fn wall(points: &[Vec2]) -> Barrier {
        barrier(Obstacle::Wall(points.windows(2).map(|ends| Segment::new(ends[0], ends[1])).collect()))
    }

    fn block(low: Vec2, high: Vec2) -> Barrier {
        barrier(Obstacle::Solid(Shape::rectangle(low, high)))
    }

    /// What is felt at a place: unit vectors and distances.
    fn felt(barriers: &[Barrier], place: Vec2) -> Vec<(Vec2, f64)> {
        let all = Surfaces::new(barriers);
        (0..barriers.len() as u32).map(|k| all.felt_at(k, place)).filter(|(_, d)| d.is_finite()).collect()
    }

    fn places() -> impl Iterator<Item = Vec2> {
        (0..41 * 41).map(|k| p(f64::from(k % 41) * 0.2 - 4.03, f64::from(k / 41) * 0.2 - 4.01))
    }

    #[test]
    fn a_straight_wall_in_pieces_is_one_wall() {
        let whole = wall(&[p(-3.0, 0.0), p(3.0, 0.0)]);
        let one = wall(&[p(-3.0, 0.0), p(-1.0, 0.0)]);
        let two = wall(&[p(1.5, 0.0), p(-1.0, 0.0)]);
        let three = wall(&[p(1.0, 0.0), p(2.0, 0.0), p(3.0, 0.0)]);
        for pieces in [[&one, &two, &three], [&three, &one, &two], [&two, &three, &one]] {
            let pieces = pieces.map(Clone::clone);
            for place in places().chain([p(-1.0, 1.0), p(1.5, -2.0)]) {
                let (found, wanted) = (felt(&pieces, place), felt(std::slice::from_ref(&whole), place));
                assert_eq!(found.len(), 1, "{place}");
                assert!((found[0].0 - wanted[0].0).norm() < 1e-12, "{place}");
                assert!((found[0].1 - wanted[0].1).abs() < 1e-12, "{place}");
            }
        }
    }

    #[test]
    fn outside_a_corner_of_two_walls_one_pushes_and_inside_both() {
        let (east, north) = (wall(&[p(0.0, 0.0), p(9.0, 0.0)]), wall(&[p(0.0, 9.0), p(0.0, 0.0)]));
        for barriers in [[east.clone(), north.clone()], [north, east]] {
            for place in places() {
                let found = felt(&barriers, place);
                let inside = place.x > 0.0 && place.y > 0.0;
                assert_eq!(found.len(), if inside { 2 } else { 1 }, "{place}");
                let least = found.iter().map(|f| f.1).fold(f64::INFINITY, f64::min);
                let nearest = p(place.x.max(0.0), 0.0).metric_distance(&place);
                let nearest = nearest.min(p(0.0, place.y.max(0.0)).metric_distance(&place));
                assert!((least - nearest).abs() < 1e-12, "{place}");
            }
        }
    }

    #[test]
    fn an_end_on_a_side_or_inside_a_solid_is_not_felt() {
        let side = wall(&[p(-9.0, 0.0), p(9.0, 0.0)]);
        let pillar = barrier(Obstacle::Solid(Shape::Circle { centre: p(0.0, -0.5), radius: 0.6 }));
        let table = block(p(-9.0, -1.0), p(9.0, 0.0));
        for (other, foot, surface) in [(side, 0.0, 0.0), (table, -0.5, 0.0), (pillar, 0.0, 0.1)] {
            let stem = wall(&[p(0.0, 5.0), p(0.0, foot)]);
            for place in places() {
                let found = felt(&[stem.clone(), other.clone()], place);
                // The stem is felt where the nearest of it is not hidden.
                assert_eq!(found.len(), if place.y > surface { 2 } else { 1 }, "{place}");
                assert_eq!(found.last(), felt(std::slice::from_ref(&other), place).last());
            }
        }
    }

    #[test]
    fn blocks_side_by_side_or_overlapping_are_one_block() {
        let whole = block(p(-2.0, 0.0), p(2.0, 1.0));
        for (a, b) in [(-0.5, -0.5), (0.3, -1.0)] {
            let parts = [
                block(p(-2.0, 0.0), p(a, 1.0)),
                block(p(b, 0.0), p(0.5, 1.0)),
                block(p(0.5, 0.0), p(2.0, 1.0)),
            ];
            for place in places() {
                let wanted = felt(std::slice::from_ref(&whole), place)[0];
                if wanted.1 > 0.0 {
                    let found = felt(&parts, place);
                    assert_eq!(found.len(), 1, "{place}");
                    let off = (found[0].0 - wanted.0).norm() + (found[0].1 - wanted.1).abs();
                    assert!(off < 1e-12, "{place}");
                }
            }
        }
    }

    #[test]
    fn four_walls_that_meet_in_a_point_push_with_the_two_faces_of_a_quarter() {
        let ends = [p(9.0, 0.0), p(0.0, 9.0), p(-9.0, 0.0), p(0.0, -9.0)];
        let cross = ends.map(|end| wall(&[end, Vec2::zeros()]));
        for place in places() {
            let mut found: Vec<f64> = felt(&cross, place).iter().map(|f| f.1).collect();
            found.sort_by(f64::total_cmp);
            let (x, y) = (place.x.abs(), place.y.abs());
            assert_eq!(found.len(), 2, "{place}");
            assert!((found[0] - x.min(y)).abs() + (found[1] - x.max(y)).abs() < 1e-12, "{place}");
        }
    }

    #[test]
    fn what_is_drawn_twice_is_felt_once_and_what_is_apart_twice() {
        let (first, gap) = (wall(&[p(0.0, 0.0), p(1.0, 0.0)]), wall(&[p(1.01, 0.0), p(2.0, 0.0)]));
        assert_eq!(felt(&[first.clone(), gap], p(1.005, 1.0)).len(), 2);
        for place in places() {
            assert_eq!(felt(&[first.clone(), first.clone()], place).len(), 1);
        }
    }

    #[test]
    fn pieces_that_do_not_meet_have_no_joint_and_those_that_do_a_small_one() {
        let turn = |at: Vec2| rotated(at, 0.5);
        let row = |k: i32, upright: bool| {
            let (a, b) = (p(-60.0, f64::from(k)), p(60.0, f64::from(k)));
            let flip = |at: Vec2| if upright { p(at.y, at.x) } else { at };
            wall(&[turn(flip(a)), turn(flip(b))])
        };
        let apart: Vec<Barrier> = (0..40).map(|k| row(k, false)).collect();
        assert!(Surfaces::new(&apart).joints.iter().all(Vec::is_empty));
        let grid: Vec<Barrier> = (0..20).map(|k| row(k / 2, k % 2 == 0)).collect();
        for joints in Surfaces::new(&grid).joints {
            assert_eq!(joints.len(), 10);
            assert!(joints.iter().all(|joint| (joint.around.high - joint.around.low).norm() < 0.02));
        }
    }

    #[inline(always)]
    fn eight<S: Simd>(simd: S, all: &Surfaces, x: &Lanes, y: &Lanes) -> Vec<Lanes> {
        let mut out = vec![Lanes::ZERO; all.list.len()];
        for part in parts(simd) {
            let (x, y) = (part.load(x), part.load(y));
            for (k, out) in out.iter_mut().enumerate() {
                let nearest = all.list[k].nearest(part, x, y);
                part.store(all.felt(k as u32, part, (x, y), &nearest), out);
            }
        }
        out
    }

    /// Chains, discs and blocks that end on or near each other, with ends that are off by up to 1.5 mm.
    fn scene() -> impl Strategy<Value = Vec<Barrier>> {
        let off = (-1.5e-3..1.5e-3, -1.5e-3..1.5e-3).prop_map(|(x, y)| p(x, y));
        let off = prop_oneof![Just(Vec2::zeros()), off];
        let knot = (0..3, 0..3).prop_map(|(x, y)| p(f64::from(x), f64::from(y)));
        let place = (knot, off).prop_map(|(knot, off)| knot + off);
        let chain = prop::collection::vec(place.clone(), 2..4).prop_map(|points| wall(&points));
        let solid = (place, 0.2..1.1, 0.0..1.5).prop_map(|(low, size, turn)| {
            let around = [p(0.0, 0.0), p(size, 0.0), p(size, 1.0), p(0.0, 1.0)];
            let outline = around.map(|q| low + rotated(q, turn)).to_vec();
            barrier(Obstacle::Solid(if turn < 0.3 {
                Shape::Circle { centre: low, radius: size }
            } else {
                Shape::Polygon(Polygon::new(outline))
            }))
        });
        prop::collection::vec(prop_oneof![3 => chain, 1 => solid], 1..6)
    }

    proptest! {
        /// The rule of the head of this file, of every pair and without rectangles.
        #[test]
        fn the_rule_holds_everywhere_and_eight_at_once_are_as_one_by_one(
            barriers in scene(),
            x in prop::array::uniform8(-1.0..3.0),
            y in prop::array::uniform8(-1.0..3.0),
        ) {
            let all = Surfaces::new(&barriers);
            let found = dispatch!(Level::new(), simd => eight(simd, &all, &Lanes(x), &Lanes(y)));
            for lane in 0..8 {
                let place = p(x[lane], y[lane]);
                let nearest: Vec<(Vec2, f64)> = all.iter().map(|s| s.nearest_to(place)).collect();
                let mut least = f64::INFINITY;
                for (k, (normal, distance)) in nearest.iter().enumerate() {
                    let has_the_say = |other: usize| {
                        let first = nearest[other].1.total_cmp(distance).then(other.cmp(&k)).is_lt();
                        first && all.list[other].nearest_to(place - normal * *distance).1 <= ON
                    };
                    let silent = (0..nearest.len()).any(has_the_say);
                    let wanted = if silent { f64::INFINITY } else { *distance };
                    prop_assert_eq!(all.felt_at(k as u32, place).1, wanted, "{} {}", k, place);
                    prop_assert_eq!(found[k].0[lane], wanted);
                    least = least.min(wanted);
                }
                prop_assert_eq!(least, nearest.iter().map(|n| n.1).fold(f64::INFINITY, f64::min));
            }
        }
    }
}
