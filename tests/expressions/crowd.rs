//! Large crowds, whose clearances and contacts look only at who is near: the same bits as a look at all.

use super::plain::Plain;
use super::{p, scenario};
use proptest::prelude::*;
use smc::base::geometry::Segment;
use smc::base::lanes::{LANES, Mask};
use smc::kernel::{Code, Layout, Program, Readings, Scratch, State, dynamics};
use smc::model::{
    AgentId, Arithmetic, Barrier, Bool, Comparison, Field, Fold, Num, Obstacle, Parameter, Place, Scene,
    Separation, Set, Who,
};
use std::sync::Arc;

/// A number from 0 to 1 that looks drawn.
fn drawn(seed: u64, k: usize, what: u64) -> f64 {
    let mut bits = (seed << 32) ^ (k as u64 * 8 + what);
    for _ in 0..3 {
        bits = (bits ^ (bits >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    (bits >> 40) as f64 / f64::from(1 << 24)
}

/// How a crowd stands.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// Anywhere on a field so wide.
    Even(f64),
    /// On the points of a lattice, where bodies touch to the last bit.
    Lattice(f64),
    /// Most of them near each other, the others very far away.
    Clusters,
    /// In a row.
    Row,
    /// In one place.
    Heap,
}

/// Which bodies there are.
#[derive(Clone, Copy, Debug)]
enum Bodies {
    Equal,
    Drawn,
    /// Small ones, and some particles that are as wide as a room.
    Two,
}

fn place(shape: Shape, seed: u64, k: usize, step: usize) -> (f64, f64) {
    let (u, v) = (drawn(seed, k, 0), drawn(seed, k, 1));
    let (x, y) = match shape {
        Shape::Even(wide) => (wide * u, wide * v),
        Shape::Lattice(apart) => (apart * (k % 17) as f64, apart * (k / 17) as f64),
        Shape::Clusters if k.is_multiple_of(50) => (1e5 * (u - 0.5), 1e6 * (v - 0.5)),
        Shape::Clusters if k.is_multiple_of(3) => (300.0 + 4.0 * u, -80.0 + 9.0 * v),
        Shape::Clusters => (10.0 * u, 10.0 * v),
        Shape::Row => (0.4 * k as f64, 2.5),
        Shape::Heap => (1.5, -2.5),
    };
    // Everybody goes on, all of them some way together, now and then somebody far in some crowds.
    let jumps = seed.is_multiple_of(2) && drawn(seed, k, 2 + step as u64) > 0.98;
    let (far, together) = (if jumps { 40.0 } else { 0.15 }, 0.37 * step as f64);
    (x + together + step as f64 * far * (u - 0.5), y + step as f64 * far * (v - 0.5))
}

fn state(agents: usize, shape: Shape, bodies: Bodies, (seed, step): (u64, usize), odd: usize) -> State {
    let mut state = State::new(Layout::Agents, agents);
    state.occupied = Mask(1);
    for k in 0..agents {
        let (block, lane) = (k / LANES, k % LANES);
        let (x, y) = place(shape, seed, k, step);
        state.motion.x[block].0[lane] = x;
        state.motion.y[block].0[lane] = y;
        for parameter in [Parameter::Mass, Parameter::Tau, Parameter::A, Parameter::B, Parameter::B2] {
            state.bodies[parameter][block].0[lane] = 1.0;
        }
        state.bodies[Parameter::Radius][block].0[lane] = match bodies {
            Bodies::Equal => 0.25,
            Bodies::Drawn => 0.2 + 0.1 * drawn(seed, k, 6),
            Bodies::Two if k.is_multiple_of(67) => 3.0,
            Bodies::Two => 0.2,
        };
        if drawn(seed, k, 7) < 0.9 {
            state.present[block] |= Mask::lane(lane);
        }
    }
    // Not everybody's numbers are numbers.
    let k = (seed as usize * 31 + step) % agents;
    let (block, lane) = (k / LANES, k % LANES);
    match odd {
        1 => state.motion.x[block].0[lane] = f64::NAN,
        2 => state.motion.y[block].0[lane] = f64::INFINITY,
        3 => state.bodies[Parameter::Radius][block].0[lane] = f64::NAN,
        4 => state.motion.x[block].0[lane] = -1e200,
        5 => state.present.fill(Mask::NONE),
        6 => {
            state.present.fill(Mask::NONE);
            state.present[block] = Mask::lane(lane);
        }
        _ => {}
    }
    state
}

fn walls() -> Scene {
    let wall = |a, b| Barrier { name: String::new(), obstacle: Obstacle::Wall(vec![Segment::new(a, b)]) };
    Scene {
        barriers: vec![wall(p(-1.0, -1.0), p(25.0, -1.0)), wall(p(3.0, 2.0), p(3.0, 9.0))],
        regions: Vec::new(),
        ..Scene::default()
    }
}

/// Questions to everybody of a crowd, or to most, and questions to some.
fn questions(agents: usize) -> (Vec<Bool>, Vec<Num>) {
    let everybody: Arc<[AgentId]> = (0..agents as u32).map(AgentId).collect();
    let all = |except| Set { members: Arc::clone(&everybody), except };
    let some = Set { members: everybody.iter().copied().step_by(3).collect(), except: None };
    let (me, you) = (Who::Running(0), Who::Running(1));
    let distance = || Num::Distance(Place::Agent(me), Place::Agent(you));
    let less =
        |a, who| Num::Combine(Arithmetic::Subtract, Box::new(a), Box::new(Num::Of(Field::Radius, who)));
    let (fixed_first, running_first) = (less(less(distance(), me), you), less(less(distance(), you), me));
    let far = |comparison, measure: &Num, bound| {
        let body = Bool::Compare(comparison, Box::new(measure.clone()), Box::new(Num::Constant(bound)));
        Bool::Forall(all(Some(me)), Box::new(body))
    };
    let near = |set: Set, measure: Num| {
        let least = Num::Fold(Fold::Min, set, Box::new(measure));
        Num::Fold(Fold::Sum, all(None), Box::new(least))
    };
    let clearances =
        |fold| Num::Fold(fold, all(None), Box::new(Num::Of(Field::Separation(Separation::Clearance), me)));
    let alone = |k: usize| Who::Agent(AgentId((k % agents) as u32));
    let mut atoms = vec![
        Bool::Exists(all(None), Box::new(Bool::Contact(me))),
        Bool::Forall(all(Some(alone(5))), Box::new(Bool::Contact(me))),
        Bool::Exists(all(None), Box::new(far(Comparison::Greater, &fixed_first, 0.1))),
        Bool::Exists(all(None), Box::new(far(Comparison::AtLeast, &running_first, 2.0))),
        Bool::Forall(all(None), Box::new(far(Comparison::Greater, &distance(), 0.3))),
        Bool::Forall(all(None), Box::new(far(Comparison::Greater, &distance(), -1.0))),
    ];
    // Of clearances that are only compared with a number, in some way or other, no more need be known.
    let clear = |comparison, bound| {
        Bool::Compare(
            comparison,
            Box::new(Num::Of(Field::Separation(Separation::Clearance), me)),
            Box::new(Num::Constant(bound)),
        )
    };
    let fast = Bool::Compare(
        Comparison::Less,
        Box::new(Num::Constant(0.3)),
        Box::new(Num::Coordinate(smc::model::Axis::X, Place::Agent(me))),
    );
    let turned_round = Bool::Compare(
        Comparison::AtMost,
        Box::new(Num::Constant(0.4)),
        Box::new(Num::Of(Field::Separation(Separation::Clearance), me)),
    );
    atoms.extend([
        Bool::Exists(all(None), Box::new(clear(Comparison::Less, 0.3))),
        Bool::Forall(some.clone(), Box::new(clear(Comparison::AtLeast, 0.05))),
        Bool::Exists(all(None), Box::new(clear(Comparison::Greater, 2.5))),
        Bool::Exists(all(None), Box::new(clear(Comparison::Less, f64::INFINITY))),
        Bool::Forall(all(None), Box::new(Bool::Or(vec![Bool::Not(Box::new(turned_round)), fast]))),
        Bool::Exists(
            all(None),
            Box::new(Bool::And(vec![clear(Comparison::Greater, 0.1), clear(Comparison::Less, 0.6)])),
        ),
    ]);
    let nearest = || Num::Fold(Fold::Min, all(Some(me)), Box::new(fixed_first.clone()));
    let sign = Num::Combine(Arithmetic::Multiply, Box::new(Num::Constant(-1.0)), Box::new(nearest()));
    let turned = Num::Combine(Arithmetic::Min, Box::new(nearest()), Box::new(sign));
    let mut signals = vec![
        clearances(Fold::Min),
        clearances(Fold::Max),
        clearances(Fold::Sum),
        Num::Count(all(None), Box::new(Bool::Contact(me))),
        Num::Count(all(None), Box::new(far(Comparison::AtLeast, &distance(), 0.75))),
        Num::Count(all(None), Box::new(clear(Comparison::Less, 0.2))),
        Num::Count(all(None), Box::new(clear(Comparison::Equal, 0.0))),
        Num::Count(some.clone(), Box::new(far(Comparison::Greater, &fixed_first, 7.0))),
        near(some.clone(), distance()),
        near(all(Some(me)), distance()),
        near(all(Some(me)), running_first.clone()),
        Num::Fold(Fold::Min, some.clone(), Box::new(Num::Of(Field::Separation(Separation::Clearance), me))),
        Num::Fold(
            Fold::Min,
            all(Some(alone(7))),
            Box::new(Num::Of(Field::Separation(Separation::Clearance), me)),
        ),
        Num::Fold(Fold::Min, all(None), Box::new(nearest())),
        Num::Fold(Fold::Min, all(None), Box::new(Num::Fold(Fold::Min, some, Box::new(running_first)))),
        Num::Fold(Fold::Min, all(None), Box::new(turned)),
    ];
    for k in [0, 50, 67, agents - 1] {
        atoms.push(Bool::Contact(alone(k)));
        signals.push(Num::Of(Field::Separation(Separation::Clearance), alone(k)));
    }
    (atoms, signals)
}

/// Some states one after the other, by the same registers.
fn check(
    agents: usize,
    shape: Shape,
    bodies: Bodies,
    scene: Scene,
    seed: u64,
    odd: usize,
) -> Result<(), TestCaseError> {
    let scenario = scenario(agents, scene);
    let mut program = Program::new(Arc::clone(&scenario));
    program.layout = Layout::Agents;
    let (atoms, signals) = questions(agents);
    // Some questions are answered by what others ask, too, and only so many are kept: each is asked alone as well. And each
    // with the pairs that the forces find.
    let mut codes = vec![(Code::compile(&scenario, &atoms, &signals), atoms.as_slice(), signals.as_slice())];
    for k in 0..atoms.len() {
        codes.push((Code::compile(&scenario, &atoms[k..=k], &[]), &atoms[k..=k], &[]));
    }
    for k in 0..signals.len() {
        codes.push((Code::compile(&scenario, &[], &signals[k..=k]), &[], &signals[k..=k]));
    }
    let mut readings: Vec<[Readings; 2]> = codes.iter().map(|_| Default::default()).collect();
    let mut scratch = Scratch::default();
    for step in 0..6 {
        let mut state = state(agents, shape, bodies, (seed, step), if step == 3 { odd } else { 0 });
        dynamics::refresh(&program, &mut state, &mut scratch, Mask::lane(0));
        let close = scratch.close(&state);
        prop_assert!(close.is_some() || (step == 3 && odd > 0));
        let mut plain = Plain { scene: &scenario.scene, state: &state, trial: 0, running: Vec::new() };
        let truths: Vec<_> = atoms.iter().map(|atom| plain.truth(atom).map(|bit| bit.0)).collect();
        let numbers: Vec<_> = signals.iter().map(|signal| plain.number(signal).unwrap()).collect();
        for ((code, own_atoms, own_signals), readings) in codes.iter().zip(&mut readings) {
            for (close, readings) in [None, close].into_iter().zip(readings) {
                code.run_close(&program, &state, close, readings);
                let first = |one: &Bool| atoms.iter().position(|atom| std::ptr::eq(atom, one)).unwrap();
                for (k, atom) in own_atoms.iter().enumerate() {
                    let (at, found) = (first(atom), readings.atoms[k]);
                    prop_assert_eq!(Some(found.has(0)), truths[at], "atom {} step {}", at, step);
                    prop_assert_eq!(Some(found.has(7)), truths[at], "atom {} step {}", at, step);
                }
                for (k, signal) in own_signals.iter().enumerate() {
                    let at = signals.iter().position(|one| std::ptr::eq(one, signal)).unwrap();
                    let (wanted, found) = (numbers[at], readings.signals[k].0[0]);
                    let same = wanted.to_bits() == found.to_bits() || (wanted.is_nan() && found.is_nan());
                    prop_assert!(same, "signal {} step {}: {} {}", at, step, wanted, found);
                }
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_crowd_sorted_by_squares_has_the_bits_of_a_look_at_all(
        agents in 30..300usize,
        shape in prop::sample::select(vec![
            Shape::Even(8.0),
            Shape::Even(25.0),
            Shape::Even(3_000.0),
            Shape::Lattice(0.5),
            Shape::Lattice(0.4),
            Shape::Clusters,
            Shape::Row,
            Shape::Heap,
        ]),
        bodies in prop::sample::select(vec![Bodies::Equal, Bodies::Drawn, Bodies::Two]),
        with_walls in any::<bool>(),
        seed in 0..1_000_000u64,
        odd in 0..14usize,
    ) {
        check(agents, shape, bodies, if with_walls { walls() } else { Scene::default() }, seed, odd)?;
    }
}
