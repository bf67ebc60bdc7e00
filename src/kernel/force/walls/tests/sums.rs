//! What the faces of a scene give together, however it is drawn.
#![allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]

use super::*;
use crate::kernel::vector::first_part;

/// A wall along corners of a polygon, closed.
fn closed(points: &[Vec2]) -> Barrier {
    let mut points = points.to_vec();
    points.push(points[0]);
    wall(&points)
}

/// A ring with this hole.
fn around_hole(hole: &[Vec2]) -> Barrier {
    let mut ring = Polygon::rectangle(p(-20.0, -20.0), p(20.0, 20.0));
    ring.holes.push(hole.to_vec());
    barrier(Obstacle::Solid(Shape::Polygon(ring)))
}

/// Sum of the social forces on a body of radius 0.3 m with A = 1 N at a place, N.
fn force(barriers: &[Barrier], place: Vec2, range: f64) -> Vec2 {
    let all = Surfaces::new(barriers, |_| false);
    let at = [place; 8];
    let [x, y] = dispatch!(Level::new(), simd => forces(simd, &all, &at, range));
    p(x.0[0], y.0[0])
}

#[inline(always)]
fn forces<S: Simd>(simd: S, all: &Surfaces, at: &[Vec2; 8], range: f64) -> [Lanes; 2] {
    let (x, y) = (Lanes(at.map(|p| p.x)), Lanes(at.map(|p| p.y)));
    let mut out = [Lanes::ZERO; 2];
    for part in parts(simd) {
        let bodies = AtWalls {
            place: (part.load(&x), part.load(&y)),
            r: part.c(0.3),
            a: part.c(1.0),
            least: part.c(crate::kernel::force::walls::LEAST),
            rate: part.c(std::f64::consts::LOG2_E / range),
        };
        let near: Vec<u32> = (0..all.len() as u32).collect();
        let (fx, fy) = all.push(part, &near, &bodies, 0.0, &mut Room::default(), |_, _| {});
        part.store(fx, &mut out[0]);
        part.store(fy, &mut out[1]);
    }
    out
}

/// The force of one face alone, N.
fn alone(distance: f64, range: f64) -> f64 {
    ((0.3 - distance) / range).exp()
}

#[test]
fn a_room_is_a_room_however_it_is_drawn() {
    let corners = [p(-3.0, -2.0), p(3.5, -2.0), p(3.5, 1.0), p(1.0, 1.0), p(1.0, 3.0), p(-3.0, 3.0)];
    let pieces: Vec<Barrier> = (0..6).map(|k| wall(&[corners[k], corners[(k + 1) % 6]])).collect();
    let reverse: Vec<Vec2> = corners.iter().rev().copied().collect();
    for place in places() {
        let wanted = force(&pieces, place, 0.2);
        let inside = Obstacle::Solid(Shape::Polygon(Polygon::new(corners.to_vec()))).distance(place) < -0.05;
        assert!((force(&[closed(&corners)], place, 0.2) - wanted).norm() < 1e-12 * wanted.norm(), "{place}");
        if inside {
            for hole in [&corners[..], &reverse[..]] {
                let found = force(&[around_hole(hole)], place, 0.2);
                assert!((found - wanted).norm() < 1e-12 * wanted.norm(), "{place} {found} {wanted}");
            }
        }
    }
}

#[test]
fn opposite_sides_of_one_barrier_push_both() {
    let corners = [p(-9.0, 0.0), p(9.0, 0.0), p(9.0, 1.0), p(-9.0, 1.0)];
    for corridor in [closed(&corners), around_hole(&corners)] {
        let found = force(&[corridor], p(0.0, 0.4), 0.1);
        assert!((found.y - alone(0.4, 0.1) + alone(0.6, 0.1)).abs() < 1e-12, "{found}");
    }
}

#[test]
fn from_behind_an_edge_is_not_felt_and_from_inside_the_rim_is() {
    let panel = block(p(-2.0, 0.0), p(2.0, 0.1));
    let found = felt(std::slice::from_ref(&panel), p(0.3, 0.5));
    assert_eq!(found, [(p(0.0, 1.0), 0.4)]);
    let found = felt(std::slice::from_ref(&panel), p(0.3, 0.08));
    assert_eq!(found.len(), 1);
    assert!((found[0].0 - p(0.0, 1.0)).norm() < 1e-12 && (found[0].1 + 0.02).abs() < 1e-12);
    // Against a wall: only the panel is felt.
    let found = felt(&[wall(&[p(-9.0, 0.0), p(9.0, 0.0)]), panel], p(0.3, 0.5));
    assert_eq!(found, [(p(0.0, 1.0), 0.4)]);
}

#[test]
fn faces_at_an_angle_give_at_least_what_the_nearer_one_gives_and_at_most_their_sum() {
    for degrees in [5, 10, 30, 45, 60, 80, 89, 90, 91, 120, 150, 170] {
        let bend = f64::from(degrees).to_radians();
        let other = p(-(bend.cos()), bend.sin());
        let chain = wall(&[other * 9.0, Vec2::zeros(), p(9.0, 0.0)]);
        let pieces = [wall(&[other * 9.0, Vec2::zeros()]), wall(&[p(9.0, 0.0), Vec2::zeros()])];
        let normals = [p(0.0, 1.0), p(other.y, -other.x)];
        // The last is on the bisector.
        for turn in (0..60)
            .map(|k| (f64::from(k) + 0.5) / 60.0 * std::f64::consts::PI)
            .chain([0.5 * (std::f64::consts::PI - bend)])
        {
            for far in [0.35, 0.7, 1.2] {
                let place = p(turn.cos(), turn.sin()) * far;
                let feet = [place.x, place.dot(&other)];
                let heights = normals.map(|normal| normal.dot(&place));
                // Inside of the corner, where both feet lie on the faces and not on the end of the other.
                if heights.iter().any(|height| *height < 0.03)
                    || feet.iter().any(|foot| foot * bend.sin() <= ON)
                {
                    continue;
                }
                let found = force(std::slice::from_ref(&chain), place, 0.2);
                assert!((force(&pieces, place, 0.2) - found).norm() < 1e-12, "{degrees} {place}");
                let alone = heights.map(|height| alone(height, 0.2));
                let sum = normals[0] * alone[0] + normals[1] * alone[1];
                if degrees >= 90 {
                    assert!((found - sum).norm() < 1e-9, "{degrees} {place}");
                    continue;
                }
                let along = normals.map(|normal| normal.dot(&found));
                let nearer = usize::from(alone[1] > alone[0]);
                assert!(
                    along[nearer] > 0.92 * alone[nearer] && found.norm() < sum.norm(),
                    "{degrees} {place} {found}"
                );
                if (heights[0] - heights[1]).abs() < 1e-12 {
                    assert!(
                        (0..2).all(|k| (along[k] / alone[k] - 1.0).abs() < 1e-9),
                        "{degrees} {place} {found}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_round_wall_of_straight_pieces_pushes_the_same_everywhere() {
    for (count, spread) in [(12, 0.15), (24, 0.1), (64, 0.1)] {
        let corner = |k: i32| {
            let (sin, cos) = crate::base::math::sin_cos_turn(f64::from(k) / f64::from(count));
            p(3.0 * cos, 3.0 * sin)
        };
        let corners: Vec<Vec2> = (0..count).map(corner).collect();
        for room in [closed(&corners), around_hole(&corners)] {
            let all = std::slice::from_ref(&room);
            let mut last: Option<Vec2> = None;
            for k in 0..2_000 {
                let (sin, cos) = crate::base::math::sin_cos_turn(f64::from(k) / 2_000.0);
                let place = p(cos, sin) * 2.5;
                let found = force(all, place, 0.1);
                // The nearest piece gives what is along its normal; nothing jumps.
                let distance =
                    -Obstacle::Solid(Shape::Polygon(Polygon::new(corners.clone()))).distance(place);
                let whole = alone(distance, 0.1);
                assert!((found.norm() / whole - 1.0).abs() < spread, "{count} {k} {found} {whole}");
                if let Some(last) = last {
                    // A hundredth of a metre of way changes a force of 0.1 m of range by a tenth.
                    assert!((found - last).norm() < 0.1 * whole, "{count} {k} {found} {last}");
                }
                last = Some(found);
            }
        }
    }
}

#[test]
fn contact_shares_as_the_social_force_does() {
    let bend = wall(&[p(-3.0, 1.0), p(0.0, 0.0), p(3.0, 1.0)]);
    let room = wall(&[p(10.0, 3.0), p(10.0, 0.0), p(13.0, 0.0)]);
    let all = Surfaces::new(&[bend, room], |_| false);
    let touch = |faces: [u32; 2], place: Vec2| {
        let mut room = Room::default();
        let found = dispatch!(Level::new(), simd => {
            all.touch(first_part(simd), faces.into_iter(), place, 0.3, &mut room)
        });
        [0, 1].map(|k| (p(found[k].nx.0[0], found[k].ny.0[0]), found[k].shared.0[0]))
    };
    let both = touch([0, 1], p(0.0, 0.25));
    let sum = both[0].0 * both[0].1 + both[1].0 * both[1].1;
    let depth = 0.3 - 0.25 * (0.9_f64).sqrt();
    for (normal, _) in both {
        assert!((sum.dot(&normal) / depth - 1.0).abs() < 1e-12);
    }
    let [(_, one), (_, other)] = touch([2, 3], p(10.2, 0.25));
    assert!((one - 0.1).abs() < 1e-12 && (other - 0.05).abs() < 1e-12);
}

#[test]
fn what_is_drawn_twice_or_in_another_order_pushes_the_same() {
    let room = |x: f64| wall(&[p(x, 0.0), p(x + 4.0, 0.0), p(x + 4.0, 3.0), p(x, 3.0), p(x, 0.0)]);
    // The first of each changes nothing at these places.
    let scenes = [
        [room(-4.0), room(0.0)],
        [block(p(-1.0, 0.0), p(0.0, 3.0)), wall(&[p(0.0, 3.0), p(0.0, 0.0), p(4.0, 0.0)])],
        [wall(&[p(0.0, 0.0), p(5.0, 0.0)]), wall(&[p(0.0, 5.0), p(0.0, 0.0), p(5.0, 0.0)])],
    ];
    for k in 0..900 {
        let place = p(0.1 * (f64::from(k % 30) + 0.53), 0.1 * (f64::from(k / 30) + 0.37));
        // Above the upper end of the wall the block pushes on.
        for scene in scenes.iter().filter(|_| place.y < 2.9) {
            let wanted = force(&scene[1..], place, 0.2);
            for barriers in [scene.clone(), [scene[1].clone(), scene[0].clone()]] {
                let found = force(&barriers, place, 0.2);
                assert!((found - wanted).norm() < 1e-9 * wanted.norm(), "{place} {found} {wanted}");
            }
        }
    }
}

#[test]
fn a_ledge_or_a_wall_drawn_as_its_outline_is_one_wall() {
    let ledge = [p(-5.0, 0.0), p(0.0, 0.0), p(0.0, 0.005), p(5.0, 0.005)];
    let mut solid = ledge.to_vec();
    solid.extend([p(5.0, -1.0), p(-5.0, -1.0)]);
    let ledges = [wall(&ledge), barrier(Obstacle::Solid(Shape::Polygon(Polygon::new(solid))))];
    for ledge in ledges {
        let mut last: Option<Vec2> = None;
        for k in -300..300 {
            let found = force(std::slice::from_ref(&ledge), p(f64::from(k) * 1e-3 + 1e-4, 0.4), 0.08);
            let bounds = [alone(0.4, 0.08), alone(0.395, 0.08)];
            assert!((0.89 * bounds[0]..1.02 * bounds[1]).contains(&found.norm()), "{k} {found} {bounds:?}");
            if let Some(last) = last {
                assert!((found - last).norm() < 0.08 * bounds[0], "{k} {found} {last}");
            }
            last = Some(found);
        }
    }
    for thick in [2e-3, 0.05, 0.1, 0.3] {
        let outline = closed(&[p(0.0, -thick), p(5.0, -thick), p(5.0, 0.0), p(0.0, 0.0)]);
        let found = force(&[outline], p(2.5, 0.3), 0.2);
        let ratio = found.y / alone(0.3, 0.2);
        assert!((0.92..1.0 + 1e-12).contains(&ratio) && found.x.abs() < 1e-12, "{thick} {found}");
    }
    // A piece that comes out of a wall by a centimetre, upright or nearly so.
    for foot in [2.5, 2.501] {
        let spur = barrier(Obstacle::Wall(vec![
            Segment::new(p(0.0, 0.0), p(5.0, 0.0)),
            Segment::new(p(foot, -2.0), p(2.5, 0.01)),
        ]));
        for x in [2.3, 2.45, 2.499, 2.501, 2.6] {
            let found = force(std::slice::from_ref(&spur), p(x, 0.35), 0.08);
            let bounds = [alone(0.35, 0.08), alone(0.34, 0.08)];
            assert!((0.92 * bounds[0]..1.03 * bounds[1]).contains(&found.norm()), "{x} {found} {bounds:?}");
        }
    }
}

/// Whether a scene pushes as the sum of these faces does, each alone: which way, and how far it is.
fn pushes_as(barriers: &[Barrier], place: Vec2, faces: &[(Vec2, f64)]) {
    let wanted: Vec2 = faces.iter().map(|(normal, distance)| *normal * alone(*distance, 0.5)).sum();
    let found = force(barriers, place, 0.5);
    assert!((found - wanted).norm() < 1e-12 * wanted.norm(), "{place} {found} {wanted}");
}

/// The nearest of a scene.
fn nearest(barrier: &Barrier, place: Vec2) -> (Vec2, f64) {
    Surface::new(barrier).unwrap().nearest_to(place)
}

/// Places that are not nearer to a line of the grid than bodies ever are to a wall.
fn free_places() -> impl Iterator<Item = Vec2> {
    places().filter(|place| place.x.abs() > 0.08 && place.y.abs() > 0.08)
}

#[test]
fn a_straight_wall_in_pieces_is_one_wall() {
    let whole = wall(&[p(-3.0, 0.0), p(3.0, 0.0)]);
    let one = wall(&[p(-3.0, 0.0), p(-1.0, 0.0)]);
    let two = wall(&[p(1.5, 0.0), p(-1.0, 0.0)]);
    let three = wall(&[p(1.0, 0.0), p(2.0, 0.0), p(2.95, 0.0), p(3.0, 0.0)]);
    for pieces in [[&one, &two, &three], [&three, &one, &two], [&two, &three, &one]] {
        let pieces = pieces.map(Clone::clone);
        for place in free_places().chain([p(-1.0, 1.0), p(1.5, -2.0), p(2.98, 0.3)]) {
            pushes_as(&pieces, place, &[nearest(&whole, place)]);
        }
    }
}

#[test]
fn inside_a_corner_both_walls_push_and_outside_one() {
    let (east, north) = (wall(&[p(0.0, 0.0), p(9.0, 0.0)]), wall(&[p(0.0, 9.0), p(0.0, 0.0)]));
    for barriers in [[east.clone(), north.clone()], [north, east]] {
        for place in free_places() {
            let both = [nearest(&barriers[0], place), nearest(&barriers[1], place)];
            let inside = place.x > 0.0 && place.y > 0.0;
            let one = if both[0].1 < both[1].1 { both[0] } else { both[1] };
            pushes_as(&barriers, place, if inside { &both[..] } else { std::slice::from_ref(&one) });
        }
    }
    let cross = [p(9.0, 0.0), p(0.0, 9.0), p(-9.0, 0.0), p(0.0, -9.0)].map(|end| wall(&[end, Vec2::zeros()]));
    for place in free_places() {
        let faces = [(p(place.x.signum(), 0.0), place.x.abs()), (p(0.0, place.y.signum()), place.y.abs())];
        pushes_as(&cross, place, &faces);
    }
}

#[test]
fn an_end_on_a_side_or_inside_a_solid_is_not_felt() {
    let side = wall(&[p(-9.0, 0.0), p(9.0, 0.0)]);
    let table = block(p(-9.0, -1.0), p(9.0, 0.0));
    for (other, foot) in [(side, 0.0), (table, -0.5)] {
        let stem = wall(&[p(0.0, 5.0), p(0.0, foot)]);
        for place in free_places().filter(|place| place.y > 0.0 || place.y < -1.0 || foot == 0.0) {
            let both = [nearest(&other, place), nearest(&stem, place)];
            // The stem is felt where the nearest of it is not hidden.
            let count = if place.y > 0.0 { 2 } else { 1 };
            pushes_as(&[stem.clone(), other.clone()], place, &both[..count]);
        }
    }
    let pillar = barrier(Obstacle::Solid(Shape::Circle { centre: p(0.0, -0.5), radius: 0.6 }));
    let stem = wall(&[p(0.0, 5.0), p(0.0, 0.0)]);
    for place in free_places() {
        let found = felt(&[stem.clone(), pillar.clone()], place);
        assert_eq!(found.len(), if place.y > 0.1 { 2 } else { 1 }, "{place}");
    }
}

#[test]
fn blocks_side_by_side_or_overlapping_are_one_block() {
    let whole = block(p(-2.0, 0.0), p(2.0, 1.0));
    for (a, b) in [(-0.5, -0.5), (0.3, -1.0)] {
        let parts =
            [block(p(-2.0, 0.0), p(a, 1.0)), block(p(b, 0.0), p(0.5, 1.0)), block(p(0.5, 0.0), p(2.0, 1.0))];
        for place in places().filter(|place| nearest(&whole, *place).1 > 0.08) {
            let (found, wanted) =
                (force(&parts, place, 0.5), force(std::slice::from_ref(&whole), place, 0.5));
            // Faces inside the block are farther away than those around it, and take a little of what these give.
            assert!((found - wanted).norm() < 3e-3 * wanted.norm(), "{place} {found} {wanted}");
        }
    }
}

#[test]
fn what_is_drawn_twice_is_felt_once_and_what_is_apart_twice() {
    let (first, gap) = (wall(&[p(0.0, 0.0), p(1.0, 0.0)]), wall(&[p(1.01, 0.0), p(2.0, 0.0)]));
    let place = p(1.005, 1.0);
    pushes_as(&[first.clone(), gap.clone()], place, &[nearest(&first, place), nearest(&gap, place)]);
    for place in free_places() {
        pushes_as(&[first.clone(), first.clone()], place, &[nearest(&first, place)]);
    }
}

#[test]
fn a_rounded_corner_pushes_alike_however_it_is_drawn_and_nothing_jumps() {
    for count in [4, 8, 16] {
        let arc = |k: i32| {
            let (sin, cos) = crate::base::math::sin_cos_turn(f64::from(k) / f64::from(count) * 0.25);
            p(0.5 - 0.5 * cos, 0.5 - 0.5 * sin)
        };
        let mut corner = vec![p(0.0, 5.0)];
        corner.extend((0..=count).map(arc));
        corner.push(p(5.0, 0.0));
        let mut room = corner.clone();
        room.push(p(5.0, 5.0));
        let drawn = [wall(&corner), around_hole(&room)];
        let pieces: Vec<Barrier> = corner.windows(2).rev().map(wall).collect();
        for y in [0.45, 0.5, 0.52, 0.6] {
            let mut last: Option<Vec2> = None;
            for k in 0..1_500 {
                let place = p(0.42 + f64::from(k) * 1e-4, y);
                let found = force(&drawn[..1], place, 0.08);
                let others = [&drawn[1..], &pieces[..]];
                for other in others.into_iter().filter(|_| k % 25 == 0) {
                    let other = force(other, place, 0.08);
                    assert!((other - found).norm() < 1e-6 * found.norm(), "{count} {place} {found} {other}");
                }
                if let Some(last) = last {
                    assert!((found - last).norm() < 0.03 * found.norm(), "{count} {place} {found} {last}");
                }
                last = Some(found);
            }
        }
    }
}

#[test]
fn however_many_share_they_give_what_one_would() {
    for count in [1, 3, 40] {
        let same = vec![wall(&[p(-5.0, 0.0), p(5.0, 0.0)]); count];
        pushes_as(&same, p(0.0, 0.5), &[(p(0.0, 1.0), 0.5)]);
    }
    // At the centre of a half circle, and about it.
    for count in [16, 64, 128] {
        let corner = |k: i32| {
            let (sin, cos) = crate::base::math::sin_cos_turn(f64::from(k) / f64::from(count) * 0.5);
            p(0.5 * cos, 0.5 * sin)
        };
        let apse = wall(&(0..=count).map(corner).collect::<Vec<_>>());
        for y in [-0.002, -0.001, 0.0, 0.001, 0.002] {
            let found = force(std::slice::from_ref(&apse), p(0.0, y), 0.08);
            let ratio = found.norm() / alone(0.5, 0.08);
            assert!((0.5..1.6).contains(&ratio), "{count} {y} {ratio}");
        }
    }
}

#[test]
fn the_order_of_many_that_share_does_not_matter() {
    let fin = |k: i32| {
        let (sin, cos) = crate::base::math::sin_cos_turn(f64::from(k) / 16.0);
        wall(&[p(0.45 * cos, 0.45 * sin), p(1.2 * cos, 1.2 * sin)])
    };
    let rim = |k: i32| {
        let (sin, cos) = crate::base::math::sin_cos_turn(f64::from(k) / 16.0);
        p(1.2 * cos, 1.2 * sin)
    };
    let mut fins: Vec<Barrier> = (0..=8).map(fin).collect();
    fins.push(wall(&(0..=8).map(rim).collect::<Vec<_>>()));
    let reversed: Vec<Barrier> = fins.iter().rev().cloned().collect();
    for (x, y) in [(0.02, 0.01), (0.1, 0.05), (0.0, 0.05)] {
        let (one, other) = (force(&fins, p(x, y), 0.08), force(&reversed, p(x, y), 0.08));
        let mirrored = force(&fins, p(-x, y), 0.08);
        assert!((one - other).norm() < 1e-9 * one.norm(), "{one} {other}");
        assert!((one - p(-mirrored.x, mirrored.y)).norm() < 1e-9 * one.norm(), "{one} {mirrored}");
    }
}

proptest! {
    /// Forces do not depend on the other lanes, and nobody is pulled.
    #[test]
    fn a_force_is_that_of_one_alone(
        barriers in scene(),
        x in prop::array::uniform8(-1.0..3.0),
        y in prop::array::uniform8(-1.0..3.0),
    ) {
        let all = Surfaces::new(&barriers, |_| false);
        let at: [Vec2; 8] = std::array::from_fn(|lane| p(x[lane], y[lane]));
        let found = dispatch!(Level::new(), simd => forces(simd, &all, &at, 0.3));
        for lane in 0..8 {
            let [one_x, one_y] = dispatch!(Level::new(), simd => forces(simd, &all, &[at[lane]; 8], 0.3));
            prop_assert_eq!((found[0].0[lane], found[1].0[lane]), (one_x.0[0], one_y.0[0]));
            prop_assert!(one_x.0[0].is_finite() && one_y.0[0].is_finite());
            // What the nearest face gives is there along its normal, but for faces that push against it: less 8 % of
            // two, and 28 % of eleven, the worst case (0.72 is the least of (1 + 10 x^4)/(1 + 10 x^3)).
            let nearest = felt(&barriers, at[lane]);
            let (normal, distance) = *nearest.iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
            let against: f64 = nearest
                .iter()
                .filter(|(other, _)| other.dot(&normal) < 0.0)
                .map(|(other, distance)| -other.dot(&normal) * alone(*distance, 0.3))
                .sum();
            if distance.abs() < 1e-6 {
                continue;
            }
            let along = normal.dot(&p(one_x.0[0], one_y.0[0]));
            let wanted = alone(distance, 0.3);
            prop_assert!(along + against > 0.72 * wanted, "{} {} {}", along, against, wanted);
        }
    }
}
