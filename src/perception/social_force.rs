//! The social force model as a model of motion (Given-Wilson, Legay, Sedwards, Zendra, "Modelling of Machine-Aided Human
//! Group Motion", 2017, Algorithm 2 with equation (1)): people react to each other and to barriers, without noise, and
//! want to keep the velocity of the end of their trace.

use super::motion::Motion;
use super::trace::TracePoint;
use crate::base::decimal::Decimal;
use crate::base::geometry::Vec2;
use crate::base::tick::{Clock, Tick};
use crate::compile::presets;
use crate::kernel::Program;
use crate::kernel::run::{Address, End, Run};
use crate::kernel::start::Fault;
use crate::model::{
    Agent, AgentId, Barrier, Behaviours, Body, Kind, Law, Parameter, Processes, Route, Scenario, Scene,
    Start, TOP_SPEED,
};
use std::sync::Arc;

/// Longest step, s: a shorter one changes no result of docs/perception.md by more than two switches.
const STEP: f64 = 0.05;
/// Over a longer time everybody goes straight on, s.
const LONGEST: f64 = 60.0;

/// People who react to each other. Somebody in an obstacle, two at one place and people whose motion diverges keep their
/// velocity.
#[derive(Clone, Debug)]
pub struct SocialForce {
    body: Arc<Body>,
    scene: Scene,
    /// Where everybody was projected last.
    last: Vec<Walker>,
}

/// Somebody who goes on from the end of a trace.
#[derive(Clone, Copy, Debug)]
struct Walker {
    end: TracePoint,
    /// s
    time: f64,
    /// m
    position: Vec2,
    /// m/s
    velocity: Vec2,
}

impl Walker {
    /// At the end of a trace.
    fn at(end: &TracePoint) -> Self {
        Self { end: *end, time: end.time, position: end.position, velocity: driving(end) }
    }

    /// Straight on, or back, to another time.
    fn straight(&self, time: f64) -> Self {
        Self { time, position: self.position + self.velocity * (time - self.time), ..*self }
    }

    /// Whether it moves as a person can.
    fn is_sound(&self) -> bool {
        let speeds = [self.velocity, driving(&self.end)].map(|velocity| velocity.norm());
        self.position.iter().all(|x| x.is_finite()) && speeds.iter().all(|speed| *speed <= TOP_SPEED)
    }
}

/// The velocity that somebody wants after the end of a trace, m/s: without a velocity there, to stand.
fn driving(end: &TracePoint) -> Vec2 {
    end.velocity.unwrap_or_else(Vec2::zeros)
}

impl SocialForce {
    /// People with the parameters of a body, each at its mean, among barriers. `None` for a body that no force moves.
    pub fn new(body: &Body, barriers: Vec<Barrier>) -> Option<Self> {
        // One projection of each person is wanted, so nothing is drawn.
        let law = |parameter| match parameter {
            Parameter::Noise => Law::Constant(0.0),
            other => Law::Constant(body[other].mean()),
        };
        let is_forced = Kind::FORCED.contains(&body.kind);
        let scene = Scene { barriers, ..Scene::default() };
        is_forced.then(|| Self { body: Arc::new(Body::new(Kind::Sfm, law)), scene, last: Vec::new() })
    }

    /// People with the parameters of a preset, such as `helbing2000`, each at its mean, among barriers. `None` for an
    /// unknown preset.
    pub fn preset(name: &str, barriers: Vec<Barrier>) -> Option<Self> {
        presets::law(name, Parameter::Mass)?;
        let law = |parameter: Parameter| {
            let default = || parameter.description().default.map(Law::Constant);
            // The other parameters belong to plans and are never read.
            presets::law(name, parameter).or_else(default).unwrap_or(Law::Constant(1.0))
        };
        Self::new(&Body::new(Kind::Sfm, law), barriers)
    }

    /// Moves walkers, who are all at one time, to another time.
    fn walk(&self, walkers: &[Walker], to: f64) -> Vec<Walker> {
        let mut moved: Vec<Walker> = walkers.iter().map(|one| one.straight(to)).collect();
        let seconds = walkers.first().map_or(0.0, |one| to - one.time);
        let micros = (seconds * 1e6).round();
        if !(micros >= 1.0 && seconds <= LONGEST) {
            return moved;
        }
        let steps = (seconds / STEP - 1e-6).ceil();
        let Some(step) = Decimal::ratio(micros as i128, 1_000_000 * steps as i128) else { return moved };
        let mut sound: Vec<usize> = (0..walkers.len()).filter(|k| walkers[*k].is_sound()).collect();
        while !sound.is_empty() {
            let program = self.program(sound.iter().map(|k| &walkers[*k]), step, steps as u64);
            match Run::of(&program, Address::default()) {
                Ok((run, _)) => {
                    finish(run, sound.iter().copied(), &mut moved);
                    break;
                }
                Err(fault) => {
                    let wrong = agents_of(&fault);
                    if wrong.is_empty() {
                        break;
                    }
                    let mut agents = (0..).map(AgentId);
                    sound.retain(|_| agents.next().is_none_or(|agent| !wrong.contains(&agent)));
                }
            }
        }
        moved
    }

    /// Everybody goes on from where they are.
    fn program<'a>(&self, walkers: impl Iterator<Item = &'a Walker>, step: Decimal, steps: u64) -> Program {
        let agent = |(walker, entity): (&Walker, u32)| Agent {
            name: String::new(),
            entity,
            body: Arc::clone(&self.body),
            start: Start {
                velocity: walker.velocity,
                driving: Some(driving(&walker.end)),
                ..Start::at_rest(walker.position)
            },
            route: Route::Onward,
            group: None,
            particle: None,
        };
        Program::new(Arc::new(Scenario {
            title: String::new(),
            clock: Clock::Stepped(step),
            horizon: Tick(steps),
            scene: self.scene.clone(),
            agents: walkers.zip(0..).map(agent).collect(),
            groups: Vec::new(),
            moves: Vec::new(),
            processes: Processes::default(),
            behaviours: Behaviours::default(),
            sources: Vec::new(),
            doors: Vec::new(),
        }))
    }
}

/// Runs to the horizon, and takes over where the agents are then. `places` has the place of each agent in `moved`.
fn finish(mut run: Run<'_>, places: impl Iterator<Item = usize>, moved: &mut [Walker]) {
    while run.next_state().is_ok() {}
    if run.end(0) != Some(End::Horizon) {
        return;
    }
    let state = run.state();
    for (agent, place) in places.enumerate() {
        let slot = state.slot(agent, 0);
        moved[place].position = state.position(slot);
        moved[place].velocity = state.velocity(slot);
    }
}

/// The agents who keep a run from starting.
fn agents_of(fault: &Fault) -> Vec<AgentId> {
    match *fault {
        Fault::Together { agents: (one, other) } => vec![one, other],
        Fault::Inside { agent } | Fault::Nowhere { agent } => vec![agent],
        _ => Vec::new(),
    }
}

impl Motion for SocialForce {
    /// An end that was projected before goes on from there: people who are hidden react to where the others were seen.
    /// Ends of different times begin at their own time; until then they act on the others as if they had come straight.
    fn project(&mut self, ends: &[TracePoint], time: f64) -> Vec<TracePoint> {
        let known = |end: &TracePoint| self.last.iter().find(|one| one.end == *end && one.time <= time);
        let mut walkers: Vec<Walker> =
            ends.iter().map(|end| known(end).copied().unwrap_or_else(|| Walker::at(end))).collect();
        let mut times: Vec<f64> = walkers.iter().map(|one| one.time).chain([time]).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        for pair in times.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let all: Vec<Walker> = walkers.iter().map(|one| one.straight(from)).collect();
            for (one, moved) in walkers.iter_mut().zip(self.walk(&all, to)) {
                if one.time <= from {
                    *one = moved;
                }
            }
        }
        let point = |one: &Walker| TracePoint {
            time,
            position: one.position,
            velocity: one.end.velocity.map(|_| one.velocity),
        };
        let points = walkers.iter().map(point).collect();
        self.last = walkers;
        points
    }

    fn name(&self) -> &'static str {
        "social-force"
    }
}

#[cfg(test)]
mod tests;
