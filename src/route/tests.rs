//! Shortest ways against an oracle that knows no graph: it tries all orders in which a band could be hung around the circles,
//! pulls it tight by Newton's method, and looks at many places of it.

use super::Atlas;
use crate::base::geometry::{Polygon, Segment, Shape, Vec2};
use crate::base::math::{atan2, sin_cos};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::{Barrier, Goal, Obstacle, Piece, Region, RegionId, Scene, Sight};
use std::f64::consts::{PI, TAU};

const RADIUS: f64 = 0.25;

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn wall(points: &[(f64, f64)]) -> Barrier {
    let segments = points.windows(2).map(|w| Segment::new(p(w[0].0, w[0].1), p(w[1].0, w[1].1))).collect();
    Barrier { name: String::new(), obstacle: Obstacle::Wall(segments) }
}

fn solid(shape: Shape) -> Barrier {
    Barrier { name: String::new(), obstacle: Obstacle::Solid(shape) }
}

fn atlas(barriers: Vec<Barrier>, region: Option<Shape>) -> Atlas {
    let regions = region.map(|shape| Region::new("", shape)).into_iter().collect();
    Atlas::new(Scene { barriers, regions, ..Scene::default() })
}

#[test]
fn around_the_end_of_a_wall() {
    let atlas = atlas(vec![wall(&[(0.0, -50.0), (0.0, 3.0)])], None);
    let way = atlas.way(p(-4.0, 0.0), &Goal::Point(p(4.0, 0.0)), RADIUS).unwrap();
    // Two tangents to the circle of the radius around the end, and the arc between them.
    let far = (16.0_f64 + 9.0).sqrt();
    let tangent = (far * far - RADIUS * RADIUS).sqrt();
    let arc = 2.0 * PI - 2.0 * atan2(tangent, RADIUS) - 2.0 * atan2(4.0, 3.0);
    assert!((way.length - (2.0 * tangent + RADIUS * arc)).abs() < 1e-9, "{way:?}");
    assert_eq!(way.bends.len(), 1);
    assert!(way.bends[0].turn < 0.0);
    // Who walks from point to point keeps the distance.
    let points = [vec![p(-4.0, 0.0)], way.points()].concat();
    let sight = atlas.sight();
    assert!(points.windows(2).all(|w| sight.is_clear(w[0], w[1], RADIUS)));
}

#[test]
fn into_a_room_through_its_door() {
    // A room of 4 m by 4 m with a door of 1 m in the middle of its right side.
    let room = || wall(&[(4.0, 1.5), (4.0, 0.0), (0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 2.5)]);
    let region = Shape::rectangle(p(0.5, 0.5), p(3.0, 3.5));
    let goal = Goal::Region(RegionId(0));
    let from = |radius| atlas(vec![room()], Some(region.clone())).way(p(-2.0, 2.0), &goal, radius);
    let way = from(RADIUS).unwrap();
    // Around two corners of the room, through the door, and a radius inside.
    assert_eq!(way.bends.len(), 3, "{way:?}");
    assert!((way.end.x - 2.75).abs() < 1e-9);
    // Whom the door is too narrow for has no way.
    assert!(from(0.5).is_some() && from(0.51).is_none());
}

#[test]
fn a_disc_is_passed_on_the_shorter_side_and_a_place_within_reach_is_left() {
    let disc = solid(Shape::Circle { centre: p(0.0, 0.1), radius: 1.0 });
    let atlas = atlas(vec![disc], None);
    let goal = Goal::Point(p(3.0, 0.0));
    let way = atlas.way(p(-3.0, 0.0), &goal, RADIUS).unwrap();
    assert!(way.bends.len() == 1 && way.bends[0].turn > 0.0);
    // Somebody who is pressed against the disc.
    let pressed = atlas.way(p(-1.1, 0.0), &goal, RADIUS).unwrap();
    assert!(pressed.length > 4.1 && pressed.length < way.length, "{pressed:?}");
}

#[test]
fn from_a_place_at_a_wall_a_way_begins_with_a_step_aside() {
    // Beside the door of a wall, nearer to it than the radius.
    let atlas = atlas(vec![wall(&[(0.0, 0.6), (0.0, 9.0)]), wall(&[(0.0, -0.6), (0.0, -9.0)])], None);
    let goal = Goal::Point(p(5.0, 0.0));
    for (x, y) in [(-0.24, 1.0), (-0.1, 3.0), (-0.249, 0.7), (-0.24, -1.0)] {
        let way = atlas.way(p(x, y), &goal, RADIUS).unwrap_or_else(|| panic!("none from ({x}, {y})"));
        let free = atlas.way(p(-RADIUS, y), &goal, RADIUS).unwrap();
        assert!((way.length - free.length - (RADIUS + x)).abs() < 1e-6, "({x}, {y})");
    }
}

/// A scene of a few walls, boxes and discs from a stream of random numbers.
fn scene(stream: &Stream, number: u32) -> Vec<Barrier> {
    let draw = |k: u32, low: f64, high: f64| low + (high - low) * stream.uniform(number * 64 + k);
    (0..5)
        .map(|k| {
            let at = p(draw(4 * k, -4.0, 4.0), draw(4 * k + 1, -3.0, 3.0));
            let size = p(draw(4 * k + 2, -2.0, 2.0), draw(4 * k + 3, -2.0, 2.0));
            match k {
                0 | 1 => {
                    wall(&[(at.x, at.y), (at.x + size.x, at.y + size.y), (at.x - size.y, at.y + size.x)])
                }
                2 => wall(&[(at.x, at.y), (at.x + 2.0 * size.x, at.y + 2.0 * size.y)]),
                3 => solid(Shape::Polygon(Polygon::rectangle(at, at + size))),
                _ => solid(Shape::Circle { centre: at, radius: 0.3 + 0.4 * size.x.abs() }),
            }
        })
        .collect()
}

/// The circles of the oracle: corners and discs, grown by the radius.
fn pins(sight: &Sight) -> Vec<(Vec2, f64)> {
    let mut out: Vec<(Vec2, f64)> = Vec::new();
    for piece in sight.pieces() {
        let found = match piece {
            Piece::Edge(edge) => vec![(edge.a, RADIUS), (edge.b, RADIUS)],
            Piece::Disc { centre, radius } => vec![(*centre, radius + RADIUS)],
        };
        for pin in found {
            if !out.contains(&pin) {
                out.push(pin);
            }
        }
    }
    out
}

/// The direction from one circle to the next, of signed radii, by Newton's method: the angle at which the line that touches the first also touches
/// the second.
fn direction(a: (Vec2, f64), b: (Vec2, f64)) -> Option<f64> {
    let between = b.0 - a.0;
    if between.norm() <= (b.1 - a.1).abs() {
        return None;
    }
    let mut angle = atan2(between.y, between.x);
    for _ in 0..60 {
        // The part of `between` across the direction is the difference of the radii.
        let (sin, cos) = sin_cos(angle);
        let across = between.y * cos - between.x * sin - (b.1 - a.1);
        let slope = -(between.y * sin + between.x * cos);
        angle -= across / slope;
    }
    Some(angle)
}

/// A band around circles in order, with the senses in which it turns.
struct Band {
    length: f64,
    /// Straight pieces, and arcs as many short ones.
    places: Vec<Vec2>,
}

/// The band that is pulled tight; none where it does not turn as it should.
fn band(path: &[(Vec2, f64)]) -> Option<Band> {
    let (mut length, mut places) = (0.0, Vec::new());
    let mut before: Option<f64> = None;
    let touch = |(centre, radius): (Vec2, f64), angle: f64| {
        let (sin, cos) = sin_cos(angle);
        centre + p(sin, -cos) * radius
    };
    for pair in path.windows(2) {
        let angle = direction(pair[0], pair[1])?;
        if let Some(before) = before {
            let (sign, radius) = (pair[0].1.signum(), pair[0].1.abs());
            let turn = (sign * (angle - before)).rem_euclid(TAU);
            // Nobody turns by more than three quarters of a circle around something, as far as it is of use.
            if turn > 1.5 * PI {
                return None;
            }
            length += turn * radius;
            places.extend((0..=40).map(|k| touch(pair[0], before + sign * turn * f64::from(k) / 40.0)));
        }
        let (from, to) = (touch(pair[0], angle), touch(pair[1], angle));
        let steps = ((to - from).norm() / 0.01).ceil().max(1.0);
        places.extend((0..=steps as u32).map(|k| from + (to - from) * (f64::from(k) / steps)));
        length += (to - from).norm();
        before = Some(angle);
    }
    Some(Band { length, places })
}

/// The length of the shortest band that turns around at most two circles.
fn shortest(pins: &[(Vec2, f64)], ends: [Vec2; 2], is_free: &dyn Fn(Vec2) -> bool) -> Option<f64> {
    let turned = || pins.iter().flat_map(|(centre, radius)| [(*centre, *radius), (*centre, -radius)]);
    let ones = turned().map(|a| vec![a]);
    let twos = turned().flat_map(|a| turned().filter(move |b| a.0 != b.0).map(move |b| vec![a, b]));
    let orders = std::iter::once(vec![]).chain(ones).chain(twos);
    let path = |order: Vec<(Vec2, f64)>| [vec![(ends[0], 0.0)], order, vec![(ends[1], 0.0)]].concat();
    let mut bands: Vec<Band> = orders.filter_map(|order| band(&path(order))).collect();
    bands.sort_by(|a, b| a.length.total_cmp(&b.length));
    bands.iter().find(|band| band.places.iter().all(|q| is_free(*q))).map(|band| band.length)
}

#[test]
fn ways_are_as_short_as_those_of_the_oracle() {
    compare(0..60);
}

/// About a minute with optimisation.
#[test]
#[ignore = "long"]
fn ways_are_as_short_in_a_thousand_scenes() {
    compare(0..1000);
}

fn compare(scenes: std::ops::Range<u32>) {
    let all = scenes.len();
    let stream = Stream::of(TrialKey { seed: 7, index: 0, branch: 0 }, 1, Purpose::Placement);
    let (mut compared, mut bent, mut none) = (0, 0, 0);
    for number in scenes {
        let barriers = scene(&stream, number);
        let inside = |q: Vec2| {
            barriers.iter().any(|b| matches!(b.obstacle, Obstacle::Solid(_)) && b.obstacle.distance(q) < 0.0)
        };
        let sight = Sight::new(&Scene { barriers: barriers.clone(), ..Scene::default() });
        let is_free =
            |q: Vec2| sight.pieces().iter().all(|piece| piece.distance(q) >= RADIUS - 1e-7) && !inside(q);
        let ends = [p(-6.0, 0.0), p(6.0, 0.3)];
        if !ends.into_iter().all(is_free) {
            continue;
        }
        let found = atlas(barriers.clone(), None).way(ends[0], &Goal::Point(ends[1]), RADIUS);
        let wanted = shortest(&pins(&sight), ends, &is_free);
        match (found, wanted) {
            (Some(way), Some(wanted)) => {
                // A band around three circles may be shorter still.
                assert!(way.length <= wanted + 1e-9, "scene {number}: {} and {wanted}", way.length);
                if way.bends.len() <= 2 {
                    assert!(
                        (way.length - wanted).abs() < 1e-9,
                        "scene {number}: {way:?} and {wanted} {barriers:?}"
                    );
                    compared += 1;
                    bent += usize::from(!way.bends.is_empty());
                }
                let points = [vec![ends[0]], way.points()].concat();
                assert!(
                    points.windows(2).all(|w| sight.is_clear(w[0], w[1], RADIUS - 1e-7)),
                    "scene {number}"
                );
            }
            (Some(way), None) => assert!(way.bends.len() > 2, "scene {number}: {way:?}"),
            (None, wanted) => {
                assert_eq!(wanted, None, "scene {number}");
                none += 1;
            }
        }
    }
    assert!(compared > all / 2 && bent > all / 5, "{compared} {bent} {none} of {all}");
}
