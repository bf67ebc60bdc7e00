//! The forces of both layouts against a plain, slow sum written from the equations.

use crate::crowd::{Crowd, Numbers, Person, crowd, p, person, wall};
use smc::base::geometry::{Polygon, Segment, Shape, Vec2};
use smc::base::lanes::Mask;
use smc::kernel::{Layout, Scratch, State, refresh};
use smc::model::{Obstacle, Particle};

/// What of an obstacle pushes someone: where from, which way, and the straight piece that does.
struct Push {
    obstacle: usize,
    foot: Vec2,
    normal: Vec2,
    distance: f64,
    piece: Option<Segment>,
}

/// Nearer than this is on it, m.
const ON: f64 = 1e-3;

/// The pieces of all obstacles as someone at a place sees them.
fn pushes(scene: &Crowd, at: Vec2) -> Vec<Push> {
    let mut all = Vec::new();
    for (obstacle, form) in scene.obstacles.iter().enumerate() {
        let edges: Vec<Segment> = match form {
            Obstacle::Wall(pieces) => pieces.clone(),
            Obstacle::Solid(Shape::Polygon(polygon)) if form.distance(at) > 0.0 => {
                polygon.segments().collect()
            }
            Obstacle::Solid(_) => Vec::new(),
        };
        for piece in edges {
            let foot = piece.nearest(at);
            let (distance, normal) = ((at - foot).norm(), (at - foot).normalize());
            // Seen is what one leaves into the open, from before it.
            let upright = p(piece.a.y - piece.b.y, piece.b.x - piece.a.x).normalize();
            let middle = 0.5 * (piece.a + piece.b);
            let open = form.distance(middle + upright * 1e-6) > 0.0;
            let side = upright.dot(&(at - piece.a)) * if open { 1.0 } else { -1.0 };
            if matches!(form, Obstacle::Wall(_)) || (side >= 0.0 && form.distance(foot + normal * 1e-6) > 0.0)
            {
                all.push(Push { obstacle, foot, normal, distance, piece: Some(piece) });
            }
        }
        let distance = form.distance(at);
        let is_round = matches!(form, Obstacle::Solid(Shape::Circle { .. }));
        if distance < 0.0 || is_round {
            // As a whole: the normal is the gradient of the distance.
            let h = 1e-6;
            let slope = |step: Vec2| (form.distance(at + step) - form.distance(at - step)) / (2.0 * h);
            let normal = p(slope(p(h, 0.0)), slope(p(0.0, h)));
            all.push(Push { obstacle, foot: at - normal * distance, normal, distance, piece: None });
        }
    }
    all
}

/// Given-Wilson et al. 2017, equation (5) without contact: of pieces that meet, by the rules of `kernel::surfaces`.
fn of_walls(scene: &Crowd, one: &Person) -> Vec2 {
    let all = pushes(scene, one.at);
    let nearest: Vec<f64> = scene.obstacles.iter().map(|obstacle| obstacle.distance(one.at)).collect();
    // What is left where something nearer has the say: nothing in an obstacle or on its back; behind an end that lies
    // on another piece a face fades out.
    let left = |k: usize| {
        let Push { obstacle, foot, distance, piece, .. } = all[k];
        let on = |j: usize| match all[j].piece {
            Some(piece) => piece.distance(foot) <= ON,
            None => scene.obstacles[all[j].obstacle].distance(foot) <= ON,
        };
        let before = |j: usize| all[j].distance.total_cmp(&distance).then(j.cmp(&k)).is_lt();
        let is_polygon =
            |obstacle: usize| matches!(scene.obstacles[obstacle], Obstacle::Solid(Shape::Polygon(_)));
        let is_inside = |j: usize| all[j].piece.is_none() && is_polygon(all[j].obstacle);
        let mut rest: f64 = 1.0;
        for j in (0..all.len()).filter(|&j| j != k && !is_inside(j) && on(j) && before(j)) {
            rest = match (piece, all[j].piece) {
                (Some(piece), Some(_)) => {
                    let way = (piece.b - piece.a).normalize();
                    let past = (way.dot(&(one.at - piece.b))).max(way.dot(&(piece.a - one.at))).max(0.0);
                    rest.min((1.0 - past / piece.length().min(0.1)).max(0.0))
                }
                _ => 0.0,
            };
        }
        let is_hidden = (0..nearest.len()).any(|other| {
            let is_hidden = scene.obstacles[other].distance(foot) <= ON && nearest[other] < distance;
            let mut faces = (0..all.len()).filter(|j| all[*j].obstacle == other && !is_inside(*j));
            other != obstacle && is_polygon(other) && is_hidden && !faces.any(|j| j != k && on(j))
        });
        if is_hidden { 0.0 } else { rest }
    };
    let gap = |push: &Push| one.radius - push.distance;
    let mut felt: Vec<(&Push, f64)> = (0..all.len())
        .filter(|k| gap(&all[*k]) > -16.0 * one.b)
        .map(|k| (&all[k], left(k) * one.a * (gap(&all[k]) / one.b).exp()))
        .filter(|(_, f)| *f > 0.0)
        .collect();
    // What hangs together shares.
    let structure = structures(scene);
    let of = |push: &Push| structure[push.obstacle];
    let alone: Vec<f64> = felt.iter().map(|(_, f)| *f).collect();
    let c = |j: usize, k: usize, felt: &[(&Push, f64)]| {
        let is_one = j != k && of(felt[j].0) == of(felt[k].0);
        if is_one { felt[j].0.normal.dot(&felt[k].0.normal).clamp(0.0, 1.0) } else { 0.0 }
    };
    let n = felt.len();
    let mut is_crowded = false;
    for k in 0..n {
        let others: Vec<usize> = (0..n).filter(|&j| c(j, k, &felt) > 0.0).collect();
        is_crowded |= others.len() > 1;
        for j in others {
            let c = c(j, k, &felt);
            let given = alone[k] / (1.0 + c) + c * (alone[k] - alone[j]) / (1.0 - c * c + 1e-300);
            felt[k].1 = felt[k].1.min(given.max(0.0));
        }
    }
    if is_crowded {
        let given = |k: usize| felt[k].1 + (0..n).map(|j| c(j, k, &felt) * felt[j].1).sum::<f64>();
        let less: Vec<f64> = (0..n).map(|k| (alone[k] / given(k)).min(1.0)).collect();
        for (one, less) in felt.iter_mut().zip(less) {
            one.1 *= less;
        }
    }
    for _ in 0..if is_crowded { 16 } else { 0 } {
        let next = |k: usize| {
            let given: f64 = (0..n).map(|j| c(j, k, &felt) * felt[j].1).sum();
            let row: f64 = (0..n).map(|j| c(j, k, &felt)).sum();
            felt[k].1 + ((alone[k] - given).max(0.0) - felt[k].1) / (1.0 + row)
        };
        let all: Vec<f64> = (0..n).map(next).collect();
        for (one, next) in felt.iter_mut().zip(all) {
            one.1 = next;
        }
    }
    felt.iter().map(|(push, f)| push.normal * *f).sum()
}

/// Which obstacles hang together: of each the first that it is reached from.
fn structures(scene: &Crowd) -> Vec<usize> {
    let touch = |one: &Obstacle, other: &Obstacle| {
        let pieces = |obstacle: &Obstacle| match obstacle {
            Obstacle::Wall(pieces) => pieces.clone(),
            Obstacle::Solid(Shape::Polygon(polygon)) => polygon.segments().collect(),
            Obstacle::Solid(Shape::Circle { .. }) => Vec::new(),
        };
        let (ones, others) = (pieces(one), pieces(other));
        let round = |disc: &Obstacle, pieces: &[Segment]| match disc {
            Obstacle::Solid(Shape::Circle { centre, radius }) => {
                pieces.iter().any(|piece| piece.distance(*centre) <= radius + ON)
            }
            _ => false,
        };
        ones.iter().any(|a| others.iter().any(|b| apart(*a, *b) <= ON))
            || round(one, &others)
            || round(other, &ones)
    };
    let n = scene.obstacles.len();
    let mut first: Vec<usize> = (0..n).collect();
    loop {
        let before = first.clone();
        for j in 0..n {
            for k in 0..j {
                if first[j] != first[k] && touch(&scene.obstacles[j], &scene.obstacles[k]) {
                    let (low, high) = (first[j].min(first[k]), first[j].max(first[k]));
                    first.iter_mut().filter(|f| **f == high).for_each(|f| *f = low);
                }
            }
        }
        if first == before {
            return first;
        }
    }
}

fn apart(one: Segment, other: Segment) -> f64 {
    let ends = [one.distance(other.a), one.distance(other.b), other.distance(one.a), other.distance(one.b)];
    if one.meets(&other) { 0.0 } else { ends.into_iter().fold(f64::INFINITY, f64::min) }
}

/// Given-Wilson et al. 2017, equations (3) and (5) without contact, and the attraction of groups.
fn plain(scene: &Crowd, i: usize) -> Vec2 {
    let one = &scene.people[i];
    if !one.present {
        return p(0.0, 0.0);
    }
    let mut force = p(0.0, 0.0);
    for (j, other) in scene.people.iter().enumerate() {
        if j == i || !other.present {
            continue;
        }
        let d = one.at - other.at;
        let (distance, n) = (d.norm(), d.normalize());
        let gap = one.radius + other.radius - distance;
        let cos_phi = -n.dot(&one.towards);
        let term = |a: f64, b: f64, lambda: f64| {
            let weight = lambda + (1.0 - lambda) * (1.0 + cos_phi) / 2.0;
            if gap > -16.0 * b { a * (gap / b).exp() * weight } else { 0.0 }
        };
        let social = term(one.a, one.b, one.lambda) + term(one.a2, one.b2, one.lambda2);
        let drive = one.mass * one.drive / one.tau;
        force += n * match (one.particle, other.particle) {
            (Some(a), Some(b)) if a.persons > 1 && b.persons > 1 && drive > 0.0 => {
                0.5 * (a.repulsion + b.repulsion) * social * drive / (social + drive)
            }
            (Some(a), Some(b)) if a.persons > 1 && b.persons > 1 => 0.0,
            _ => social,
        };
    }
    force += of_walls(scene, one);
    for (members, attraction) in &scene.groups {
        if members.contains(&(i as u32)) {
            let here: Vec<Vec2> = members
                .iter()
                .map(|&k| &scene.people[k as usize])
                .filter(|m| m.present)
                .map(|m| m.at)
                .collect();
            let way = here.iter().sum::<Vec2>() / here.len() as f64 - one.at;
            if way.norm() > 0.5 * (here.len() as f64 - 1.0) {
                force += way.normalize() * *attraction;
            }
        }
    }
    force
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
                tau_factor: 1.0,
            }),
            ..person(p(rng.between(0.0, side), rng.between(0.0, side)))
        }
    });
    let mut scene = crowd(people.collect(), "0.01");
    let corner = vec![Segment::new(p(0.0, -1.0), p(-1.0, -1.0)), Segment::new(p(-1.0, -1.0), p(-1.0, side))];
    let mut ring = Polygon::rectangle(p(0.3 * side, 0.3 * side), p(0.6 * side, 0.65 * side));
    ring.holes.push(Polygon::rectangle(p(0.35 * side, 0.35 * side), p(0.55 * side, 0.6 * side)).outline);
    scene.obstacles = vec![
        Obstacle::Wall(corner),
        wall(p(side + 0.2, 0.0), p(0.5 * side, side + 1.0)),
        Obstacle::Solid(Shape::Polygon(ring)),
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
                let (found, wanted) = (run.force(i), plain(&scene, i));
                let near = (found - wanted).norm() <= 1e-7 * wanted.norm() + 1e-9;
                assert!(near, "round {round}, {layout:?}, agent {i}: {found} instead of {wanted}");
            }
        }
    }
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
    for _ in 0..300 {
        let at = p(rng.between(-2.0, 12.0), rng.between(-2.0, 12.0));
        scene.obstacles.push(wall(at, at + p(rng.between(-0.5, 0.5), rng.between(-0.5, 0.5))));
    }
    for layout in [Layout::Trials, Layout::Agents] {
        let run = scene.start(layout);
        for i in 0..50 {
            let (found, wanted) = (run.force(i), plain(&scene, i));
            assert!((found - wanted).norm() <= 1e-7 * wanted.norm() + 1e-9, "{layout:?}, agent {i}");
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
    let mut scratch = Scratch::new();
    for (lane, scene) in scenes.iter().enumerate() {
        scene.load(&mut state, lane, lane as u64);
        // One after the other: what was refreshed before must stay.
        refresh(&program, &mut state, &mut scratch, Mask::lane(lane));
    }
    for (lane, scene) in scenes.iter().enumerate() {
        for i in 0..30 {
            let found = p(state.motion.fx[i].0[lane], state.motion.fy[i].0[lane]);
            let wanted = plain(scene, i);
            assert!((found - wanted).norm() <= 1e-7 * wanted.norm() + 1e-9, "lane {lane}, agent {i}");
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
                let (found, wanted) = (run.force(i), plain(&scene, i));
                assert!((found - wanted).norm() <= 1e-7 * wanted.norm() + 1e-9, "{layout:?}, agent {i}");
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
    assert!((near.force(0) - plain(&scene, 0)).norm() < 1e-9);
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
