//! The beginning of a trial: parameters are drawn, bodies placed, routes begun.
//!
//! Every draw is addressed by the agent's entity and the parameter's name, so an agent, a parameter or a
//! move more changes nobody else's. Placement is random sequential (Widom 1966) with a fixed number of
//! attempts, then relaxation; what still overlaps, or was recorded so, shrinks to touch.

mod area;
mod arrival;
mod body;
mod crowd;
mod placement;
mod relaxation;
mod sampler;

pub use area::{Crowding, JAMMED, check_area};
pub use arrival::Arrivals;
pub use placement::Starts;

use super::drive;
use super::program::Program;
use super::state::{Layout, State};
use crate::base::geometry::Vec2;
use crate::base::lanes::{Lanes, Mask};
use crate::base::random::TrialKey;
use crate::model::{AgentId, BarrierId, Move, Parameter, Route};
pub(super) use body::Values;

/// What loading a trial found worth counting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// Bodies that overlapped something at the start and whose radii were shrunk to touch it.
    pub shrunk: Vec<Shrunk>,
    /// Bodies that found no free place by chance and were pushed apart.
    pub pushed: u32,
}

/// A body that was made smaller at the start of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrunk {
    /// Whose body.
    pub agent: AgentId,
    /// What it overlapped.
    pub at: Overlapped,
    /// Its radius before, m.
    pub from: f64,
    /// Its radius after, m.
    pub to: f64,
}

/// What a body overlapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlapped {
    /// The body of another agent, which was made smaller by the same factor.
    Agent(AgentId),
    /// A wall or an obstacle.
    Barrier(BarrierId),
}

/// Why a trial cannot begin.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A parameter has a value with which nobody can move.
    #[error("parameter `{name}` of agent {} is {value}", agent.0)]
    Parameter {
        /// Whose.
        agent: AgentId,
        /// Which.
        name: &'static str,
        /// Its value, SI units.
        value: f64,
    },
    /// A start that is no point of the plane.
    #[error("agent {} has no place to start", agent.0)]
    Nowhere {
        /// Whose.
        agent: AgentId,
    },
    /// An agent is to start near one that is placed after it.
    #[error("agent {} starts near an agent that is placed after it", agent.0)]
    Order {
        /// Whose start it is.
        agent: AgentId,
    },
    /// By chance somebody is placed in an obstacle or on a wall, out of which nothing could push them.
    #[error("agent {} is placed in an obstacle or on a wall", agent.0)]
    Inside {
        /// Whom.
        agent: AgentId,
    },
    /// By chance somebody is pushed farther from another than they may start, with a wall on the way back.
    #[error("agent {} starts too far from another", agent.0)]
    Far {
        /// Whom.
        agent: AgentId,
    },
    /// Two are placed at one point.
    #[error("agents {} and {} are placed at one point", agents.0.0, agents.1.0)]
    Together {
        /// Whom.
        agents: (AgentId, AgentId),
    },
    /// There is no such option.
    #[error("there is no option {option} in declaration {declaration} of moves")]
    Advice {
        /// Which declaration of moves.
        declaration: usize,
        /// Which of its options.
        option: usize,
    },
}

/// Loads the initial state of a trial into a lane (in `Layout::Agents`: as the only trial). No other lane is
/// touched, and on a fault nothing is. `advice` is a declaration of moves and one of its options.
pub fn load(
    program: &Program,
    state: &mut State,
    lane: usize,
    key: TrialKey,
    advice: Option<(usize, usize)>,
) -> Result<Loaded, Fault> {
    let scenario = &program.scenario;
    if scenario.agents.is_empty() && advice.is_none() {
        begin(program, state, lane, key);
        return Ok(Loaded::default());
    }
    let advised = match advice {
        None => None,
        Some((declaration, option)) => {
            let moves = scenario.moves.get(declaration);
            let chosen = moves.and_then(|moves| Some((moves, moves.options.get(option)?.1)));
            let (moves, chosen) = chosen.ok_or(Fault::Advice { declaration, option })?;
            let heeded = program.behaviours.heeds(program, key, moves.agent.0 as usize);
            heeded.then_some((moves.agent, (chosen, moves.duration.0)))
        }
    };
    let mut bodies = Vec::with_capacity(scenario.agents.len());
    for (k, agent) in scenario.agents.iter().enumerate() {
        let here = !program.arrivals.comes(k);
        let draw = || program.starts.laws(k).draw(AgentId(k as u32), agent, agent.entity, key);
        bodies.push(here.then(draw).transpose()?);
    }
    let radii = bodies
        .iter()
        .map(|body| body.as_ref().map_or(0.0, |body| body[Parameter::Radius as usize]))
        .collect();
    let placed = placement::place(scenario, &program.starts, key, radii)?;

    let lane = if state.layout == Layout::Agents { 0 } else { lane };
    begin(program, state, lane, key);
    for (k, body) in bodies.into_iter().enumerate() {
        let Some(mut body) = body else { continue };
        body[Parameter::Radius as usize] = placed.radii[k];
        let own = advised.filter(|(whose, _)| whose.0 as usize == k).map(|(_, advice)| advice);
        enter(program, state, k, lane, &body, placed.positions[k], own);
    }
    program.arrivals.open(program, state, lane);
    Ok(placed.counts)
}

/// Puts an agent into the scene, at the beginning of its way.
fn enter(
    program: &Program,
    state: &mut State,
    agent: usize,
    lane: usize,
    body: &Values,
    at: Vec2,
    advice: Option<(Move, u64)>,
) {
    let slot = state.slot(agent, lane);
    state.bodies.put(slot, body, Parameter::ALL.into_iter());
    let velocity = program.scenario.agents[agent].start.velocity;
    let put = |field: &mut [Lanes], value| field[slot.block].0[slot.lane] = value;
    put(&mut state.motion.x, at.x);
    put(&mut state.motion.y, at.y);
    put(&mut state.motion.vx, velocity.x);
    put(&mut state.motion.vy, velocity.y);
    for field in [&mut state.motion.travelled, &mut state.motion.fx, &mut state.motion.fy] {
        put(field, 0.0);
    }
    state.present[slot.block] |= Mask::lane(slot.lane);
    drive::begin(program, state, agent, lane, advice);
    program.behaviours.begin(program, state, agent, lane);
}

/// The trial itself and its processes.
fn begin(program: &Program, state: &mut State, lane: usize, key: TrialKey) {
    state.keys[lane] = key;
    state.ticks[lane] = 0;
    state.occupied |= Mask::lane(lane);
    state.diverged &= !Mask::lane(lane);
    program.processes.load(state, lane);
    program.arrivals.load(state, lane, key);
}

/// The parameters of an agent, or of the person so many numbers later on its place, as drawn; none if nobody can move with
/// them.
pub(super) fn own_parameters(
    program: &Program,
    key: TrialKey,
    (id, later): (AgentId, u32),
) -> Option<Values> {
    let agent = program.scenario.agents.get(id.0 as usize)?;
    let laws = program.starts.laws(id.0 as usize);
    let mut values = laws.draw(id, agent, agent.entity + later, key).ok()?;
    // Who goes on as recorded has the recorded speed as driving speed.
    let recorded = agent.start.velocity.norm();
    if agent.route == Route::Onward && recorded > 0.0 {
        values[Parameter::Speed as usize] = recorded;
    }
    Some(values)
}
