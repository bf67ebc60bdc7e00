//! The beginning of trials: draws that nobody else disturbs, places without overlaps, lanes apart.

use smc::base::decimal::Decimal;
use smc::base::geometry::{Polygon, Segment, Shape, Vec2};
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::random::{Purpose, Stream, TrialKey, name_hash};
use smc::base::tick::{Clock, Tick};
use smc::kernel::start::{Fault, Overlapped, check_area, load};
use smc::kernel::{Layout, Program, State};
use smc::model::{
    Agent, AgentId, Barrier, BarrierId, Body, Family, Goal, Kind, Law, Leg, Move, Moves, Obstacle, Parameter,
    Particle, Position, Region, RegionId, Route, Scenario, Scene, Start,
};
use std::sync::Arc;

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn uniform(low: f64, high: f64) -> Law {
    Law::Random { family: Family::Uniform { low, high }, low, high }
}

fn body() -> Body {
    Body::new(Kind::Sfm, |parameter| match parameter {
        Parameter::Mass => uniform(60.0, 90.0),
        Parameter::Radius => uniform(0.2, 0.28),
        Parameter::Speed => uniform(1.0, 1.6),
        Parameter::Tau => Law::Constant(0.5),
        Parameter::A => Law::Constant(2000.0),
        Parameter::B => Law::Constant(0.08),
        Parameter::Lambda => Law::Constant(0.5),
        Parameter::K1 => Law::Constant(1.2e5),
        Parameter::K2 => Law::Constant(2.4e5),
        Parameter::Noise => Law::Constant(0.08),
        other => Law::Constant(other.description().default.unwrap_or(0.0)),
    })
}

/// The same with another law of one parameter.
fn body_with(parameter: Parameter, law: Law) -> Arc<Body> {
    let mut body = body();
    body[parameter] = law;
    Arc::new(body)
}

fn agent(entity: u32, position: Position) -> Agent {
    Agent {
        name: format!("a{entity}"),
        entity,
        body: Arc::new(body()),
        start: Start { position, velocity: p(0.0, 0.0), ..Start::at_rest(Vec2::zeros()) },
        route: Route::Legs { legs: vec![Leg::To(Goal::Region(RegionId(0)))], then_leave: false },
        group: None,
        particle: None,
    }
}

fn hall() -> Shape {
    Shape::rectangle(p(8.0, 0.3), p(19.0, 3.7))
}

fn scenario(agents: Vec<Agent>) -> Scenario {
    let wall = |a, b| Barrier { name: String::new(), obstacle: Obstacle::Wall(vec![Segment::new(a, b)]) };
    let pillar = Obstacle::Solid(Shape::Circle { centre: p(12.0, 2.0), radius: 0.4 });
    Scenario {
        title: String::new(),
        clock: Clock::Stepped(Decimal::parse("0.02").unwrap()),
        horizon: Tick(1500),
        scene: Scene {
            barriers: vec![
                wall(p(0.0, 0.0), p(20.0, 0.0)),
                wall(p(0.0, 4.0), p(20.0, 4.0)),
                Barrier { name: "pillar".into(), obstacle: pillar },
            ],
            regions: vec![Region::new("west", Shape::rectangle(p(0.0, 0.0), p(1.0, 4.0)))],
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

fn crowd(n: u32) -> Vec<Agent> {
    let mut agents = vec![agent(1, Position::Point(p(1.0, 2.0)))];
    agents.extend((0..n).map(|k| agent(100 + k, Position::Within(hall()))));
    agents
}

fn key(index: u64) -> TrialKey {
    TrialKey { seed: 42, index, branch: 0 }
}

fn empty(program: &Program) -> State {
    State::new(program.layout, program.scenario.agents.len())
}

/// All bytes of one agent in one lane.
fn bytes(state: &State, agent: usize, lane: usize) -> Vec<u64> {
    let slot = state.slot(agent, lane);
    let mut out: Vec<u64> = fields(state).iter().map(|f| f[slot.block].0[slot.lane].to_bits()).collect();
    out.push(u64::from(state.present[slot.block].has(slot.lane)));
    out
}

fn fields(s: &State) -> Vec<&Vec<Lanes>> {
    vec![
        &s.motion.x,
        &s.motion.y,
        &s.motion.vx,
        &s.motion.vy,
        &s.driving.ex,
        &s.driving.ey,
        &s.driving.speed,
        &s.motion.travelled,
        &s.bodies[Parameter::Speed],
        &s.bodies[Parameter::Mass],
        &s.bodies[Parameter::Radius],
        &s.bodies[Parameter::Tau],
        &s.bodies[Parameter::A],
        &s.bodies[Parameter::B],
        &s.bodies[Parameter::Lambda],
        &s.bodies[Parameter::A2],
        &s.bodies[Parameter::B2],
        &s.bodies[Parameter::Lambda2],
        &s.bodies[Parameter::K1],
        &s.bodies[Parameter::K2],
        &s.bodies[Parameter::Noise],
        &s.motion.fx,
        &s.motion.fy,
    ]
}

fn overlaps(state: &State, lane: usize) -> usize {
    let at = |k: usize| {
        let slot = state.slot(k, lane);
        let of = |f: &Vec<Lanes>| f[slot.block].0[slot.lane];
        (p(of(&state.motion.x), of(&state.motion.y)), of(&state.bodies[Parameter::Radius]))
    };
    let all: Vec<_> = (0..state.agents).map(at).collect();
    let mut count = 0;
    for (i, a) in all.iter().enumerate() {
        count += all[i + 1..].iter().filter(|b| (a.0 - b.0).norm() < a.1 + b.1).count();
    }
    count
}

#[test]
fn every_number_is_drawn_from_its_address() {
    let program = Program::new(Arc::new(scenario(crowd(5))));
    let mut state = empty(&program);
    load(&program, &mut state, 3, key(7), None).unwrap();
    for (k, agent) in program.scenario.agents.iter().enumerate() {
        let stream = Stream::of(key(7), agent.entity, Purpose::Parameter);
        let of = |name: &str, law: &Law| law.draw(stream.uniform(name_hash(name) as u32));
        assert_eq!(state.bodies[Parameter::Mass][k].0[3], of("mass", &agent.body[Parameter::Mass]));
        assert_eq!(state.bodies[Parameter::Speed][k].0[3], of("speed", &agent.body[Parameter::Speed]));
        assert_eq!(state.bodies[Parameter::Radius][k].0[3], of("radius", &agent.body[Parameter::Radius]));
    }
}

#[test]
fn a_lane_is_like_any_other_and_disturbs_none() {
    let program = Program::new(Arc::new(scenario(crowd(20))));
    let (mut one, mut many) = (empty(&program), empty(&program));
    load(&program, &mut one, 0, key(5), None).unwrap();
    for lane in [2, 7, 0] {
        load(&program, &mut many, lane, key(lane as u64 + 90), None).unwrap();
    }
    let before = many.clone();
    load(&program, &mut many, 5, key(5), None).unwrap();
    for agent in 0..21 {
        assert_eq!(bytes(&one, agent, 0), bytes(&many, agent, 5));
        for lane in (0..LANES).filter(|&lane| lane != 5) {
            assert_eq!(bytes(&before, agent, lane), bytes(&many, agent, lane));
        }
    }
    assert_eq!(many.occupied, Mask(0b1010_0101));
    assert_eq!((many.keys[5], many.keys[7]), (key(5), key(97)));
    // A used lane is as good as a new one.
    load(&program, &mut many, 7, key(5), None).unwrap();
    assert_eq!(many.route.way(3, 7), many.route.way(3, 5));
    assert_eq!(bytes(&many, 3, 7), bytes(&many, 3, 5));
}

#[test]
fn an_agent_more_and_a_move_change_nobody_elses_start() {
    let few = Program::new(Arc::new(scenario(crowd(12))));
    let mut more = scenario(crowd(12));
    // In the middle of the list, far from everybody.
    more.agents.insert(4, agent(999, Position::Point(p(5.0, 2.0))));
    more.moves.push(Moves {
        agent: AgentId(0),
        others: Vec::new(),
        duration: Tick(100),
        options: vec![("stop".into(), Move::Stop), ("left".into(), Move::Heading(0.5))],
        routes: Vec::new(),
        paths: None,
    });
    let more = Program::new(Arc::new(more));
    for index in 0..20 {
        let (mut a, mut b, mut c) = (empty(&few), empty(&more), empty(&more));
        load(&few, &mut a, 0, key(index), None).unwrap();
        load(&more, &mut b, 0, key(index), None).unwrap();
        load(&more, &mut c, 0, key(index), Some((0, 1))).unwrap();
        for agent in 0..13 {
            let shifted = if agent < 4 { agent } else { agent + 1 };
            assert_eq!(bytes(&a, agent, 0), bytes(&b, shifted, 0));
            if agent > 0 {
                assert_eq!(bytes(&b, shifted, 0), bytes(&c, shifted, 0));
            }
        }
        assert_eq!(b.driving.speed[0].0[0], 0.0, "the user starts in the region it goes to");
        assert!((b.driving.ex[0].0[0] + 1.0).abs() < 1e-15);
        assert!(
            c.driving.speed[0].0[0] > 0.9
                && (c.driving.ex[0].0[0] + smc::base::math::sin_cos(0.5).1).abs() < 1e-12
        );
    }
}

#[test]
fn bodies_are_apart_in_their_shape_and_off_the_barriers() {
    let program = Program::new(Arc::new(scenario(crowd(40))));
    let mut state = empty(&program);
    let mut means = p(0.0, 0.0);
    for index in 0..200 {
        let lane = index as usize % LANES;
        let loaded = load(&program, &mut state, lane, key(index), None).unwrap();
        assert_eq!(loaded.shrunk, []);
        assert_eq!(overlaps(&state, lane), 0);
        for k in 1..41 {
            let at = p(state.motion.x[k].0[lane], state.motion.y[k].0[lane]);
            assert!(hall().distance(at) < 1e-9);
            for barrier in &program.scenario.scene.barriers {
                assert!(barrier.obstacle.distance(at) >= state.bodies[Parameter::Radius][k].0[lane]);
            }
            means += at / (200.0 * 40.0);
        }
    }
    assert!((means - p(13.5, 2.0)).norm() < 0.1, "{means}");
}

#[test]
fn a_crowded_shape_is_relaxed() {
    // 26 discs of mean radius 0.24 m with their centres in 2.4 m x 2.4 m: throwing alone never gets that far.
    let shape = Shape::rectangle(p(2.0, 1.0), p(4.4, 3.4));
    let agents = (0..26).map(|k| agent(k, Position::Within(shape.clone()))).collect();
    let program = Program::new(Arc::new(scenario(agents)));
    let mut state = empty(&program);
    for index in 0..20 {
        let loaded = load(&program, &mut state, 0, key(index), None).unwrap();
        assert!(loaded.pushed > 0);
        assert_eq!(loaded.shrunk, [], "trial {index}");
        assert_eq!(overlaps(&state, 0), 0);
        for k in 0..26 {
            assert!(shape.distance(p(state.motion.x[k].0[0], state.motion.y[k].0[0])) < 1e-9);
        }
    }
}

#[test]
fn overlapping_points_shrink_to_touch() {
    let mut agents = vec![
        agent(1, Position::Point(p(5.0, 2.0))),
        agent(2, Position::Point(p(5.3, 2.0))),
        agent(3, Position::Point(p(7.0, 2.0))),
        agent(4, Position::Point(p(16.0, 0.1))),
    ];
    let law = Law::Constant(0.25);
    for agent in &mut agents {
        agent.body = body_with(Parameter::Radius, law.clone());
    }
    let program = Program::new(Arc::new(scenario(agents)));
    let mut state = empty(&program);
    let loaded = load(&program, &mut state, 0, key(1), None).unwrap();
    let at: Vec<_> = loaded.shrunk.iter().map(|one| (one.agent.0, one.at, one.from)).collect();
    let wanted = [
        (0, Overlapped::Agent(AgentId(1)), 0.25),
        (1, Overlapped::Agent(AgentId(0)), 0.25),
        (3, Overlapped::Barrier(BarrierId(0)), 0.25),
    ];
    assert_eq!((at.as_slice(), loaded.pushed), (&wanted[..], 0));
    assert!(
        loaded.shrunk.iter().all(|one| one.to == state.bodies[Parameter::Radius][one.agent.0 as usize].0[0])
    );
    let radius = |k: usize| state.bodies[Parameter::Radius][k].0[0];
    assert!((radius(0) - 0.15).abs() < 1e-12 && (radius(1) - 0.15).abs() < 1e-12);
    assert!(radius(0) + radius(1) <= 0.3);
    assert_eq!(radius(2), 0.25);
    assert!((radius(3) - 0.1).abs() < 1e-12);
}

#[test]
fn near_is_near_and_needs_its_anchor() {
    let mut agents = crowd(8);
    agents.push(agent(500, Position::Near { agent: AgentId(2), within: 1.5 }));
    let program = Program::new(Arc::new(scenario(agents.clone())));
    let mut state = empty(&program);
    for index in 0..50 {
        load(&program, &mut state, 0, key(index), None).unwrap();
        let at = |k: usize| p(state.motion.x[k].0[0], state.motion.y[k].0[0]);
        assert!((at(9) - at(2)).norm() <= 1.5 + 1e-9);
        assert_eq!(overlaps(&state, 0), 0);
    }
    agents.swap(1, 9);
    let program = Program::new(Arc::new(scenario(agents)));
    let fault = load(&program, &mut state, 0, key(0), None).unwrap_err();
    assert_eq!(fault, Fault::Order { agent: AgentId(1) });
}

#[test]
fn a_particle_is_the_sum_of_its_persons() {
    let mut four = agent(9, Position::Point(p(3.0, 2.0)));
    four.particle = Some(Particle {
        persons: 4,
        repulsion: 1.0,
        friction: 0.0,
        radius_factor: 1.0,
        spread: 0.0,
        room: f64::INFINITY,
        tau_factor: 1.0,
    });
    let program = Program::new(Arc::new(scenario(vec![four.clone()])));
    let mut state = empty(&program);
    load(&program, &mut state, 0, key(0), None).unwrap();
    let stream = Stream::of(key(0), 9, Purpose::Parameter);
    let base = name_hash("mass") as u32;
    let mass: f64 =
        (0..4).map(|k| four.body[Parameter::Mass].draw(stream.uniform(base.wrapping_add(k)))).sum();
    assert_eq!(state.bodies[Parameter::Mass][0].0[0], mass);
    assert_eq!((state.bodies[Parameter::A][0].0[0], state.bodies[Parameter::Noise][0].0[0]), (8000.0, 0.04));
    assert_eq!((state.bodies[Parameter::K1][0].0[0], state.bodies[Parameter::K2][0].0[0]), (1.2e5, 2.4e5));
}

#[test]
fn impossible_parameters_are_faults_and_leave_the_state_alone() {
    let mut bad = agent(9, Position::Point(p(3.0, 2.0)));
    bad.body = body_with(Parameter::Tau, Law::Constant(0.0));
    let program = Program::new(Arc::new(scenario(vec![bad])));
    let mut state = empty(&program);
    let before = state.clone();
    let fault = load(&program, &mut state, 0, key(0), None).unwrap_err();
    assert_eq!(fault, Fault::Parameter { agent: AgentId(0), name: "tau", value: 0.0 });
    assert_eq!(state, before);
    let fault = load(&program, &mut state, 0, key(0), Some((0, 0))).unwrap_err();
    assert_eq!(fault, Fault::Advice { declaration: 0, option: 0 });
}

#[test]
fn a_large_crowd_has_its_own_layout_and_no_overlaps() {
    let shape = Shape::rectangle(p(0.0, 10.0), p(40.0, 40.0));
    let agents = (0..1000).map(|k| agent(k, Position::Within(shape.clone()))).collect();
    let program = Program::new(Arc::new(scenario(agents)));
    assert_eq!(program.layout, Layout::Agents);
    let mut state = empty(&program);
    let loaded = load(&program, &mut state, 0, key(0), None).unwrap();
    assert_eq!((loaded.shrunk.len(), overlaps(&state, 0)), (0, 0));
    assert!(state.present[..1000 / LANES].iter().all(|&mask| mask == Mask::ALL));
    assert_eq!(state.occupied, Mask::lane(0));
}

#[test]
fn only_what_cannot_fit_is_refused() {
    assert_eq!(check_area(&scenario(crowd(100))), []);
    let too_many = check_area(&scenario(crowd(260)));
    assert_eq!(too_many.len(), 1);
    assert_eq!(too_many[0].agents.len(), 260);
    assert!(too_many[0].bodies > 0.84 * too_many[0].free);
    // One body fits into a shape smaller than itself, two do not.
    let tiny = Shape::Circle { centre: p(5.0, 2.0), radius: 0.05 };
    let alone = vec![agent(1, Position::Within(tiny.clone()))];
    assert_eq!(check_area(&scenario(alone.clone())), []);
    let two = vec![alone[0].clone(), agent(2, Position::Within(tiny))];
    assert_eq!(check_area(&scenario(two)).len(), 1);
    // Inside an obstacle nobody fits.
    let inside = Shape::Polygon(Polygon::rectangle(p(11.95, 1.95), p(12.05, 2.05)));
    assert_eq!(check_area(&scenario(vec![agent(1, Position::Within(inside))])).len(), 1);
}

/// Somebody of a fixed radius in a shape.
fn of_radius(entity: u32, radius: f64, shape: &Shape) -> Agent {
    let mut agent = agent(entity, Position::Within(shape.clone()));
    agent.body = body_with(Parameter::Radius, Law::Constant(radius));
    agent
}

#[test]
fn what_is_allowed_of_few_can_be_placed() {
    let spot = |radius| Shape::Circle { centre: p(5.0, 2.0), radius };
    let row = |length| Shape::rectangle(p(5.0, 2.0), p(5.0 + length, 2.01));
    // Each fills more than 0.84 of what it can cover.
    for (count, shape) in [(1, spot(0.01)), (1, spot(0.02)), (2, row(0.61)), (1, row(0.01))] {
        let mut only = scenario((0..count).map(|k| of_radius(k, 0.3, &shape)).collect());
        only.scene.barriers.clear();
        assert_eq!(check_area(&only), [], "{shape:?}");
        let program = Program::new(Arc::new(only));
        let mut state = empty(&program);
        for index in 0..50 {
            let loaded = load(&program, &mut state, 0, key(index), None).unwrap();
            assert_eq!((loaded.shrunk.len(), overlaps(&state, 0)), (0, 0), "{shape:?}");
        }
        assert!(f64::from(count) * 0.09 * std::f64::consts::PI > 0.84 * covered(&shape, 0.3));
    }
}

/// Area of what lies within reach of a shape, roughly.
fn covered(shape: &Shape, reach: f64) -> f64 {
    let bounds = shape.bounds();
    let low = bounds.low - p(reach, reach);
    let cell = (bounds.high - bounds.low + p(2.0 * reach, 2.0 * reach)) / 200.0;
    let at = |k: u32| low + p(f64::from(k % 200) + 0.5, f64::from(k / 200) + 0.5).component_mul(&cell);
    (0..40_000).filter(|k| shape.distance(at(*k)) <= reach).count() as f64 * cell.x * cell.y
}

#[test]
fn few_are_refused_only_if_they_take_more_than_there_is() {
    let spot = Shape::Circle { centre: p(5.0, 2.0), radius: 0.05 };
    let three = check_area(&scenario((0..3).map(|k| of_radius(k, 0.3, &spot)).collect()));
    assert_eq!((three.len(), three[0].share), (1, None));
    // Radii that may be drawn small tell nothing of those that are.
    let drawn = body_with(Parameter::Radius, uniform(0.01, 0.4));
    let drawn = |k| Agent { body: Arc::clone(&drawn), ..of_radius(k, 0.3, &spot) };
    assert_eq!(check_area(&scenario((0..3).map(drawn).collect())), []);
}

#[test]
fn a_row_of_many_fills_more_than_a_hall_does() {
    // A line of thirty, with a little to spare: nothing of what they cover beyond it is anybody else's.
    let line = Shape::rectangle(p(1.0, 20.0), p(1.0 + 29.0 * 0.63, 20.001));
    let many = scenario((0..30).map(|k| of_radius(k, 0.3, &line)).collect());
    assert_eq!(check_area(&many), []);
    let hall = check_area(&scenario(crowd(260)));
    assert!(hall[0].share.is_some_and(|share| (0.84..0.9).contains(&share)), "{:?}", hall[0].share);
}
