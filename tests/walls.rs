//! People at walls against closed forms (Helbing, Farkas, Vicsek 2000, with m = 80 kg, tau = 0.5 s, A = 2000 N,
//! B = 0.08 m, R = 0.25 m unless said otherwise). Both layouts must meet each.

use crate::crowd::{NEVER, Person, crowd, p, person, wall};
use smc::base::geometry::{Polygon, Segment, Shape};
use smc::kernel::Layout;
use smc::model::Obstacle;

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
