//! People at walls against closed forms (Helbing, Farkas, Vicsek 2000, with m = 80 kg, tau = 0.5 s, A = 2000 N,
//! B = 0.08 m, R = 0.25 m unless said otherwise). Both layouts must meet each.

use crate::crowd::{Crowd, NEVER, Person, crowd, p, person, wall};
use smc::base::geometry::{Polygon, Segment, Shape, Vec2};
use smc::kernel::Layout;
use smc::model::{Obstacle, Particle, Period, Periods};

const BOTH: [Layout; 2] = [Layout::Trials, Layout::Agents];

fn close(found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within, "found {found}, wanted {wanted} within {within}");
}

#[test]
fn who_walks_into_a_wall_stands_off() {
    let wanted = 0.25 + 0.08 * (2000.0 * 0.5 / (80.0 * 1.34f64)).ln();
    close(wanted, 0.4286, 5e-5);
    for layout in BOTH {
        for dt in ["0.01", "0.02"] {
            let walker = Person { drive: 1.34, towards: p(0.0, -1.0), ..person(p(0.0, 2.0)) };
            let mut scene = crowd(vec![walker], dt);
            scene.obstacles.push(wall(p(-5.0, 0.0), p(5.0, 0.0)));
            let mut run = scene.start(layout);
            run.steps(4000);
            close(run.at(0).y, wanted, 2e-5);
            close(run.velocity(0).norm(), 0.0, 1e-9);
        }
    }
}

#[test]
fn who_is_driven_into_the_corner_of_a_room_stands_still_however_it_is_drawn() {
    let corners = [p(0.0, 5.0), p(0.0, 0.0), p(5.0, 0.0), p(5.0, 5.0)];
    let pieces = || corners.windows(2).map(|ends| Segment::new(ends[0], ends[1])).collect();
    let mut ring = Polygon::rectangle(p(-1.0, -1.0), p(6.0, 6.0));
    ring.holes.push(corners.to_vec());
    let angle = vec![p(0.0, 5.0), p(0.0, 0.0), p(5.0, 0.0), p(5.0, -1.0), p(-1.0, -1.0), p(-1.0, 5.0)];
    let rooms = [
        vec![wall(corners[0], corners[1]), wall(corners[1], corners[2])],
        vec![Obstacle::Wall(pieces())],
        vec![Obstacle::Solid(Shape::Polygon(ring))],
        vec![Obstacle::Solid(Shape::Polygon(Polygon::new(angle)))],
    ];
    for layout in BOTH {
        for room in &rooms {
            let towards = p(-0.6, -0.8);
            let mut scene = crowd(vec![Person { towards, drive: 1.3, ..person(p(2.0, 2.4)) }], "0.01");
            scene.obstacles.clone_from(room);
            let mut run = scene.start(layout);
            run.steps(2_000);
            // A exp((r - d)/B) = m v0/tau along each normal.
            let stand = |drive: f64| 0.25 + 0.08 * (2000.0 * 0.5 / (80.0 * 1.3 * drive)).ln();
            close(run.at(0).x, stand(0.6), 1e-5);
            close(run.at(0).y, stand(0.8), 1e-5);
            close(run.velocity(0).norm(), 0.0, 1e-5);
        }
    }
}

#[test]
fn friction_at_a_wall_decays_the_slip_exactly_and_never_reverses_it() {
    for layout in BOTH {
        for k2 in [2.4e5, 1e12] {
            let slider =
                Person { a: 0.0, k1: 0.0, k2, tau: NEVER, velocity: p(1.0, 0.0), ..person(p(0.0, 0.23)) };
            let mut scene = crowd(vec![slider], "0.005");
            scene.obstacles.push(wall(p(-5.0, 0.0), p(5.0, 0.0)));
            let mut run = scene.start(layout);
            let mut last = 1.0;
            for k in 1..=4 {
                run.steps(1);
                let now = run.velocity(0).x;
                assert!((0.0..=last).contains(&now), "{now} after {last}");
                last = now;
                close(now, (-k2 * 0.02 / 80.0 * 0.005 * f64::from(k)).exp(), 1e-13);
            }
            close(run.velocity(0).y, 0.0, 1e-14);
        }
    }
}

#[test]
fn nobody_steps_over_a_wall() {
    for layout in BOTH {
        // Beyond r sqrt(k1 / m), 9.7 m/s, compression itself cannot hold a body, however short the step.
        for (speed, dt) in [(7.0, "0.1"), (9.0, "0.1"), (9.0, "0.05"), (9.0, "0.02")] {
            for k in 0..40 {
                let runner = |x: f64, v: f64| Person {
                    velocity: p(v, 0.0),
                    towards: p(v.signum(), 0.0),
                    drive: speed,
                    ..person(p(x, 0.0))
                };
                let start = f64::from(k) * 0.037;
                let mut scene = crowd(vec![runner(start, speed)], dt);
                scene.obstacles.push(wall(p(8.0, -50.0), p(8.0, 50.0)));
                let mut run = scene.start(layout);
                for _ in 0..60 {
                    run.steps(1);
                    assert!(run.at(0).x <= 8.0, "{speed} m/s, {dt} s: {}", run.at(0).x);
                }
            }
        }
    }
}

/// Whether a step led somebody through a barrier or into one.
fn has_passed(obstacle: &Obstacle, from: Vec2, to: Vec2) -> bool {
    match obstacle {
        Obstacle::Wall(pieces) => pieces.iter().any(|piece| piece.meets(&Segment::new(from, to))),
        Obstacle::Solid(_) => obstacle.distance(to) <= 0.0,
    }
}

/// Runners of all speeds, radii and masses 10 m from each other, who run at x = 0 from the left.
fn runners(dt: &'static str, particle: Option<Particle>) -> Crowd {
    let mut people = Vec::new();
    for drive in [1.3, 4.0, 8.0, 14.0] {
        for radius in [0.02, 0.2, 0.4] {
            for mass in [30.0, 80.0, 400.0] {
                let towards = if people.len() % 2 == 0 { p(1.0, 0.0) } else { p(0.8, 0.6) };
                let at = p(-2.0, 10.0 * people.len() as f64);
                let tau = 0.25;
                people.push(Person {
                    drive,
                    radius,
                    mass,
                    towards,
                    tau,
                    a: 140.0,
                    b: 0.35,
                    particle,
                    ..person(at)
                });
            }
        }
    }
    crowd(people, dt)
}

#[test]
fn no_centre_passes_a_barrier_at_any_speed() {
    let top = 400.0;
    let zigzag = (0..160).map(|k| p(0.3 * f64::from(k % 2), f64::from(k) * 2.5 - 10.0)).collect::<Vec<_>>();
    let chain = Obstacle::Wall(zigzag.windows(2).map(|ends| Segment::new(ends[0], ends[1])).collect());
    let slab = Obstacle::Solid(Shape::Polygon(Polygon::rectangle(p(0.0, -10.0), p(0.05, top))));
    let disc = |k: u32| Obstacle::Solid(Shape::Circle { centre: p(0.5, 10.0 * f64::from(k)), radius: 0.5 });
    let scenes =
        [vec![wall(p(0.0, -10.0), p(0.0, top))], vec![chain], vec![slab], (0..36).map(disc).collect()];
    let particle = Some(Particle {
        persons: 4,
        repulsion: 0.25,
        friction: 1e4,
        radius_factor: 2.0,
        spread: 0.0,
        room: f64::INFINITY,
        tau_factor: 2.0,
    });
    for layout in BOTH {
        for dt in ["0.01", "0.025", "0.05"] {
            for (obstacles, particle) in scenes.iter().zip([None, particle, None, None]) {
                let mut scene = runners(dt, particle);
                scene.obstacles.clone_from(obstacles);
                let mut run = scene.start(layout);
                for step in 0..(2.5 / dt.parse::<f64>().unwrap()) as usize {
                    let from: Vec<Vec2> = (0..scene.people.len()).map(|k| run.at(k)).collect();
                    run.steps(1);
                    for (k, from) in from.into_iter().enumerate() {
                        let passed = obstacles.iter().any(|one| has_passed(one, from, run.at(k)));
                        assert!(!passed, "{:?} at {from} in step {step} of {dt} s", scene.people[k]);
                    }
                }
                assert!(run.state.diverged.is_empty());
            }
        }
    }
}

#[test]
fn no_centre_passes_a_barrier_at_the_seam_of_a_closed_plane() {
    for layout in BOTH {
        for dt in ["0.02", "0.05"] {
            let mut scene = runners(dt, None);
            let size = 10.0 * scene.people.len() as f64;
            scene.periods = Periods {
                x: Some(Period { low: -3.0, length: 3.02 }),
                y: Some(Period { low: -5.0, length: size }),
            };
            scene.obstacles.push(wall(p(0.0, -5.0), p(0.0, size - 5.0)));
            let mut run = scene.start(layout);
            for _ in 0..80 {
                run.steps(1);
                // Whoever passes comes in again at the other side.
                for k in 0..scene.people.len() {
                    assert!((-2.9..0.0).contains(&run.at(k).x), "{:?} at {}", scene.people[k], run.at(k));
                }
            }
        }
    }
}

#[test]
fn a_crowd_that_storms_does_not_press_anybody_through_a_wall() {
    for layout in BOTH {
        for (dt, drive) in [("0.02", 5.0), ("0.025", 5.0), ("0.04", 2.2)] {
            let row = |k: u32| Person {
                drive,
                radius: 0.25 + 0.001 * f64::from(k % 97),
                ..person(p(-1.0 - 0.75 * f64::from(k / 8), 0.75 * f64::from(k % 8)))
            };
            let mut scene = crowd((0..80).map(row).collect(), dt);
            scene.obstacles = vec![
                wall(p(0.0, -1.0), p(0.0, 6.5)),
                wall(p(-20.0, -1.0), p(0.0, -1.0)),
                wall(p(-20.0, 6.5), p(0.0, 6.5)),
            ];
            let mut run = scene.start(layout);
            for _ in 0..200 {
                run.steps(1);
                assert!((0..80).all(|k| run.at(k).x < 0.0 && run.at(k).y > -1.0 && run.at(k).y < 6.5));
            }
            assert!(run.state.diverged.is_empty());
        }
    }
}

#[test]
fn who_fits_passes_a_door_one_body_wide_at_any_speed() {
    for layout in BOTH {
        for dt in ["0.01", "0.05"] {
            for drive in [0.5, 1.3, 8.0] {
                let mut scene = crowd(vec![Person { drive, a: 0.0, ..person(p(-2.0, 0.0)) }], dt);
                scene.obstacles =
                    vec![wall(p(0.0, -5.0), p(0.0, -0.2501)), wall(p(0.0, 0.2501), p(0.0, 5.0))];
                let mut run = scene.start(layout);
                run.steps((6.0 / dt.parse::<f64>().unwrap()) as usize);
                assert!(run.at(0).x > 0.5, "{drive} m/s, {dt} s: {}", run.at(0));
            }
        }
    }
}

#[test]
fn both_layouts_stop_runners_alike() {
    let mut scene = runners("0.02", None);
    scene.obstacles.push(wall(p(0.0, -10.0), p(0.0, 400.0)));
    let ends = BOTH.map(|layout| {
        let mut run = scene.start(layout);
        run.steps(60);
        (0..scene.people.len()).map(|k| run.at(k)).collect::<Vec<_>>()
    });
    for (one, other) in ends[0].iter().zip(&ends[1]) {
        assert!((one - other).norm() < 1e-6, "{one} {other}");
    }
}
