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

/// What is felt in full at a place: unit vectors away from faces, and distances.
fn felt(barriers: &[Barrier], place: Vec2) -> Vec<(Vec2, f64)> {
    let all = Surfaces::new(barriers, |_| false);
    let faces = (0..all.len() as u32).map(|k| (all.nearest_to(k, place), left_at(&all, k, place)));
    let full = faces.filter(|(_, left)| *left == 1.0);
    full.map(|(nearest, _)| (nearest.normal, nearest.distance)).collect()
}

/// Share of its force that a face gives; nothing where it is not seen.
fn left_at(all: &Surfaces, face: u32, place: Vec2) -> f64 {
    let nearest = all.nearest_to(face, place);
    if nearest.distance.is_finite() { all.left_at(face, place, &nearest) } else { 0.0 }
}

fn places() -> impl Iterator<Item = Vec2> {
    (0..41 * 41).map(|k| p(f64::from(k % 41) * 0.2 - 4.03, f64::from(k / 41) * 0.2 - 4.01))
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
    assert!(Surfaces::new(&apart, |_| false).faces.iter().all(|face| face.joints.is_empty()));
    let grid: Vec<Barrier> = (0..20).map(|k| row(k / 2, k % 2 == 0)).collect();
    for face in Surfaces::new(&grid, |_| false).faces {
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
            let seen = nearest.distance.simd_lt(part.c(f64::INFINITY));
            let left = all.left(k as u32, part, place, &nearest);
            part.store(seen.select(left, part.c(0.0)), out);
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
    // Walls of scenarios have no pieces without a length.
    let chain =
        prop::collection::vec(place.clone(), 2..5).prop_filter_map("a wall has a length", |mut points| {
            points.dedup();
            (points.len() > 1).then(|| wall(&points))
        });
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

/// Whether two faces are pieces that touch and lie in one line.
fn in_line(one: &Face, other: &Face) -> bool {
    let (Form::Side(one), Form::Side(other)) = (&one.form, &other.form) else { return false };
    let ends = |side: &Side| [side.piece().a, side.piece().b];
    let near = |one: &Side, at: Vec2| {
        let ends = ends(one);
        let upright = p(ends[0].y - ends[1].y, ends[1].x - ends[0].x);
        upright.norm() == 0.0 || upright.normalize().dot(&(at - ends[0])).abs() <= 1e-6
    };
    let gap = |one: &Side, other: &Side| {
        ends(other).map(|end| one.piece().distance(end)).into_iter().fold(9.0, f64::min)
    };
    ends(other).iter().all(|end| near(one, *end))
        && ends(one).iter().all(|end| near(other, *end))
        && gap(one, other).min(gap(other, one)) <= 1e-6
}

/// The first two rules of the head of the module, of every pair and without rectangles.
fn plainly(all: &Surfaces, face: u32, place: Vec2) -> f64 {
    let own = &all.faces[face as usize];
    let NearestTo { normal, near, distance, fading, fades } = all.nearest_to(face, place);
    if distance.is_infinite() {
        return 0.0;
    }
    let foot = place - normal * near;
    let on = |k: u32| all.nearest_to(k, foot).near <= ON;
    let seen = |k: u32| all.nearest_to(k, place).distance.is_finite();
    let mut left = if fades { fading } else { 1.0 };
    for k in (0..all.len() as u32).filter(|k| *k != face && on(*k)) {
        let other = &all.faces[k as usize];
        let (theirs, is_own) = (all.nearest_to(k, place), other.barrier == own.barrier);
        let is_before = seen(k) && theirs.distance.total_cmp(&distance).then(k.cmp(&face)).is_lt();
        match other.form {
            Form::Inside => {
                // In it, or on the back of it.
                let mut faces =
                    (0..all.len() as u32).filter(|j| all.faces[*j as usize].barrier == other.barrier);
                let on_face = faces.any(|j| j != k && seen(j) && on(j));
                let is_open = on_face && theirs.near >= 0.0;
                if !(is_own || is_open) && theirs.near < distance {
                    return 0.0;
                }
            }
            Form::Disc if is_before => return 0.0,
            Form::Side(_) if is_own && matches!(own.form, Form::Inside) => {}
            Form::Side(_) if !matches!(own.form, Form::Side(_)) || in_line(own, other) => {
                left = left.min(if is_before { 0.0 } else { 1.0 });
            }
            Form::Side(_) if seen(k) && (place - theirs.normal * theirs.near - foot).norm() <= ON => {
                left = left.min(1.0 - (theirs.fading - fading).max(0.0));
            }
            Form::Side(_) if is_before => left = left.min(fading),
            _ => {}
        }
    }
    left
}

proptest! {
    #[test]
    fn the_rules_hold_everywhere_and_eight_at_once_are_as_one_by_one(
        barriers in scene(),
        x in prop::array::uniform8(-1.0..3.0),
        y in prop::array::uniform8(-1.0..3.0),
    ) {
        let all = Surfaces::new(&barriers, |_| false);
        let found = dispatch!(Level::new(), simd => eight(simd, &all, &Lanes(x), &Lanes(y)));
        for lane in 0..8 {
            let place = p(x[lane], y[lane]);
            let mut least = f64::INFINITY;
            for (k, found) in found.iter().enumerate() {
                let wanted = plainly(&all, k as u32, place);
                prop_assert_eq!(left_at(&all, k as u32, place), wanted, "{} {}", k, place);
                prop_assert_eq!(found.0[lane], wanted);
                if wanted >= 0.5 {
                    least = least.min(all.nearest_to(k as u32, place).distance);
                }
            }
            // The nearest of all barriers is felt, or one that comes as near as what counts as touching.
            let nearest = barriers.iter().map(|b| b.obstacle.distance(place)).fold(f64::INFINITY, f64::min);
            prop_assert!((0.0..ON).contains(&(least - nearest + 1e-12)), "{} {} {}", place, least, nearest);
        }
    }

}
