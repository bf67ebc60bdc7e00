//! Routes: legs, pauses, advice and departures, with a mover that just walks as it is told.

use smc::base::decimal::Decimal;
use smc::base::geometry::{Polygon, Shape, Vec2};
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::math;
use smc::base::random::TrialKey;
use smc::base::tick::{Clock, Tick};
use smc::kernel::driver::steer;
use smc::kernel::start::load;
use smc::kernel::{Layout, Program, Scratch, State, refresh};
use smc::model::{
    Agent, AgentId, Body, Family, Goal, Kind, Law, Leg, Move, Moves, Parameter, Position, Region, RegionId,
    Route, Scenario, Scene, Start,
};
use std::sync::Arc;

const DT: f64 = 0.02;

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn agent(at: Vec2, velocity: Vec2, route: Route) -> Agent {
    let body = Body::new(Kind::Sfm, |parameter| {
        Law::Constant(match parameter {
            Parameter::Mass => 75.0,
            Parameter::Radius => 0.25,
            Parameter::Speed => 1.25,
            Parameter::Tau => 0.5,
            Parameter::A => 2000.0,
            Parameter::B => 0.08,
            Parameter::Lambda => 0.5,
            Parameter::K1 => 1.2e5,
            Parameter::K2 => 2.4e5,
            other => other.description().default.unwrap_or(0.0),
        })
    });
    Agent {
        name: "walker".into(),
        entity: 77,
        body: Arc::new(body),
        start: Start { position: Position::Point(at), velocity, ..Start::at_rest(Vec2::zeros()) },
        route,
        group: None,
        particle: None,
    }
}

fn region(id: u32) -> Leg {
    Leg::To(Goal::Region(RegionId(id)))
}

fn via(x: f64, y: f64) -> Leg {
    Leg::To(Goal::Point(p(x, y)))
}

fn legs(legs: Vec<Leg>) -> Route {
    Route::Legs { legs, then_leave: false }
}

fn scenario(agents: Vec<Agent>) -> Scenario {
    let named = |shape| Region::new("", shape);
    let triangle = Polygon::new(vec![p(10.0, 0.0), p(14.0, 0.0), p(12.0, 4.0)]);
    Scenario {
        title: String::new(),
        clock: Clock::Stepped(Decimal::parse("0.02").unwrap()),
        horizon: Tick(5000),
        scene: Scene {
            barriers: Vec::new(),
            regions: vec![
                named(Shape::rectangle(p(10.0, 0.0), p(12.0, 4.0))),
                named(Shape::Circle { centre: p(5.0, 5.0), radius: 1.0 }),
                named(Shape::Polygon(triangle)),
            ],
            ..Scene::default()
        },
        agents,
        groups: Vec::new(),
        moves: Vec::new(),
        processes: smc::model::Processes::default(),
        behaviours: smc::model::Behaviours::default(),
        sources: Vec::new(),
        doors: Vec::new(),
    }
}

fn program(agents: Vec<Agent>) -> Program {
    Program::new(Arc::new(scenario(agents)))
}

fn key(index: u64) -> TrialKey {
    TrialKey { seed: 1, index, branch: 0 }
}

fn begin(program: &Program, advice: Option<(usize, usize)>) -> State {
    let mut state = State::new(program.layout, program.scenario.agents.len());
    load(program, &mut state, 0, key(0), advice).unwrap();
    state
}

/// Everyone walks exactly as driven, one step.
fn walk(program: &Program, state: &mut State) {
    for block in 0..state.motion.x.len() {
        for lane in 0..LANES {
            let speed = state.driving.speed[block].0[lane];
            state.motion.x[block].0[lane] += DT * speed * state.driving.ex[block].0[lane];
            state.motion.y[block].0[lane] += DT * speed * state.driving.ey[block].0[lane];
        }
    }
    for lane in state.occupied.iter() {
        state.ticks[lane] += 1;
    }
    steer(&program.drive, state);
}

fn at(state: &State) -> Vec2 {
    p(state.motion.x[0].0[0], state.motion.y[0].0[0])
}

fn heading(state: &State) -> Vec2 {
    p(state.driving.ex[0].0[0], state.driving.ey[0].0[0])
}

fn drive(state: &State) -> f64 {
    state.driving.speed[0].0[0]
}

#[test]
fn the_goal_is_aimed_at_a_radius_inside_and_kept() {
    let program = program(vec![agent(p(0.0, 6.0), p(0.0, 0.0), legs(vec![region(0)]))]);
    let mut state = begin(&program, None);
    let wanted = (p(10.25, 3.75) - p(0.0, 6.0)).normalize();
    assert!((heading(&state) - wanted).norm() < 1e-12);
    assert_eq!(drive(&state), 1.25);
    let mut steps = 0;
    while drive(&state) > 0.0 && steps < 2000 {
        walk(&program, &mut state);
        steps += 1;
        assert!((heading(&state).norm() - 1.0).abs() < 1e-12);
    }
    let inside = at(&state);
    assert!(inside.x >= 10.0 && inside.x < 10.03 && inside.y <= 4.0, "{inside}");
    let last = heading(&state);
    walk(&program, &mut state);
    assert_eq!((drive(&state), heading(&state)), (0.0, last));
    // Pushed out, one walks back.
    state.motion.x[0].0[0] = 9.0;
    walk(&program, &mut state);
    assert_eq!(drive(&state), 1.25);
}

#[test]
fn waypoints_are_taken_in_order() {
    let route = legs(vec![via(4.0, 0.0), region(1), region(0)]);
    let program = program(vec![agent(p(0.0, 0.0), p(0.0, 0.0), route)]);
    let mut state = begin(&program, None);
    let (mut near_via, mut in_disc, mut arrived) = (None, None, None);
    for step in 0..1500 {
        walk(&program, &mut state);
        let x = at(&state);
        if (x - p(4.0, 0.0)).norm() <= 0.5 && near_via.is_none() {
            near_via = Some(step);
            // On to the disc at once, whose nearest point lies towards its centre.
            assert!((heading(&state) - (p(5.0, 5.0) - x).normalize()).norm() < 1e-12);
        }
        if (x - p(5.0, 5.0)).norm() <= 1.0 && in_disc.is_none() {
            in_disc = Some(step);
            assert!(heading(&state).x > 0.9);
        }
        if drive(&state) == 0.0 && arrived.is_none() {
            arrived = Some(step);
        }
    }
    assert!(near_via.unwrap() < in_disc.unwrap() && in_disc.unwrap() < arrived.unwrap());
}

#[test]
fn a_point_passed_by_within_two_metres_counts_and_farther_away_does_not() {
    for (offset, passed) in [(1.5, true), (-1.9, true), (2.1, false)] {
        let program = program(vec![agent(p(0.0, 0.0), p(0.0, 0.0), legs(vec![via(4.0, 0.0), region(0)]))]);
        let mut state = begin(&program, None);
        // Swept aside by others, beyond the line through the point.
        for x in [3.9, 4.1] {
            state.motion.x[0].0[0] = x;
            state.motion.y[0].0[0] = offset;
            steer(&program.drive, &mut state);
            let to_via = (p(4.0, 0.0) - at(&state)).normalize();
            let still = (heading(&state) - to_via).norm() < 1e-9;
            assert_eq!(still, x < 4.0 || !passed, "{x} {offset}");
        }
    }
}

#[test]
fn a_point_as_last_goal_is_not_passed_by() {
    let program = program(vec![agent(p(0.0, 0.0), p(0.0, 0.0), legs(vec![via(4.0, 0.0)]))]);
    let mut state = begin(&program, None);
    for (x, speed) in [(3.4, 1.25), (3.6, 0.0), (4.4, 0.0), (4.6, 1.25)] {
        state.motion.x[0].0[0] = x;
        steer(&program.drive, &mut state);
        assert_eq!(drive(&state), speed, "{x}");
    }
    assert_eq!(heading(&state).x, -1.0);
}

#[test]
fn a_polygon_is_entered_and_kept() {
    let program = program(vec![agent(p(2.0, 3.0), p(0.0, 0.0), legs(vec![region(2)]))]);
    let mut state = begin(&program, None);
    for _ in 0..1000 {
        walk(&program, &mut state);
    }
    let Shape::Polygon(triangle) = &program.scenario.scene.regions[2].shape else { unreachable!() };
    assert!(triangle.contains(at(&state)));
    assert_eq!(drive(&state), 0.0);
}

#[test]
fn a_pause_lasts_as_drawn() {
    let law = Law::Random { family: Family::Uniform { low: 1.0, high: 3.0 }, low: 1.0, high: 3.0 };
    let route = legs(vec![region(1), Leg::Wait(law.clone()), region(0)]);
    let program = program(vec![agent(p(2.0, 5.0), p(0.0, 0.0), route)]);
    let mut state = begin(&program, None);
    let mut standing = 0;
    for _ in 0..1000 {
        walk(&program, &mut state);
        if drive(&state) == 0.0 && at(&state).x < 9.0 {
            standing += 1;
        }
    }
    let stream = smc::base::random::Stream::of(key(0), 77, smc::base::random::Purpose::Pause);
    let wanted = (law.draw(stream.uniform(1)) / DT).ceil();
    assert_eq!(f64::from(standing), wanted);
    assert!(at(&state).x >= 10.0);
}

#[test]
fn only_who_leaves_is_gone() {
    let leaving = |then_leave| Route::Legs { legs: vec![region(0)], then_leave };
    let start = p(8.0, 2.0);
    let program = program(vec![
        agent(start, p(0.0, 0.0), leaving(true)),
        agent(start + p(0.0, 1.0), p(0.0, 0.0), leaving(false)),
    ]);
    let mut state = begin(&program, None);
    for _ in 0..200 {
        walk(&program, &mut state);
        let inside = state.motion.x[0].0[0] >= 10.0;
        assert_eq!(state.present[0].has(0), !inside);
    }
    assert_eq!((state.present[0], state.present[1]), (Mask::NONE, Mask::lane(0)));
}

#[test]
fn without_a_route_one_goes_on_and_who_stands_keeps_standing() {
    let mut walker = program(vec![agent(p(0.0, 0.0), p(0.6, 0.8), Route::Onward)]);
    let mut state = begin(&walker, None);
    for _ in 0..100 {
        walk(&walker, &mut state);
    }
    assert!((at(&state) - p(1.2, 1.6)).norm() < 1e-9);
    assert_eq!(state.bodies[Parameter::Speed][0].0[0], 1.0, "the recorded speed is the driving speed");
    walker = program(vec![agent(p(0.0, 0.0), p(0.0, 0.0), Route::Onward)]);
    let mut state = begin(&walker, None);
    walk(&walker, &mut state);
    assert_eq!((at(&state), drive(&state)), (p(0.0, 0.0), 0.0));
    // A route without legs is a place to stand.
    let stander = program(vec![agent(p(0.0, 0.0), p(1.0, 0.0), legs(vec![]))]);
    assert_eq!(drive(&begin(&stander, None)), 0.0);
}

fn with_moves(agent: Agent) -> Program {
    let mut scenario = scenario(vec![agent]);
    let other = Moves {
        agent: AgentId(0),
        others: Vec::new(),
        duration: Tick(5),
        options: vec![("stop".into(), Move::Stop)],
        routes: Vec::new(),
        paths: None,
    };
    let options = vec![("stop".into(), Move::Stop), ("left".into(), Move::Heading(0.5))];
    scenario.moves = vec![
        other,
        Moves {
            agent: AgentId(0),
            others: Vec::new(),
            duration: Tick(100),
            options,
            routes: Vec::new(),
            paths: None,
        },
    ];
    Program::new(Arc::new(scenario))
}

#[test]
fn advice_holds_for_its_time_and_then_the_route_goes_on() {
    let (sin, cos) = math::sin_cos(0.5);
    let walker = with_moves(agent(p(0.0, 2.0), p(0.0, 0.0), legs(vec![region(0)])));
    let mut state = begin(&walker, Some((1, 1)));
    for tick in 0..100 {
        assert_eq!(state.ticks[0], tick);
        assert!((heading(&state) - p(cos, sin)).norm() < 1e-12, "left of the way to the goal");
        assert_eq!(drive(&state), 1.25);
        walk(&walker, &mut state);
    }
    let back = (p(10.25, 3.2) - at(&state)).normalize();
    assert!((heading(&state) - back).norm() < 0.01 && drive(&state) == 1.25);

    let mut state = begin(&walker, Some((1, 0)));
    for _ in 0..100 {
        assert_eq!((drive(&state), heading(&state)), (0.0, p(1.0, 0.0)));
        walk(&walker, &mut state);
    }
    assert_eq!(drive(&state), 1.25);
}

#[test]
fn advice_turns_who_goes_on_and_moves_who_stands() {
    let (sin, cos) = math::sin_cos(0.5);
    let walker = with_moves(agent(p(0.0, 0.0), p(0.0, 0.8), Route::Onward));
    let mut state = begin(&walker, Some((1, 1)));
    assert!((heading(&state) - p(-sin, cos)).norm() < 1e-12);
    assert_eq!(drive(&state), 0.8);
    for _ in 0..100 {
        walk(&walker, &mut state);
    }
    assert_eq!((heading(&state), drive(&state)), (p(0.0, 1.0), 0.8));

    let stander = with_moves(agent(p(0.0, 0.0), p(0.0, 0.0), Route::Onward));
    let mut state = begin(&stander, Some((1, 1)));
    assert!((heading(&state) - p(cos, sin)).norm() < 1e-12);
    assert_eq!(drive(&state), 1.25, "the drawn speed");
    for _ in 0..100 {
        walk(&stander, &mut state);
    }
    assert_eq!(drive(&state), 0.0);
}

#[test]
fn waypoints_passed_under_advice_count() {
    let route = legs(vec![via(1.0, 0.0), region(0)]);
    let walker = with_moves(agent(p(0.0, 0.0), p(0.0, 0.0), route));
    let mut state = begin(&walker, Some((1, 1)));
    for _ in 0..100 {
        walk(&walker, &mut state);
    }
    // After 2 s it is 2.5 m away, past the point; the way on is to the region, not back.
    assert!(heading(&state).x > 0.9, "{}", heading(&state));
}

/// Agents of every kind of route; lane by lane the same as alone.
#[test]
fn lanes_do_not_see_one_another() {
    let law = Law::Random { family: Family::Uniform { low: 0.0, high: 1.0 }, low: 0.0, high: 1.0 };
    let agents = vec![
        agent(p(0.0, 0.0), p(1.0, 0.0), legs(vec![via(1.0, 0.2), region(1), region(0)])),
        agent(p(0.0, 2.0), p(1.0, 0.0), Route::Onward),
        agent(p(8.0, 2.0), p(0.0, 0.0), Route::Legs { legs: vec![region(0)], then_leave: true }),
        agent(p(3.0, 5.0), p(0.0, 0.0), legs(vec![region(1), Leg::Wait(law), region(2)])),
    ];
    let mut scenario = scenario(agents);
    let options = vec![("left".into(), Move::Heading(0.5))];
    scenario.moves = vec![Moves {
        agent: AgentId(0),
        others: Vec::new(),
        duration: Tick(30),
        options,
        routes: Vec::new(),
        paths: None,
    }];
    let program = Program::new(Arc::new(scenario));
    let mut together = State::new(program.layout, 4);
    // Lanes start at different times and with different advice.
    let advice = |index: u64| index.is_multiple_of(2).then_some((0, 0));
    let mut alone: Vec<State> = Vec::new();
    for step in 0..600u64 {
        if step.is_multiple_of(40) && alone.len() < LANES {
            let index = alone.len() as u64;
            let mut single = State::new(program.layout, 4);
            load(&program, &mut single, 2, key(index), advice(index)).unwrap();
            load(&program, &mut together, alone.len(), key(index), advice(index)).unwrap();
            alone.push(single);
        }
        walk(&program, &mut together);
        for (lane, single) in alone.iter_mut().enumerate() {
            walk(&program, single);
            for agent in 0..4 {
                let of = |s: &State, k: usize| {
                    let bits = |f: &[Lanes]| f[agent].0[k].to_bits();
                    let fields = [&s.motion.x, &s.motion.y, &s.driving.ex, &s.driving.ey, &s.driving.speed]
                        .map(|f| bits(f));
                    (fields, s.present[agent].has(k), s.route.way(agent, k))
                };
                assert_eq!(of(single, 2), of(&together, lane), "agent {agent} lane {lane} step {step}");
            }
        }
    }
}

/// A crowd in its own layout goes the same ways as one trial in a lane.
#[test]
fn both_layouts_steer_alike() {
    let agents: Vec<Agent> = (0..20)
        .map(|k| {
            let at = p(0.3 * f64::from(k), 6.0 - 0.2 * f64::from(k));
            let route = match k % 4 {
                0 => legs(vec![via(5.0, 1.0), region(0)]),
                1 => legs(vec![region(1), region(2)]),
                2 => Route::Legs { legs: vec![region(0)], then_leave: true },
                _ => Route::Onward,
            };
            agent(at, p(0.5, 0.1), route)
        })
        .collect();
    let program = program(agents);
    let mut crowd = program.clone();
    crowd.layout = Layout::Agents;
    let (mut a, mut b) = (begin(&program, None), begin(&crowd, None));
    for _ in 0..800 {
        walk(&program, &mut a);
        walk(&crowd, &mut b);
    }
    for agent in 0..20 {
        let slot = b.slot(agent, 0);
        for (f, g) in [
            (&a.motion.x, &b.motion.x),
            (&a.motion.y, &b.motion.y),
            (&a.driving.ex, &b.driving.ex),
            (&a.driving.ey, &b.driving.ey),
            (&a.driving.speed, &b.driving.speed),
        ] {
            assert_eq!(f[agent].0[0].to_bits(), g[slot.block].0[slot.lane].to_bits());
        }
        assert_eq!(a.present[agent].has(0), b.present[slot.block].has(slot.lane));
    }
}

/// The way from a point to where a body of 0.25 m aims: the rectangle, the disc, the triangle, and a point.
fn aim(goal: usize, at: Vec2) -> Vec2 {
    match goal {
        0 => p(at.x.clamp(10.25, 11.75), at.y.clamp(0.25, 3.75)) - at,
        1 => p(5.0, 5.0) - at,
        2 => p(10.0, 0.0) - at,
        _ => p(4.0, 1.0) - at,
    }
}

/// Place after 1.6 s by the method of Runge and Kutta with steps of a tenth of a millisecond.
fn by_runge_kutta(goal: usize, start: Vec2, velocity: Vec2) -> Vec2 {
    let (h, steps) = (1e-4, 16_000);
    let slope = |x: Vec2, v: Vec2| (v, (aim(goal, x).normalize() * 1.25 - v) / 0.5);
    let (mut x, mut v) = (start, velocity);
    for _ in 0..steps {
        let a = slope(x, v);
        let b = slope(x + a.0 * (0.5 * h), v + a.1 * (0.5 * h));
        let c = slope(x + b.0 * (0.5 * h), v + b.1 * (0.5 * h));
        let d = slope(x + c.0 * h, v + c.1 * h);
        x += (a.0 + b.0 * 2.0 + c.0 * 2.0 + d.0) * (h / 6.0);
        v += (a.1 + b.1 * 2.0 + c.1 * 2.0 + d.1) * (h / 6.0);
    }
    x
}

#[test]
fn a_walk_whose_direction_turns_is_of_second_order_in_the_step() {
    let starts = [
        (legs(vec![region(0)]), p(8.0, 6.0), p(1.0, 1.5)),
        (legs(vec![region(1)]), p(2.0, 4.0), p(0.0, 1.5)),
        (legs(vec![region(2)]), p(7.5, -1.5), p(1.5, -0.5)),
        (legs(vec![via(4.0, 1.0)]), p(2.0, 0.0), p(0.0, 1.8)),
    ];
    for (goal, (route, start, velocity)) in starts.into_iter().enumerate() {
        let wanted = by_runge_kutta(goal, start, velocity);
        for layout in [Layout::Trials, Layout::Agents] {
            let error = |step: &str, steps: u32| {
                let scene = scenario(vec![agent(start, velocity, route.clone())]);
                let scene = Scenario { clock: Clock::Stepped(Decimal::parse(step).unwrap()), ..scene };
                let program = Program { layout, ..Program::new(Arc::new(scene)) };
                let (mut state, mut scratch) = (State::new(layout, 1), Scratch::default());
                load(&program, &mut state, 0, key(0), None).unwrap();
                refresh(&program, &mut state, &mut scratch, Mask::lane(0));
                for _ in 0..steps {
                    smc::kernel::step(&program, &mut state, &mut scratch);
                }
                (at(&state) - wanted).norm()
            };
            let errors = [error("0.04", 40), error("0.02", 80), error("0.01", 160)];
            assert!(errors[1] < 5e-4, "goal {goal}, {layout:?}: {errors:?}");
            for pair in errors.windows(2) {
                assert!((3.5..4.5).contains(&(pair[0] / pair[1])), "goal {goal}, {layout:?}: {errors:?}");
            }
        }
    }
}
