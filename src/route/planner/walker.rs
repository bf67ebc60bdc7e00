//! The driver of walkers that plan.

use super::errand::{Errand, Floor};
use super::options::{PathOption, path_options};
use super::speeds::{Course, Speeds};
use super::terrain::{Terrain, Terrains, widest};
use crate::base::geometry::Vec2;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::kernel::driver::{Driver, Drivers, Limits, Memory, Occasion, Plan, Situation};
use crate::model::{AgentId, Goal, Leg, Move, Parameter, RoadmapRule, Scenario};
use crate::route::atlas::Atlases;
use crate::route::roadmap::shortest;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// Largest correction towards the plan, as a share of the largest speed.
const CORRECTION: f64 = 0.3;
/// Farther than this from the plan, m, the time of the plan stands still.
const LAG: f64 = 0.5;
/// Who is nearer to where the errand ends has nothing to plan, m.
const THERE: f64 = 0.1;
/// How long somebody stands until the driver looks again, s.
const PAUSE: f64 = 0.5;
/// So far behind the line of stairs a plan would end, m: nobody slows down for it.
const BEYOND: f64 = 2.0;
/// Draws of one plan: knots, and those that are put between them.
const DRAWS: u32 = 1 << 10;

/// The walkers of a run.
#[derive(Debug)]
pub struct Walkers {
    terrains: Arc<Terrains>,
    /// The ways over the stairs of a scene with levels.
    levels: Option<Arc<Atlases>>,
    seed: u64,
    /// The terrain of each agent whose roadmap does not depend on where it goes, on each island.
    terrain: BTreeMap<(AgentId, usize), OnceLock<Option<Arc<Terrain>>>>,
    /// The paths of those who may be advised to take one, and how many there are at most; found when they are first needed.
    paths: BTreeMap<AgentId, (usize, OnceLock<Vec<PathOption>>)>,
}

/// Who needs a plan, and from where.
#[derive(Clone, Copy, Debug)]
pub struct Wish<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The agent.
    pub agent: AgentId,
    /// Addresses the draws of the person: trial, number of the person, and which plan of theirs it is.
    pub address: (TrialKey, u32, u32),
    /// Where it is, m, and its velocity, m/s.
    pub motion: (Vec2, Vec2),
    /// The legs of its route that are left.
    pub legs: &'a [Leg],
    /// What it can do and wants.
    pub speeds: Speeds,
    /// The class of paths that it is advised to take.
    pub path: Option<u32>,
}

/// A plan.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Where it was made.
    pub terrain: Arc<Terrain>,
    /// The corners of its path, m.
    pub corners: Vec<Vec2>,
    /// The path and the speeds along it; none where there is nowhere to go.
    pub course: Option<Course>,
}

/// All agents of a scenario that plan.
fn planned(scenario: &Scenario) -> impl Iterator<Item = AgentId> + '_ {
    let plans = |id: &AgentId| scenario.agents[id.0 as usize].body.planner.is_some();
    (0..scenario.agents.len() as u32).map(AgentId).filter(plans)
}

/// Gives all agents that plan their driver.
pub(in crate::route) fn walkers(
    drivers: Drivers,
    terrains: &Arc<Terrains>,
    scenario: &Scenario,
    levels: Option<Arc<Atlases>>,
) -> Drivers {
    if planned(scenario).next().is_none() {
        return drivers;
    }
    let walkers = Walkers::new(terrains, scenario, drivers.seed(), levels);
    drivers.with(planned(scenario), Arc::new(walkers))
}

impl Walkers {
    /// Of a scenario, in a run with a seed; with the ways over stairs where its scene has levels.
    pub(in crate::route) fn new(
        terrains: &Arc<Terrains>,
        scenario: &Scenario,
        seed: u64,
        levels: Option<Arc<Atlases>>,
    ) -> Self {
        let declared = scenario.moves.iter().filter(|moves| moves.paths.is_some());
        let most = |options: &[(String, Move)]| {
            let class = |option| if let Move::Path(k) = option { Some(k as usize + 1) } else { None };
            options.iter().filter_map(|(_, option)| class(*option)).max().unwrap_or(0)
        };
        let is_fixed = |id: &AgentId| {
            let planner = &scenario.agents[id.0 as usize].body.planner;
            planner.as_ref().is_some_and(|planner| matches!(planner.roadmap, RoadmapRule::Prm { .. }))
        };
        let islands = scenario.scene.storeys.islands.len().max(1);
        let fixed = planned(scenario).filter(is_fixed);
        let fixed = fixed.flat_map(|id| (0..islands).map(move |island| ((id, island), OnceLock::new())));
        Self {
            terrains: Arc::clone(terrains),
            levels,
            seed,
            terrain: fixed.collect(),
            paths: declared.map(|moves| (moves.agent, (most(&moves.options), OnceLock::new()))).collect(),
        }
    }

    /// The terrain of an agent on a floor, on the way to a goal.
    fn terrain(
        &self,
        floor: &Floor<'_>,
        scenario: &Scenario,
        id: AgentId,
        goal: &Goal,
    ) -> Option<Arc<Terrain>> {
        let find = || self.terrains.of(floor.scene, &scenario.agents[id.0 as usize], goal, self.seed);
        self.terrain.get(&(id, floor.island)).map_or_else(find, |known| known.get_or_init(find).clone())
    }

    /// The floor on which an agent does the next part of its errand; `None` without a way.
    fn floor<'a>(
        &'a self,
        scenario: &'a Scenario,
        id: AgentId,
        from: Vec2,
        legs: &[Leg],
    ) -> Option<Floor<'a>> {
        let (scene, body) = (&scenario.scene, &scenario.agents[id.0 as usize].body);
        let Some(levels) = &self.levels else {
            return Some(Floor { scene, island: 0, storeys: &scene.storeys, legs: legs.len(), over: None });
        };
        let (Some(Leg::To(goal)), Some(planner)) = (legs.first(), &body.planner) else { return None };
        let atlas = levels.of(0);
        let storeys = &scene.storeys;
        let island = storeys.island_at(from);
        let reach = widest(&body[Parameter::Radius]) + planner.clearance;
        let way = atlas.way_of((reach, body.stairs), from, goal)?;
        let is_here = |p: Vec2| storeys.island_at(p) == island;
        let stays = |leg: &&Leg| match leg {
            Leg::To(Goal::Point(p)) => is_here(*p),
            Leg::To(Goal::Region(id)) => {
                let parts = scene.regions[id.0 as usize].shape.parts();
                parts.iter().all(|part| is_here(part.inner_point()))
            }
            Leg::Wait(_) => false,
        };
        let over = way.over.map(|(portal, _)| [way.end, way.end + storeys.portals[portal].across * BEYOND]);
        let legs = if over.is_some() { 0 } else { 1 + legs[1..].iter().take_while(stays).count() };
        Some(Floor { scene: atlas.islands[island].scene(), island, storeys, legs, over })
    }

    /// The path of a class.
    fn option(&self, scenario: &Scenario, id: AgentId, class: u32) -> Option<&PathOption> {
        let (most, found) = self.paths.get(&id)?;
        found.get_or_init(|| path_options(&self.terrains, scenario, self.seed, id, *most)).get(class as usize)
    }

    /// The corners of a way through all goals of an errand.
    fn corners(&self, wish: &Wish<'_>, terrain: &Terrain, errand: &Errand) -> Option<Vec<Vec2>> {
        let (free, sight) = (&terrain.free, terrain.free.sight());
        let is_free = |a: Vec2, b: Vec2| free.is_clear(a, b);
        // The advice is about the way to the first goal of the route.
        let mut advised = wish.path.and_then(|class| self.option(wish.scenario, wish.agent, class));
        let mut corners = vec![wish.motion.0];
        for &goal in &errand.points {
            let from = *corners.last()?;
            let part = match advised.take() {
                Some(option) => {
                    let part = option.way(terrain, from, goal)?;
                    let word = free.rays().word(&part);
                    wish.speeds.straightened(part, sight, is_free, |points| free.rays().word(points) == word)
                }
                None => {
                    let part = shortest(&terrain.roadmap, free, from, goal)?;
                    wish.speeds.straightened(part, sight, is_free, |_| true)
                }
            };
            corners.extend(part.into_iter().skip(1));
        }
        // Behind a line of stairs nothing is to be tested: one goes on elsewhere.
        corners.extend(errand.beyond);
        Some(corners)
    }

    /// A plan through the goals up to the next pause; `None` without a way.
    pub fn outline(&self, wish: &Wish<'_>) -> Option<Outline> {
        let Some(Leg::To(goal)) = wish.legs.first() else { return None };
        let floor = self.floor(wish.scenario, wish.agent, wish.motion.0, wish.legs)?;
        let terrain = self.terrain(&floor, wish.scenario, wish.agent, goal)?;
        let errand = wish.errand(&floor, &terrain);
        if wish.speeds.radius > terrain.radius {
            return None;
        }
        let corners = self.corners(wish, &terrain, &errand)?;
        let first = wish.address.2.wrapping_mul(DRAWS) & !(1 << 31);
        let stream = wish.stream();
        let draw = |knot: u32| stream.uniform_pair(first + knot % DRAWS);
        let course =
            wish.speeds.course(&corners, errand.through(), terrain.free.sight(), wish.motion.1, draw).ok();
        Some(Outline { terrain, corners, course })
    }
}

impl Wish<'_> {
    fn stream(&self) -> Stream {
        Stream::of(self.address.0, self.address.1, Purpose::Plan)
    }

    fn errand(&self, floor: &Floor<'_>, terrain: &Terrain) -> Errand {
        let mut errand =
            Errand::new(floor, terrain, self.legs, (self.motion.0, self.speeds.radius), self.stream());
        // Whoever stands at a line of stairs has only to cross it.
        let is_there = |p: &Vec2| (p - self.motion.0).norm() < THERE;
        errand.points.retain(|p| floor.over.is_none() || !is_there(p));
        errand
    }
}

impl Driver for Walkers {
    fn plan(&self, situation: &Situation<'_>, _: &mut Memory) -> Plan {
        let Some(goal) = situation.goal() else {
            // In a pause the plan goes on to its end.
            return match (situation.occasion, situation.plan) {
                (Occasion::Ended, _) => Plan::Stand(f64::INFINITY),
                (_, Plan::Follow(..)) => Plan::Keep,
                _ => Plan::Straight,
            };
        };
        let (scenario, id) = (situation.scenario, situation.agent);
        let Some(planner) = scenario.agents[id.0 as usize].body.planner.as_ref() else {
            return Plan::Straight;
        };
        let of = |parameter| situation.parameter(parameter);
        let speeds = Speeds::new(of, situation.own_speed, planner.profile);
        let speeds = Speeds { rounding: planner.rounding, ..speeds };
        let wish = Wish {
            scenario,
            agent: id,
            address: (situation.key, situation.entity, situation.asked),
            motion: (situation.position, situation.velocity),
            legs: situation.legs,
            speeds,
            path: situation.path,
        };
        let Some(floor) = self.floor(scenario, id, situation.position, situation.legs) else {
            return Plan::NoWay;
        };
        let Some(terrain) = self.terrain(&floor, scenario, id, goal) else { return Plan::Straight };
        let errand = wish.errand(&floor, &terrain);
        let Some(end) = errand.end() else { return Plan::Straight };
        match (situation.occasion, situation.plan) {
            // The plan leads on through the next goal.
            (Occasion::Leg, Plan::Follow(trajectory, _))
                if (trajectory.at(trajectory.duration())[0] - end).norm() < THERE =>
            {
                return Plan::Keep;
            }
            // Where somebody is who has lagged behind is known when they stand.
            (Occasion::Ended, Plan::Follow(..)) => return Plan::Stand(PAUSE),
            _ => {}
        }
        if errand.points.len() == 1 && (situation.position - end).norm() < THERE {
            return Plan::Stand(PAUSE);
        }
        let Some(outline) = self.outline(&wish) else { return Plan::NoWay };
        let Some(trajectory) = outline.course.and_then(|course| course.trajectory()) else {
            return Plan::Stand(PAUSE);
        };
        let correction = CORRECTION * speeds.limits.speed;
        let leave = situation.parameter(Parameter::Replan);
        Plan::Follow(Arc::new(trajectory), Limits { correction, lag: LAG, leave })
    }
}
