//! The moving part against closed forms (Helbing, Farkas, Vicsek 2000, with m = 80 kg, tau = 0.5 s,
//! A = 2000 N, B = 0.08 m, R = 0.25 m unless said otherwise). Both layouts must meet each.

use crate::crowd::{Crowd, NEVER, Person, Run, crowd, p, person, streams, wall};
use smc::base::geometry::Vec2;
use smc::kernel::Layout;
use smc::model::Particle;

const BOTH: [Layout; 2] = [Layout::Trials, Layout::Agents];

fn close(found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within, "found {found}, wanted {wanted} within {within}");
}

#[test]
fn a_free_walk_relaxes_exactly() {
    for layout in BOTH {
        for (dt, steps) in [("0.01", 170), ("0.1", 17)] {
            let mut run = crowd(vec![Person { drive: 1.34, ..person(p(0.0, 0.0)) }], dt).start(layout);
            run.steps(steps);
            let left = (-1.7f64 / 0.5).exp();
            close(run.velocity(0).x, 1.34 * (1.0 - left), 1e-14);
            let h: f64 = dt.parse().unwrap();
            close(run.at(0).x, 1.34 * (1.7 - 0.5 * (1.0 - left)), 0.5 * h * h);
            assert_eq!(run.at(0).y, 0.0);
            close(run.state.motion.travelled[0].0[0], run.at(0).x, 1e-14);
            assert_eq!(run.state.ticks[0], steps as u64);
        }
    }
}

#[test]
fn the_social_force_at_touch_is_a_and_falls_with_a_over_b() {
    for layout in BOTH {
        let at =
            |d: f64| crowd(vec![person(p(0.0, 0.0)), person(p(d, 0.0))], "0.01").start(layout).force(1).x;
        close(at(0.5), 2000.0, 1e-9);
        close((at(0.5 + 1e-6) - at(0.5 - 1e-6)) / 2e-6, -2000.0 / 0.08, 1e-3);
        close(at(0.45), 2000.0 * (0.05f64 / 0.08).exp(), 1e-9);
        assert!(at(0.5 + 15.99 * 0.08) > 0.0);
        assert_eq!(at(0.5 + 16.01 * 0.08), 0.0, "nothing beyond the reach");
    }
}

#[test]
fn an_overlap_adds_compression() {
    for layout in BOTH {
        let pair = |x: f64| Person { a: 0.0, tau: NEVER, ..person(p(x, 0.0)) };
        let mut run = crowd(vec![pair(0.0), pair(0.47)], "0.00001").start(layout);
        run.steps(1);
        close(run.velocity(1).x, 1.2e5 * 0.03 / 80.0 * 1e-5, 1e-9);
        close(run.velocity(0).x, -run.velocity(1).x, 1e-18);
    }
}

#[test]
fn a_head_on_pair_stands_off_whatever_lambda() {
    for layout in BOTH {
        for lambda in [0.0, 0.3, 1.0] {
            let one =
                |x: f64, to: f64| Person { drive: 1.34, lambda, towards: p(to, 0.0), ..person(p(x, 0.0)) };
            let mut run = crowd(vec![one(-1.0, 1.0), one(1.0, -1.0)], "0.01").start(layout);
            run.steps(3000);
            let wanted = 0.5 + 0.08 * (2000.0 * 0.5 / (80.0 * 1.34f64)).ln();
            close((run.at(1) - run.at(0)).norm(), wanted, 2e-5);
            close(wanted, 0.6786, 5e-5);
        }
    }
}

#[test]
fn the_oscillation_at_the_stand_off_has_the_period_of_theory() {
    let rest = 0.25 + 0.08 * (2000.0 * 0.5 / (80.0 * 1.34f64)).ln();
    let walker = Person { drive: 1.34, towards: p(0.0, -1.0), ..person(p(0.0, rest + 1e-4)) };
    let mut scene = crowd(vec![walker], "0.005");
    scene.obstacles.push(wall(p(-5.0, 0.0), p(5.0, 0.0)));
    let mut run = scene.start(Layout::Trials);
    // The rest of the discrete flow itself, so that crossings are equally spaced.
    let mut still = scene.start(Layout::Trials);
    still.steps(20_000);
    let rest = still.at(0).y;
    let mut crossings = Vec::new();
    let mut last = run.at(0).y;
    for k in 1..1000 {
        run.steps(1);
        let y = run.at(0).y;
        if last > rest && y <= rest {
            crossings.push((f64::from(k) - (rest - y) / (last - y)) * 0.005);
        }
        last = y;
    }
    let omega = (1.34f64 / (0.5 * 0.08) - 1.0).sqrt();
    close(2.0 * std::f64::consts::PI / omega, 1.102, 5e-4);
    close(crossings[2] - crossings[1], 2.0 * std::f64::consts::PI / omega, 2e-3);
    close(crossings[1] - crossings[0], 2.0 * std::f64::consts::PI / omega, 2e-3);
}

#[test]
fn friction_between_two_decays_their_slip_and_keeps_momentum() {
    for layout in BOTH {
        let one = |y: f64, v: f64, mass: f64| Person {
            a: 0.0,
            k1: 0.0,
            mass,
            tau: NEVER,
            velocity: p(v, 0.0),
            ..person(p(0.0, y))
        };
        let mut run = crowd(vec![one(0.0, 1.0, 80.0), one(0.48, -0.5, 60.0)], "0.0002").start(layout);
        run.steps(10);
        let slip = run.velocity(0).x - run.velocity(1).x;
        let rate = 2.4e5 * 0.02 * (1.0 / 80.0 + 1.0 / 60.0);
        close(slip, 1.5 * (-rate * 0.002f64).exp(), 1e-4);
        close(80.0 * run.velocity(0).x + 60.0 * run.velocity(1).x, 50.0, 1e-12);
        // Even the stiffest friction over a long step leaves a slip of the same sign.
        let mut run = crowd(vec![one(0.0, 1.0, 80.0), one(0.48, -0.5, 60.0)], "0.02").start(layout);
        for _ in 0..20 {
            run.steps(1);
            let n = (run.at(0) - run.at(1)).normalize();
            let slip = (run.velocity(0) - run.velocity(1)).dot(&Vec2::new(-n.y, n.x));
            assert!(slip >= -1e-12, "{slip}");
        }
    }
}

/// Bodies that move freely, overlap and bounce.
fn bouncing(k2: f64, dt: &'static str) -> Crowd {
    let mut scene = streams(12, 2.4, 1.8, 0.3, dt);
    scene.obstacles.clear();
    for (k, one) in scene.people.iter_mut().enumerate() {
        *one = Person { tau: NEVER, k2, mass: 60.0 + 3.0 * k as f64, ..one.clone() };
    }
    scene
}

#[test]
fn momentum_is_constant() {
    for layout in BOTH {
        let mut run = bouncing(2.4e5, "0.01").start(layout);
        let momentum =
            |run: &Run| (0..12).fold(p(0.0, 0.0), |sum, k| sum + run.velocity(k) * (60.0 + 3.0 * k as f64));
        let start = momentum(&run);
        run.steps(200);
        assert!((momentum(&run) - start).norm() < 1e-9);
    }
}

fn energy(run: &Run) -> f64 {
    let mut sum = 0.0;
    for i in 0..12 {
        sum += 0.5 * (60.0 + 3.0 * i as f64) * run.velocity(i).norm_squared();
        for j in 0..i {
            let gap = 0.5 - (run.at(i) - run.at(j)).norm();
            sum += 2000.0 * 0.08 * (gap / 0.08).exp() + 0.5 * 1.2e5 * gap.max(0.0).powi(2);
        }
    }
    sum
}

#[test]
fn energy_is_kept_without_friction_to_second_order_and_never_raised_by_friction() {
    let drift = |dt, steps| {
        let mut run = bouncing(0.0, dt).start(Layout::Trials);
        let start = energy(&run);
        let mut worst: f64 = 0.0;
        for _ in 0..steps {
            run.steps(1);
            worst = worst.max((energy(&run) / start - 1.0).abs());
        }
        worst
    };
    let (coarse, fine) = (drift("0.004", 250), drift("0.001", 1000));
    assert!(coarse < 1e-2 && fine < coarse / 8.0, "{coarse} {fine}");
    let mut run = bouncing(2.4e5, "0.002").start(Layout::Trials);
    let mut last = energy(&run);
    for _ in 0..500 {
        run.steps(1);
        let now = energy(&run);
        assert!(now < last * (1.0 + 2e-3), "{now} after {last}");
        last = now;
    }
    assert!(last < 0.9 * energy(&bouncing(2.4e5, "0.002").start(Layout::Trials)));
}

#[test]
fn a_single_file_walks_with_the_speed_of_the_ring_formula() {
    let wanted = 1.34 - 0.5 * 2000.0 / 80.0 * 0.9 * (0.5f64 / 0.08).exp() / ((0.8f64 / 0.08).exp() - 1.0);
    close(wanted, 1.0754, 5e-5);
    for layout in BOTH {
        let file = (0..41).map(|k| Person {
            drive: 1.34,
            lambda: 0.1,
            velocity: p(wanted, 0.0),
            ..person(p(0.8 * f64::from(k), 0.0))
        });
        let mut run = crowd(file.collect(), "0.01").start(layout);
        close(1.34 + 0.5 * run.force(20).x / 80.0, wanted, 1e-8);
        run.steps(100);
        // The splitting's own error in a driven balance: (dt/tau)^2/12 of the loss of speed.
        close(run.velocity(20).x, wanted, 1e-4 / 3.0 * (1.34 - wanted) * 1.01);
    }
}

#[test]
fn the_noise_has_its_variance_and_memory_at_every_step() {
    for (dt, steps) in [("0.005", 2000), ("0.05", 800), ("0.4", 800)] {
        let people = (0..32).map(|k| Person { noise: 0.3, ..person(p(50.0 * f64::from(k), 0.0)) });
        let scene = crowd(people.collect(), dt);
        let mut run = scene.start(Layout::Agents);
        let h: f64 = dt.parse().unwrap();
        let lag = (0.4 / h).round() as usize;
        run.steps((4.0 / h) as usize);
        let (mut squares, mut products, mut n) = (0.0, 0.0, 0.0);
        let mut past: Vec<Vec<Vec2>> = Vec::new();
        for k in 0..steps {
            run.steps(1);
            let now: Vec<Vec2> = (0..32).map(|agent| run.velocity(agent)).collect();
            squares += now.iter().map(Vec2::norm_squared).sum::<f64>();
            if k >= lag {
                products += now.iter().zip(&past[k - lag]).map(|(a, b)| a.dot(b)).sum::<f64>();
                n += 64.0;
            }
            past.push(now);
        }
        let variance = squares / (64.0 * steps as f64);
        close(variance / 0.09, 1.0, 0.08);
        close(products / n / variance, (-0.8f64).exp(), 0.04);
    }
}

#[test]
fn contact_in_sub_steps_leaves_the_variance_alone() {
    // People who lean on a wall: compression only, so each velocity keeps its stationary variance.
    let people = (0..64).map(|k| Person {
        a: 0.0,
        k2: 0.0,
        noise: 0.1,
        drive: 1.0,
        towards: p(0.0, -1.0),
        ..person(p(20.0 * f64::from(k), 0.25))
    });
    for layout in BOTH {
        for dt in ["0.01", "0.02"] {
            let mut scene = crowd(people.clone().collect(), dt);
            scene.obstacles.push(wall(p(-5.0, 0.0), p(2000.0, 0.0)));
            let mut run = scene.start(layout);
            run.steps(300);
            let (mut squares, mut in_contact) = (0.0, 0);
            for _ in 0..2500 {
                run.steps(1);
                for agent in 0..64 {
                    squares += run.velocity(agent).y.powi(2);
                    in_contact += usize::from(run.at(agent).y < 0.25);
                }
            }
            let n = 64.0 * 2500.0;
            assert!(f64::from(in_contact as u32) > 0.3 * n, "{in_contact} of {n}");
            close(squares / n / 0.01, 1.0, 0.05);
        }
    }
}

#[test]
fn turned_mirrored_moved_and_permuted_scenes_move_alike() {
    let scene = streams(20, 6.0, 4.0, 0.3, "0.01");
    let image = |turn: &dyn Fn(Vec2) -> Vec2, shift: Vec2| {
        let mut other = scene.clone();
        for one in &mut other.people {
            *one = Person {
                at: turn(one.at) + shift,
                velocity: turn(one.velocity),
                towards: turn(one.towards),
                ..one.clone()
            };
        }
        let corners = [p(0.0, 0.0), p(6.0, 0.0), p(6.0, 4.0), p(0.0, 4.0)].map(|c| turn(c) + shift);
        other.obstacles = (0..4).map(|k| wall(corners[k], corners[(k + 1) % 4])).collect();
        other
    };
    let (sin, cos) = 0.7f64.sin_cos();
    let turns: [Box<dyn Fn(Vec2) -> Vec2>; 3] = [
        Box::new(move |v| p(cos * v.x - sin * v.y, sin * v.x + cos * v.y)),
        Box::new(|v| p(-v.x, v.y)),
        Box::new(|v| v),
    ];
    for layout in BOTH {
        let mut run = scene.start(layout);
        run.steps(60);
        for turn in &turns {
            let shift = p(3.5, -1.25);
            let mut other = image(turn, shift).start(layout);
            other.steps(60);
            for k in 0..20 {
                assert!((turn(run.at(k)) + shift - other.at(k)).norm() < 1e-8);
            }
        }
        let mut reversed = scene.clone();
        reversed.people.reverse();
        let mut other = reversed.start(layout);
        other.steps(60);
        for k in 0..20 {
            assert!((run.at(k) - other.at(19 - k)).norm() < 1e-8);
        }
    }
}

#[test]
fn lambda_weighs_front_side_and_back_even_at_rest() {
    for layout in BOTH {
        for (other, weight) in [(p(0.6, 0.0), 1.0), (p(0.0, 0.6), 0.65), (p(-0.6, 0.0), 0.3)] {
            let walker = Person { lambda: 0.3, ..person(p(0.0, 0.0)) };
            let run = crowd(vec![walker, person(other)], "0.01").start(layout);
            let full = 2000.0 * (-0.1f64 / 0.08).exp();
            assert!((run.force(0) + other / 0.6 * (weight * full)).norm() < 1e-9);
        }
    }
}

#[test]
fn friends_pull_towards_their_centroid_beyond_half_a_metre_each() {
    for layout in BOTH {
        let at = |far: f64| {
            let mut scene =
                crowd([0.0, 0.0, far].map(|x| Person { a: 0.0, ..person(p(x, 0.0)) }).to_vec(), "0.01");
            scene.people[1].at.y = 0.1;
            scene.groups.push((vec![0, 1, 2], 150.0));
            let run = scene.start(layout);
            [run.force(0), run.force(1), run.force(2)]
        };
        // The centroid is a third of the way; the free distance of three is 1 m.
        assert_eq!(at(1.4), [p(0.0, 0.0); 3]);
        let [first, _, last] = at(2.4);
        assert_eq!(first, p(0.0, 0.0));
        close(last.norm(), 150.0, 1e-10);
        assert!(last.x < -149.9);
    }
}

#[test]
fn a_particle_of_one_is_a_person_and_two_of_several_have_their_own_law() {
    for layout in BOTH {
        let scene = |particle: Option<Particle>| {
            let mut scene = streams(10, 4.0, 2.0, 0.2, "0.01");
            for one in &mut scene.people {
                one.particle = particle;
                one.lambda = 0.4;
            }
            scene
        };
        let particle = |persons| {
            Some(Particle {
                persons,
                repulsion: 0.25,
                friction: 0.0,
                radius_factor: 1.0,
                spread: 0.0,
                room: f64::INFINITY,
                tau_factor: 1.0,
            })
        };
        let (mut persons, mut ones) = (scene(None).start(layout), scene(particle(1)).start(layout));
        let pair = |drive| {
            let body = |x: f64| Person { drive, particle: particle(2), ..person(p(x, 0.0)) };
            crowd(vec![body(0.0), body(0.6)], "0.01").start(layout).force(1).x
        };
        let (social, drive) = (2000.0 * (-0.1f64 / 0.08).exp(), 80.0 * 1.34 / 0.5);
        close(pair(1.34), 0.25 * social * drive / (social + drive), 1e-9);
        assert_eq!(pair(0.0), 0.0, "nothing drives");
        persons.steps(100);
        ones.steps(100);
        assert_eq!(crate::crowd::bits_of(&persons.state, 0), crate::crowd::bits_of(&ones.state, 0));

        // No compression between bodies of several, and their own friction.
        let body = |y: f64, v: f64| Person {
            a: 0.0,
            tau: NEVER,
            velocity: p(v, 0.0),
            particle: Some(Particle {
                persons: 3,
                repulsion: 1.0,
                friction: 1e4,
                radius_factor: 1.0,
                spread: 0.0,
                room: f64::INFINITY,
                tau_factor: 1.0,
            }),
            ..person(p(0.0, y))
        };
        let mut run = crowd(vec![body(0.0, 0.5), body(0.4, -0.5)], "0.001").start(layout);
        run.steps(1);
        close(run.velocity(0).x - run.velocity(1).x, (-1e4 * 0.1 * (2.0 / 80.0) * 0.001f64).exp(), 1e-5);
        assert!(run.velocity(0).y.abs() < 1e-4, "{}", run.velocity(0).y);
    }
}

/// Four a square metre in a closed box; neighbours overlap by up to 0.1 m, with `pushed` every tenth more.
fn dense(pushed: bool, dt: &'static str) -> Crowd {
    let mut scene = streams(200, 10.0, 5.0, 0.1, dt);
    for k in (0..190).step_by(10).filter(|_| pushed) {
        let towards = (scene.people[k + 1].at - scene.people[k].at).normalize();
        scene.people[k].at = scene.people[k + 1].at - towards * 0.4;
    }
    scene
}

#[test]
fn a_dense_crowd_with_overlaps_stays_slow_and_inside() {
    let scene = dense(false, "0.01");
    let overlap = |i: usize, j: usize| 0.5 - (scene.people[i].at - scene.people[j].at).norm();
    let deepest = (0..200).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| overlap(i, j));
    assert!(deepest.fold(0.0, f64::max) > 0.095);
    for layout in BOTH {
        let mut run = scene.start(layout);
        for _ in 0..300 {
            run.steps(1);
            assert!(run.fastest() < 6.0, "{}", run.fastest());
        }
        for k in 0..200 {
            let at = run.at(k);
            assert!((0.0..10.0).contains(&at.x) && (0.0..5.0).contains(&at.y), "{at}");
        }
        assert!(run.state.diverged.is_empty());
    }
}

#[test]
fn a_step_of_10_ms_sees_the_peak_speed_of_a_twentieth_of_it() {
    let peak = |dt, steps| {
        let mut run = dense(true, dt).start(Layout::Trials);
        (0..steps).fold(0.0, |peak: f64, _| {
            run.steps(1);
            peak.max(run.fastest())
        })
    };
    close(peak("0.01", 30), peak("0.0005", 600), 0.1);
}

#[test]
fn sparse_crowds_walk_quietly_with_a_step_of_20_ms() {
    for (n, wide, high) in [(20, 20.0, 4.0), (200, 20.0, 20.0)] {
        let mut run = streams(n, wide, high, 0.3, "0.02").start(Layout::Trials);
        for _ in 0..400 {
            run.steps(1);
            assert!(run.fastest() < 2.2, "{}", run.fastest());
        }
    }
}

#[test]
fn a_speed_that_no_human_reaches_is_divergence_of_that_lane_alone() {
    for layout in BOTH {
        let fast = Person { velocity: p(20.0, 0.0), tau: NEVER, ..person(p(0.0, 0.0)) };
        let mut run = crowd(vec![fast, person(p(9.0, 9.0))], "0.01").start(layout);
        run.steps(1);
        assert!(run.state.diverged.has(0));
        let lost = Person { at: p(f64::NAN, 0.0), ..person(p(0.0, 0.0)) };
        let mut run = crowd(vec![lost, person(p(9.0, 9.0))], "0.01").start(layout);
        run.steps(2);
        assert!(run.state.diverged.has(0));
    }
}
