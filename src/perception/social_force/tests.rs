//! Tests of the social force model as a model of motion.

use super::*;
use crate::base::geometry::{Segment, Shape};
use crate::model::Obstacle;
use crate::perception::ConstantVelocity;

fn end(time: f64, x: f64, y: f64, vx: f64) -> TracePoint {
    TracePoint { time, position: Vec2::new(x, y), velocity: Some(Vec2::new(vx, 0.0)) }
}

fn among(obstacles: Vec<Obstacle>) -> SocialForce {
    let barrier = |obstacle| Barrier { name: String::new(), obstacle };
    SocialForce::preset("helbing2000", obstacles.into_iter().map(barrier).collect()).unwrap()
}

fn is_near(one: &TracePoint, other: &TracePoint, within: f64) -> bool {
    let apart = |a: Vec2, b: Vec2| (a - b).norm();
    let velocities = [one, other].map(|point| point.velocity.unwrap_or_else(Vec2::zeros));
    apart(one.position, other.position) <= within && apart(velocities[0], velocities[1]) <= within
}

/// The points of constant velocity.
fn straight(ends: &[TracePoint], time: f64) -> Vec<TracePoint> {
    ConstantVelocity.project(ends, time)
}

#[test]
fn one_alone_goes_straight_on() {
    let mut still = end(0.0, 30.0, 0.0, 0.0);
    still.velocity = None;
    let ends = [end(0.0, 1.0, 2.0, 1.3), still];
    for time in [0.0, 1e-7, 0.033, 0.4, 2.0, 1e6] {
        let found = among(Vec::new()).project(&ends, time);
        assert!(is_near(&found[0], &straight(&ends, time)[0], 1e-9), "{time}: {found:?}");
        assert_eq!(found[1], TracePoint { time, ..still });
    }
}

#[test]
fn two_who_meet_slow_down_or_turn_aside() {
    for aside in [0.0, 0.2] {
        let ends = [end(0.0, 0.0, 0.0, 1.3), end(0.0, 3.0, aside, -1.3)];
        for time in [0.5, 1.0, 1.5, 2.0] {
            let found = among(Vec::new()).project(&ends, time);
            let apart = (found[0].position - found[1].position).norm();
            assert!(apart > 0.6, "{aside} {time}: {found:?}");
            let is_moved =
                found.iter().zip(straight(&ends, time)).all(|(one, other)| !is_near(one, &other, 0.1));
            assert!(time < 1.5 || is_moved, "{aside} {time}: {found:?}");
        }
    }
}

#[test]
fn a_wall_stops() {
    let wall = Segment::new(Vec2::new(2.0, -5.0), Vec2::new(2.0, 5.0));
    let mut motion = among(vec![Obstacle::Wall(vec![wall])]);
    let found = motion.project(&[end(0.0, 0.0, 0.0, 1.3)], 3.0);
    assert!((1.0..1.75).contains(&found[0].position.x), "{found:?}");
    assert!(found[0].velocity.unwrap().norm() < 0.1, "{found:?}");
}

#[test]
fn who_cannot_be_moved_by_forces_keeps_the_velocity() {
    let disc = Shape::Circle { centre: Vec2::new(0.0, 5.0), radius: 1.0 };
    let ends = [
        end(0.0, 0.0, 5.0, 1.0),
        end(0.0, 8.0, 8.0, 1.0),
        end(0.0, 8.0, 8.0, -1.0),
        end(0.0, -9.0, 0.0, 20.0),
        end(0.0, f64::NAN, 0.0, 1.0),
        end(0.0, 0.0, 0.0, 1.3),
        end(0.0, 2.0, 0.1, -1.3),
    ];
    let found = among(vec![Obstacle::Solid(disc)]).project(&ends, 1.0);
    let wanted = straight(&ends, 1.0);
    assert_eq!(found[..4], wanted[..4]);
    assert!(found[4].position.x.is_nan());
    assert!((5..7).all(|k| !is_near(&found[k], &wanted[k], 0.1)), "the others react: {found:?}");
}

#[test]
fn a_hidden_person_goes_on_from_the_last_projection() {
    let ends = [end(0.0, 0.0, 0.0, 1.3), end(0.0, 2.0, 0.1, -1.3)];
    let mut motion = among(Vec::new());
    motion.project(&ends, 0.4);
    let twice = motion.project(&ends, 0.8);
    let once = among(Vec::new()).project(&ends, 0.8);
    assert!(once.iter().zip(&twice).all(|(a, b)| is_near(a, b, 1e-9)), "{once:?} {twice:?}");
    // Seen again elsewhere, the second no longer is in the way of the first.
    let elsewhere = [ends[0], end(0.8, 9.0, 9.0, 0.0)];
    let freed = motion.project(&elsewhere, 1.6);
    let met = among(Vec::new()).project(&ends, 1.6);
    let speed = |found: &[TracePoint]| found[0].velocity.unwrap().x;
    assert!(speed(&freed) > speed(&met) + 0.2, "{freed:?} {met:?}");
}

#[test]
fn ends_of_different_times_begin_at_their_own() {
    let ends = [end(0.0, 0.0, 0.0, 1.3), end(0.8, 3.0, 0.1, -1.3)];
    let found = among(Vec::new()).project(&ends, 0.8);
    assert_eq!(found[1], ends[1]);
    // The other one comes near only later.
    assert!(is_near(&found[0], &straight(&ends, 0.8)[0], 0.05), "{found:?}");
    let met = among(Vec::new()).project(&ends, 2.0);
    assert!((met[0].position - met[1].position).norm() > 0.6, "{met:?}");
}

#[test]
fn only_bodies_that_forces_move_are_taken() {
    assert!(SocialForce::preset("helbing2001", Vec::new()).is_none());
    assert!(SocialForce::new(&Body::new(Kind::Planned, |_| Law::Constant(1.0)), Vec::new()).is_some());
    assert!(SocialForce::new(&Body::new(Kind::Stepped, |_| Law::Constant(1.0)), Vec::new()).is_none());
}
