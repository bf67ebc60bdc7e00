//! Agents with an own driver: plans are followed as they say, in both layouts, whatever other lanes do.

use crate::crowd::bits_of;
use smc::base::decimal::Decimal;
use smc::base::geometry::{Segment, Shape, Vec2};
use smc::base::lanes::{LANES, Mask};
use smc::base::random::TrialKey;
use smc::base::tick::{Clock, Tick};
use smc::kernel::driver::{Driver, Drivers, Limits, Memory, Occasion, Plan, Sample, Situation, Trajectory};
use smc::kernel::fault::Fault;
use smc::kernel::start::load;
use smc::kernel::{Layout, Program, Scratch, State, refresh, step};
use smc::model::{
    Agent, AgentId, Barrier, Body, Goal, Kind, Law, Leg, Move, Moves, Obstacle, Parameter, Position, Region,
    RegionId, Route, Scenario, Scene, Start,
};
use std::sync::{Arc, Mutex};

const DT: f64 = 0.04;
const LIMITS: Limits = Limits { correction: 0.3, lag: 0.5, leave: 1.0 };

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn agent(k: u32, at: Vec2, noise: f64) -> Agent {
    let body = Body::new(Kind::Sfm, |parameter| {
        Law::Constant(match parameter {
            Parameter::Mass => 80.0,
            Parameter::Radius => 0.25,
            Parameter::Speed => 1.3,
            Parameter::Tau => 0.5,
            Parameter::A => 2000.0,
            Parameter::B => 0.08,
            Parameter::K1 => 1.2e5,
            Parameter::K2 => 2.4e5,
            Parameter::Noise => noise,
            other => other.description().default.unwrap_or(0.0),
        })
    });
    Agent {
        name: format!("person[{k}]"),
        entity: 40 + k,
        body: Arc::new(body),
        start: Start {
            position: Position::Point(at),
            velocity: p(0.0, 0.0),
            ..Start::at_rest(Vec2::zeros())
        },
        route: Route::Legs {
            legs: vec![Leg::To(Goal::Point(p(6.0, 0.0))), Leg::To(Goal::Region(RegionId(0)))],
            then_leave: false,
        },
        group: None,
        particle: None,
    }
}

fn scenario(agents: Vec<Agent>, walls: &[Segment]) -> Scenario {
    let region = Region::new("end", Shape::rectangle(p(10.0, -1.0), p(12.0, 1.0)));
    let barrier = Barrier { name: String::new(), obstacle: Obstacle::Wall(walls.to_vec()) };
    Scenario {
        title: String::new(),
        clock: Clock::Stepped(Decimal::parse("0.04").unwrap()),
        horizon: Tick(5000),
        scene: Scene {
            barriers: if walls.is_empty() { Vec::new() } else { vec![barrier] },
            regions: vec![region],
            ..Scene::default()
        },
        agents,
        groups: Vec::new(),
        moves: vec![Moves {
            agent: AgentId(0),
            others: Vec::new(),
            duration: Tick(25),
            options: vec![("stop".to_owned(), Move::Stop)],
            routes: Vec::new(),
            paths: None,
        }],
        processes: smc::model::Processes::default(),
        behaviours: smc::model::Behaviours::default(),
        sources: Vec::new(),
        doors: Vec::new(),
    }
}

/// Answers with the plans of a list in turn, then keeps the last one, and notes when it is asked.
#[derive(Debug)]
struct Listed {
    plans: Vec<Plan>,
    asked: Mutex<Vec<(f64, Occasion, Vec2)>>,
}

impl Listed {
    fn new(plans: Vec<Plan>) -> Arc<Self> {
        Arc::new(Self { plans, asked: Mutex::default() })
    }

    fn occasions(&self) -> Vec<Occasion> {
        self.asked.lock().unwrap().iter().map(|(_, occasion, _)| *occasion).collect()
    }
}

impl Driver for Listed {
    fn plan(&self, situation: &Situation<'_>, _: &mut Memory) -> Plan {
        self.asked.lock().unwrap().push((situation.time, situation.occasion, situation.position));
        self.plans.get(situation.asked as usize).cloned().unwrap_or(Plan::Keep)
    }
}

/// From rest at the origin with 0.8 m/s^2 to 1.2 m/s, and back to rest at 6 m.
fn there() -> Arc<Trajectory> {
    let sample = |time, x, v| Sample { time, position: p(x, 0.0), velocity: p(v, 0.0) };
    let samples =
        [sample(0.0, 0.0, 0.0), sample(1.5, 0.9, 1.2), sample(5.0, 5.1, 1.2), sample(6.5, 6.0, 0.0)];
    Arc::new(Trajectory::through(&samples).unwrap())
}

/// A quarter of a circle of 4 m, from the origin to the right and up, with 1 m/s.
fn bend() -> Arc<Trajectory> {
    let sample = |k: u32| {
        let (sin, cos) = smc::base::math::sin_cos_turn(f64::from(k) / 160.0);
        let time = f64::from(k) / 40.0 * 2.0 * std::f64::consts::PI;
        Sample { time, position: p(4.0 * sin, 4.0 - 4.0 * cos), velocity: p(cos, sin) }
    };
    Arc::new(Trajectory::through(&(0..=40).map(sample).collect::<Vec<_>>()).unwrap())
}

struct Run {
    program: Program,
    state: State,
    scratch: Scratch,
}

impl Run {
    fn new(scenario: Scenario, drivers: Drivers, layout: Layout) -> Self {
        let mut program = Program::driven(Arc::new(scenario), drivers);
        program.layout = layout;
        let state = State::new(layout, program.scenario.agents.len());
        Self { program, state, scratch: Scratch::default() }
    }

    fn load(mut self, lane: usize, index: u64, advice: Option<(usize, usize)>) -> Self {
        load(&self.program, &mut self.state, lane, key(index), advice).unwrap();
        refresh(&self.program, &mut self.state, &mut self.scratch, Mask::lane(lane));
        self
    }

    fn step(&mut self) {
        step(&self.program, &mut self.state, &mut self.scratch);
    }

    fn of(&self, field: &[smc::base::lanes::Lanes], agent: usize) -> f64 {
        let slot = self.state.slot(agent, 0);
        field[slot.block].0[slot.lane]
    }

    fn at(&self, agent: usize) -> Vec2 {
        p(self.of(&self.state.motion.x, agent), self.of(&self.state.motion.y, agent))
    }

    fn velocity(&self, agent: usize) -> Vec2 {
        p(self.of(&self.state.motion.vx, agent), self.of(&self.state.motion.vy, agent))
    }
}

fn key(index: u64) -> TrialKey {
    TrialKey { seed: 3, index, branch: 0 }
}

fn one(plan: Plan, layout: Layout) -> (Run, Arc<Listed>) {
    let driver = Listed::new(vec![plan]);
    let drivers = Drivers::new(3).with([AgentId(0)], driver.clone());
    let run = Run::new(scenario(vec![agent(0, p(0.0, 0.0), 0.0)], &[]), drivers, layout);
    (run.load(0, 0, None), driver)
}

#[test]
fn someone_alone_walks_a_trajectory_within_2_cm() {
    for trajectory in [there(), bend()] {
        let mut both = Vec::new();
        for layout in [Layout::Trials, Layout::Agents] {
            let (mut run, _) = one(Plan::Follow(trajectory.clone(), LIMITS), layout);
            // A circle is entered with its speed.
            let [_, start, _] = trajectory.at(0.0);
            let slot = run.state.slot(0, 0);
            (run.state.motion.vx[slot.block].0[slot.lane], run.state.motion.vy[slot.block].0[slot.lane]) =
                (start.x, start.y);
            let mut farthest: f64 = 0.0;
            let mut seen = Vec::new();
            for k in 1..=(trajectory.duration() / DT) as u32 {
                run.step();
                let [position, ..] = trajectory.at(f64::from(k) * DT);
                farthest = farthest.max((run.at(0) - position).norm());
                seen.push([run.at(0).x.to_bits(), run.at(0).y.to_bits(), run.velocity(0).x.to_bits()]);
            }
            assert!(farthest < 0.02, "{farthest} m from the plan");
            both.push(seen);
        }
        assert!(both[0] == both[1], "the layouts differ");
    }
}

#[test]
fn the_plan_waits_for_someone_far_behind_and_asks_when_left() {
    let (mut run, driver) = one(Plan::Follow(there(), LIMITS), Layout::Trials);
    for _ in 0..50 {
        run.step();
    }
    // Pushed back by 0.8 m: the plan waits until the distance is 0.5 m, 0.3 m at 1.5 m/s. Otherwise 5.98 m would be reached
    // 0.22 s before the end at 6.5 s.
    run.state.motion.x[0].0[0] -= 0.8;
    let mut ended = 0;
    for k in 51..400 {
        run.step();
        if ended == 0 && run.at(0).x > 5.98 {
            ended = k;
        }
    }
    assert!(f64::from(ended) * DT > 6.4, "at the end at {} s", f64::from(ended) * DT);
    assert!((run.at(0) - p(6.0, 0.0)).norm() < 0.02);
    assert!(!driver.occasions().contains(&Occasion::Left), "it was never 1 m away");
    run.state.motion.y[0].0[0] += 1.5;
    run.step();
    assert_eq!(driver.occasions().last(), Some(&Occasion::Left));
    let before = driver.occasions().len();
    for _ in 0..12 {
        run.step();
    }
    assert_eq!(driver.occasions().len(), before, "at most every 0.5 s");
}

/// Straight on at 1 m/s for 8 m.
fn on() -> Plan {
    let sample = |time: f64| Sample { time, position: p(time, 0.0), velocity: p(1.0, 0.0) };
    Plan::Step(Arc::new(Trajectory::through(&[sample(0.0), sample(3.01), sample(8.0)]).unwrap()))
}

#[test]
fn forces_do_not_move_someone_who_steps_but_others_give_way() {
    for layout in [Layout::Trials, Layout::Agents] {
        let (mut alone, _) = one(on(), layout);
        let mut standing = agent(1, p(3.0, 0.02), 0.0);
        standing.route = Route::Legs { legs: Vec::new(), then_leave: false };
        let drivers = Drivers::new(3).with([AgentId(0)], Listed::new(vec![on()]));
        let two = scenario(vec![agent(0, p(0.0, 0.0), 0.3), standing], &[]);
        let mut run = Run::new(two, drivers, layout).load(0, 0, None);
        let mut nearest = f64::INFINITY;
        for k in 1..=200 {
            run.step();
            alone.step();
            let at = run.at(0);
            assert!((at - p(f64::from(k) * DT, 0.0)).norm() < 1e-12, "{at}");
            assert_eq!([at.x.to_bits(), at.y.to_bits()], [alone.at(0).x.to_bits(), alone.at(0).y.to_bits()]);
            nearest = nearest.min((run.at(1) - at).norm());
        }
        assert!((run.at(1) - p(3.0, 0.02)).norm() > 0.2, "the other was pushed");
        assert!(nearest > 0.4, "nobody is walked through: {nearest}");
        assert!((run.of(&run.state.motion.travelled, 0) - 8.0).abs() < 1e-9);
    }
}

#[test]
fn one_step_begins_when_the_one_before_it_ends() {
    // Steps of 0.7 s, which end between states: the way is that of one long step all the same.
    let pace = |from: f64| {
        let sample = |time: f64| Sample { time, position: p(from + time, 0.0), velocity: p(1.0, 0.0) };
        Plan::Step(Arc::new(Trajectory::through(&[sample(0.0), sample(0.7)]).unwrap()))
    };
    let driver = Listed::new((0..8).map(|k| pace(0.7 * f64::from(k))).collect());
    let drivers = Drivers::new(3).with([AgentId(0)], driver.clone());
    let mut run =
        Run::new(scenario(vec![agent(0, p(0.0, 0.0), 0.0)], &[]), drivers, Layout::Trials).load(0, 0, None);
    for k in 1..=100 {
        run.step();
        assert!((run.at(0).x - f64::from(k) * DT).abs() < 1e-9, "{} after {k} steps", run.at(0).x);
    }
    let asked = driver.asked.lock().unwrap();
    assert_eq!(asked[0].1, Occasion::Begins);
    for (k, (_, occasion, position)) in asked.iter().enumerate().skip(1) {
        assert_eq!(*occasion, Occasion::Ended);
        assert!((position.x - 0.7 * k as f64).abs() < 1e-12, "the plan begins where the last one ends");
    }
}

#[test]
fn a_way_leads_around_a_wall_and_is_passed_in_sight_of_what_follows() {
    let wall = Segment::new(p(3.0, -4.0), p(3.0, 1.0));
    let way = vec![Plan::Way([p(2.6, 1.6), p(3.4, 1.6)].into()), Plan::Straight];
    let straight = vec![Plan::Straight, Plan::Straight];
    for (layout, plans, arrives) in
        [(Layout::Trials, &way, true), (Layout::Agents, &way, true), (Layout::Trials, &straight, false)]
    {
        let driver = Listed::new(plans.clone());
        let drivers = Drivers::new(3).with([AgentId(0)], driver.clone());
        let agents = vec![agent(0, p(0.0, -1.0), 0.0)];
        let mut run = Run::new(scenario(agents, &[wall]), drivers, layout).load(0, 0, None);
        let mut nearest = f64::INFINITY;
        for _ in 0..400 {
            run.step();
            nearest = wall.distance(run.at(0)).min(nearest);
        }
        assert_eq!(run.at(0).x > 10.0, arrives, "at {}", run.at(0));
        assert!(nearest > 0.2, "{nearest}");
        let occasions = driver.occasions();
        if arrives {
            assert_eq!(occasions, [Occasion::Begins, Occasion::Leg]);
        } else {
            // Who goes straight is asked about the goal while it is out of sight.
            assert_eq!(occasions[0], Occasion::Begins);
            assert!((28..=32).contains(&occasions[1..].len()), "{} times in 16 s", occasions.len());
            assert!(occasions[1..].iter().all(|occasion| *occasion == Occasion::Left));
        }
    }
}

#[test]
fn points_are_passed_in_turn_though_a_later_one_is_in_sight() {
    let detour: Arc<[Vec2]> = [p(1.0, 2.0), p(3.0, -2.0)].into();
    for layout in [Layout::Trials, Layout::Agents] {
        let nearest = |plan| {
            let (mut run, _) = one(plan, layout);
            let mut nearest = [f64::INFINITY; 2];
            for _ in 0..400 {
                run.step();
                for (distance, point) in nearest.iter_mut().zip(detour.iter()) {
                    *distance = distance.min((run.at(0) - point).norm());
                }
            }
            assert!(run.at(0).x > 10.0, "at {}", run.at(0));
            nearest
        };
        // Within two radii, and as far as it turns while it passes.
        assert!(nearest(Plan::Through(detour.clone())).iter().all(|distance| *distance < 0.6));
        let [first, _] = nearest(Plan::Way(detour.clone()));
        assert!(first > 0.7, "a way is as short as what is in sight, and comes within {first} m");
    }
}

#[test]
fn a_driver_that_fails_ends_its_trial_and_no_other() {
    let fault = Fault::Unsteady { agent: AgentId(0) };
    for failed in [None, Some(fault)] {
        #[derive(Debug)]
        struct Fails(Option<Fault>);
        impl Driver for Fails {
            fn plan(&self, seen: &Situation<'_>, _: &mut Memory) -> Plan {
                let is_wrong = seen.key.index == 1 && seen.occasion == Occasion::Leg;
                if is_wrong { Plan::Failed(self.0) } else { Plan::Straight }
            }
        }
        let drivers = Drivers::new(3).with([AgentId(0)], Arc::new(Fails(failed)));
        let crowd = scenario(vec![agent(0, p(0.0, 0.0), 0.0)], &[]);
        let mut run = Run::new(crowd, drivers, Layout::Trials).load(0, 0, None).load(1, 1, None);
        let ended = (0..400).find(|_| {
            run.step();
            run.state.diverged.has(1)
        });
        let at = run.state.motion.x[0].0[1];
        assert!(
            ended.is_some() && (5.0..6.1).contains(&at),
            "the driver fails where the first leg ends: {at}"
        );
        assert_eq!(run.state.undriven(1), Some(0));
        assert_eq!(run.state.undriven(0), None);
        assert!(!run.state.diverged.has(0) && !run.state.faulty.has(0));
        assert_eq!((run.state.faulty.has(1), run.state.faults[1]), (failed.is_some(), failed));
    }
}

#[test]
fn a_point_out_of_sight_is_asked_about_twice_a_second() {
    let wall = Segment::new(p(3.0, -4.0), p(3.0, 4.0));
    let driver = Listed::new(vec![Plan::Way([p(5.0, 0.0)].into())]);
    let drivers = Drivers::new(3).with([AgentId(0)], driver.clone());
    let agents = vec![agent(0, p(0.0, 0.0), 0.0)];
    let mut run = Run::new(scenario(agents, &[wall]), drivers, Layout::Trials).load(0, 0, None);
    for _ in 0..250 {
        run.step();
    }
    let asked = driver.occasions();
    assert!((18..=20).contains(&asked.len()), "{} times in 10 s", asked.len());
    assert!(asked[1..].iter().all(|occasion| *occasion == Occasion::Left));
}

#[test]
fn a_driver_is_asked_again_after_a_stand_a_leg_and_advice() {
    let driver = Listed::new(vec![Plan::Stand(1.0), Plan::Straight]);
    let drivers = Drivers::new(3).with([AgentId(0)], driver.clone());
    let agents = vec![agent(0, p(0.0, 0.0), 0.0)];
    let mut run = Run::new(scenario(agents.clone(), &[]), drivers, Layout::Trials).load(0, 0, None);
    for _ in 0..25 {
        assert_eq!(run.at(0), p(0.0, 0.0));
        run.step();
    }
    for _ in 0..400 {
        run.step();
    }
    assert_eq!(driver.occasions(), [Occasion::Begins, Occasion::Ended, Occasion::Leg]);
    assert!(run.at(0).x > 10.0, "straight to the goals");

    // Advised to stop for a second: the plan begins then.
    let driver = Listed::new(vec![Plan::Follow(there(), LIMITS), Plan::Follow(there(), LIMITS)]);
    let drivers = Drivers::new(3).with([AgentId(0)], driver.clone());
    let mut run = Run::new(scenario(agents, &[]), drivers, Layout::Trials).load(0, 0, Some((0, 0)));
    for _ in 0..25 {
        run.step();
        assert_eq!(run.at(0), p(0.0, 0.0));
    }
    run.step();
    assert!(run.velocity(0).x > 0.0);
    assert_eq!(driver.occasions(), [Occasion::Begins, Occasion::Diverted]);
}

#[test]
fn plans_of_one_lane_do_not_touch_another() {
    let agents = || {
        let mut out =
            vec![agent(0, p(0.0, 0.0), 0.1), agent(1, p(0.0, 0.7), 0.1), agent(2, p(4.0, 0.3), 0.1)];
        out.push(agent(3, p(2.0, -0.6), 0.2));
        out
    };
    let drivers = || {
        Drivers::new(3)
            .with([AgentId(0)], Listed::new(vec![on()]))
            .with([AgentId(1)], Listed::new(vec![Plan::Follow(there(), LIMITS)]))
            .with([AgentId(3)], Listed::new(vec![Plan::Way([p(4.0, -2.0)].into())]))
    };
    let scene = || scenario(agents(), &[Segment::new(p(7.0, -3.0), p(7.0, -1.0))]);
    let mut together = Run::new(scene(), drivers(), Layout::Trials);
    for lane in 0..LANES {
        together = together.load(lane, lane as u64, None);
    }
    for _ in 0..220 {
        together.step();
    }
    for lane in 0..LANES {
        let mut alone = Run::new(scene(), drivers(), Layout::Trials).load(lane, lane as u64, None);
        for _ in 0..220 {
            alone.step();
        }
        assert!(bits_of(&alone.state, lane) == bits_of(&together.state, lane), "lane {lane}");
    }
    assert!((together.at(0) - p(8.0, 0.0)).norm() < 1e-9, "{}", together.at(0));
}
