//! Which faces push where, against the rules written plainly.

mod sums;

use super::*;
use crate::base::geometry::{Polygon, Segment, rotated};
use crate::base::lanes::Lanes;
use crate::kernel::vector::parts;
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

/// What is felt at a place: unit vectors away from faces, and distances.
fn felt(barriers: &[Barrier], place: Vec2) -> Vec<(Vec2, f64)> {
    let all = Surfaces::new(barriers);
    (0..all.len() as u32).map(|k| all.felt_at(k, place)).filter(|(_, d)| d.is_finite()).collect()
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
        let parts =
            [block(p(-2.0, 0.0), p(a, 1.0)), block(p(b, 0.0), p(0.5, 1.0)), block(p(0.5, 0.0), p(2.0, 1.0))];
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
    assert!(Surfaces::new(&apart).faces.iter().all(|face| face.joints.is_empty()));
    let grid: Vec<Barrier> = (0..20).map(|k| row(k / 2, k % 2 == 0)).collect();
    for face in Surfaces::new(&grid).faces {
        assert_eq!(face.joints.len(), 10);
        assert!(face.joints.iter().all(|joint| (joint.around.high - joint.around.low).norm() < 0.02));
    }
}

#[inline(always)]
fn eight<S: Simd>(simd: S, all: &Surfaces, x: &Lanes, y: &Lanes) -> Vec<Lanes> {
    let mut out = vec![Lanes::ZERO; all.len()];
    for part in parts(simd) {
        let place = (part.load(x), part.load(y));
        for (k, out) in out.iter_mut().enumerate() {
            let nearest = all.nearest(k as u32, part, place);
            part.store(all.felt(k as u32, part, place, &nearest), out);
        }
    }
    out
}

/// Chains, discs, blocks, angles and rings that end on or near each other, with ends that are off by up to 1.5 mm.
fn scene() -> impl Strategy<Value = Vec<Barrier>> {
    let off = (-1.5e-3..1.5e-3, -1.5e-3..1.5e-3).prop_map(|(x, y)| p(x, y));
    let off = prop_oneof![Just(Vec2::zeros()), off];
    let knot = (0..3, 0..3).prop_map(|(x, y)| p(f64::from(x), f64::from(y)));
    let place = (knot, off).prop_map(|(knot, off)| knot + off);
    let chain = prop::collection::vec(place.clone(), 2..5).prop_map(|points| wall(&points));
    let solid = (place, 0.2..1.1, 0.0..1.5, 0..3, any::<bool>()).prop_map(|(low, size, turn, form, back)| {
        let place = |&(x, y): &(f64, f64)| low + rotated(p(x * size, y), turn);
        let ring = |corners: &[(f64, f64)]| {
            let mut ring: Vec<Vec2> = corners.iter().map(place).collect();
            if back {
                ring.reverse();
            }
            ring
        };
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        barrier(Obstacle::Solid(if turn < 0.3 {
            Shape::Circle { centre: low, radius: size }
        } else if form == 0 {
            Shape::Polygon(Polygon::new(ring(&square)))
        } else if form == 1 {
            let angle = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.3), (0.4, 0.4), (0.3, 1.0), (0.0, 1.0)];
            Shape::Polygon(Polygon::new(ring(&angle)))
        } else {
            let mut polygon = Polygon::new(ring(&square));
            polygon.holes.push([(0.2, 0.2), (0.8, 0.2), (0.7, 0.9)].iter().map(place).collect());
            Shape::Polygon(polygon)
        }))
    });
    prop::collection::vec(prop_oneof![3 => chain, 1 => solid], 1..6)
}

/// The first two rules of the head of the module, of every pair and without rectangles.
fn plainly(all: &Surfaces, face: u32, place: Vec2) -> f64 {
    let own = &all.faces[face as usize];
    let NearestTo { normal, near, distance } = all.nearest_to(face, place);
    let foot = place - normal * near;
    let on = |k: u32| all.nearest_to(k, foot).near <= ON;
    let seen = |k: u32| all.nearest_to(k, place).distance.is_finite();
    let has_the_say = |k: u32| {
        let other = &all.faces[k as usize];
        let (theirs, is_own) = (all.nearest_to(k, place), other.barrier == own.barrier);
        if k == face || !on(k) {
            return false;
        }
        match other.form {
            Form::Inside => {
                // In it, or on the back of it.
                let mut faces =
                    (0..all.len() as u32).filter(|j| all.faces[*j as usize].barrier == other.barrier);
                let on_face = faces.any(|j| j != k && seen(j) && on(j));
                !is_own && !on_face && theirs.near < distance
            }
            _ if is_own && matches!(own.form, Form::Inside) => false,
            _ => seen(k) && theirs.distance.total_cmp(&distance).then(k.cmp(&face)).is_lt(),
        }
    };
    if (0..all.len() as u32).any(has_the_say) { f64::INFINITY } else { distance }
}

proptest! {
    #[test]
    fn the_rules_hold_everywhere_and_eight_at_once_are_as_one_by_one(
        barriers in scene(),
        x in prop::array::uniform8(-1.0..3.0),
        y in prop::array::uniform8(-1.0..3.0),
    ) {
        let all = Surfaces::new(&barriers);
        let found = dispatch!(Level::new(), simd => eight(simd, &all, &Lanes(x), &Lanes(y)));
        for lane in 0..8 {
            let place = p(x[lane], y[lane]);
            let mut least = f64::INFINITY;
            for (k, found) in found.iter().enumerate() {
                let wanted = plainly(&all, k as u32, place);
                prop_assert_eq!(all.felt_at(k as u32, place).1, wanted, "{} {}", k, place);
                prop_assert_eq!(found.0[lane], wanted);
                least = least.min(wanted);
            }
            // The nearest of all barriers is felt.
            let nearest = barriers.iter().map(|b| b.obstacle.distance(place)).fold(f64::INFINITY, f64::min);
            prop_assert!((least - nearest).abs() < 1e-12, "{} {} {}", place, least, nearest);
        }
    }

}
