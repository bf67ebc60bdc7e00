//! What walkers that plan cost: profiles, roadmaps, paths, the first plan of a walker, and steps of a crowd in which a third
//! plans. `cargo bench --bench plans`; `benches/peers/planning.py` times TOPP-RA, Ruckig and OMPL on the same tasks.

#![allow(clippy::disallowed_methods, reason = "this measures time")]

use smc::Model;
use smc::base::geometry::{Polygon, Segment, Shape, Vec2};
use smc::base::random::{Purpose, Stream, TrialKey};
use smc::kernel::{Program, Run};
use smc::model::{AgentId, Barrier, Obstacle, Parameter, Route, Scene, SpeedRule};
use smc::route::Ways;
use smc::route::path::PathShape;
use smc::route::planner::{Speeds, Wish};
use smc::route::profile::{Law, Limits, Variety, optimal, printed, varied};
use smc::route::roadmap::{FreeSpace, Prm, Roadmap, Sampler, SamplingRule, shortest};
use std::hint::black_box;
use std::io::Write as _;
use std::time::Instant;

/// Best time of some rounds of a task, us.
fn best(rounds: u32, repeats: u32, mut task: impl FnMut(u32)) -> f64 {
    (0..rounds)
        .map(|_| {
            let started = Instant::now();
            (0..repeats).for_each(&mut task);
            started.elapsed().as_secs_f64() * 1e6 / f64::from(repeats)
        })
        .fold(f64::INFINITY, f64::min)
}

fn plaza() -> Model {
    let text = include_str!("../models/plaza.scn");
    Model::parse(text).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The two triangles of Li, Li and Ge, without walls.
fn triangles() -> Scene {
    let p = |x: f64, y: f64| Vec2::new(x, y);
    let solid = |corners: Vec<Vec2>| Barrier {
        name: String::new(),
        obstacle: Obstacle::Solid(Shape::Polygon(Polygon::new(corners))),
    };
    let corners = [p(0., 0.), p(20., 0.), p(20., 20.), p(0., 20.), p(0., 0.)];
    let wall = corners.windows(2).map(|pair| Segment::new(pair[0], pair[1])).collect();
    Scene {
        barriers: vec![
            solid(vec![p(4., 4.), p(14., 4.), p(4., 14.)]),
            solid(vec![p(16., 16.), p(6., 16.), p(16., 6.)]),
            Barrier { name: String::new(), obstacle: Obstacle::Wall(wall) },
        ],
        ..Scene::default()
    }
}

/// Million agent-steps per second of a number of trials, planning included.
fn rate(model: &Model, trials: u64, agents: usize) -> f64 {
    let ways = Ways::default();
    let program = Program::driven(model.scenario().clone(), ways.drivers(model.scenario(), 0));
    let mut steps = 0_u64;
    let mut run = Run::new(&program);
    let started = Instant::now();
    for index in 0..trials {
        let key = TrialKey { seed: 0, index, branch: 0 };
        run.start(key.into()).unwrap_or_else(|_| panic!("no start"));
        while run.next_state().is_ok() {
            steps += 1;
        }
    }
    (steps * agents as u64) as f64 / started.elapsed().as_secs_f64() / 1e6
}

fn main() {
    let mut out = std::io::stdout().lock();
    let shape: PathShape = "L10 A45/7 L10 A60/3 L2".parse().unwrap_or_else(|error| panic!("{error}"));
    let stretches = shape.stretches();
    for (speed, along) in [(10.0, 2.0), (1.5, 0.8)] {
        let limits = Limits { speed, along, across: along };
        let fastest = best(20, 5000, |_| {
            let _ = black_box(optimal(black_box(&stretches), limits, 0.0, 0.0));
        });
        let stream = Stream::of(TrialKey::default(), 1, Purpose::Test);
        let mut drawn = [0.0; 2];
        for (k, law) in
            [Law::Preferred { speed: 0.85 * speed, spread: 0.15 }, Law::Uniform].into_iter().enumerate()
        {
            let variety = Variety { pieces: 8, floor: 0.1, law };
            drawn[k] = best(20, 500, |n| {
                let _ = black_box(varied(&stretches, limits, 0.0, 0.0, &variety, |k| {
                    stream.uniform_pair(99 * n + k)
                }));
            });
        }
        let _ = writeln!(
            out,
            "{speed} m/s, {along} m/s^2: fastest profile {fastest:.2} us, varied {:.1} us, uniform {:.1} us",
            drawn[0], drawn[1]
        );
    }
    // Figure 7 of the paper: time over the number of pieces.
    let limits = Limits { speed: 10.0, along: 2.0, across: 2.0 };
    let stream = Stream::of(TrialKey::default(), 2, Purpose::Test);
    for pieces in 2..=10 {
        let variety = Variety { pieces, floor: 0.1, law: Law::Preferred { speed: 8.5, spread: 0.15 } };
        let time = best(10, 500, |n| {
            let draw = |k: u32| stream.uniform_pair(99 * n + k);
            let _ = black_box(varied(&stretches, limits, 0.0, 0.0, &variety, draw));
        });
        let _ = writeln!(out, "{pieces} pieces: {time:.1} us");
    }
    let time = best(10, 500, |n| {
        let _ = black_box(printed(&stretches, limits, 0.0, 0.0, None, |k| stream.uniform(99 * n + k)));
    });
    let _ = writeln!(out, "the printed algorithm, 2 to 10 pieces: {time:.1} us a run, returned or not");
    let free = FreeSpace::new(&triangles(), 0.0);
    let prm = |samples, separation| {
        Sampler::Prm(Prm { samples, sampling: SamplingRule::Bridge, separation, neighbours: 6 })
    };
    for (samples, separation) in [(1000, 0.0), (500, 0.5)] {
        let stream =
            |k: u32| Stream::of(TrialKey { seed: u64::from(k), ..TrialKey::default() }, 1, Purpose::Run);
        let draw = best(5, 10, |k| {
            black_box(Roadmap::draw(&free, &prm(samples, separation), stream(k)));
        });
        let roadmap = Roadmap::draw(&free, &prm(samples, separation), stream(0));
        let ends = (Vec2::new(2.0, 2.0), Vec2::new(18.0, 18.0));
        let path = best(5, 100, |_| {
            black_box(shortest(&roadmap, &free, ends.0, ends.1));
        });
        let _ = writeln!(
            out,
            "roadmap of {samples} samples, separation {separation} m: {:.2} ms, {} vertices; a shortest path {path:.0} us",
            draw / 1e3,
            roadmap.vertices().len()
        );
    }
    let model = plaza();
    let scenario = model.scenario();
    let ways = Ways::default();
    let walkers = ways.walkers(scenario, 0);
    let Route::Legs { legs, .. } = &scenario.agents[0].route else { panic!("legs") };
    let plan = |n: u32| {
        let key = TrialKey { index: u64::from(n), ..TrialKey::default() };
        let of = |parameter: Parameter| match parameter {
            Parameter::LimitSpeed => 1.5,
            Parameter::LimitAlong => 0.8,
            Parameter::LimitAcross => 1.6,
            Parameter::Pieces => 6.0,
            Parameter::Spread => 0.15,
            Parameter::Corner => 1.5,
            _ => 0.25,
        };
        let at = Vec2::new(0.6 + 0.14 * f64::from(n % 20), 14.5 + 0.2 * f64::from(n % 23));
        let wish = Wish {
            scenario,
            agent: AgentId(0),
            address: (key, 7, 0),
            motion: (at, Vec2::zeros()),
            legs,
            speeds: Speeds::new(of, 1.27, SpeedRule::Varied),
            path: None,
        };
        let course = walkers.outline(&wish).and_then(|outline| outline.course);
        black_box(course.and_then(|course| course.trajectory()));
    };
    plan(0);
    let _ = writeln!(out, "the first plan of a walker of `plaza`: {:.0} us", best(5, 400, plan));
    let crowd = |first: &str| {
        let text = format!(
            "horizon = 30 s\nstep = 0.04 s
            scene {{
              wall (0, 0) -- (20, 0) -- (20, 20) -- (0, 20) -- (0, 0)
              obstacle lower: polygon (4, 4) (14, 4) (4, 14)
              obstacle upper: polygon (16, 16) (6, 16) (16, 6)
              region start: rect (0.5, 14) .. (3.5, 19.5)
              region goal:  rect (15, 0.5) .. (19.5, 3.5)
              region other: rect (16.5, 0.5) .. (19.5, 19.5)
            }}
            kind planner: planned {{ limit speed = uniform(1.2 m/s, 1.8 m/s) }}
            kind plain: sfm preset helbing2000 {{ radius = 0.25 m }}
            agents first[15]: {first} {{ at = uniform in start; route = goal }}
            agents others[30]: plain {{ at = uniform in other; route = start }}"
        );
        Model::parse(&text).unwrap_or_else(|errors| panic!("{errors}"))
    };
    let (planned, plain) = (crowd("planner"), crowd("plain"));
    for _ in 0..3 {
        let (with, without) = (rate(&planned, 40, 45), rate(&plain, 40, 45));
        let _ = writeln!(
            out,
            "45 agents: {with:.2} M agent-steps/s with 15 that plan, {without:.2} without; {:.2}",
            with / without
        );
    }
}
