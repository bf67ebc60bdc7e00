//! Compiled expressions against a plain evaluator that walks the tree, lane by lane: the same bits.

mod cases;
mod crowd;
mod margins;
mod plain;

use cases::{Hidden, measure, number, state, truth};
use plain::Plain;
use proptest::prelude::*;
use smc::base::decimal::Decimal;
use smc::base::geometry::{Polygon, Segment, Shape, Vec2};
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::tick::{Clock, Tick};
use smc::kernel::{Code, Layout, Program, Readings, State};
use smc::model::{
    Agent, AgentId, Arithmetic, Barrier, Body, Bool, Comparison, Field, Fold, Kind, Law, Num, Obstacle,
    Parameter, Position, Region, Route, Scenario, Scene, Set, Start, Who,
};
use std::sync::Arc;

const AGENTS: usize = 10;

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn scene() -> Scene {
    let mut ring = Polygon::rectangle(p(2.0, 1.0), p(5.0, 4.0));
    ring.holes.push(Polygon::new(vec![p(3.0, 2.0), p(4.0, 2.0), p(3.5, 3.0)]).outline);
    let region = |shape| Region::new("", shape);
    let barrier = |obstacle| Barrier { name: String::new(), obstacle };
    Scene {
        regions: vec![
            region(Shape::rectangle(p(1.0, 0.5), p(4.0, 3.0))),
            region(Shape::Circle { centre: p(3.0, 3.0), radius: 1.5 }),
            region(Shape::Polygon(ring.clone())),
        ],
        barriers: vec![
            barrier(Obstacle::Wall(vec![
                Segment::new(p(0.0, 0.0), p(6.0, 0.0)),
                Segment::new(p(6.0, 0.0), p(6.0, 5.0)),
                Segment::new(p(1.0, 1.0), p(1.0, 1.0)),
            ])),
            barrier(Obstacle::Solid(Shape::Circle { centre: p(2.0, 4.0), radius: 0.5 })),
            barrier(Obstacle::Solid(Shape::Polygon(ring))),
            barrier(Obstacle::Solid(Shape::rectangle(p(0.0, 2.0), p(1.0, 3.0)))),
        ],
        ..Scene::default()
    }
}

fn scenario(agents: usize, scene: Scene) -> Arc<Scenario> {
    let body = Arc::new(Body::new(Kind::Sfm, |_| Law::Constant(1.0)));
    let agent = |k: usize| Agent {
        name: format!("a{k}"),
        entity: k as u32,
        body: Arc::clone(&body),
        start: Start {
            position: Position::Point(p(0.0, 0.0)),
            velocity: p(0.0, 0.0),
            ..Start::at_rest(Vec2::zeros())
        },
        route: Route::Onward,
        group: None,
        particle: None,
    };
    Arc::new(Scenario {
        title: String::new(),
        clock: Clock::Stepped(Decimal::parse("0.02").unwrap()),
        horizon: Tick(1000),
        scene,
        agents: (0..agents).map(agent).collect(),
        groups: Vec::new(),
        moves: Vec::new(),
        processes: smc::model::Processes::default(),
        behaviours: smc::model::Behaviours::default(),
        sources: Vec::new(),
        doors: Vec::new(),
    })
}

fn same(a: f64, b: f64) -> bool {
    // The bits of a NaN mean nothing; everything else must agree to the last, signs of zero apart
    // where `min` and `max` meet both zeros.
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (a == 0.0 && b == 0.0)
}

fn check(
    layout: Layout,
    Hidden(state): &Hidden,
    atoms: &[Bool],
    signals: &[Num],
) -> Result<(), TestCaseError> {
    let scenario = scenario(AGENTS, scene());
    let mut program = Program::new(Arc::clone(&scenario));
    program.layout = layout;
    let code = Code::compile(&scenario, atoms, signals);
    let (mut readings, mut baseline) = (Readings::default(), Readings::default());
    code.run(&program, state, &mut readings);
    code.clone().at_baseline().run(&program, state, &mut baseline);
    for trial in state.occupied.iter() {
        let mut plain = Plain { scene: &scenario.scene, state, trial, running: Vec::new() };
        let mut open = false;
        for (k, atom) in atoms.iter().enumerate() {
            match plain.truth(atom) {
                Some(bit) => {
                    prop_assert_eq!(readings.atoms[k].has(trial), bit.0, "atom {} lane {}", k, trial);
                    prop_assert_eq!(baseline.atoms[k].has(trial), bit.0);
                }
                None => open = true,
            }
        }
        for (k, signal) in signals.iter().enumerate() {
            match plain.number(signal) {
                Some(value) => {
                    let (fast, slow) = (readings.signals[k].0[trial], baseline.signals[k].0[trial]);
                    prop_assert!(same(value, fast), "signal {} lane {}: {} {}", k, trial, value, fast);
                    prop_assert!(same(value, slow));
                }
                None => open = true,
            }
        }
        prop_assert_eq!(readings.unresolved.has(trial), open, "lane {}", trial);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn eight_trials_agree_with_the_tree(
        state in state(Layout::Trials),
        atoms in proptest::collection::vec(truth(0, 3), 1..3),
        signals in proptest::collection::vec(number(0, 3), 0..3),
    ) {
        check(Layout::Trials, &state, &atoms, &signals)?;
    }

    #[test]
    fn one_trial_agrees_with_the_tree(
        state in state(Layout::Agents),
        atoms in proptest::collection::vec(truth(0, 3), 1..3),
        signals in proptest::collection::vec(number(0, 3), 0..3),
    ) {
        check(Layout::Agents, &state, &atoms, &signals)?;
    }
}

/// A bound within an ulp of the gap must be decided as the subtraction decides it.
#[test]
fn bounds_at_the_last_bit_are_decided_exactly() {
    let mut state = State::new(Layout::Trials, AGENTS);
    state.occupied = Mask::ALL;
    state.present.fill(Mask::ALL);
    for agent in 0..AGENTS {
        for lane in 0..LANES {
            state.motion.x[agent].0[lane] = agent as f64 * 1.37 + lane as f64 * 0.011;
            state.motion.y[agent].0[lane] = 0.31 * (agent * lane) as f64;
            state.bodies[Parameter::Radius][agent].0[lane] = 0.2 + 0.013 * lane as f64;
        }
    }
    let user = Who::Agent(AgentId(0));
    let everybody = Set { members: (0..AGENTS as u32).map(AgentId).collect(), except: Some(user) };
    for kind in 0..3 {
        let least = Num::Fold(Fold::Min, everybody.clone(), Box::new(measure(user, Who::Running(0), kind)));
        let scenario = scenario(AGENTS, scene());
        let program = Program::new(Arc::clone(&scenario));
        let mut readings = Readings::default();
        Code::compile(&scenario, &[], &[least]).run(&program, &state, &mut readings);
        let value = readings.signals[0].0[3];
        for bound in [value.next_down(), value, value.next_up()] {
            let atoms: Vec<Bool> = [Comparison::Greater, Comparison::AtLeast]
                .into_iter()
                .map(|c| {
                    let (a, b) = (measure(user, Who::Running(0), kind), Num::Constant(bound));
                    Bool::Forall(everybody.clone(), Box::new(Bool::Compare(c, Box::new(a), Box::new(b))))
                })
                .collect();
            Code::compile(&scenario, &atoms, &[]).run(&program, &state, &mut readings);
            assert_eq!(readings.atoms[0].has(3), value > bound);
            assert_eq!(readings.atoms[1].has(3), value >= bound);
        }
    }
}

#[test]
fn a_sum_of_ten_thousand_terms_compiles() {
    let scenario = scenario(1, Scene::default());
    let sum = (0..10_000).fold(Num::Time, |sum, _| {
        Num::Combine(Arithmetic::Add, Box::new(sum), Box::new(Num::Of(Field::Mass, Who::Agent(AgentId(0)))))
    });
    let mut state = State::new(Layout::Trials, 1);
    state.occupied = Mask::ALL;
    let mut readings = Readings::default();
    Code::compile(&scenario, &[], &[sum]).run(&Program::new(Arc::clone(&scenario)), &state, &mut readings);
    assert_eq!(readings.signals[0], Lanes::splat(10_000.0));
}
