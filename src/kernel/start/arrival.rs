//! Sources: people who come in while a trial runs.
//!
//! The n-th arrival of a source is one person, with the n-th of its stable numbers. It takes the n-th place of the source,
//! and once all places are taken the first one whose person has left; without such a one the trial is unresolved.
//! What follows a place as if it were a person (a formula over time about somebody) knows no more from then
//! on; where the scenario itself does so, places are used once. The times between arrivals are draws 0, 1, … of the
//! source's own stream. Someone has arrived at the first state at or after their time; they are placed where
//! they touch nobody who is present and no barrier. Without a free place they wait, those behind them too, and try
//! again at each state.

use super::placement::{ATTEMPTS, Ground};
use super::sampler::Sampler;
use super::{body::Parameters, enter};
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::kernel::process::delay::after;
use crate::kernel::program::Program;
use crate::kernel::state::{Layout, State};
use crate::model::law::Ready;
use crate::model::{AgentId, Bool, Num, Position, Scenario, Source, Timing};

/// The share of a step within which a time after a state still counts as at it: rounding of sums.
const SLACK: f64 = 1e-6;

/// One source.
#[derive(Clone, Debug)]
struct Door {
    entity: u32,
    every: Ready,
    members: Vec<AgentId>,
    /// Most arrivals.
    most: u32,
}

/// The sources of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Arrivals {
    doors: Vec<Door>,
    /// Per agent, whether it comes from a source; empty without sources.
    comes: Vec<bool>,
    /// Whether places are used once, because the scenario speaks of single ones.
    once: bool,
}

/// How far the sources of a batch are; lanes are trials in both layouts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Queues {
    /// Time of the next arrival of each source, s.
    next: Vec<Lanes>,
    /// How many have arrived.
    arrived: Vec<[u32; LANES]>,
    /// How many have come in.
    pub entered: Vec<[u32; LANES]>,
    /// How often the next one has tried to come in.
    tries: Vec<[u32; LANES]>,
    /// Per agent: how many numbers its person is behind the first one on its place. Empty without sources.
    later: Vec<[u32; LANES]>,
    /// Lanes in which a place was given to a second person.
    pub reused: Mask,
    /// Lanes in which more have arrived than there is room for: the trial is unresolved.
    pub full: Mask,
    /// Which source that was.
    which: [u32; LANES],
}

impl Queues {
    /// The lanes in which member `number` of a source, counted from 0, has come in.
    pub fn has_entered(&self, source: usize, number: u32) -> Mask {
        let Some(entered) = self.entered.get(source) else { return Mask::NONE };
        let here = entered.iter().enumerate().filter(|(_, entered)| **entered > number);
        here.fold(Mask::NONE, |mask, (lane, _)| mask | Mask::lane(lane))
    }
}

impl Queues {
    /// Why the trial in a lane is unresolved, if a source is the reason.
    pub fn overrun(&self, sources: &[Source], lane: usize) -> Option<String> {
        let source = sources.get(self.which[lane] as usize).filter(|_| self.full.has(lane))?;
        let (count, name) = (source.members.len(), &source.name);
        let words =
            if self.reused.has(lane) { "are present at once from source" } else { "arrived by source" };
        Some(format!("more than {count} agents {words} `{name}`; write a larger `limit`"))
    }

    /// Why a question that follows single people has no answer in the trial of a lane, if that is the reason.
    pub fn lost_sight(&self, sources: &[Source], lane: usize) -> Option<String> {
        let source = sources.get(self.which[lane] as usize).filter(|_| self.reused.has(lane))?;
        let (count, name) = (source.members.len(), &source.name);
        Some(format!(
            "more than {} arrived by source `{name}`, and the formula follows single agents of it; write a larger `limit`",
            if count == 1 { "1 agent".to_owned() } else { format!("{count} agents") }
        ))
    }

    /// The name of the person on a place of a source, if it is not the first one there: `doors[57]`.
    pub fn arrival(&self, sources: &[Source], agent: AgentId, lane: usize) -> Option<String> {
        let later = self.later(agent.0 as usize, lane);
        let source = sources.iter().find(|source| later > 0 && source.members.contains(&agent))?;
        let place = source.members.iter().position(|member| *member == agent)?;
        Some(format!("{}[{}]", source.name, place as u32 + later + 1))
    }

    /// How many numbers the person on an agent's place is behind the first one there; 0 but for places of sources.
    #[inline]
    pub fn later(&self, agent: usize, lane: usize) -> u32 {
        self.later.get(agent).map_or(0, |later| later[lane])
    }
}

impl Arrivals {
    /// Prepares the sources of a scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let mut out = Self::default();
        for source in &scenario.sources {
            out.comes.resize(scenario.agents.len(), false);
            for member in &source.members {
                if let Some(comes) = out.comes.get_mut(member.0 as usize) {
                    *comes = true;
                }
            }
            let (entity, every) = (source.entity, source.every.ready());
            out.doors.push(Door { entity, every, members: source.members.clone(), most: source.most });
        }
        out.once = out.speaks_of_single_ones(scenario);
        out
    }

    /// Whether behaviours, processes or starts of a scenario name single places of sources other than their own.
    fn speaks_of_single_ones(&self, scenario: &Scenario) -> bool {
        if self.doors.is_empty() {
            return false;
        }
        let mut found = false;
        for one in &scenario.behaviours.attached {
            let own = one.agent;
            let mut tell = |id: AgentId| found |= id != own && self.comes(id.0 as usize);
            one.guards.iter().for_each(|guard| guard.mentions(&mut tell));
        }
        let mut tell = |id: AgentId| found |= self.comes(id.0 as usize);
        for command in scenario.processes.list.iter().flat_map(|process| &process.commands) {
            command.guard.mentions(&mut tell);
            if let Timing::Rate(rate) = &command.timing {
                rate.mentions(&mut tell);
            }
            for branch in &command.branches {
                branch.weight.mentions(&mut tell);
                branch.updates.iter().for_each(|(_, value)| value.mentions(&mut tell));
            }
        }
        for agent in &scenario.agents {
            if let Position::Near { agent, .. } = &agent.start.position {
                tell(*agent);
            }
        }
        found
    }

    /// Whether a truth value or a number names somebody from a source.
    pub fn are_named(&self, atoms: &[Bool], signals: &[Num]) -> bool {
        let mut found = false;
        if !self.doors.is_empty() {
            let mut tell = |id: AgentId| found |= self.comes(id.0 as usize);
            for atom in atoms {
                atom.mentions(&mut tell);
            }
            for signal in signals {
                signal.mentions(&mut tell);
            }
        }
        found
    }

    /// Whether an agent comes from a source, and so is not there at the start.
    pub fn comes(&self, agent: usize) -> bool {
        self.comes.get(agent).copied().unwrap_or(false)
    }

    /// Begins a trial.
    pub(super) fn load(&self, state: &mut State, lane: usize, key: TrialKey) {
        state.queues.full &= !Mask::lane(lane);
        state.queues.reused &= !Mask::lane(lane);
        if self.doors.is_empty() {
            return;
        }
        let queues = &mut state.queues;
        queues.next.resize(self.doors.len(), Lanes::ZERO);
        for list in [&mut queues.arrived, &mut queues.entered, &mut queues.tries] {
            list.resize(self.doors.len(), [0; LANES]);
            for source in list {
                source[lane] = 0;
            }
        }
        queues.later.resize(self.comes.len(), [0; LANES]);
        queues.later.iter_mut().for_each(|later| later[lane] = 0);
        for (next, door) in queues.next.iter_mut().zip(&self.doors) {
            next.0[lane] = door.interval(key, 0);
        }
        for door in &self.doors {
            for member in &door.members {
                leave_empty(state, member.0 as usize, lane);
            }
        }
    }

    /// Lets in who comes at time 0.
    pub(super) fn open(&self, program: &Program, state: &mut State, lane: usize) {
        let now = SLACK * program.dt;
        for source in 0..self.doors.len() {
            if state.queues.next[source].0[lane] <= now {
                self.arrive(program, state, source, lane, now);
            }
        }
    }

    /// Lets in who has arrived; to be called with the ticks and positions after a step. Whether somebody came in.
    pub(in crate::kernel) fn step(&self, program: &Program, state: &mut State) -> bool {
        let mut came = false;
        for source in 0..self.doors.len() {
            for lane in state.occupied.iter() {
                let now = (state.ticks[lane] as f64 + SLACK) * program.dt;
                let due = state.queues.next[source].0[lane] <= now;
                if due || state.queues.entered[source][lane] < state.queues.arrived[source][lane] {
                    came |= self.arrive(program, state, source, lane, now);
                }
            }
        }
        came
    }

    fn arrive(&self, program: &Program, state: &mut State, source: usize, lane: usize, now: f64) -> bool {
        let mut came = false;
        let door = &self.doors[source];
        let key = state.keys[lane];
        while state.queues.next[source].0[lane] <= now {
            let arrived = &mut state.queues.arrived[source][lane];
            let most = if self.once { door.members.len() as u32 } else { door.most };
            if *arrived >= most {
                state.queues.full |= Mask::lane(lane);
                state.queues.which[lane] = source as u32;
                return came;
            }
            *arrived += 1;
            let next = &mut state.queues.next[source].0[lane];
            *next = after(*next, door.interval(key, *arrived), program.scenario.clock);
        }
        while state.queues.entered[source][lane] < state.queues.arrived[source][lane] {
            let number = state.queues.entered[source][lane];
            let Some(place) = door.place(state, lane, number) else {
                state.queues.full |= Mask::lane(lane);
                state.queues.which[lane] = source as u32;
                return came;
            };
            let (member, later) = (door.members[place], number - place as u32);
            let agent = &program.scenario.agents[member.0 as usize];
            let entity = agent.entity + later;
            let Ok(body) =
                Parameters::draw(member, agent, entity, program.starts.laws(member.0 as usize), key)
            else {
                // Nobody can move like that; such laws are refused when they are compiled.
                state.diverged |= Mask::lane(lane);
                return came;
            };
            let tries = state.queues.tries[source][lane];
            let Some(at) = free_place(program, state, lane, (member, entity), body.radius, tries) else {
                state.queues.tries[source][lane] += 1;
                return came;
            };
            state.queues.tries[source][lane] = 0;
            state.queues.entered[source][lane] += 1;
            state.queues.later[member.0 as usize][lane] = later;
            if later > 0 && !state.queues.reused.has(lane) {
                state.queues.reused |= Mask::lane(lane);
                state.queues.which[lane] = source as u32;
            }
            enter(program, state, member.0 as usize, lane, &body, at, None);
            let slot = state.slot(member.0 as usize, lane);
            crate::kernel::dynamics::prepare(state, program.dt, slot);
            came = true;
        }
        came
    }
}

impl Door {
    /// The place for arrival `number`, counted from 0: its own, or once all have been taken the first that is free.
    fn place(&self, state: &State, lane: usize, number: u32) -> Option<usize> {
        let number = number as usize;
        if number < self.members.len() {
            return Some(number);
        }
        self.members.iter().position(|member| {
            let slot = state.slot(member.0 as usize, lane);
            !state.present[slot.block].has(slot.lane)
        })
    }

    /// Time between arrival `number` and the one before it, s.
    fn interval(&self, key: TrialKey, number: u32) -> f64 {
        self.every.draw(Stream::of(key, self.entity, Purpose::Arrival).uniform(number))
    }
}

/// Harmless numbers in the place of someone who has not come yet.
fn leave_empty(state: &mut State, agent: usize, lane: usize) {
    let slot = state.slot(agent, lane);
    let zero = [
        &mut state.x,
        &mut state.y,
        &mut state.vx,
        &mut state.vy,
        &mut state.ey,
        &mut state.drive,
        &mut state.travelled,
        &mut state.speed,
        &mut state.radius,
        &mut state.a,
        &mut state.a2,
        &mut state.noise,
        &mut state.fx,
        &mut state.fy,
    ];
    for field in zero {
        field[slot.block].0[slot.lane] = 0.0;
    }
    for field in [&mut state.ex, &mut state.mass, &mut state.tau] {
        field[slot.block].0[slot.lane] = 1.0;
    }
    state.present[slot.block] &= !Mask::lane(slot.lane);
}

/// A place for an agent that touches nobody, in the `tries`-th attempt to come in. Near somebody who is not there
/// is no place yet.
fn free_place(
    program: &Program,
    state: &State,
    lane: usize,
    (member, entity): (AgentId, u32),
    radius: f64,
    tries: u32,
) -> Option<Vec2> {
    let agent = &program.scenario.agents[member.0 as usize];
    let around;
    let sampler = match &agent.start.position {
        Position::Point(point) => {
            let free = is_free(program, &all_present(state, lane), *point, radius);
            return free.then_some(*point);
        }
        Position::Within(_) => program.starts.sampler(member.0 as usize)?,
        Position::Near { agent, within } => {
            let slot = state.slot(agent.0 as usize, lane);
            if !state.present[slot.block].has(slot.lane) {
                return None;
            }
            let centre = Vec2::new(state.x[slot.block].0[slot.lane], state.y[slot.block].0[slot.lane]);
            around = Sampler::Disc { centre, radius: *within };
            &around
        }
    };
    let stream = Stream::of(state.keys[lane], entity, Purpose::Placement);
    let others = all_present(state, lane);
    for attempt in 0..ATTEMPTS {
        let draw = tries.wrapping_mul(ATTEMPTS).wrapping_add(attempt);
        let point = sampler.point(stream.uniform_pair(draw))?;
        if is_free(program, &others, point, radius) {
            return Some(point);
        }
    }
    None
}

/// Places and radii of all who are present.
fn all_present(state: &State, lane: usize) -> Vec<(f64, f64, f64)> {
    let mut out = Vec::new();
    for block in 0..state.x.len() {
        let slots = match state.layout {
            Layout::Trials => Mask::lane(lane),
            Layout::Agents => Mask::ALL,
        };
        for slot in (state.present[block] & slots).iter() {
            out.push((state.x[block].0[slot], state.y[block].0[slot], state.radius[block].0[slot]));
        }
    }
    out
}

fn is_free(program: &Program, others: &[(f64, f64, f64)], p: Vec2, radius: f64) -> bool {
    let apart = |&(x, y, r): &(f64, f64, f64)| {
        let (dx, dy, touch) = (p.x - x, p.y - y, radius + r);
        dx * dx + dy * dy >= touch * touch
    };
    let ground = Ground::of(&program.scenario.scene, &program.starts);
    others.iter().all(apart) && ground.near(p, radius).all(|barrier| barrier.distance(p) >= radius)
}
