//! Speed of the moving part: million agent-steps per second on one core, with noise, per-agent parameters
//! and contact. The scenes are rebuilt bit for bit by `splitmix64`: corridor20 (20 m x 4 m, ten against
//! ten), room200 (20 m x 20 m, both directions), open2000 and open20000 (one person a square metre, two
//! streams, no walls), dense200 (four persons a square metre in a box); walls-corridor20 and walls-open2000 are
//! the same scenes with 5 000 pieces of wall beside them.
//!
//! `cargo bench --bench kernel -- [scene ...] [base|avx2|best] [lanes|cells] [own-b|free|cfs] [threads=N]`: best of several, each
//! from the start. `own-b`: every agent has its own range of the social force too; `free`: without contact; `cfs`: the
//! collision-free speed model.

use fearless_simd::Level;
use smc::base::decimal::Decimal;
use smc::base::geometry::{Segment, Vec2};
use smc::base::lanes::Mask;
use smc::base::random::TrialKey;
use smc::base::tick::{Clock, Tick};
use smc::engine::Threads;
use smc::kernel::{Layout, Program, Scratch, State, refresh, step};
use smc::model::{
    Agent, Barrier, Body, Family, Kind, Law, Obstacle, Parameter, Route, Scenario, Scene as Surroundings,
    Start,
};
use std::io::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

struct SplitMix64(u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }
}

/// Points on a near-square lattice, each moved by at most `jitter` times half the gap.
fn lattice(n: usize, low: (f64, f64), high: (f64, f64), jitter: f64, rng: &mut SplitMix64) -> Vec<Vec2> {
    let (w, h) = (high.0 - low.0, high.1 - low.1);
    let columns = ((n as f64 * w / h).sqrt().round() as usize).max(1);
    let (dx, dy) = (w / columns as f64, h / n.div_ceil(columns) as f64);
    (0..n)
        .map(|k| {
            let (i, j) = ((k % columns) as f64, (k / columns) as f64);
            let x = low.0 + (i + 0.5) * dx + jitter * dx * (rng.uniform() - 0.5);
            let y = low.1 + (j + 0.5) * dy + jitter * dy * (rng.uniform() - 0.5);
            Vec2::new(x, y)
        })
        .collect()
}

struct Walker {
    at: Vec2,
    speed: f64,
    /// Abscissa of the goal, straight ahead.
    goal: f64,
}

struct Scene {
    name: String,
    walkers: Vec<Walker>,
    walls: Vec<Segment>,
    steps: usize,
}

fn room(w: f64, h: f64) -> Vec<Segment> {
    let p = |x, y| Vec2::new(x, y);
    vec![
        Segment::new(p(0.0, 0.0), p(w, 0.0)),
        Segment::new(p(w, 0.0), p(w, h)),
        Segment::new(p(w, h), p(0.0, h)),
        Segment::new(p(0.0, h), p(0.0, 0.0)),
    ]
}

fn corridor20() -> Scene {
    let mut rng = SplitMix64(1);
    let mut walkers = Vec::new();
    for (low, high, goal) in [(0.5, 5.5, 19.6), (14.5, 19.5, 0.4)] {
        for at in lattice(10, (low, 0.4), (high, 3.6), 0.3, &mut rng) {
            walkers.push(Walker { at, speed: 1.1 + 0.5 * rng.uniform(), goal });
        }
    }
    Scene { name: "corridor20".into(), walkers, walls: room(20.0, 4.0), steps: 1000 }
}

fn by_coin(points: Vec<Vec2>, goals: impl Fn(Vec2) -> (f64, f64), rng: &mut SplitMix64) -> Vec<Walker> {
    let walker = |at: Vec2| {
        let (right, left) = goals(at);
        let goal = if rng.next() & 1 == 1 { right } else { left };
        Walker { at, speed: 1.1 + 0.5 * rng.uniform(), goal }
    };
    points.into_iter().map(walker).collect()
}

fn room200() -> Scene {
    let mut rng = SplitMix64(2);
    let points = lattice(200, (0.5, 0.5), (19.5, 19.5), 0.3, &mut rng);
    let walkers = by_coin(points, |_| (19.5, 0.5), &mut rng);
    Scene { name: "room200".into(), walkers, walls: room(20.0, 20.0), steps: 600 }
}

fn dense200() -> Scene {
    let mut rng = SplitMix64(4);
    let points = lattice(200, (0.3, 0.3), (9.7, 4.7), 0.1, &mut rng);
    let walkers = by_coin(points, |_| (9.5, 0.5), &mut rng);
    Scene { name: "dense200".into(), walkers, walls: room(10.0, 5.0), steps: 200 }
}

fn open(n: usize) -> Scene {
    let mut rng = SplitMix64(3);
    let side = (n as f64).sqrt();
    let points = lattice(n, (0.0, 0.0), (side, side), 0.3, &mut rng);
    let walkers = by_coin(points, |at| (at.x + 60.0, at.x - 60.0), &mut rng);
    Scene { name: format!("open{n}"), walkers, walls: Vec::new(), steps: (2_000_000 / n).clamp(20, 400) }
}

/// A building of ten rows of sixteen rooms of 10 m by 10 m, each with a door of 1.2 m, and corridors of 4 m between the rows.
fn rooms(rows: usize, columns: usize) -> Vec<Segment> {
    let mut walls = Vec::new();
    let mut wall = |a, b| walls.push(Segment::new(a, b));
    let width = columns as f64 * 10.0;
    for row in 0..rows {
        let y = row as f64 * 14.0;
        wall(Vec2::new(0.0, y), Vec2::new(width, y));
        for column in 0..=columns {
            let x = column as f64 * 10.0;
            wall(Vec2::new(x, y), Vec2::new(x, y + 10.0));
        }
        for column in 0..columns {
            let x = column as f64 * 10.0;
            wall(Vec2::new(x, y + 10.0), Vec2::new(x + 4.4, y + 10.0));
            wall(Vec2::new(x + 5.6, y + 10.0), Vec2::new(x + 10.0, y + 10.0));
        }
    }
    walls
}

/// In the rooms of a building of 500 walls: each walks in their room.
fn building(n: usize) -> Scene {
    let mut rng = SplitMix64(6);
    let mut walkers = Vec::new();
    let each = n / 160;
    for room in 0..160 {
        let (x, y) = ((room % 16) as f64 * 10.0, (room / 16) as f64 * 14.0);
        let count = each + usize::from(room < n % 160);
        let points = lattice(count, (x + 0.4, y + 0.4), (x + 9.6, y + 9.6), 0.2, &mut rng);
        walkers.extend(by_coin(points, |_| (x + 9.2, x + 0.8), &mut rng));
    }
    Scene { name: format!("building{n}"), walkers, walls: rooms(10, 16), steps: 100 }
}

/// Four persons who stand in each of 100 rooms, among 400 pieces of wall.
fn standing() -> Scene {
    let mut rng = SplitMix64(7);
    let (mut walkers, mut walls) = (Vec::new(), Vec::new());
    for room in 0..100 {
        let low = Vec2::new(f64::from(room % 10) * 5.0, f64::from(room / 10) * 5.0);
        let corner = |x, y| low + Vec2::new(x, y);
        for (a, b) in [
            (corner(0.0, 0.0), corner(2.0, 0.0)),
            (corner(3.0, 0.0), corner(5.0, 0.0)),
            (corner(0.0, 0.0), corner(0.0, 2.0)),
            (corner(0.0, 3.0), corner(0.0, 5.0)),
        ] {
            walls.push(Segment::new(a, b));
        }
        for at in lattice(4, (low.x + 0.5, low.y + 0.5), (low.x + 4.5, low.y + 4.5), 0.3, &mut rng) {
            walkers.push(Walker { at, speed: 0.0, goal: at.x });
        }
    }
    Scene { name: "standing400".into(), walkers, walls, steps: 1000 }
}

/// Among as many pieces of wall as an imported building has, most of them far from everybody: a field of
/// 5 000 beside the scene.
fn among_walls(mut scene: Scene, far: f64) -> Scene {
    let mut rng = SplitMix64(5);
    for at in lattice(5_000, (far, 0.0), (far + 150.0, 100.0), 0.3, &mut rng) {
        let end = at + Vec2::new(2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0);
        scene.walls.push(Segment::new(at, end));
    }
    scene.name.insert_str(0, "walls-");
    scene
}

/// Beside eight people far away, who must not make the crowd slower.
fn far_from_some(mut scene: Scene) -> Scene {
    for k in 1..=8 {
        let at = Vec2::new(1e5 * f64::from(k), 9e5);
        scene.walkers.push(Walker { at, speed: 1.3, goal: at.x + 60.0 });
    }
    scene.name.insert_str(0, "far-");
    scene
}

fn uniform(low: f64, high: f64) -> Law {
    Law::Random { family: Family::Uniform { low, high }, low, high }
}

/// How the people of a scene walk.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Walk {
    /// Social forces with contact.
    Contact,
    /// The same, and each agent has its own range.
    OwnRange,
    /// Social forces without contact.
    Free,
    /// Collision-free speeds.
    Speeds,
}

impl Walk {
    fn named(word: &str) -> Option<Self> {
        Some(match word {
            "contact" => Self::Contact,
            "own-b" => Self::OwnRange,
            "free" => Self::Free,
            "cfs" => Self::Speeds,
            _ => return None,
        })
    }
}

fn scenario(scene: &Scene, walk: Walk) -> Scenario {
    let kind = if walk == Walk::Speeds { Kind::Cfs } else { Kind::Sfm };
    let body = Arc::new(Body::new(kind, |parameter| match parameter {
        Parameter::K1 | Parameter::K2 if walk == Walk::Free => Law::Constant(0.0),
        Parameter::Mass => uniform(60.0, 90.0),
        Parameter::Radius => uniform(0.2, 0.28),
        Parameter::Speed => uniform(1.1, 1.6),
        Parameter::Tau => uniform(0.4, 0.6),
        Parameter::A => uniform(1800.0, 2200.0),
        Parameter::B if walk == Walk::OwnRange => uniform(0.07, 0.09),
        Parameter::B => Law::Constant(0.08),
        Parameter::Lambda => uniform(0.2, 0.4),
        Parameter::K1 => Law::Constant(1.2e5),
        Parameter::K2 => Law::Constant(2.4e5),
        Parameter::Noise => Law::Constant(0.08),
        other => Law::Constant(other.description().default.unwrap_or(0.0)),
    }));
    let agent = |(k, walker): (usize, &Walker)| Agent {
        name: format!("walker[{}]", k + 1),
        entity: k as u32,
        body: body.clone(),
        start: Start::at_rest(walker.at),
        route: Route::Onward,
        group: None,
        particle: None,
    };
    Scenario {
        title: scene.name.clone(),
        clock: Clock::Stepped(Decimal::parse("0.01").expect("a number")),
        horizon: Tick(100_000),
        scene: Surroundings {
            barriers: scene
                .walls
                .iter()
                .map(|&wall| Barrier { name: String::new(), obstacle: Obstacle::Wall(vec![wall]) })
                .collect(),
            regions: Vec::new(),
            ..Surroundings::default()
        },
        agents: scene.walkers.iter().enumerate().map(agent).collect(),
        groups: Vec::new(),
        moves: Vec::new(),
        processes: smc::model::Processes::default(),
        behaviours: smc::model::Behaviours::default(),
        sources: Vec::new(),
        doors: Vec::new(),
    }
}

fn loaded(scene: &Scene, layout: Layout, walk: Walk) -> State {
    let mut state = State::new(layout, scene.walkers.len());
    let width = state.width();
    let mut rng = SplitMix64(77);
    for lane in 0..width {
        state.occupied |= Mask::lane(lane);
        state.keys[lane] = TrialKey { seed: 1, index: lane as u64, branch: 0 };
        for (k, walker) in scene.walkers.iter().enumerate() {
            let slot = state.slot(k, lane);
            let (b, l) = (slot.block, slot.lane);
            let ahead = if walker.goal > walker.at.x { 1.0 } else { -1.0 };
            let mut between = |low: f64, high: f64| low + (high - low) * rng.uniform();
            state.present[b] |= Mask::lane(l);
            state.motion.x[b].0[l] = walker.at.x;
            state.motion.y[b].0[l] = walker.at.y;
            state.motion.vx[b].0[l] = ahead * walker.speed;
            state.driving.ex[b].0[l] = ahead;
            state.driving.ey[b].0[l] = 0.0;
            state.driving.speed[b].0[l] = walker.speed;
            state.bodies[Parameter::Speed][b].0[l] = walker.speed;
            if walk == Walk::Speeds {
                for parameter in Parameter::of_kind(Kind::Cfs) {
                    state.bodies[parameter][b].0[l] = parameter.description().default.unwrap_or(0.0);
                }
                state.bodies[Parameter::Mass][b].0[l] = 80.0;
                state.bodies[Parameter::Speed][b].0[l] = walker.speed;
                state.bodies[Parameter::Radius][b].0[l] = between(0.2, 0.28);
                state.bodies[Parameter::Noise][b].0[l] = 0.08;
                continue;
            }
            state.bodies[Parameter::Mass][b].0[l] = between(60.0, 90.0);
            state.bodies[Parameter::Radius][b].0[l] = between(0.2, 0.28);
            state.bodies[Parameter::Tau][b].0[l] = between(0.4, 0.6);
            state.bodies[Parameter::A][b].0[l] = between(1800.0, 2200.0);
            state.bodies[Parameter::B][b].0[l] =
                if walk == Walk::OwnRange { between(0.07, 0.09) } else { 0.08 };
            state.bodies[Parameter::Lambda][b].0[l] = between(0.2, 0.4);
            let touched = if walk == Walk::Free { 0.0 } else { 1.0 };
            state.bodies[Parameter::K1][b].0[l] = touched * 1.2e5;
            state.bodies[Parameter::K2][b].0[l] = touched * 2.4e5;
            state.bodies[Parameter::Noise][b].0[l] = 0.08;
        }
    }
    state
}

/// Who is at the goal stands.
fn arrive(scene: &Scene, state: &mut State) {
    for lane in 0..state.width() {
        for (k, walker) in scene.walkers.iter().enumerate() {
            let slot = state.slot(k, lane);
            if (state.motion.x[slot.block].0[slot.lane] - walker.goal)
                * state.driving.ex[slot.block].0[slot.lane]
                > -0.5
            {
                state.driving.speed[slot.block].0[slot.lane] = 0.0;
            }
        }
    }
}

/// Time that this process had a core; the time of day where the system does not say.
struct Stopwatch {
    since: Instant,
    on_core: Option<Duration>,
}

impl Stopwatch {
    #[allow(clippy::disallowed_methods, reason = "this measures time")]
    fn start() -> Self {
        Self { since: Instant::now(), on_core: Self::on_core() }
    }

    #[allow(clippy::disallowed_methods, reason = "the system tells the time on a core in a file")]
    fn on_core() -> Option<Duration> {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
    }

    fn read(&self) -> Duration {
        match (self.on_core, Self::on_core()) {
            (Some(start), Some(end)) => end.saturating_sub(start),
            _ => self.since.elapsed(),
        }
    }
}

fn measure(scene: &Scene, layout: Layout, walk: Walk, level: Level, threads: usize) -> (f64, State) {
    let program = Program::new(Arc::new(scenario(scene, walk)));
    let start = loaded(scene, layout, walk);
    let mut best = Duration::MAX;
    let mut state = start.clone();
    let agent_steps = scene.walkers.len() * state.width() * scene.steps;
    let runs = (4_000_000 / agent_steps).max(1);
    let mut scratch = Scratch::at_level(level);
    scratch.share(threads);
    for _ in 0..4 {
        let clock = Stopwatch::start();
        for _ in 0..runs {
            state.clone_from(&start);
            refresh(&program, &mut state, &mut scratch, Mask::ALL);
            for k in 0..scene.steps {
                if k % 25 == 0 {
                    arrive(scene, &mut state);
                }
                step(&program, &mut state, &mut scratch);
            }
        }
        best = best.min(if threads > 1 { clock.since.elapsed() } else { clock.read() });
    }
    ((runs * agent_steps) as f64 / best.as_secs_f64() / 1e6, state)
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let level = |word: &str| match word {
        "base" => Some(Level::baseline()),
        "best" => Some(Level::new()),
        #[cfg(target_arch = "x86_64")]
        "avx2" => Level::new().as_avx2().map(Level::Avx2),
        _ => None,
    };
    let mut levels: Vec<Level> = words.iter().filter_map(|word| level(word)).collect();
    if levels.is_empty() {
        levels.extend(["base", "avx2", "best"].iter().filter_map(|word| level(word)));
    }
    let layout_of = |word: &str| match word {
        "lanes" => Some(Layout::Trials),
        "cells" => Some(Layout::Agents),
        _ => None,
    };
    let mut layouts: Vec<Layout> = words.iter().filter_map(|word| layout_of(word)).collect();
    if layouts.is_empty() {
        layouts = vec![Layout::Trials, Layout::Agents];
    }
    let mut walks: Vec<Walk> = words.iter().filter_map(|word| Walk::named(word)).collect();
    if walks.is_empty() {
        walks.push(Walk::Contact);
    }
    let threads_of = |word: &str| word.strip_prefix("threads=").and_then(|count| count.parse().ok());
    let threads: usize = words.iter().find_map(|word| threads_of(word)).unwrap_or(1);
    let pool = Threads::new(Some(threads)).unwrap();
    let is_option = |word: &str| {
        threads_of(word).is_some()
            || level(word).is_some()
            || layout_of(word).is_some()
            || Walk::named(word).is_some()
    };
    let wanted: Vec<&String> = words.iter().filter(|word| !is_option(word)).collect();
    let scenes = [
        corridor20(),
        room200(),
        dense200(),
        open(2_000),
        open(20_000),
        open(100_000),
        among_walls(corridor20(), 25.0),
        among_walls(open(2_000), 80.0),
        far_from_some(open(2_000)),
        building(10_000),
        standing(),
    ];
    let mut out = std::io::stdout().lock();
    for scene in scenes {
        if !wanted.is_empty() && !wanted.iter().any(|name| scene.name.starts_with(name.as_str())) {
            continue;
        }
        for &walk in &walks {
            for &layout in &layouts {
                if layout == Layout::Trials && scene.walkers.len() > 500 {
                    continue;
                }
                for &level in &levels {
                    let work = || measure(&scene, layout, walk, level, threads);
                    let (rate, state) = pool.helped(work).unwrap();
                    let checksum: f64 = state.motion.x.iter().flat_map(|lanes| lanes.0).sum();
                    let name = format!("{level:?}");
                    let name = name.split('(').next().unwrap_or_default();
                    let _ = writeln!(
                        out,
                        "{:<11} {:<7} {:<9} {:<8} {rate:7.1} M agent-steps/s  diverged {}  checksum {checksum}",
                        scene.name,
                        format!("{layout:?}"),
                        name,
                        format!("{walk:?}"),
                        state.diverged.iter().count(),
                    );
                }
            }
        }
    }
    let _ = out.flush();
}
