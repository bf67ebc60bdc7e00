//! Contact written plainly, pair by pair in the order of candidates: the reference of the tests.

use super::{Contacts, at, within_reach, within_reach_of_face};
use crate::base::decimal::Decimal;
use crate::base::geometry::{Segment, Vec2};
use crate::base::lanes::{LANES, Mask};
use crate::base::math;
use crate::base::tick::{Clock, Tick};
use crate::kernel::force::walls;
use crate::kernel::program::Program;
use crate::kernel::state::{Layout, State};
use crate::kernel::vector::first_part;
use crate::model::{Barrier, Behaviours, Obstacle, Parameter, Periods, Processes, Scenario, Scene};
use fearless_simd::{Level, dispatch};
use std::sync::Arc;

/// Half a step, s.
const H: f64 = 0.005;
const PEOPLE: usize = 60;

fn program() -> Program {
    let wall = |a: Vec2, b: Vec2| Barrier {
        name: String::new(),
        obstacle: Obstacle::Wall(vec![Segment::new(a, b)]),
    };
    let (low, side, top) = (Vec2::new(-0.1, -0.1), Vec2::new(4.2, -0.1), Vec2::new(-0.1, 4.2));
    Program::new(Arc::new(Scenario {
        title: String::new(),
        clock: Clock::Stepped(Decimal::parse("0.01").unwrap()),
        horizon: Tick(10),
        scene: Scene {
            barriers: vec![wall(low, side), wall(low, top)],
            regions: Vec::new(),
            ..Scene::default()
        },
        agents: Vec::new(),
        groups: Vec::new(),
        moves: Vec::new(),
        processes: Processes::default(),
        behaviours: Behaviours::default(),
        sources: Vec::new(),
        doors: Vec::new(),
    }))
}

struct Numbers(u64);

impl Numbers {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / 9_007_199_254_740_992.0)
    }
}

/// Eight crowds, the first dense, the last with some clusters that touch and some that do not.
fn state(numbers: &mut Numbers) -> State {
    let mut state = State::new(Layout::Trials, PEOPLE);
    for lane in 0..LANES {
        // One lane has no trial.
        if lane != 2 {
            state.occupied |= Mask::lane(lane);
        }
        let wide = 4.0 + lane as f64;
        for k in 0..PEOPLE {
            if k % 13 != lane {
                state.present[k] |= Mask::lane(lane);
            }
            state.motion.x[k].0[lane] = numbers.between(0.0, wide);
            state.motion.y[k].0[lane] = numbers.between(0.0, wide);
            state.motion.vx[k].0[lane] = numbers.between(-1.5, 1.5);
            state.motion.vy[k].0[lane] = numbers.between(-1.5, 1.5);
            state.bodies[Parameter::Mass][k].0[lane] = numbers.between(50.0, 100.0);
            state.bodies[Parameter::Radius][k].0[lane] = numbers.between(0.15, 0.3);
            state.bodies[Parameter::K1][k].0[lane] = numbers.between(0.5e5, 3e5);
            state.bodies[Parameter::K2][k].0[lane] = numbers.between(1e5, 3e5);
        }
    }
    state
}

/// Pairs and bodies at walls that are less than 5 cm from touching, as the forces list them.
fn candidates(program: &Program, state: &State) -> Contacts {
    let mut contacts = Contacts::default();
    contacts.clear();
    for lane in 0..LANES {
        let place = |k: usize| Vec2::new(state.motion.x[k].0[lane], state.motion.y[k].0[lane]);
        let here = |k: usize| state.present[k].has(lane);
        for i in (0..PEOPLE).filter(|&i| here(i)) {
            for j in (i + 1..PEOPLE).filter(|&j| here(j)) {
                let gap = state.bodies[Parameter::Radius][i].0[lane]
                    + state.bodies[Parameter::Radius][j].0[lane]
                    - (place(i) - place(j)).norm();
                if gap > -0.05 {
                    contacts.push_pair(i as u32, j as u32, Mask::lane(lane));
                }
            }
            for k in 0..program.forces.surfaces.len() as u32 {
                if state.bodies[Parameter::Radius][i].0[lane]
                    - program.forces.surfaces.nearest_to(k, place(i)).near
                    > -0.05
                {
                    contacts.push_wall(i as u32, k, Mask::lane(lane));
                }
            }
        }
    }
    contacts
}

/// Two bodies or one at a wall, the sum of their inverse masses, the normal, the gap, k1 and k2.
type Overlap = ((u32, Option<u32>, f64), Vec2, f64, (f64, f64));

/// The same as `Contacts::advance`. Gives how many bodies moved, and how many candidates stayed cold.
fn plainly(contacts: &Contacts, program: &Program, state: &mut State, moved: &mut [Mask]) -> (usize, usize) {
    let (mut many, mut cold) = (0, 0);
    for lane in state.occupied.iter() {
        let (pairs, walls) = (&contacts.candidates[lane].pairs, &contacts.candidates[lane].walls);
        let slot = |i: u32| state.slot(i as usize, lane);
        let mut x: Vec<Vec2> =
            (0..PEOPLE as u32).map(|i| at(&state.motion.x, &state.motion.y, slot(i))).collect();
        let mut v: Vec<Vec2> =
            (0..PEOPLE as u32).map(|i| at(&state.motion.vx, &state.motion.vy, slot(i))).collect();
        let of = |field: &[crate::base::lanes::Lanes], i: u32| field[i as usize].0[lane];
        let radius = |i| of(&state.bodies[Parameter::Radius], i);
        let inverse = |i| 1.0 / of(&state.bodies[Parameter::Mass], i);
        let mean = |field: &[crate::base::lanes::Lanes], i, j| 0.5 * (of(field, i) + of(field, j));
        let moving = |i: u32| (x[i as usize], v[i as usize]);
        let mut hot = [false; PEOPLE];
        for &(i, j) in pairs {
            hot[i as usize] |=
                within_reach(&Periods::default(), radius(i) + radius(j), moving(i), moving(j), H);
        }
        for &(i, face) in walls {
            hot[i as usize] |= within_reach_of_face(&program.forces.surfaces, face, radius(i), moving(i), H);
        }
        for _ in 0..PEOPLE {
            for &(i, j) in pairs {
                let either = hot[i as usize] | hot[j as usize];
                (hot[i as usize], hot[j as usize]) = (either, either);
            }
        }
        let is_hot = |i: u32| hot[i as usize];
        let pairs: Vec<(u32, u32)> = pairs.iter().copied().filter(|&(i, _)| is_hot(i)).collect();
        cold += contacts.candidates[lane].pairs.len() - pairs.len();
        let walls: Vec<(u32, u32)> = walls.iter().copied().filter(|&(i, _)| is_hot(i)).collect();
        let of_pairs =
            pairs.iter().map(|&(i, j)| mean(&state.bodies[Parameter::K1], i, j) * (inverse(i) + inverse(j)));
        let of_walls = walls.iter().map(|&(i, _)| of(&state.bodies[Parameter::K1], i) * inverse(i));
        let stiffest = of_pairs.chain(of_walls).fold(0.0, f64::max);
        let count = (H * (4.0 * stiffest).sqrt() / 0.35).ceil().clamp(1.0, 1000.0) as usize;
        let t = H / count as f64;
        let drift = |x: &mut [Vec2], v: &[Vec2], t: f64| x.iter_mut().zip(v).for_each(|(x, v)| *x += v * t);
        drift(&mut x, &v, 0.5 * t);
        for k in 0..count {
            // Who overlaps whom (or a wall): normal, share of the slip taken away, impulse of compression.
            let mut overlaps: Vec<Overlap> = Vec::new();
            for &(i, j) in &pairs {
                let d = x[i as usize] - x[j as usize];
                let distance = (d.dot(&d) + 1e-300).sqrt();
                let both = inverse(i) + inverse(j);
                overlaps.push((
                    (i, Some(j), both),
                    d / distance,
                    radius(i) + radius(j) - distance,
                    (mean(&state.bodies[Parameter::K1], i, j), mean(&state.bodies[Parameter::K2], i, j)),
                ));
            }
            for k in 0..walls.len() {
                let (i, face) = walls[k];
                let faces: Vec<u32> = walls.iter().filter(|wall| wall.0 == i).map(|wall| wall.1).collect();
                let mut room = walls::Room::default();
                let (place, all) = (x[i as usize], &program.forces.surfaces);
                let touches = dispatch!(Level::baseline(), simd => {
                    all.touch(first_part(simd), faces.iter().copied(), place, radius(i), &mut room)
                });
                let touch = touches[faces.iter().position(|other| *other == face).unwrap()];
                let normal = Vec2::new(touch.nx.0[0], touch.ny.0[0]);
                let k = (of(&state.bodies[Parameter::K1], i), of(&state.bodies[Parameter::K2], i));
                overlaps.push(((i, None, inverse(i)), normal, touch.shared.0[0], k));
            }
            overlaps.retain(|&(_, _, gap, _)| gap > 0.0);
            let exchange = |v: &mut [Vec2], i: u32, j: Option<u32>, impulse: Vec2| {
                v[i as usize] += impulse * inverse(i);
                if let Some(j) = j {
                    v[j as usize] -= impulse * inverse(j);
                }
            };
            let rub = |v: &mut [Vec2], o: &Overlap| {
                let ((i, j, both), normal, gap, (_, k2)) = *o;
                let tangent = Vec2::new(-normal.y, normal.x);
                let other = j.map_or(Vec2::zeros(), |j| v[j as usize]);
                let slip = (v[i as usize] - other).dot(&tangent);
                let share = 1.0 - math::exp(-k2 * gap * both * (0.5 * t));
                exchange(v, i, j, tangent * (-slip * share / both));
            };
            for overlap in &overlaps {
                rub(&mut v, overlap);
            }
            for &((i, j, _), normal, gap, (k1, _)) in &overlaps {
                exchange(&mut v, i, j, normal * (k1 * gap * t));
            }
            for overlap in overlaps.iter().rev() {
                rub(&mut v, overlap);
            }
            drift(&mut x, &v, if k + 1 < count { t } else { 0.5 * t });
        }
        let bodies = contacts.candidates[lane].pairs.iter().flat_map(|&(i, j)| [i, j]);
        let bodies = bodies.chain(contacts.candidates[lane].walls.iter().map(|&(i, _)| i));
        for i in bodies.filter(|&i| is_hot(i)).map(|i| i as usize) {
            many += usize::from(!moved[i].has(lane));
            moved[i] |= Mask::lane(lane);
            (state.motion.x[i].0[lane], state.motion.y[i].0[lane]) = (x[i].x, x[i].y);
            (state.motion.vx[i].0[lane], state.motion.vy[i].0[lane]) = (v[i].x, v[i].y);
        }
    }
    (many, cold)
}

#[test]
fn in_turns_and_eight_at_a_time_contact_has_the_bits_of_pair_after_pair() {
    let program = program();
    let mut numbers = Numbers(9);
    for _ in 0..10 {
        let start = state(&mut numbers);
        for level in [Level::baseline(), Level::new()] {
            let mut contacts = candidates(&program, &start);
            let (mut one, mut other) = (start.clone(), start.clone());
            // Twice, as in a step.
            for _ in 0..2 {
                let (mut moved, mut wanted) = (vec![Mask::NONE; PEOPLE], vec![Mask::NONE; PEOPLE]);
                let (many, cold) = plainly(&contacts, &program, &mut other, &mut wanted);
                assert!(many > 100 && cold > 0, "{many} {cold}");
                dispatch!(level, simd => contacts.advance(simd, &program.forces, &mut one, &mut moved, H));
                assert_eq!(moved, wanted);
                assert!(one == other, "another state");
            }
        }
    }
}
