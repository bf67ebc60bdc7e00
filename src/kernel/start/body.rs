//! The parameters of a body, drawn from their laws.

use super::Fault;
use crate::base::random::{Purpose, Stream, TrialKey, name_hash};
use crate::model::law::Ready;
use crate::model::{Agent, AgentId, Body};

/// Parameters of one agent of one trial, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parameters {
    pub(super) mass: f64,
    pub(super) radius: f64,
    pub(super) speed: f64,
    pub(super) tau: f64,
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) lambda: f64,
    pub(super) a2: f64,
    pub(super) b2: f64,
    pub(super) lambda2: f64,
    pub(super) k1: f64,
    pub(super) k2: f64,
    pub(super) noise: f64,
    pub(super) attention: f64,
}

/// The draw that belongs to a parameter's name.
const fn draw_of(name: &str) -> u32 {
    name_hash(name) as u32
}

/// Draws of one agent; remembers the first value with which nobody can move.
struct Drawing {
    stream: Stream,
    agent: AgentId,
    fault: Option<Fault>,
}

impl Drawing {
    fn value(&mut self, name: &'static str, draw: u32, law: &Ready, low: f64) -> f64 {
        let value = match law.constant() {
            Some(value) => value,
            None => law.draw(self.stream.uniform(draw)),
        };
        if !(value >= low && value.is_finite()) && self.fault.is_none() {
            self.fault = Some(Fault::Parameter { agent: self.agent, name, value });
        }
        value
    }
}

/// The laws of a body, made ready to draw from in every trial.
#[derive(Clone, Debug)]
pub(super) struct Laws {
    mass: Ready,
    radius: Ready,
    speed: Ready,
    tau: Ready,
    a: Ready,
    b: Ready,
    lambda: Ready,
    a2: Ready,
    b2: Ready,
    lambda2: Ready,
    k1: Ready,
    k2: Ready,
    noise: Ready,
    attention: Ready,
}

impl Laws {
    /// Makes the laws of a body ready.
    pub(super) fn new(body: &Body) -> Self {
        Self {
            mass: body.mass.ready(),
            radius: body.radius.ready(),
            speed: body.speed.ready(),
            tau: body.tau.ready(),
            a: body.a.ready(),
            b: body.b.ready(),
            lambda: body.lambda.ready(),
            a2: body.a2.ready(),
            b2: body.b2.ready(),
            lambda2: body.lambda2.ready(),
            k1: body.k1.ready(),
            k2: body.k2.ready(),
            noise: body.noise.ready(),
            attention: body.attention.ready(),
        }
    }
}

impl Parameters {
    /// Draws them for one agent of one trial, whose stable number is `entity`. A particle has the mass of its persons, their common force
    /// and the smaller noise of their mean.
    pub(super) fn draw(
        id: AgentId,
        agent: &Agent,
        entity: u32,
        body: &Laws,
        key: TrialKey,
    ) -> Result<Self, Fault> {
        let stream = Stream::of(key, entity, Purpose::Parameter);
        let mut from = Drawing { stream, agent: id, fault: None };
        let persons = agent.particle.map_or(1, |particle| particle.persons.max(1));
        let mut mass = 0.0;
        for person in 0..persons {
            let draw = const { draw_of("mass") }.wrapping_add(person);
            mass += from.value("mass", draw, &body.mass, f64::MIN_POSITIVE);
        }
        macro_rules! draw {
            ($name:literal, $law:expr, $low:expr) => {
                from.value($name, const { draw_of($name) }, $law, $low)
            };
        }
        let any = f64::MIN;
        let many = f64::from(persons);
        let (wider, slower) = agent.particle.map_or((1.0, 1.0), |p| (p.radius_factor, p.tau_factor));
        let out = Self {
            mass,
            radius: draw!("radius", &body.radius, 0.0) * wider,
            speed: draw!("speed", &body.speed, any),
            tau: draw!("tau", &body.tau, f64::MIN_POSITIVE) * slower,
            a: draw!("A", &body.a, any) * many,
            b: draw!("B", &body.b, f64::MIN_POSITIVE),
            lambda: draw!("lambda", &body.lambda, any),
            a2: draw!("A2", &body.a2, any),
            b2: draw!("B2", &body.b2, f64::MIN_POSITIVE),
            lambda2: draw!("lambda2", &body.lambda2, any),
            k1: draw!("k1", &body.k1, any),
            k2: draw!("k2", &body.k2, any),
            noise: draw!("noise", &body.noise, 0.0) / many.sqrt(),
            attention: draw!("attention", &body.attention, 0.0),
        };
        from.fault.map_or(Ok(out), Err)
    }
}
