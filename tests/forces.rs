//! The forces of both layouts against a plain, slow sum written from the equations.

use crate::crowd::{Crowd, Numbers, Person, crowd, p, person, wall};
use smc::base::geometry::{Polygon, Segment, Shape, Vec2};
use smc::base::lanes::Mask;
use smc::kernel::{Layout, Scratch, State, refresh};
use smc::model::{Obstacle, Particle};

/// Range of the social force beyond touching distance, in units of B: by definition, so no part of an error.
const REACH: f64 = 16.0;

/// A sum of forces, and the sum of their magnitudes, N.
#[derive(Clone, Copy, Default)]
pub(crate) struct Sum {
    force: Vec2,
    size: f64,
}

impl Sum {
    fn add(&mut self, force: Vec2) {
        self.force += force;
        self.size += force.norm();
    }

    /// Rounding of the forces and of their sum is all that may differ.
    pub(crate) fn assert_is(&self, found: Vec2, words: &str) {
        self.assert_within(found, 1e-12, words);
    }

    pub(crate) fn assert_within(&self, found: Vec2, share: f64, words: &str) {
        let wanted = self.force;
        assert!((found - wanted).norm() <= share * self.size, "{words}: {found} instead of {wanted}");
    }
}

/// A exp(gap/B), up to a reach.
fn decay(a: f64, gap: f64, b: f64, reach: f64) -> f64 {
    if gap > -reach * b { a * (gap / b).exp() } else { 0.0 }
}

/// Given-Wilson et al. 2017, equation (5) without contact: of straight walls and discs, of which those that meet do so
/// at right angles, each pushes from its nearest point. (`kernel::force::walls` has the tests of all other cases.)
fn of_walls(scene: &Crowd, one: &Person, sum: &mut Sum) {
    for obstacle in &scene.obstacles {
        let nearest: Vec<(Vec2, f64)> = match obstacle {
            Obstacle::Wall(pieces) => pieces.iter().map(|piece| (piece.nearest(one.at), 0.0)).collect(),
            Obstacle::Solid(Shape::Circle { centre, radius }) => vec![(*centre, *radius)],
            Obstacle::Solid(Shape::Polygon(_) | Shape::Parts(_)) => panic!("no closed form"),
        };
        for (from, radius) in nearest {
            let way = one.at - from;
            let gap = one.radius + radius - way.norm();
            sum.add(way.normalize() * decay(one.a, gap, one.b, REACH));
        }
    }
}

/// Given-Wilson et al. 2017, equations (3) and (5) without contact, and the attraction of groups.
pub(crate) fn plain(scene: &Crowd, i: usize) -> Sum {
    let (one, mut sum) = (&scene.people[i], Sum::default());
    if !one.present {
        return sum;
    }
    of_others(scene, i, REACH, &mut sum);
    of_walls(scene, one, &mut sum);
    for (members, attraction) in &scene.groups {
        if members.contains(&(i as u32)) {
            let members = members.iter().map(|&k| &scene.people[k as usize]);
            let here: Vec<Vec2> = members.filter(|m| m.present).map(|m| m.at).collect();
            let way = here.iter().sum::<Vec2>() / here.len() as f64 - one.at;
            if way.norm() > 0.5 * (here.len() as f64 - 1.0) {
                sum.add(way.normalize() * *attraction);
            }
        }
    }
    sum
}

/// Whether an obstacle crosses the line between two people.
fn hides(obstacle: &Obstacle, one: Vec2, other: Vec2) -> bool {
    let line = Segment::new(one, other);
    match obstacle {
        Obstacle::Wall(pieces) => pieces.iter().any(|piece| piece.meets(&line)),
        Obstacle::Solid(Shape::Circle { centre, radius }) => line.distance(*centre) < *radius,
        Obstacle::Solid(Shape::Polygon(polygon)) => polygon.segments().any(|edge| edge.meets(&line)),
        Obstacle::Solid(Shape::Parts(_)) => unreachable!("obstacles have one part"),
    }
}

/// Equation (3), up to a reach.
fn of_others(scene: &Crowd, i: usize, reach: f64, sum: &mut Sum) {
    let one = &scene.people[i];
    for (j, other) in scene.people.iter().enumerate() {
        if j == i
            || !other.present
            || scene.obstacles.iter().any(|obstacle| hides(obstacle, one.at, other.at))
        {
            continue;
        }
        let d = one.at - other.at;
        let (distance, n) = (d.norm(), d.normalize());
        let gap = one.radius + other.radius - distance;
        let cos_phi = -n.dot(&one.towards);
        let weight = |lambda: f64| lambda + (1.0 - lambda) * (1.0 + cos_phi) / 2.0;
        let social = decay(one.a, gap, one.b, reach) * weight(one.lambda)
            + decay(one.a2, gap, one.b2, reach) * weight(one.lambda2);
        let drive = one.mass * one.drive / one.tau;
        sum.add(
            n * match (one.particle, other.particle) {
                (Some(a), Some(b)) if a.persons > 1 && b.persons > 1 && drive > 0.0 => {
                    0.5 * (a.repulsion + b.repulsion) * social * drive / (social + drive)
                }
                (Some(a), Some(b)) if a.persons > 1 && b.persons > 1 => 0.0,
                _ => social,
            },
        );
    }
}

#[derive(Clone, Copy)]
struct Kind {
    own_b: bool,
    second: bool,
    ties: bool,
}

fn random(n: usize, side: f64, kind: Kind, rng: &mut Numbers) -> Crowd {
    let people = (0..n).map(|k| {
        let angle: f64 = rng.between(-3.2, 3.2);
        Person {
            towards: p(angle.cos(), angle.sin()),
            radius: rng.between(0.2, 0.3),
            a: rng.between(1500.0, 2500.0),
            b: if kind.own_b { rng.between(0.05, 0.3) } else { 0.08 },
            lambda: rng.between(0.0, 1.0),
            a2: if kind.second { rng.between(10.0, 50.0) } else { 0.0 },
            b2: if kind.own_b { rng.between(0.3, 1.0) } else { 0.6 },
            lambda2: rng.between(0.0, 1.0),
            present: k % 7 != 3,
            drive: if k % 5 == 2 { 0.0 } else { rng.between(0.5, 2.0) },
            particle: (kind.ties && k % 3 > 0).then(|| Particle {
                persons: (k % 3) as u32,
                repulsion: rng.between(0.1, 2.0),
                friction: 1e4,
                radius_factor: 1.0,
                spread: 0.0,
                room: f64::INFINITY,
                tau_factor: 1.0,
            }),
            ..person(p(rng.between(0.0, side), rng.between(0.0, side)))
        }
    });
    let mut scene = crowd(people.collect(), "0.01");
    let far = side + 3.0;
    let corner = vec![Segment::new(p(far, -1.0), p(-1.0, -1.0)), Segment::new(p(-1.0, -1.0), p(-1.0, far))];
    scene.obstacles = vec![
        Obstacle::Wall(corner),
        wall(p(side + 0.2, 0.0), p(0.5 * side, side + 1.0)),
        Obstacle::Solid(Shape::Circle { centre: p(0.8 * side, 0.2 * side), radius: 0.05 * side }),
    ];
    scene.groups = vec![(vec![0, 1, 2, 3], 120.0), (vec![5, 8], 80.0)];
    scene
}

#[test]
fn both_layouts_sum_the_plain_forces() {
    let mut rng = Numbers(3);
    for round in 0..24 {
        let kind = Kind { own_b: round & 1 > 0, second: round & 2 > 0, ties: round & 4 > 0 };
        let n = 9 + 4 * round;
        let scene = random(n, (n as f64 * 2.0).sqrt(), kind, &mut rng);
        for layout in [Layout::Trials, Layout::Agents] {
            let run = scene.start(layout);
            for i in 0..n {
                plain(&scene, i).assert_is(run.force(i), &format!("round {round}, {layout:?}, agent {i}"));
            }
        }
    }
}

#[test]
fn the_reach_leaves_out_what_pairs_beyond_it_give_and_nothing_else() {
    let mut rng = Numbers(4);
    for round in 0..8 {
        let kind = Kind { own_b: round & 1 > 0, second: round & 2 > 0, ties: false };
        let mut scene = random(60, 11.0, kind, &mut rng);
        scene.obstacles.clear();
        scene.groups.clear();
        let run = scene.start(Layout::Agents);
        let beyond = (0..60).filter(|&i| scene.people[i].present).map(|i| {
            let (mut endless, mut within) = (Sum::default(), Sum::default());
            of_others(&scene, i, f64::INFINITY, &mut endless);
            of_others(&scene, i, REACH, &mut within);
            within.assert_is(run.force(i), &format!("round {round}, agent {i}"));
            let left_out = (endless.force - run.force(i)).norm();
            let one = &scene.people[i];
            assert!(left_out <= 59.0 * (one.a + one.a2) * (-REACH).exp() + 1e-12 * endless.size);
            left_out
        });
        assert!(beyond.fold(0.0, f64::max) > 0.0);
    }
}

#[test]
fn both_layouts_feel_the_same_of_barriers_that_meet() {
    let mut rng = Numbers(12);
    for round in 0..8 {
        let kind = Kind { own_b: round & 1 > 0, second: round & 2 > 0, ties: round & 4 > 0 };
        let side = 9.0;
        let mut scene = random(40, side, kind, &mut rng);
        let mut ring = Polygon::rectangle(p(0.3 * side, 0.3 * side), p(0.6 * side, 0.65 * side));
        ring.holes.push(Polygon::rectangle(p(0.35 * side, 0.35 * side), p(0.55 * side, 0.6 * side)).outline);
        scene.obstacles.push(Obstacle::Solid(Shape::Polygon(ring)));
        for _ in 0..60 {
            let (at, way) = (p(rng.between(0.0, side), rng.between(0.0, side)), rng.between(-1.0, 1.0));
            scene.obstacles.push(wall(at, at + p(way, rng.between(-1.0, 1.0))));
        }
        let (lanes, cells) = (scene.start(Layout::Trials), scene.start(Layout::Agents));
        for i in 0..40 {
            let (one, other) = (lanes.force(i), cells.force(i));
            let size = plain_size(&scene, i).max(one.norm());
            assert!((one - other).norm() <= 1e-12 * size, "round {round}, agent {i}: {one}, {other}");
        }
    }
}

/// Sum of the magnitudes of the forces on someone but those of barriers, N.
fn plain_size(scene: &Crowd, i: usize) -> f64 {
    let mut alone = crowd(scene.people.clone(), "0.01");
    alone.groups.clone_from(&scene.groups);
    plain(&alone, i).size
}

/// Barriers that nobody feels, of many sizes, between those of a scene.
fn among_thousands(scene: &Crowd, rng: &mut Numbers) -> Crowd {
    let mut crowded = crowd(scene.people.clone(), "0.01");
    crowded.groups.clone_from(&scene.groups);
    for obstacle in &scene.obstacles {
        for _ in 0..1_000 {
            let at = p(rng.between(40.0, 300.0), rng.between(-200.0, 300.0));
            let size = rng.between(0.1, 20.0);
            crowded.obstacles.push(wall(at, at + p(size, rng.between(-size, size))));
        }
        crowded.obstacles.push(obstacle.clone());
    }
    crowded
}

#[test]
fn thousands_of_barriers_change_no_bit_of_the_forces_of_a_few() {
    let mut rng = Numbers(5);
    for round in 0..6 {
        let kind = Kind { own_b: round & 1 > 0, second: false, ties: false };
        let few = random(60, 11.0, kind, &mut rng);
        let many = among_thousands(&few, &mut rng);
        for layout in [Layout::Trials, Layout::Agents] {
            let (mut one, mut other) = (few.start(layout), many.start(layout));
            for _ in 0..5 {
                for i in 0..60 {
                    assert_eq!(one.force(i), other.force(i), "{layout:?}, agent {i}");
                }
                one.steps(4);
                other.steps(4);
            }
        }
    }
}

#[test]
fn hundreds_of_near_barriers_sum_to_the_plain_forces() {
    let mut rng = Numbers(6);
    let mut scene = random(50, 10.0, Kind { own_b: true, second: false, ties: false }, &mut rng);
    scene.obstacles.clear();
    for k in 0..300 {
        // None meets another one.
        let at = p(f64::from(k % 20) * 0.7 - 2.0, f64::from(k / 20) * 0.7 - 0.9);
        let end = at + p(rng.between(-0.3, 0.3), rng.between(-0.3, 0.3));
        scene.obstacles.push(wall(at, end));
    }
    for layout in [Layout::Trials, Layout::Agents] {
        let run = scene.start(layout);
        for i in 0..50 {
            plain(&scene, i).assert_is(run.force(i), &format!("{layout:?}, agent {i}"));
        }
    }
}

#[test]
fn eight_different_trials_side_by_side_each_have_their_own_forces() {
    let mut rng = Numbers(8);
    let kind = Kind { own_b: true, second: true, ties: false };
    let scenes: Vec<Crowd> = (0..8).map(|_| random(30, 7.0, kind, &mut rng)).collect();
    let program = scenes[0].program();
    let mut state = State::new(Layout::Trials, 30);
    let mut scratch = Scratch::default();
    for (lane, scene) in scenes.iter().enumerate() {
        scene.load(&mut state, lane, lane as u64);
        // One after the other: what was refreshed before must stay.
        refresh(&program, &mut state, &mut scratch, Mask::lane(lane));
    }
    for (lane, scene) in scenes.iter().enumerate() {
        for i in 0..30 {
            let found = p(state.motion.fx[i].0[lane], state.motion.fy[i].0[lane]);
            plain(scene, i).assert_is(found, &format!("lane {lane}, agent {i}"));
        }
    }
}

#[test]
fn lists_and_cells_stay_right_while_people_walk() {
    // After many steps the kept list must still hold everyone in reach.
    for layout in [Layout::Trials, Layout::Agents] {
        let mut scene = crate::crowd::streams(60, 12.0, 6.0, 0.3, "0.02");
        let mut run = scene.start(layout);
        for _ in 0..40 {
            run.steps(7);
            for (k, one) in scene.people.iter_mut().enumerate() {
                one.at = run.at(k);
            }
            for i in 0..60 {
                plain(&scene, i).assert_is(run.force(i), &format!("{layout:?}, agent {i}"));
            }
        }
    }
}

#[test]
fn both_layouts_walk_the_same_ways() {
    let scene = crate::crowd::streams(50, 12.0, 5.0, 0.3, "0.01");
    let (mut lanes, mut cells) = (scene.start(Layout::Trials), scene.start(Layout::Agents));
    lanes.steps(100);
    cells.steps(100);
    for k in 0..50 {
        assert!((lanes.at(k) - cells.at(k)).norm() < 1e-9, "agent {k}");
    }
}

#[test]
fn someone_far_away_or_nobody_at_all_does_no_harm() {
    let mut scene = crowd(vec![person(p(0.0, 0.0)), person(p(0.6, 0.0)), person(p(1e9, -1e9))], "0.01");
    let near = scene.start(Layout::Agents);
    plain(&scene, 0).assert_is(near.force(0), "someone far away");
    for one in &mut scene.people {
        one.present = false;
    }
    let mut nobody = scene.start(Layout::Agents);
    nobody.steps(3);
    assert_eq!(nobody.at(1), p(0.6, 0.0));
}

#[test]
fn a_crowd_feels_nobody_far_away() {
    let people: Vec<_> = (0..1_600)
        .map(|k| person(p(f64::from(k % 40) * 0.9 + 0.001 * f64::from(k % 7), f64::from(k / 40) * 0.9)))
        .collect();
    let mut alone = crowd(people.clone(), "0.01");
    let mut beside = crowd(people, "0.01");
    for k in 0..8 {
        beside.people.push(person(p(1e6 * f64::from(k), 1e6)));
    }
    let forces = |scene: &mut Crowd| {
        let mut run = scene.start(Layout::Agents);
        run.steps(20);
        (0..1_600).map(|k| run.force(k)).collect::<Vec<_>>()
    };
    let (alone, beside) = (forces(&mut alone), forces(&mut beside));
    assert!(alone.iter().zip(&beside).all(|(a, b)| (*a - *b).norm() < 1e-6));
}

#[test]
fn two_at_the_same_place_get_a_finite_force() {
    for layout in [Layout::Trials, Layout::Agents] {
        let mut run = crowd(vec![person(p(1.0, 1.0)), person(p(1.0, 1.0))], "0.01").start(layout);
        run.steps(5);
        assert_eq!(run.at(0), p(1.0, 1.0));
        assert!(run.state.diverged.is_empty());
    }
}
