//! Paths against dense samples, formulas of the table of fillets, and exact shortest ways.

use super::rounding::LEAST_RADIUS;
use super::{Path, PathShape, Piece, round, shortcut};
use crate::base::geometry::{Segment, Shape, Vec2, cross, rotated};
use crate::base::math::{atan2, sin_cos};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::sight::ROUNDING;
use crate::model::{Barrier, Goal, Obstacle, Piece as Surface, Scene, Sight};
use crate::route::{Atlas, Bend, ShortestWay};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_4, PI};

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

/// The path of a shortest way: the arcs around corners, and the lines that join them.
fn of_bends(start: Vec2, bends: &[Bend], end: Vec2) -> Path {
    let mut path = Path::empty(start);
    for &Bend { centre, radius, from, turn } in bends {
        let arc = Piece::Arc { centre, radius, from, turn };
        path.push_line(arc.at(0.0).position);
        path.push(arc);
    }
    path.push_line(end);
    path
}

/// Random numbers of a test, one after the other.
struct Draws(Stream, u32);

impl Draws {
    fn of(entity: u32) -> Self {
        Self(Stream::of(TrialKey::default(), entity, Purpose::Test), 0)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.1 += 1;
        low + (high - low) * self.0.uniform(self.1)
    }

    fn place(&mut self, size: f64) -> Vec2 {
        p(self.between(0.0, size), self.between(0.0, size))
    }

    /// A scene of walls, boxes and discs.
    fn scene(&mut self, walls: usize, boxes: usize, discs: usize, size: f64) -> Scene {
        let mut barriers = Vec::new();
        let mut add = |obstacle| barriers.push(Barrier { name: String::new(), obstacle });
        for _ in 0..walls {
            let (a, angle, length) = (self.place(size), self.between(-PI, PI), self.between(0.2, 4.0));
            add(Obstacle::Wall(vec![Segment::new(a, a + rotated(p(length, 0.0), angle))]));
        }
        for _ in 0..boxes {
            let (a, b) = (self.place(size), p(self.between(0.3, 2.0), self.between(0.3, 2.0)));
            add(Obstacle::Solid(Shape::rectangle(a, a + b)));
        }
        for _ in 0..discs {
            let (centre, radius) = (self.place(size), self.between(0.05, 0.8));
            add(Obstacle::Solid(Shape::Circle { centre, radius }));
        }
        Scene { barriers, ..Scene::default() }
    }

    /// A polyline whose legs keep a distance from all surfaces.
    fn polyline(&mut self, sight: &Sight, count: usize, reach: f64, size: f64) -> Vec<Vec2> {
        let keeps = |a, b| sight.pieces().iter().all(|s| s.distance_to(&Segment::new(a, b)) >= reach);
        let mut points: Vec<Vec2> = Vec::new();
        for _ in 0..40 * count {
            let q = match points.last() {
                Some(last) => last + rotated(p(self.between(0.3, 5.0), 0.0), self.between(-PI, PI)),
                None => self.place(size),
            };
            if keeps(points.last().copied().unwrap_or(q), q) {
                points.push(q);
            }
        }
        points.truncate(count);
        points
    }
}

/// Places of a path at equal distances, with the distances.
fn places(path: &Path, count: u32) -> impl Iterator<Item = (f64, Vec2)> + '_ {
    let at = move |k| path.length() * f64::from(k) / f64::from(count);
    (0..=count).map(move |k| (at(k), path.at(at(k)).position))
}

fn assert_is_smooth(path: &Path) {
    for pair in path.pieces().windows(2) {
        let (a, b) = (pair[0].end(), pair[1].start());
        assert!((a.position - b.position).norm() < 1e-9, "{pair:?}");
        assert!((a.direction - b.direction).norm() < 1e-6, "{pair:?}");
    }
    for (k, piece) in path.pieces().iter().enumerate() {
        assert!((path.joints()[k + 1] - path.joints()[k] - piece.length()).abs() < 1e-12);
        assert!((piece.start().direction.norm() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_path_of_the_paper() {
    let path = "L10 A45/7 L10 A60/3 L2".parse::<PathShape>().unwrap().path();
    assert!((path.length() - 30.639_379_797_372).abs() < 1e-12);
    assert_is_smooth(&path);
    let joints =
        [0.0, 10.0, 10.0 + 7.0 * FRAC_PI_4, 20.0 + 7.0 * FRAC_PI_4, 20.0 + 2.75 * PI, 22.0 + 2.75 * PI];
    assert!(path.joints().iter().zip(joints).all(|(a, b)| (a - b).abs() < 1e-13), "{:?}", path.joints());
    assert_eq!(path.joints().len(), joints.len());
    // Equation 10 of the paper: q = (L1 + R sin psi, R - R cos psi).
    let (sin, cos) = sin_cos(0.3);
    let place = path.at(10.0 + 7.0 * 0.3);
    assert!((place.position - p(10.0 + 7.0 * sin, 7.0 - 7.0 * cos)).norm() < 1e-13);
    assert!((place.direction - p(cos, sin)).norm() < 1e-14 && (place.curvature - 1.0 / 7.0).abs() < 1e-15);
    // The polyline of its edges (12.90, 14.63 and 3.73 m) with fillets of 7 m keeps the first arc.
    let (first, second) = (7.0 * (2.0_f64.sqrt() - 1.0), 3.0 / 3.0_f64.sqrt());
    let b = p(10.0 + first, 0.0);
    let c = b + rotated(p(first + 10.0 + second, 0.0), FRAC_PI_4);
    let d = c + rotated(p(second + 2.0, 0.0), FRAC_PI_4 + PI / 3.0);
    assert!((d - path.end().position).norm() < 1e-12);
    let rounded = round(&[Vec2::zeros(), b, c, d], 7.0, 0.3, &Sight::default());
    assert!((rounded.joints()[1] - 10.0).abs() < 1e-12 && (rounded.joints()[2] - joints[2]).abs() < 1e-12);
    // The last one takes the whole of the last leg.
    let Some(Piece::Arc { radius, .. }) = rounded.pieces().last() else { panic!("{rounded:?}") };
    assert!((radius - (second + 2.0) * 3.0_f64.sqrt()).abs() < 1e-12, "{rounded:?}");
}

#[test]
fn rounded_polylines_keep_their_distance() {
    let (mut arcs, mut shrunk, mut turns) = (0, 0, 0);
    for round_ in 0..150 {
        let mut draws = Draws::of(round_);
        let reach = draws.between(0.1, 0.4);
        let sight = Sight::new(&draws.scene(12, 4, 4, 16.0));
        let points = draws.polyline(&sight, 12, reach, 16.0);
        let corner = draws.between(0.3, 6.0);
        let path = round(&points, corner, reach, &sight);
        assert_is_smooth(&path);
        let (first, last) = (points[0], points[points.len() - 1]);
        assert!(
            (path.at(0.0).position - first).norm() < 1e-12 && (path.end().position - last).norm() < 1e-12
        );
        for piece in path.pieces() {
            arcs += u32::from(matches!(piece, Piece::Arc { .. }));
            shrunk += u32::from(matches!(piece, Piece::Arc { radius, .. } if *radius < corner));
            turns += u32::from(matches!(piece, Piece::Turn { .. }));
            for surface in sight.pieces() {
                let distance = piece.distance_to(surface);
                assert!(distance >= reach - ROUNDING, "{piece:?} {surface:?} {distance} {reach}");
            }
        }
        for (_, q) in places(&path, 1_000) {
            let nearest = sight.pieces().iter().map(|s| s.distance(q)).fold(f64::INFINITY, f64::min);
            assert!(nearest >= reach - ROUNDING, "{nearest} {reach}");
        }
    }
    assert!(arcs > 1_000 && shrunk > 500 && turns < arcs, "{arcs} {shrunk} {turns}");
}

/// The fillet of a corner by the table of fillets, and its tangent length.
fn fillet(a: Vec2, b: Vec2, c: Vec2, radius: f64) -> (Piece, f64) {
    let (u1, u2) = ((a - b).normalize(), (c - b).normalize());
    let delta = atan2(cross(-u1, u2), (-u1).dot(&u2));
    let (sin, cos) = sin_cos(0.5 * delta.abs());
    let centre = b + (u1 + u2).normalize() * (radius / cos);
    let tangent = radius * sin / cos;
    let out = b + u1 * tangent - centre;
    (Piece::Arc { centre, radius, from: atan2(out.y, out.x), turn: delta }, tangent)
}

fn nearest_surface(piece: &Piece, sight: &Sight) -> f64 {
    sight.pieces().iter().map(|s| piece.distance_to(s)).fold(f64::INFINITY, f64::min)
}

#[test]
fn each_radius_is_the_largest() {
    let (mut by_barrier, mut by_leg, mut by_corner) = (0, 0, 0);
    for round_ in 0..4_000 {
        let mut draws = Draws::of(10_000 + round_);
        let reach = draws.between(0.0, 0.4);
        let (a, b, c) = (draws.place(8.0), draws.place(8.0), draws.place(8.0));
        let legs = [Segment::new(a, b), Segment::new(b, c)];
        let mut scene = draws.scene(4, 2, 4, 8.0);
        scene.barriers.retain(|barrier| {
            let barriers = vec![barrier.clone()];
            let alone = Sight::new(&Scene { barriers, ..Scene::default() });
            alone.pieces().iter().all(|s| legs.iter().all(|leg| s.distance_to(leg) >= reach + 0.01))
        });
        let (points, sight) = ([a, b, c], Sight::new(&scene));
        let corner = draws.between(0.3, 8.0);
        let path = round(&points, corner, reach, &sight);
        let arc = path.pieces().iter().find(|piece| matches!(piece, Piece::Arc { .. }));
        let &Piece::Arc { radius, .. } = arc.unwrap_or(&fillet(a, b, c, LEAST_RADIUS).0) else {
            unreachable!()
        };
        let (larger, tangent) = fillet(a, b, c, radius * (1.0 + 1e-6));
        if larger.radius() > corner {
            by_corner += 1;
        } else if tangent > (a - b).norm().min((c - b).norm()) {
            by_leg += 1;
        } else {
            by_barrier += 1;
            let distance = nearest_surface(&larger, &sight);
            assert!(distance < reach, "{radius} {distance} {reach}");
        }
        // All smaller ones are legal as well.
        for share in [0.1, 0.5, 0.9, 0.99, 1.0] {
            let (smaller, _) = fillet(a, b, c, radius * share);
            assert!(arc.is_none() || nearest_surface(&smaller, &sight) >= reach - 1e-12);
        }
    }
    assert!(by_barrier > 200 && by_leg > 200 && by_corner > 200, "{by_barrier} {by_leg} {by_corner}");
}

#[test]
fn distances_of_arcs_are_those_of_dense_samples() {
    for round_ in 0..400 {
        let mut draws = Draws::of(20_000 + round_);
        let arc = Piece::Arc {
            centre: draws.place(4.0),
            radius: draws.between(0.1, 3.0),
            from: draws.between(-PI, PI),
            turn: draws.between(-2.2 * PI, 2.2 * PI),
        };
        let (a, b) = (draws.place(4.0), draws.place(4.0));
        let surface = match round_ % 3 {
            0 => Surface::Disc { centre: a, radius: draws.between(0.05, 1.0) },
            1 => Surface::Edge(Segment::new(a, b)),
            _ => Surface::Edge(Segment::new(a, a + (b - a) * 0.1)),
        };
        let count = 5_000;
        let step = arc.length() / f64::from(count);
        let samples = (0..=count).map(|k| surface.distance(arc.at(step * f64::from(k)).position));
        let (exact, sampled) = (arc.distance_to(&surface), samples.fold(f64::INFINITY, f64::min));
        assert!(exact <= sampled + 1e-12 && sampled <= exact + step, "{arc:?} {surface:?} {exact} {sampled}");
    }
}

#[test]
fn the_nearest_place_is_that_of_dense_samples() {
    for round_ in 0..200 {
        let mut draws = Draws::of(30_000 + round_);
        let points: Vec<Vec2> = (0..7).map(|_| draws.place(6.0)).collect();
        let path = round(&points, 0.6, 0.2, &Sight::default());
        let q = draws.place(7.0);
        let (from, to) = (draws.between(-1.0, path.length()), draws.between(-1.0, path.length() + 1.0));
        let (low, high) = (from.max(0.0), to.min(path.length()).max(from.max(0.0)));
        let inside = |(along, _): &(f64, Vec2)| (low..=high).contains(along);
        let count = 5_000;
        let step = path.length() / f64::from(count);
        for (found, all) in [(path.nearest(q), true), (path.nearest_within(q, from, to), false)] {
            let samples = places(&path, count).filter(|place| all || inside(place));
            let sampled = samples.map(|(_, place)| (place - q).norm()).fold(f64::INFINITY, f64::min);
            let (along, distance) = found;
            assert!(all || (low - 1e-12..=high + 1e-12).contains(&along), "{along} {low} {high}");
            assert!(((path.at(along).position - q).norm() - distance).abs() < 1e-12);
            assert!(distance <= sampled + 1e-12);
            assert!(sampled <= distance + step || high - low < step, "{distance} {sampled}");
        }
    }
}

#[test]
fn the_first_of_equally_near_places_counts() {
    let path = "L2 A180/1 L2 A180/1".parse::<PathShape>().unwrap().path();
    assert_eq!(path.nearest(p(1.0, 1.0)), (1.0, 1.0));
    // All of the arc is equally far from its centre.
    assert_eq!(path.nearest_within(p(2.0, 1.0), 2.0, 9.0), (2.0, 1.0));
    assert_eq!(Path::empty(p(1.0, 1.0)).nearest(p(4.0, 5.0)), (0.0, 5.0));
}

#[test]
fn odd_polylines() {
    let open = Sight::default();
    for points in [vec![p(3.0, 4.0)], vec![p(3.0, 4.0); 5], Vec::new()] {
        let path = round(&points, 1.0, 0.2, &open);
        assert_eq!((path.length(), path.pieces().len(), path.joints()), (0.0, 0, &[0.0][..]));
        assert_eq!(path.at(1.0).position, points.first().copied().unwrap_or_default());
    }
    // Vertices on a line vanish, also if a polyline goes past them.
    let path = round(&[p(0.0, 0.0), p(1.0, 0.0), p(1.0, 0.0), p(3.0, 0.0), p(7.0, 0.0)], 1.0, 0.2, &open);
    assert_eq!(path.pieces(), [Piece::Line { from: p(0.0, 0.0), to: p(7.0, 0.0) }]);
    // A turn back is a turn on the spot.
    let path = round(&[p(0.0, 0.0), p(3.0, 0.0), p(1.0, 0.0)], 1.0, 0.2, &open);
    assert_eq!(path.pieces()[1], Piece::Turn { at: p(3.0, 0.0), from: p(1.0, 0.0), to: p(-1.0, 0.0) });
    assert_eq!(path.at(3.0).direction, p(-1.0, 0.0));
    assert_eq!(path.length(), 5.0);
    // Legs that are too short for 0.05 m.
    let path = round(&[p(0.0, 0.0), p(3.0, 0.0), p(3.0, 0.04)], 1.0, 0.2, &open);
    assert!(matches!(path.pieces()[1], Piece::Turn { .. }));
}

#[test]
fn taut_polylines_become_exact_shortest_ways() {
    let (mut same, mut ways, mut others) = (0, 0, 0);
    let reach = 0.25;
    for round_ in 0..150 {
        let mut draws = Draws::of(40_000 + round_);
        let atlas = Atlas::new(draws.scene(8, 4, 4, 12.0));
        let (from, to) = (p(-1.0, draws.between(0.0, 12.0)), p(13.5, draws.between(0.0, 12.0)));
        let free = |q: Vec2| atlas.sight().pieces().iter().all(|s| s.distance(q) > reach);
        let Some(way) = atlas.way(from, &Goal::Point(to), reach).filter(|_| free(from) && free(to)) else {
            continue;
        };
        let exact = of_bends(from, &way.bends, way.end);
        assert_is_smooth(&exact);
        assert!((exact.length() - way.length).abs() < 1e-9);
        assert!(exact.pieces().iter().all(|piece| nearest_surface(piece, atlas.sight()) >= reach - 1e-8));
        assert!(exact.pieces().iter().all(|piece| !matches!(piece, Piece::Turn { .. })));
        // Around the arcs from outside: fillets of the same radius at least.
        let outside: Vec<Vec2> = std::iter::once(from).chain(way.points()).collect();
        let path = round(&outside, 2.0, reach, atlas.sight());
        assert_is_smooth(&path);
        assert!(path.pieces().iter().all(|piece| nearest_surface(piece, atlas.sight()) >= reach - 1e-8));
        // Through the corners of the obstacles, as a point goes.
        let point = atlas.way(from, &Goal::Point(to), 1e-6).unwrap();
        let taut: Vec<Vec2> = std::iter::once(from).chain(point.points()).collect();
        let path = round(&taut, 2.0, reach, atlas.sight());
        assert_is_smooth(&path);
        let turns = |way: &ShortestWay| {
            let mut turns: Vec<(Vec2, bool)> = way.bends.iter().map(|b| (b.centre, b.turn > 0.0)).collect();
            turns.dedup();
            turns
        };
        let is_same = (path.length() - way.length).abs() < 1e-9;
        if turns(&way) == turns(&point) && !way.bends.is_empty() {
            ways += 1;
            same += u32::from(is_same);
        } else {
            others += u32::from(is_same);
        }
    }
    assert!(same == ways && ways > 50 && others > 20, "{same} of {ways}, {others}");
}

#[test]
fn a_path_that_has_no_room_goes_around_the_end_of_a_wall() {
    let wall = Obstacle::Wall(vec![Segment::new(p(0.0, 0.0), p(0.0, -9.0))]);
    let sight = Sight::new(&Scene {
        barriers: vec![Barrier { name: String::new(), obstacle: wall }],
        ..Scene::default()
    });
    let reach = 0.25;
    // From one side of the wall to the other, past two vertices at its end.
    for points in [
        vec![p(-3.0, -3.0), p(0.0, 0.1), p(3.0, -3.0)],
        vec![p(-1.0, -3.0), p(-0.1, 0.1), p(0.1, 0.1), p(1.0, -3.0)],
    ] {
        let path = round(&points, 1.0, reach, &sight);
        let [_, Piece::Arc { centre, radius, turn, .. }, _] = path.pieces() else { panic!("{path:?}") };
        assert!(*centre == Vec2::zeros() && *radius == reach && *turn < 0.0);
        assert_is_smooth(&path);
        let tangent = (points[0].norm_squared() - reach * reach).sqrt();
        assert!((path.length() - 2.0 * tangent - reach * turn.abs()).abs() < 1e-12);
    }
    // Another wall leaves no room for the arc: stop and turn.
    let close = Segment::new(p(-5.0, 0.3), p(5.0, 0.3));
    let barriers = [close, Segment::new(p(0.0, 0.0), p(0.0, -9.0))]
        .map(|edge| Barrier { name: String::new(), obstacle: Obstacle::Wall(vec![edge]) })
        .to_vec();
    let sight = Sight::new(&Scene { barriers, ..Scene::default() });
    let path = round(&[p(-3.0, -3.0), p(0.0, 0.1), p(3.0, -3.0)], 1.0, reach, &sight);
    assert!(matches!(path.pieces(), [_, Piece::Turn { .. }, _]), "{path:?}");
}

#[test]
fn errors_of_shapes_say_what_to_write() {
    let error = |text: &str| text.parse::<PathShape>().unwrap_err().to_string();
    assert_eq!(error("L10 A45"), "column 5: `A45` needs a radius, as in `A45/7`");
    assert_eq!(error("L10 A-30"), "column 5: `A-30` needs a radius, as in `A-30/7`");
    assert_eq!(
        error("B3"),
        "column 1: `B3` is no part of a path; write a line, as in `L10`, or an arc, as in `A45/7`"
    );
    assert_eq!(error("  L0"), "column 3: `L0` needs a length above 0 m and up to 1e6 m, as in `L10`");
    assert_eq!(
        error("L1 A45/-2"),
        "column 4: `A45/-2` needs a radius above 0 m and up to 1e6 m, as in `A45/7`"
    );
    assert_eq!(error(""), "column 1: the shape has no parts; write lines and arcs, as in `L10 A45/7`");
    assert!(error("é A0/3").starts_with("column 1: `é` is no part"));
    assert!(error("L1  Ainf/3").starts_with("column 5: `Ainf/3` needs an angle in degrees"));
}

proptest! {
    #[test]
    fn shapes_are_read_as_written(parts in prop::collection::vec((0.001..1e6_f64, -720.0..720.0_f64, prop::bool::ANY), 1..9)) {
        let words: Vec<String> = parts
            .iter()
            .map(|&(size, degrees, is_line)| if is_line { format!("L{size}") } else { format!("A{degrees}/{size}") })
            .collect();
        let text = words.join(" ");
        let shape: PathShape = text.parse().unwrap();
        prop_assert_eq!(shape.to_string(), text);
        let turn = |degrees: f64, is_line| if is_line { 1.0 } else { degrees.abs() * PI / 180.0 };
        let length: f64 = parts.iter().map(|&(size, degrees, is_line)| size * turn(degrees, is_line)).sum();
        prop_assert!((shape.path().length() - length).abs() <= 1e-9 * length);
    }

    #[test]
    fn no_text_stops_the_parser(text in "[LA0-9./ e+-]{0,20}|\\PC{0,12}") {
        match text.parse::<PathShape>() {
            Ok(shape) => prop_assert!(shape.path().length().is_finite()),
            Err(error) => prop_assert!(error.column >= 1 && error.column <= text.chars().count().max(1)),
        }
    }

    #[test]
    fn any_points_have_a_path(points in prop::collection::vec((-3_i8..4, -3_i8..4), 0..9), corner in 0.0..5.0_f64) {
        let points: Vec<Vec2> = points.iter().map(|&(x, y)| p(f64::from(x), f64::from(y))).collect();
        let wall = Obstacle::Wall(vec![Segment::new(p(-2.0, 0.0), p(1.0, 1.0)), Segment::new(p(1.0, 1.0), p(1.0, -3.0))]);
        let scene = Scene { barriers: vec![Barrier { name: String::new(), obstacle: wall }], ..Scene::default() };
        let path = round(&points, corner, 0.3, &Sight::new(&scene));
        assert_is_smooth(&path);
        let straight: f64 = points.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
        prop_assert!(path.length() <= straight + 40.0);
        prop_assert!((path.end().position - points.last().copied().unwrap_or_default()).norm() < 1e-9);
    }
}

#[test]
fn shortcuts_drop_vertices_that_help_nothing() {
    let length = |points: &[Vec2]| points.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
    let points = [p(0.0, 0.0), p(1.0, 2.0), p(2.0, 0.0), p(3.0, 2.0), p(4.0, 0.0)];
    assert_eq!(shortcut(&points, |_, _| true, length), [points[0], points[4]]);
    assert_eq!(shortcut(&points, |_, _| false, length), points);
    let near = |a: Vec2, b: Vec2| b.x - a.x <= 2.0;
    assert_eq!(shortcut(&points, near, length), [points[0], points[2], points[4]]);
    // Without a gain all vertices stay.
    assert_eq!(shortcut(&points, |_, _| true, |_| 1.0), points);
    assert_eq!(shortcut(&points, |_, _| true, |_| f64::NAN), points);
}
