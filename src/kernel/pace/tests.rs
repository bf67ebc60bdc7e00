//! The bounds against what expressions are worth, and against laws with known quantiles.

use super::*;
use crate::base::decimal::Decimal;
use crate::base::geometry::Vec2;
use crate::base::tick::{Clock, Tick};
use crate::model::{
    Agent, AgentId, Attached, BehaviourId, Behaviours, Bool, Family, Kind, Leg, Mode, Particle, Processes,
    Scene, Start, Variable,
};
use proptest::prelude::*;

const LOWS: [i64; 3] = [-3, 0, 2];
const HIGHS: [i64; 3] = [4, 1, 9];

/// A scenario of one person with this speed and noise, three whole variables, and what a behaviour changes.
fn scenario(speed: Law, noise: Law, changes: Vec<(Parameter, Amount)>) -> Scenario {
    let mut body = Body::new(Kind::Sfm, |_| Law::Constant(0.0));
    (body[Parameter::Speed], body[Parameter::Noise]) = (speed, noise);
    let agent = Agent {
        name: "me".to_owned(),
        entity: 1,
        body: Arc::new(body),
        start: Start { velocity: Vec2::new(0.3, 0.4), ..Start::at_rest(Vec2::zeros()) },
        route: Route::Legs { legs: vec![Leg::Wait(Law::Constant(1.0))], then_leave: false },
        group: None,
        particle: None,
    };
    let conduct = Conduct { states: vec![Mode { changes, ..Mode::default() }], ..Conduct::default() };
    let attached = Attached {
        agent: AgentId(0),
        behaviour: BehaviourId(0),
        entity: 2,
        later: 3,
        conduct: Arc::new(conduct),
        guards: Vec::new(),
    };
    let variables = LOWS.iter().zip(HIGHS).map(|(&low, high)| Variable {
        name: String::new(),
        domain: Domain::Whole { low, high },
        initial: low as f64,
    });
    Scenario {
        title: String::new(),
        clock: Clock::Stepped(Decimal::parse("0.01").unwrap()),
        horizon: Tick(10),
        scene: Scene::default(),
        agents: vec![agent],
        groups: Vec::new(),
        moves: Vec::new(),
        processes: Processes { variables: variables.collect(), ..Processes::default() },
        behaviours: Behaviours { declared: Vec::new(), attached: vec![attached] },
        sources: Vec::new(),
        doors: Vec::new(),
    }
}

fn normal(mean: f64, sd: f64) -> Law {
    Law::Random { family: Family::Normal { mean, sd }, low: 0.0, high: f64::INFINITY }
}

fn numbers() -> impl Strategy<Value = Num> {
    let leaf = prop_oneof![
        (-4..5i32).prop_map(|value| Num::Constant(f64::from(value) / 2.0)),
        (0..3u32).prop_map(|id| Num::Variable(VariableId(id))),
    ];
    leaf.prop_recursive(5, 40, 2, |part| {
        let function = prop_oneof![
            Just(Function::Negate),
            Just(Function::Abs),
            Just(Function::Sqrt),
            Just(Function::Exp),
            Just(Function::Sin),
            Just(Function::Cos),
            Just(Function::Floor),
            Just(Function::Ceil),
            Just(Function::Round),
            Just(Function::ServiceLevel),
        ];
        let operation = prop_oneof![
            Just(Arithmetic::Add),
            Just(Arithmetic::Subtract),
            Just(Arithmetic::Multiply),
            Just(Arithmetic::Divide),
            Just(Arithmetic::Min),
            Just(Arithmetic::Max),
            Just(Arithmetic::Modulo),
            Just(Arithmetic::Power),
        ];
        prop_oneof![
            (function, part.clone()).prop_map(|(f, a)| Num::Apply(f, Box::new(a))),
            (operation, part.clone(), part).prop_map(|(op, a, b)| Num::Combine(op, Box::new(a), Box::new(b))),
        ]
    })
}

proptest! {
    #[test]
    fn what_a_number_is_worth_lies_in_its_range(
        number in numbers(),
        at in [-3..=4i64, 0..=1i64, 2..=9i64],
    ) {
        let scenario = scenario(Law::Constant(1.0), Law::Constant(0.0), Vec::new());
        let (low, high) = Pace::of(&scenario).range(&number);
        let value = number.evaluate(&at.map(|value| value as f64)).unwrap();
        // Bounds are computed in another order: by the last digits they may differ.
        let slack = 1e-9 * value.abs().max(1.0);
        prop_assert!(!(value < low - slack || value > high + slack), "{value} outside {low} .. {high}");
    }
}

#[test]
fn ranges_of_sums_and_products_are_tight() {
    let scenario = scenario(Law::Constant(1.0), Law::Constant(0.0), Vec::new());
    let pace = Pace::of(&scenario);
    let variable = |id| Box::new(Num::Variable(VariableId(id)));
    let joined = |operation| pace.range(&Num::Combine(operation, variable(0), variable(2)));
    assert_eq!(joined(Arithmetic::Add), (-1.0, 13.0));
    assert_eq!(joined(Arithmetic::Subtract), (-12.0, 2.0));
    assert_eq!(joined(Arithmetic::Multiply), (-27.0, 36.0));
    assert_eq!(joined(Arithmetic::Divide), (-1.5, 2.0));
    let by_zero = Num::Combine(Arithmetic::Divide, variable(2), variable(0));
    assert_eq!(pace.range(&by_zero), ANYTHING);
}

#[test]
fn the_fastest_is_who_walks_fastest_with_the_largest_noise() {
    let close = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-6, "{found} is not {wanted}");
    close(fastest(&scenario(Law::Constant(1.2), Law::Constant(0.1), Vec::new())), 1.2 + 0.6);
    // Whoever starts faster than anybody walks.
    close(fastest(&scenario(Law::Constant(0.1), Law::Constant(0.0), Vec::new())), 0.5);
    // 1 - 1e-9 is 5.997807 deviations (mpmath); the cut at 0 lies five below the mean.
    let drawn = fastest(&scenario(normal(1.25, 0.25), Law::Constant(0.0), Vec::new()));
    close(drawn, 1.25 + 0.25 * 5.997_807);
}

#[test]
fn what_behaviours_set_counts() {
    let fast = |changes| fastest(&scenario(Law::Constant(1.0), Law::Constant(0.1), changes));
    let variable = Num::Variable(VariableId(1));
    let computed = |num| Amount::Computed(num);
    assert_eq!(fast(vec![(Parameter::Tau, computed(Num::Constant(9.0)))]), 1.0 + 0.6);
    assert_eq!(fast(vec![(Parameter::Speed, computed(Num::Constant(2.0)))]), 2.0 + 0.6);
    assert_eq!(fast(vec![(Parameter::Noise, Amount::Drawn(Law::Constant(0.5)))]), 1.0 + 3.0);
    assert_eq!(fast(vec![(Parameter::Noise, computed(variable))]), 1.0 + 6.0);
    // Nobody knows how much; beyond the top speed a trial ends.
    assert_eq!(fast(vec![(Parameter::Speed, computed(Num::Time))]), TOP_SPEED);
}

#[test]
fn parameters_are_what_is_drawn_not_what_is_declared() {
    let own = |parameter: Parameter| {
        let at = Parameter::ALL.iter().position(|one| *one == parameter).unwrap();
        Num::Variable(VariableId((LOWS.len() + at) as u32))
    };
    let twice = |parameter| {
        let number =
            Num::Combine(Arithmetic::Multiply, Box::new(Num::Constant(2.0)), Box::new(own(parameter)));
        vec![(Parameter::Speed, Amount::Computed(number))]
    };
    // Who goes on as recorded, here at 0.5 m/s, has that as own speed.
    let mut recorded = scenario(Law::Constant(0.1), Law::Constant(0.0), twice(Parameter::Speed));
    assert_eq!(fastest(&recorded), 0.5);
    recorded.agents[0].route = Route::Onward;
    assert_eq!(fastest(&recorded), 1.0);
    // Sixteen as one body have four times the relaxation time.
    let mut group = scenario(Law::Constant(0.1), Law::Constant(0.0), twice(Parameter::Tau));
    Arc::make_mut(&mut group.agents[0].body)[Parameter::Tau] = Law::Constant(0.5);
    assert_eq!(fastest(&group), 1.0);
    group.agents[0].particle = Some(Particle {
        persons: 16,
        repulsion: 1.0,
        friction: 0.0,
        radius_factor: 4.0,
        spread: 0.0,
        room: f64::INFINITY,
        tau_factor: 4.0,
    });
    assert_eq!(fastest(&group), 4.0);
}

#[test]
fn choices_in_choices_are_looked_at_once() {
    let nested = (0..60).fold(Num::Constant(0.0), |rest, k| {
        let value = Num::Constant(f64::from(k) / 10.0);
        Num::If(Box::new(Bool::Constant(true)), Box::new(value), Box::new(rest))
    });
    let changes = vec![(Parameter::Speed, Amount::Computed(nested))];
    assert_eq!(fastest(&scenario(Law::Constant(1.0), Law::Constant(0.0), changes)), 5.9);
}
