//! The driver of walkers that step: a step at a time, or all steps to a goal, from the gait of each person.

use super::model::LearnedGait;
use super::synthetic::{Person, SyntheticGait};
use super::walk::{Ground, HybridAStar, NoStep, OtherBody, PlacedStep, Search, Walk, Walker, least_gap};
use super::{Foot, Gait, SPANS};
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::base::random::{Purpose, Stream, name_hash};
use crate::kernel::driver::{Driver, Drivers, Memory, Occasion, Plan, Sample, Situation, Trajectory};
use crate::kernel::{Slot, State};
use crate::model::{Agent, AgentId, GaitRule, Goal, Leg, Parameter, Position, Scenario, SearchRule};
use crate::route::Ways;
use crate::route::grid::{ClearanceGrid, GoalField};
use crate::route::planner::{exits, middle, point_in, shortest_of, widest};
use crate::route::roadmap::FreeSpace;
use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

/// Side of the cells of distance fields, m.
const CELL: f64 = 0.08;
/// How long somebody stands until another step is looked for, s.
const PAUSE: f64 = 0.25;
/// After so many pauses a way around those who stand there is searched.
const TRIES: u32 = 3;
/// After so many pauses next to those who stand in its goal somebody is there.
const WAITS: u32 = 8;
/// Most steps that this search expands.
const AROUND: u32 = 300;
/// Whoever is farther away when a step begins does not change it, m.
const SEEN: f64 = 4.0;
/// Slower bodies stand, m/s.
const STANDS: f64 = 0.1;
/// A heading leads to a point so far away, m.
const FAR: f64 = 1000.0;
/// Room around the scene and all starts, m.
const ROOM: f64 = 2.0;

/// The floor for bodies of one radius, and the ways to the goals on it, each made when it is first needed.
#[derive(Debug)]
struct Floor {
    ground: Ground,
    radius: f64,
    fields: RwLock<Vec<(Vec2, Arc<GoalField>)>>,
}

impl Floor {
    fn new(scenario: &Scenario, radius: f64) -> Self {
        let free = FreeSpace::new(&scenario.scene, radius);
        let Bounds { low, high } = free.bounds();
        let start = |agent: &Agent| match &agent.start.position {
            Position::Point(point) => vec![*point],
            Position::Within(shape) => vec![shape.bounds().low, shape.bounds().high],
            Position::Near { .. } => Vec::new(),
        };
        let goal = |goal: &Goal| if let Goal::Point(point) = goal { Some(*point) } else { None };
        let agents = &scenario.agents;
        let all =
            agents.iter().flat_map(start).chain(agents.iter().flat_map(|a| a.route.goals().filter_map(goal)));
        let around = Bounds::around(all.chain([low, high])).unwrap_or(Bounds { low, high });
        let room = Vec2::repeat(ROOM + 2.0 * radius);
        let bounds = Bounds { low: around.low - room, high: around.high + room };
        let grid = ClearanceGrid::new(&free, &bounds, CELL);
        Self { ground: Ground::new(free, grid), radius, fields: RwLock::default() }
    }

    /// Which of several exits has the shortest way from a place.
    fn nearest(&self, from: Vec2, exits: &[Shape]) -> usize {
        let length = |exit: &Shape| {
            let goal = exit.inner_point();
            self.field(goal).way(self.ground.grid(), from, goal).map(|way| way.length)
        };
        if exits.len() < 2 { 0 } else { shortest_of(exits.iter().map(length)) }
    }

    /// The ways to a place.
    fn field(&self, goal: Vec2) -> Arc<GoalField> {
        let known = self.fields.read().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, field)) = known.iter().find(|(at, _)| *at == goal) {
            return Arc::clone(field);
        }
        drop(known);
        let field = Arc::new(GoalField::new(self.ground.grid(), goal));
        let mut known = self.fields.write().unwrap_or_else(PoisonError::into_inner);
        known.push((goal, Arc::clone(&field)));
        field
    }
}

/// What the driver remembers of a person.
#[derive(Clone, Debug)]
struct Remembered {
    walker: Walker,
    person: Arc<dyn Gait + Send + Sync>,
    /// The goal of the present leg, how many legs are left, and the point that is drawn.
    goal: Option<(Goal, usize)>,
    /// Which exit of that goal it is: a region has one or more, a point has none.
    exit: usize,
    point: Vec2,
    /// How often in a row no step was found.
    tries: u32,
    /// How many pauses in a row it has stood next to those who stand in its goal.
    waits: u32,
}

/// Gives steps to all agents of stepped kinds.
#[derive(Debug)]
struct Steppers {
    /// By the bits of the radius.
    floors: BTreeMap<u64, Floor>,
    /// By their files.
    gaits: BTreeMap<String, Arc<LearnedGait>>,
}

/// The agents that step.
fn stepped(scenario: &Scenario) -> impl Iterator<Item = AgentId> + '_ {
    let steps = |id: &AgentId| scenario.agents[id.0 as usize].body.stepper.is_some();
    (0..scenario.agents.len() as u32).map(AgentId).filter(steps)
}

/// The drivers of a run: ways and plans, and steps for those who step.
pub fn drivers(ways: &Ways, scenario: &Scenario, seed: u64) -> Drivers {
    let drivers = ways.drivers(scenario, seed);
    if stepped(scenario).next().is_none() {
        return drivers;
    }
    let (mut floors, mut gaits) = (BTreeMap::new(), BTreeMap::new());
    for id in stepped(scenario) {
        let body = &scenario.agents[id.0 as usize].body;
        let radius = widest(&body[Parameter::Radius]);
        floors.entry(radius.to_bits()).or_insert_with(|| Floor::new(scenario, radius));
        let rule = body.stepper.as_ref().map(|stepper| &stepper.gait);
        if let Some(GaitRule::Learned { file, text }) = rule
            && !gaits.contains_key(file)
            && let Ok(gait) = LearnedGait::from_json(text)
        {
            gaits.insert(file.clone(), Arc::new(gait));
        }
    }
    drivers.with(stepped(scenario), Arc::new(Steppers { floors, gaits }))
}

/// The foot of the present step of an agent, or of its last one; `None` for other kinds.
pub fn present_foot(state: &State, slot: Slot) -> Option<Foot> {
    let known: &Remembered = state.plans.memory(slot)?.get()?;
    Some(known.walker.foot.other())
}

/// How a kind searches.
fn search(rule: SearchRule) -> Search {
    match rule {
        SearchRule::Guided { candidates } => Search::Guided { candidates },
        SearchRule::HybridAStar { cell, starters, successors } => {
            Search::HybridAStar(HybridAStar { cell, starters, successors, ..HybridAStar::default() })
        }
        SearchRule::GridAStar => Search::GridAStar,
        SearchRule::AsPublished => Search::HybridAStar(HybridAStar::as_published()),
    }
}

/// A step over time. The last one of a walk comes to rest: it slows down all the way, and takes half as long again.
fn trajectory(step: &PlacedStep, is_last: bool) -> Option<Trajectory> {
    let longer = if is_last { 1.5 } else { 1.0 };
    let sample = |k: usize| {
        let part = k as f64 / SPANS as f64;
        let (share, pace) =
            if is_last { (part * (1.5 - 0.5 * part * part), 1.0 - part * part) } else { (part, 1.0) };
        let (position, velocity) = (step.place(share), step.velocity(share) * pace);
        Sample { time: part * longer * step.duration(), position, velocity }
    };
    Trajectory::through(&(0..=SPANS).map(sample).collect::<Vec<_>>())
}

/// Whether somebody is next to bodies that stand in a goal: nobody fits in between. Who stands next to these counts as they do.
fn is_next(at: Vec2, radius: f64, goal: Vec2, standing: &[OtherBody]) -> bool {
    let (mut inside, mut around): (Vec<OtherBody>, Vec<OtherBody>) =
        standing.iter().partition(|one| (one.at - goal).norm() < one.radius + radius);
    while let Some(one) = inside.pop() {
        let is_near = |p: Vec2, of: f64| (p - one.at).norm() < one.radius + 2.0 * radius + of;
        if is_near(at, radius) {
            return true;
        }
        let (near, others): (Vec<_>, Vec<_>) =
            around.into_iter().partition(|other| is_near(other.at, other.radius));
        (inside, around) = ([inside, near].concat(), others);
    }
    false
}

impl Steppers {
    /// Who somebody is: the same in all steps of a trial.
    fn person(&self, situation: &Situation<'_>) -> Option<Arc<dyn Gait + Send + Sync>> {
        let stepper = situation.scenario.agents[situation.agent.0 as usize].body.stepper.as_ref()?;
        let stream = Stream::of(situation.key, situation.entity, Purpose::Parameter);
        Some(match &stepper.gait {
            GaitRule::Synthetic => {
                let (height, speed) = (situation.parameter(Parameter::Height), situation.own_speed);
                Arc::new(SyntheticGait::of(Person::draw(stream, Some(height), Some(speed))))
            }
            GaitRule::Learned { file, .. } => {
                let first = const { name_hash("gait offset") as u32 };
                let mut normals = [0.0; LearnedGait::NORMALS];
                for (k, pair) in (0..).zip(normals.chunks_mut(2)) {
                    pair.copy_from_slice(&stream.normal_pair(first.wrapping_add(k))[..pair.len()]);
                }
                Arc::new(self.gaits.get(file)?.person(&normals))
            }
        })
    }

    fn new_person(&self, situation: &Situation<'_>) -> Option<Remembered> {
        let velocity = situation.velocity;
        let heading = (velocity.norm() > STANDS).then(|| velocity / velocity.norm());
        let walker = Walker::standing(situation.position, heading);
        Some(Remembered {
            walker,
            person: self.person(situation)?,
            goal: None,
            exit: 0,
            point: situation.position,
            tries: 0,
            waits: 0,
        })
    }

    /// The others that can be met during a step. Who overlaps at its beginning counts as smaller.
    fn others(situation: &Situation<'_>, radius: f64) -> Vec<OtherBody> {
        let at = situation.position;
        let is_near = |other: &OtherBody| (other.at - at).norm() < SEEN + other.radius;
        let body = |other: crate::kernel::driver::Other| OtherBody {
            at: other.position + other.velocity * situation.after,
            velocity: other.velocity,
            radius: other.radius,
        };
        let mut found: Vec<OtherBody> = situation.others().map(body).filter(is_near).collect();
        for other in &mut found {
            let room = (other.at - at).norm() - radius - 1e-3;
            other.radius = if room < other.radius { room } else { other.radius };
        }
        found
    }

    /// The next plan of somebody, who remembers it.
    fn next(&self, situation: &Situation<'_>, known: &mut Remembered) -> Option<Plan> {
        let agent = &situation.scenario.agents[situation.agent.0 as usize];
        let stepper = agent.body.stepper.as_ref()?;
        let floor = self.floors.get(&widest(&agent.body[Parameter::Radius]).to_bits())?;
        let radius = situation.parameter(Parameter::Radius);
        if radius > floor.radius {
            return Some(Plan::NoWay);
        }
        let stream = Stream::of(situation.key, situation.entity, Purpose::Step);
        let scene = &situation.scenario.scene;
        let left = situation.legs.len();
        let draws = Stream::of(situation.key, situation.entity, Purpose::Plan);
        let draw = |n: u32| draws.uniform_pair((left as u32) << 8 | n);
        let field = match (situation.advice, situation.goal()) {
            (Some(direction), _) => {
                known.walker.forget_planned();
                (known.goal, known.point) = (None, known.walker.at + direction * FAR);
                Arc::new(GoalField::straight(known.point))
            }
            (None, Some(goal)) => {
                let exits = exits(scene, goal);
                let is_new = known.goal.as_ref().is_none_or(|(known, then)| known != goal || *then != left);
                if is_new {
                    known.exit = floor.nearest(known.walker.at, exits);
                }
                let exit = exits.get(known.exit);
                let centre = exit.map_or_else(|| middle(scene, goal), Shape::inner_point);
                if is_new {
                    known.walker.forget_planned();
                    // In the paper walks end near the middle.
                    known.point = match (exit, &stepper.search) {
                        (_, SearchRule::AsPublished) => centre,
                        (None, _) => floor.ground.beside(centre),
                        (Some(exit), _) => {
                            let is_free = |p| floor.ground.is_free(p);
                            floor.ground.beside(point_in(exit, is_free, radius, draw))
                        }
                    };
                    known.goal = Some((goal.clone(), left));
                }
                floor.field(centre)
            }
            (None, None) => return Some(Plan::Stand(f64::INFINITY)),
        };
        let others = Self::others(situation, radius);
        let standing: Vec<OtherBody> =
            others.iter().copied().filter(|other| other.velocity.norm() < STANDS).collect();
        let is_taken = |p: Vec2| standing.iter().any(|one| (one.at - p).norm() < one.radius + radius);
        if let (None, Some(goal)) = (situation.advice, situation.goal())
            && is_taken(known.point)
        {
            let is_free = |p: Vec2| floor.ground.is_free(p) && !is_taken(p);
            let exit = exits(scene, goal).get(known.exit);
            let point = exit.map_or(known.point, |exit| point_in(exit, is_free, radius, draw));
            if is_free(point) {
                known.walker.forget_planned();
                known.point = point;
            } else if is_next(situation.position, radius, known.point, &standing) {
                known.waits += 1;
                return Some(if known.waits > WAITS { Plan::There } else { Plan::Stand(PAUSE) });
            }
        }
        known.waits = 0;
        let is_blocked = known.tries > 0
            && known.tries.is_multiple_of(TRIES)
            && situation.advice.is_none()
            && !standing.is_empty();
        let own = situation.own_speed;
        let relative = situation.parameter(Parameter::Speed) / own;
        // A learned gait has a speed of its own, unless the kind sets one.
        let share = match &stepper.gait {
            GaitRule::Learned { .. } if stepper.sets_speed => {
                relative * own * known.person.duration() / known.person.length()
            }
            _ => relative,
        };
        let walk = Walk {
            ground: &floor.ground,
            field: &field,
            goal: known.point,
            gait: known.person.as_ref(),
            share,
            stream,
            search: if is_blocked {
                Search::HybridAStar(HybridAStar { expansions: AROUND, ..HybridAStar::default() })
            } else {
                search(stepper.search)
            },
            around: if is_blocked { &standing } else { &[] },
        };
        let gap = |step: &PlacedStep| least_gap(step, radius, &others);
        let found = walk.next(&mut known.walker, (!others.is_empty()).then_some(&gap));
        Some(match found {
            Ok(Some(step)) => {
                known.tries = 0;
                let is_last = walk.is_over(&known.walker);
                trajectory(&step, is_last).map_or(Plan::Stand(PAUSE), |path| Plan::Step(Arc::new(path)))
            }
            Ok(None) => Plan::Stand(f64::INFINITY),
            Err(NoStep::NoWay { .. } | NoStep::GoalBlocked) if situation.advice.is_none() => Plan::NoWay,
            Err(reason) => {
                known.tries += 1;
                // Others go away in time; barriers do not.
                let is_alone = others.is_empty() && situation.advice.is_none();
                if known.tries > 2 * TRIES && is_alone && reason != NoStep::Crowded {
                    return Some(Plan::NoWay);
                }
                // Other candidates.
                known.walker.number += 1;
                Plan::Stand(PAUSE)
            }
        })
    }
}

impl Driver for Steppers {
    fn plan(&self, situation: &Situation<'_>, memory: &mut Memory) -> Plan {
        let is_stepping = matches!(situation.plan, Plan::Step(_));
        let is_new = matches!(situation.occasion, Occasion::Begins | Occasion::Enters);
        // A step is made to its end, whatever happens.
        if is_stepping && !is_new && situation.occasion != Occasion::Ended {
            return Plan::Keep;
        }
        let Some(mut known) = memory.get::<Remembered>().cloned().or_else(|| self.new_person(situation))
        else {
            return Plan::NoWay;
        };
        if !is_stepping && !is_new {
            known.walker.stop_at(situation.position);
        }
        let stops = situation.advice == Some(Vec2::zeros());
        let waits = situation.advice.is_none() && !matches!(situation.legs.first(), Some(Leg::To(_)));
        let plan = if stops || waits {
            Plan::Stand(f64::INFINITY)
        } else {
            self.next(situation, &mut known).unwrap_or(Plan::NoWay)
        };
        memory.put(known);
        plan
    }
}
