//! Who looks ahead, who stands, and who is behind a wall: against closed forms, in both layouts.

use crate::crowd::{Crowd, Person, crowd, p, person, wall};
use smc::base::geometry::{Shape, Vec2};
use smc::kernel::Layout;
use smc::model::Obstacle;

const LAYOUTS: [Layout; 2] = [Layout::Trials, Layout::Agents];

fn looking(at: Vec2, velocity: Vec2, drive: f64) -> Person {
    Person { velocity, drive, towards: p(velocity.x.signum(), 0.0), a: 140.0, b: 0.35, ..person(at) }
}

fn assert_near(found: Vec2, wanted: Vec2, words: &str) {
    assert!((found - wanted).norm() <= 1e-9 * (1.0 + wanted.norm()), "{words}: {found} instead of {wanted}");
}

#[test]
fn foresight_takes_the_force_of_the_nearest_approach() {
    // Closing at 2 m/s from 4 m, 0.3 m beside each other: nearest in 2 s, when bodies of 0.25 m would overlap.
    for (foresight, apart) in [(0.0, 4.0), (1.0, 2.0), (1.5, 1.0), (3.0, 0.0)] {
        let ahead = |one: Person| Person { foresight, ..one };
        let people = vec![
            ahead(looking(p(0.0, 0.0), p(1.0, 0.0), 1.0)),
            ahead(looking(p(4.0, 0.3), p(-1.0, 0.0), 1.0)),
        ];
        let way = p(-apart, -0.3);
        let wanted = way.normalize() * (140.0 * ((0.5 - way.norm()).min(0.0) / 0.35).exp());
        for layout in LAYOUTS {
            let run = crowd(people.clone(), "0.01").start(layout);
            assert_near(run.force(0), wanted, &format!("{layout:?} {foresight}"));
            assert_near(run.force(1), -wanted, &format!("{layout:?} {foresight}, the other"));
        }
    }
}

#[test]
fn foresight_of_each_is_its_own_and_nothing_for_who_walk_alongside() {
    let one = Person { foresight: 1.0, ..looking(p(0.0, 0.0), p(1.0, 0.0), 1.0) };
    let other = looking(p(4.0, 0.3), p(-1.0, 0.0), 1.0);
    let beside =
        [p(0.0, 0.0), p(0.0, 0.6)].map(|at| Person { foresight: 1.0, ..looking(at, p(1.0, 0.0), 1.0) });
    let force = |way: Vec2| way.normalize() * (140.0 * ((0.5 - way.norm()) / 0.35).exp());
    for layout in LAYOUTS {
        let run = crowd(vec![one.clone(), other.clone()], "0.01").start(layout);
        assert_near(run.force(0), force(p(-2.0, -0.3)), "with foresight");
        assert_near(run.force(1), force(p(4.0, 0.3)), "without");
        let run = crowd(beside.to_vec(), "0.01").start(layout);
        assert_near(run.force(0), force(p(0.0, -0.6)), "alongside");
    }
}

#[test]
fn headway_limits_the_driving_speed_to_gap_over_headway() {
    let all = |towards: f64, drive: f64| {
        let behind = Person { headway: 0.8, ..looking(p(0.0, 0.0), p(1.0, 0.0), 1.3) };
        let ahead = Person { towards: p(towards, 0.0), ..looking(p(1.1, 0.0), p(0.0, 0.0), drive) };
        crowd(vec![Person { a: 0.0, ..behind }, Person { a: 0.0, ..ahead }], "0.01")
    };
    // (who is ahead walks the same way, against it, or stands, the driving speed of who is behind)
    for (towards, drive, wanted) in [(1.0, 0.5, 0.6 / 0.8), (-1.0, 0.5, 1.3), (1.0, 0.0, 1.3)] {
        for layout in LAYOUTS {
            let mut run = all(towards, drive).start(layout);
            run.steps(1);
            let speed = wanted + (1.0 - wanted) * (-0.01_f64 / 0.5).exp();
            assert_near(run.velocity(0), p(speed, 0.0), &format!("{layout:?} {towards} {drive}"));
        }
    }
}

/// A berth is a gap that is left over: what remains of it limits the speed.
#[test]
fn a_berth_is_taken_off_the_gap() {
    let behind = Person { headway: 0.8, berth: 0.2, a: 0.0, ..looking(p(0.0, 0.0), p(1.0, 0.0), 1.3) };
    let ahead = Person { towards: p(1.0, 0.0), a: 0.0, ..looking(p(1.1, 0.0), p(0.0, 0.0), 0.5) };
    for layout in LAYOUTS {
        let mut run = crowd(vec![behind.clone(), ahead.clone()], "0.01").start(layout);
        run.steps(1);
        let wanted = (0.6 - 0.2) / 0.8;
        let speed = wanted + (1.0 - wanted) * (-0.01_f64 / 0.5).exp();
        assert_near(run.velocity(0), p(speed, 0.0), &format!("{layout:?}"));
    }
}

/// A follower keeps pace with a share of the speed of a person who walks away, and not of one who comes back.
#[test]
fn who_follows_keeps_pace_with_who_walks_away() {
    let behind = Person { headway: 0.8, follow: 0.5, a: 0.0, ..looking(p(0.0, 0.0), p(1.0, 0.0), 1.3) };
    for (pace, led) in [(0.5, 0.25), (-0.5, 0.0)] {
        let ahead = Person { towards: p(1.0, 0.0), a: 0.0, ..looking(p(1.1, 0.0), p(pace, 0.0), 0.5) };
        for layout in LAYOUTS {
            let mut run = crowd(vec![behind.clone(), ahead.clone()], "0.01").start(layout);
            run.steps(1);
            let wanted = 0.6 / 0.8 + led;
            let speed = wanted + (1.0 - wanted) * (-0.01_f64 / 0.5).exp();
            assert_near(run.velocity(0), p(speed, 0.0), &format!("{layout:?} {pace}"));
        }
    }
}

/// Moussaïd et al. 2010: the attraction, and for who has to look back 4/s times mass, angle and velocity against the way.
#[test]
fn a_companion_who_is_ahead_waits_and_one_behind_does_not() {
    let member = |at| Person { abreast: 0.7, a: 0.0, ..looking(at, p(1.2, 0.0), 1.2) };
    // (the place of who is ahead, the angle by which the centroid lies behind a right one)
    for (ahead, angle) in
        [(p(1.0, 1.0), 45.0_f64), (p(1.0, 0.0), 90.0), (p(0.0, 1.0), 0.0), (p(0.5, 0.0), 90.0)]
    {
        for layout in LAYOUTS {
            let both = crowd(vec![member(p(0.0, 0.0)), member(ahead)], "0.01");
            let run = Crowd { groups: vec![(vec![0, 1], 150.0)], ..both }.start(layout);
            // From 0.35 m to the centroid on it rises to 150 N over 0.1 m.
            let share = ((ahead.norm() / 2.0 - 0.35) / 0.1).clamp(0.0, 1.0);
            let pull = ahead.normalize() * (150.0 * share);
            let brake = p(4.0 * angle.to_radians() * 80.0 * 1.2, 0.0);
            assert_near(run.force(0), pull, &format!("{layout:?} {ahead}"));
            assert_near(run.force(1), -pull - brake, &format!("{layout:?} {ahead}, ahead"));
        }
    }
}

/// The force is `1 - o cos psi` times as strong, for each by its own o.
#[test]
fn who_comes_towards_one_is_felt_more_than_who_walks_along() {
    let way = p(-2.0, -0.3);
    let plain = way.normalize() * (140.0 * ((0.5 - way.norm()) / 0.35).exp());
    for (towards, factor) in [(p(-1.0, 0.0), 1.4), (p(1.0, 0.0), 0.6), (p(0.0, 1.0), 1.0)] {
        let one = Person { oncoming: 0.4, ..looking(p(0.0, 0.0), p(1.0, 0.0), 1.0) };
        let other = Person { towards, ..looking(p(2.0, 0.3), p(0.0, 0.0), 1.0) };
        for layout in LAYOUTS {
            let run = crowd(vec![one.clone(), other.clone()], "0.01").start(layout);
            assert_near(run.force(0), plain * factor, &format!("{layout:?} {towards}"));
            assert_near(run.force(1), -plain, &format!("{layout:?} {towards}, the other"));
        }
    }
}

/// Two who meet exactly head-on, without noise: without manners they stand before each other, with them both step right.
#[test]
fn who_keep_right_pass_each_other() {
    let meet = |keep_right: f64| {
        let walker = |x: f64, ahead: f64| Person {
            keep_right,
            foresight: 1.5,
            tau: 0.25,
            radius: 0.2,
            ..looking(p(x, 0.0), p(ahead, 0.0), 1.3)
        };
        crowd(vec![walker(-4.0, 1.3), walker(4.0, -1.3)], "0.01")
    };
    for layout in LAYOUTS {
        let (mut apart, mut right) = (meet(0.0).start(layout), meet(0.1).start(layout));
        apart.steps(800);
        assert!(apart.at(0).x < 0.0 && apart.at(1).x > 0.0, "{}", apart.at(0));
        right.steps(300);
        assert!(right.at(0).y < -0.1 && right.at(1).y > 0.1, "{}", right.at(0));
        right.steps(500);
        assert!(right.at(0).x > 4.0 && right.at(1).x < -4.0, "{}", right.at(0));
    }
}

/// Somebody slow before two who push, without contact: composed, never faster than wanted; without composure, faster.
#[test]
fn nobody_composed_is_pushed_beyond_the_own_speed() {
    let fastest = |composure: f64, layout: Layout| {
        let walker = |x: f64, drive: f64| Person {
            composure,
            tau: 0.25,
            a: 400.0,
            ..looking(p(x, 0.0), p(drive, 0.0), drive)
        };
        let mut run =
            crowd(vec![walker(0.0, 0.8), walker(-0.7, 1.3), walker(-1.4, 1.3)], "0.01").start(layout);
        let mut fastest = 0.0_f64;
        for _ in 0..400 {
            run.steps(1);
            fastest = fastest.max(run.velocity(0).x);
        }
        fastest
    };
    for layout in LAYOUTS {
        assert!(fastest(1.0, layout) <= 0.8 + 1e-9, "{}", fastest(1.0, layout));
        assert!(fastest(0.0, layout) > 0.9, "{}", fastest(0.0, layout));
    }
}

#[test]
fn walls_have_their_share_of_the_force() {
    for layout in LAYOUTS {
        let force = |walls: f64| {
            let one = Person { walls, ..looking(p(0.0, 0.6), p(1.0, 0.0), 1.0) };
            let obstacles = vec![wall(p(-5.0, 0.0), p(5.0, 0.0))];
            Crowd { obstacles, ..crowd(vec![one], "0.01") }.start(layout).force(0)
        };
        assert_near(force(1.5), force(1.0) * 1.5, &format!("{layout:?}"));
        assert!(force(1.0).y > 1.0);
    }
}

#[test]
fn a_stream_that_keeps_headway_never_walks_backwards() {
    for layout in LAYOUTS {
        let people = (0..40).map(|k| {
            let at = p(0.42 * f64::from(k / 4), 0.42 * f64::from(k % 4));
            Person { radius: 0.2, headway: 0.65, foresight: 1.5, ..looking(at, p(0.0, 0.0), 1.3) }
        });
        let mut run =
            crowd(people.map(|one| Person { towards: p(1.0, 0.0), ..one }).collect(), "0.01").start(layout);
        // Equal forces cancel in the mean, whatever the density: what is left drives forward.
        for _ in 0..50 {
            run.steps(10);
            let mean = (0..40).map(|k| run.velocity(k).x).sum::<f64>() / 40.0;
            assert!(mean > -1e-9, "{mean}");
        }
    }
}

#[test]
fn nobody_is_felt_through_a_barrier() {
    let people = vec![looking(p(0.0, 0.0), p(1.0, 0.0), 1.0), looking(p(1.0, 0.0), p(1.0, 0.0), 1.0)];
    let force = p(-140.0 * (-0.5_f64 / 0.35).exp(), 0.0);
    let scene = |obstacle: Obstacle| Crowd { obstacles: vec![obstacle], ..crowd(people.clone(), "0.01") };
    let of_wall = |obstacle: Obstacle, at: Vec2| {
        let alone = Person { at, ..people[0].clone() };
        Crowd { obstacles: vec![obstacle], ..crowd(vec![alone], "0.01") }.start(Layout::Trials).force(0)
    };
    let disc = || Obstacle::Solid(Shape::Circle { centre: p(0.5, 0.0), radius: 0.1 });
    for layout in LAYOUTS {
        assert_near(crowd(people.clone(), "0.01").start(layout).force(0), force, "without a barrier");
        for (obstacle, is_between) in [
            (wall(p(0.5, -1.0), p(0.5, 1.0)), true),
            (wall(p(0.5, 0.1), p(0.5, 1.0)), false),
            (wall(p(-1.0, 0.5), p(2.0, 0.5)), false),
            (disc(), true),
        ] {
            let run = scene(obstacle.clone()).start(layout);
            let wanted = of_wall(obstacle, p(0.0, 0.0)) + if is_between { p(0.0, 0.0) } else { force };
            assert_near(run.force(0), wanted, &format!("{layout:?}"));
        }
    }
}

#[test]
fn the_line_of_sight_is_looked_at_in_every_step() {
    // They pass each other on both sides of a wall that ends at x = 0, and see each other behind its end.
    let people = vec![
        Person { hold: 0.0, drive: 1.0, tau: 1e-3, a: 1e-6, ..looking(p(-1.0, -0.6), p(1.0, 0.0), 1.0) },
        Person { hold: 0.0, drive: 1.0, tau: 1e-3, a: 1e-6, ..looking(p(-1.0, 0.6), p(1.0, 0.0), 1.0) },
    ];
    for layout in LAYOUTS {
        let scene =
            Crowd { obstacles: vec![wall(p(-9.0, 0.0), p(0.0, 0.0))], ..crowd(people.clone(), "0.01") };
        let alone = Crowd { obstacles: scene.obstacles.clone(), ..crowd(people[..1].to_vec(), "0.01") };
        let (mut run, mut alone) = (scene.start(layout), alone.start(layout));
        for _ in 0..200 {
            run.steps(1);
            alone.steps(1);
            let felt = (run.force(0) - alone.force(0)).norm() > 1e-9;
            // At the end of the wall itself rounding decides.
            let beyond = run.at(0).x;
            assert!(beyond.abs() < 1e-6 || felt == (beyond > 0.0), "{layout:?} {}", run.at(0));
        }
    }
}

#[test]
fn who_stands_returns_to_their_place_without_a_swing() {
    for layout in LAYOUTS {
        let stands = Person { hold: 0.3, ..person(p(0.0, 0.0)) };
        let mut run = crowd(vec![stands], "0.01").start(layout);
        run.steps(5);
        assert_eq!(run.at(0), p(0.0, 0.0));
        let slot = run.state.slot(0, 0);
        run.state.motion.x[slot.block].0[slot.lane] = 1.0;
        let (mut fastest, mut least) = (0.0_f64, 1.0_f64);
        for _ in 0..1000 {
            run.steps(1);
            fastest = fastest.max(run.velocity(0).norm());
            least = least.min(run.at(0).x);
        }
        assert!(fastest < 0.3 + 1e-9 && fastest > 0.29, "{fastest}");
        assert!(least > -1e-3 && run.at(0).x.abs() < 1e-3, "{least} {}", run.at(0));
    }
}

#[test]
fn who_stops_undisturbed_stops_as_without_a_place_to_hold() {
    for layout in LAYOUTS {
        let stops = Person { hold: 0.3, ..looking(p(0.0, 0.0), p(1.3, 0.0), 0.0) };
        let mut run = crowd(vec![stops], "0.01").start(layout);
        run.steps(500);
        assert!((run.at(0).x - 1.3 * 0.5).abs() < 1e-3, "{}", run.at(0));
    }
}
