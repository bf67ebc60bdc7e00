//! The driver of agents that find their way around barriers.

use super::atlas::{Atlas, Atlases};
use super::planner::{PathOption, Terrains, Walkers, path_options, walkers};
use super::survey::Doubt;
use super::way::ShortestWay;
use super::{planner, survey};
use crate::base::geometry::{Segment, Shape, Vec2, cross};
use crate::kernel::driver::{Driver, Drivers, Memory, Occasion, Plan, Situation};
use crate::model::{
    Agent, AgentId, Goal, Leg, Obstacle, Parameter, Position, RegionId, Route, Scenario, Scene,
};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Answers with the shortest way to the goal of the leg.
#[derive(Debug)]
struct Wayfinder {
    atlases: Arc<Atlases>,
}

/// How much longer a way may be that keeps off corners, as a share of the shortest.
const MORE: f64 = 0.05;

/// Persons that pass an exit for each of its metres and seconds (SFPE Handbook, Gwynne and Rosenbaum 2016).
const FLOW: f64 = 1.3;
/// Another exit is taken where it saves this share of the time.
const GAIN: f64 = 0.2;
/// Slowest speed by which a way is timed, m/s.
const SLOWEST: f64 = 0.1;

/// Most scenes whose atlases are kept: worlds of a sweep mostly share one.
const KEPT: usize = 8;

/// The atlases of the scenes of a call and the terrains of its planned kinds, each made once.
#[derive(Debug, Default)]
pub struct Ways {
    known: Mutex<VecDeque<Arc<Atlases>>>,
    terrains: Arc<Terrains>,
}

impl Ways {
    /// The atlases of a scene.
    fn atlases(&self, scene: &Scene) -> Arc<Atlases> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(atlas) = known.iter().find(|atlas| atlas.scene() == scene) {
            return Arc::clone(atlas);
        }
        let atlas = Arc::new(Atlases::new(scene.clone()));
        known.truncate(KEPT - 1);
        known.push_front(Arc::clone(&atlas));
        atlas
    }

    /// The ways over the stairs of a scene with levels.
    fn levels(&self, scenario: &Scenario) -> Option<Arc<Atlases>> {
        (!scenario.scene.storeys.are_none()).then(|| self.atlases(&scenario.scene))
    }

    /// The drivers of a run: everybody finds their way, unless their kind plans or goes straight, or no barrier can stand in the way.
    pub fn drivers(&self, scenario: &Scenario, seed: u64) -> Drivers {
        let drivers = walkers(Drivers::new(seed), &self.terrains, scenario, self.levels(scenario));
        let agents = finders(scenario);
        if agents.is_empty() {
            return drivers;
        }
        drivers.with(agents, Arc::new(Wayfinder { atlases: self.atlases(&scenario.scene) }))
    }

    /// The walkers of a scenario that plan.
    pub fn walkers(&self, scenario: &Scenario, seed: u64) -> Walkers {
        Walkers::new(&self.terrains, scenario, seed, self.levels(scenario))
    }

    /// At most so many paths of different classes for an agent, the shortest first.
    pub fn paths(&self, scenario: &Scenario, seed: u64, agent: AgentId, most: usize) -> Vec<PathOption> {
        path_options(&self.terrains, scenario, seed, agent, most)
    }

    /// What is wrong or doubtful with the ways of a scenario, before the first trial: with shortest ways, and with the roadmaps of
    /// a run with a seed.
    pub fn doubts(&self, scenario: &Scenario, seed: u64) -> Vec<Doubt> {
        let others = |id: &AgentId| {
            let body = &scenario.agents[id.0 as usize].body;
            body.planner.is_some() || body.stepper.is_some()
        };
        let others = (0..scenario.agents.len() as u32).map(AgentId).filter(others);
        let mut agents: Vec<AgentId> = finders(scenario).into_iter().chain(others).collect();
        agents.sort_unstable();
        if agents.is_empty() {
            Vec::new()
        } else {
            let planned = |id, who: &str| planner::doubt(&self.terrains, scenario, seed, id, who);
            survey::doubts(self.atlases(&scenario.scene).of(0), scenario, &agents, planned)
        }
    }
}

/// The agents that find their way.
fn finders(scenario: &Scenario) -> Vec<AgentId> {
    let chooses = scenario.routes().flat_map(Route::goals).any(|goal| scenario.scene.chooses(goal));
    let is_flat = scenario.scene.storeys.are_none();
    if !chooses && is_flat && (scenario.scene.barriers.is_empty() || is_open(scenario)) {
        return Vec::new();
    }
    let finds = |id: &AgentId| scenario.agents[id.0 as usize].body.finds_ways;
    (0..scenario.agents.len() as u32).map(AgentId).filter(finds).collect()
}

/// The drivers of a run: everybody finds their way, unless their kind goes straight, or no barrier can stand in the way.
pub fn drivers(scenario: &Scenario, seed: u64) -> Drivers {
    Ways::default().drivers(scenario, seed)
}

/// Whether an agent may have another radius in another trial.
pub(super) fn is_drawn(agent: &Agent) -> bool {
    agent.particle.is_some() || agent.body[Parameter::Radius].constant().is_none()
}

impl Driver for Wayfinder {
    fn plan(&self, situation: &Situation<'_>, memory: &mut Memory) -> Plan {
        let Some(goal) = situation.goal() else { return Plan::Straight };
        let exits = match goal {
            Goal::Region(id) => situation.scenario.scene.regions[id.0 as usize].exits.as_slice(),
            Goal::Point(_) => &[],
        };
        // Whoever has no way while doors are closed waits before one of them.
        let mut plan = |closed| {
            let atlas = self.atlases.of(closed);
            if !exits.is_empty() {
                return quickest(atlas, situation, exits, memory);
            }
            match way(atlas, situation, goal) {
                Some(way) if way.is_straight => Plan::Straight,
                Some(way) => Plan::Way(way.points().into()),
                None => Plan::NoWay,
            }
        };
        let closed = situation.closed_doors();
        let found = plan(closed);
        if found == Plan::NoWay && closed != 0 { plan(0) } else { found }
    }
}

/// The shortest way to a goal, or one that keeps off corners and is hardly longer.
fn way(atlas: &Atlas, situation: &Situation<'_>, goal: &Goal) -> Option<ShortestWay> {
    let (radius, climbs) = class(situation);
    let way = atlas.way_of((radius, climbs), situation.position, goal);
    let aside = situation.parameter(Parameter::Aside);
    let wide = way.as_ref().filter(|way| aside > 0.0 && !way.is_straight).and_then(|way| {
        let wide = atlas.way_of((Atlas::class(radius + aside, true), climbs), situation.position, goal);
        wide.filter(|wide| wide.length <= way.length * (1.0 + MORE) + aside)
    });
    wide.or(way)
}

/// The way to the quickest exit (Ehtamo, Heliövaara, Korhonen and Hostikka 2010): each person answers the present choices of
/// the others. The time to an exit is that of the way at one's own speed, and that in which those who head for it and are
/// nearer pass it. The exit that was chosen before is kept unless another one saves a fifth of its time.
fn quickest(atlas: &Atlas, situation: &Situation<'_>, exits: &[RegionId], memory: &mut Memory) -> Plan {
    let speed = situation.parameter(Parameter::Speed);
    let speed = if speed > SLOWEST { speed } else { SLOWEST };
    let others: Vec<(Vec2, Vec2)> = situation.ends().collect();
    let before = memory.get::<RegionId>().copied();
    let mut best: Option<(f64, RegionId)> = None;
    for exit in exits {
        let shape = &situation.scenario.scene.regions[exit.0 as usize].shape;
        let way = atlas.way_of(class(situation), situation.position, &Goal::Region(*exit));
        let Some(way) = way else { continue };
        let is_ahead = |(at, end): &&(Vec2, Vec2)| shape.contains(*end) && (at - end).norm() < way.length;
        let waiting = others.iter().filter(is_ahead).count() as f64;
        let time = way.length / speed + waiting / (FLOW * width(shape, way.end));
        let time = if before == Some(*exit) { time * (1.0 - GAIN) } else { time };
        if best.as_ref().is_none_or(|best| time < best.0) {
            best = Some((time, *exit));
        }
    }
    let Some((_, exit)) = best else { return Plan::NoWay };
    if before == Some(exit) && situation.occasion == Occasion::Looks {
        return Plan::Keep;
    }
    memory.put(exit);
    way(atlas, situation, &Goal::Region(exit)).map_or(Plan::NoWay, |way| Plan::Way(way.points().into()))
}

/// The radius for which ways of a body are looked up, m, and its share of the speeds on stairs.
fn class(situation: &Situation<'_>) -> (f64, f64) {
    let agent = &situation.scenario.agents[situation.agent.0 as usize];
    (Atlas::class(situation.parameter(Parameter::Radius), is_drawn(agent)), agent.body.stairs)
}

/// The width of an exit where a way ends in it, m: the length of the nearest side, or the diameter.
fn width(exit: &Shape, end: Vec2) -> f64 {
    match exit {
        Shape::Circle { radius, .. } => 2.0 * radius,
        Shape::Polygon(polygon) => {
            let nearer = |a: Segment, b: Segment| if b.distance(end) < a.distance(end) { b } else { a };
            polygon.segments().reduce(nearer).map_or(1.0, |side| side.length())
        }
        Shape::Parts(parts) => {
            let part = parts.iter().find(|part| part.contains(end)).or(parts.first());
            part.map_or(1.0, |part| width(part, end))
        }
    }
}

// Scenes in which nothing can stand in the way: all barriers lie on the rim of a convex part of the plane in which everybody
// starts and has all goals. There everybody goes straight, and no ways are looked for.

/// The convex hull of points, counterclockwise (Andrew 1979).
fn hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = &Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for &p in points {
            while let [.., a, b] = *chain.as_slice()
                && cross(b - a, p - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut out = half(&mut points.iter());
    out.extend(half(&mut points.iter().rev()));
    out
}

fn corners(shape: &Shape) -> Vec<Vec2> {
    match shape {
        Shape::Polygon(polygon) => polygon.outline.clone(),
        Shape::Parts(parts) => parts.iter().flat_map(corners).collect(),
        Shape::Circle { .. } => {
            let b = shape.bounds();
            vec![b.low, Vec2::new(b.high.x, b.low.y), b.high, Vec2::new(b.low.x, b.high.y)]
        }
    }
}

/// Whether no barrier of a scenario can stand in anybody's way.
fn is_open(scenario: &Scenario) -> bool {
    let mut edges: Vec<Segment> = Vec::new();
    for barrier in &scenario.scene.barriers {
        match &barrier.obstacle {
            Obstacle::Wall(segments) => edges.extend(segments),
            Obstacle::Solid(_) => return false,
        }
    }
    let mut points: Vec<Vec2> = edges.iter().flat_map(|edge| [edge.a, edge.b]).collect();
    for agent in &scenario.agents {
        match &agent.start.position {
            Position::Point(point) => points.push(*point),
            Position::Within(shape) => points.extend(corners(shape)),
            Position::Near { .. } if edges.is_empty() => {}
            Position::Near { .. } => return false,
        }
    }
    points.extend(scenario.routes().flat_map(|route| goals(scenario, route)));
    let rim = hull(points);
    let is_on_rim = |edge: &Segment| {
        (0..rim.len()).any(|k| {
            let side = Segment::new(rim[k], rim[(k + 1) % rim.len()]);
            side.distance(edge.a) <= 1e-9 && side.distance(edge.b) <= 1e-9
        })
    };
    edges.iter().all(is_on_rim)
}

fn goals<'a>(scenario: &'a Scenario, route: &'a Route) -> impl Iterator<Item = Vec2> + 'a {
    route.legs().iter().flat_map(|leg| match leg {
        Leg::To(Goal::Point(point)) => vec![*point],
        Leg::To(Goal::Region(id)) => {
            scenario.scene.regions.get(id.0 as usize).map_or(Vec::new(), |region| corners(&region.shape))
        }
        Leg::Wait(_) => Vec::new(),
    })
}
