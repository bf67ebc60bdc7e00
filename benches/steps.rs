//! What walkers that step cost: a walk of 8 m among obstacles (Figure 5 of Agethen et al. 2018), grid A* beside it, the drawing of
//! a step, and steps of a corridor in which all step. `cargo bench --bench steps`; with `-- corridor` the last of them alone.

#![allow(clippy::disallowed_methods, reason = "this measures time")]

use smc::base::geometry::{Segment, Shape, Vec2};
use smc::base::random::{Purpose, Stream, TrialKey};
use smc::gait::model::LearnedGait;
use smc::gait::synthetic::{Person, SyntheticGait};
use smc::gait::walk::{Ground, HybridAStar, Search, Walk, Walker};
use smc::gait::{Draws, Foot, Gait, Stance};
use smc::model::{Barrier, Obstacle, Scene};
use smc::route::grid::{ClearanceGrid, GoalField, shortest_cells};
use smc::route::roadmap::FreeSpace;
use smc::{Draft, Model, Options};
use std::hint::black_box;
use std::io::Write as _;
use std::sync::Arc;
use std::time::Instant;

const LEARNED: &str = include_str!("../gaits/cmu.gait");

/// The square of Figure 5.
fn square() -> Scene {
    let p = |x: f64, y: f64| Vec2::new(x, y);
    let solid =
        |low, high| Barrier { name: String::new(), obstacle: Obstacle::Solid(Shape::rectangle(low, high)) };
    let corners = [p(0., 0.), p(6.5, 0.), p(6.5, 6.5), p(0., 6.5), p(0., 0.)];
    let rim = corners.windows(2).map(|pair| Segment::new(pair[0], pair[1])).collect();
    Scene {
        barriers: vec![
            solid(p(1.2, 3.9), p(2.6, 5.0)),
            solid(p(2.9, 2.2), p(4.3, 3.4)),
            solid(p(0.8, 1.2), p(2.0, 2.6)),
            solid(p(4.6, 3.6), p(5.8, 5.2)),
            solid(p(4.7, 1.2), p(5.3, 2.4)),
            Barrier { name: String::new(), obstacle: Obstacle::Wall(rim) },
        ],
        ..Scene::default()
    }
}

fn stream(index: u64) -> Stream {
    Stream::of(TrialKey { seed: 0, index, branch: 0 }, 1, Purpose::Step)
}

/// A person of the learned gait, and one of the synthetic one.
fn people(learned: &Arc<LearnedGait>, index: u64) -> [Box<dyn Gait>; 2] {
    let mut normals = [0.0; LearnedGait::NORMALS];
    for (k, pair) in (0..).zip(normals.chunks_mut(2)) {
        pair.copy_from_slice(&stream(index).normal_pair(k)[..pair.len()]);
    }
    [Box::new(learned.person(&normals)), Box::new(SyntheticGait::of(Person::draw(stream(index), None, None)))]
}

/// Times of many walks in ascending order, us, and how many arrive.
fn walks(learned: &Arc<LearnedGait>, which: usize, search: Search) -> (Vec<f64>, usize) {
    let scene = square();
    let free = FreeSpace::new(&scene, 0.25);
    let grid = ClearanceGrid::new(&free, &free.bounds(), ClearanceGrid::SIDE);
    let ground = Ground::new(free, grid);
    let (from, goal) = (Vec2::new(0.5, 6.0), Vec2::new(6.0, 0.5));
    let field = GoalField::new(ground.grid(), goal);
    let mut found = 0;
    let mut times: Vec<f64> = (0..1000)
        .map(|index| {
            let gait = &people(learned, index)[which];
            let walk = Walk {
                ground: &ground,
                field: &field,
                goal,
                gait: gait.as_ref(),
                share: 1.0,
                stream: stream(index),
                search,
                around: &[],
            };
            let started = Instant::now();
            found += usize::from(black_box(walk.whole(Walker::standing(from, None))).is_ok());
            started.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    (times, found)
}

/// Twenty people who step, against each other in a corridor, at 60 Hz: million agent-steps per second.
fn corridor(gait: &str) -> f64 {
    let text = format!(
        "horizon = 20 s\nstep = 1 s / 60\nscene {{
          wall (0, 0) -- (30, 0)\n wall (0, 6) -- (30, 6)
          region west: rect (1, 0.5) .. (12, 5.5)\n region east: rect (18, 0.5) .. (29, 5.5) }}
        kind walker: stepped {{ gait = {gait} }}
        agents right[10]: walker {{ at = uniform in west; route = east }}
        agents left[10]: walker {{ at = uniform in east; route = west }}"
    );
    let mut draft = Draft::new("corridor.scn", text);
    if gait != "synthetic" {
        draft = draft.file("cmu.gait", LEARNED.as_bytes());
    }
    let model: Model = draft.parse().unwrap_or_else(|errors| panic!("{errors}"));
    let options = Options::default().threads(1);
    let query = "estimate E(max<=20 s (count(a in right: done(a)))) in 0 .. 10 by fixed(trials = 64)";
    let started = Instant::now();
    let report = model.check(query, &options).unwrap_or_else(|errors| panic!("{errors}"));
    let steps: u64 = report.results().iter().map(|result| result.consumed.steps).sum();
    (steps * 20) as f64 / started.elapsed().as_secs_f64() / 1e6
}

fn main() {
    if !std::env::args().any(|word| word == "corridor") {
        time_walks();
    }
    let mut out = std::io::stdout().lock();
    for (name, gait) in [("synthetic", "synthetic"), ("learned", "learned \"cmu.gait\"")] {
        let rates: Vec<f64> = (0..3).map(|_| corridor(gait)).collect();
        let best = rates.iter().copied().fold(0.0, f64::max);
        let _ = writeln!(out, "20 walkers in a corridor, {name}: {best:.2} M agent-steps/s");
    }
}

fn time_walks() {
    let mut out = std::io::stdout().lock();
    let learned = Arc::new(LearnedGait::from_json(LEARNED).unwrap_or_else(|error| panic!("{error}")));
    for (name, which) in [("learned", 0), ("synthetic", 1)] {
        let searches =
            [("guided", Search::default()), ("hybrid A*", Search::HybridAStar(HybridAStar::default()))];
        for (kind, search) in searches {
            let (times, found) = walks(&learned, which, search);
            let _ = writeln!(
                out,
                "walk of 8 m, {name}, {kind}: median {:.0} us, 99 % below {:.0} us, {found} of 1000 found",
                times[500], times[990]
            );
        }
        let gait = &people(&learned, 7)[which];
        let (mut stance, mut foot) = (Stance::default(), Foot::Left);
        let started = Instant::now();
        for k in 0..20_000 {
            stance = gait.step(&stance, foot, 1.0, Draws::of(stream(7), k, 0));
            foot = foot.other();
        }
        black_box(stance);
        let each = started.elapsed().as_secs_f64() * 1e6 / 20_000.0;
        let _ = writeln!(out, "one step drawn, {name}: {each:.2} us");
    }
    let scene = square();
    let free = FreeSpace::new(&scene, 0.25);
    let grid = ClearanceGrid::new(&free, &free.bounds(), ClearanceGrid::SIDE);
    let (from, goal) = (Vec2::new(0.5, 6.0), Vec2::new(6.0, 0.5));
    let started = Instant::now();
    for _ in 0..200 {
        black_box(shortest_cells(&grid, from, goal));
    }
    let each = started.elapsed().as_secs_f64() * 1e6 / 200.0;
    let _ = writeln!(out, "grid A* of {} x {} cells: {each:.0} us", grid.columns(), grid.rows());
    let started = Instant::now();
    for _ in 0..20 {
        black_box(GoalField::new(&grid, goal));
    }
    let _ = writeln!(out, "distance field: {:.0} us", started.elapsed().as_secs_f64() * 1e6 / 20.0);
}
