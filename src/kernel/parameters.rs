//! The parameters of bodies, drawn from their laws.

use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::law::Ready;
use crate::model::{AgentId, Body, Parameter, Route, Scenario};
use std::sync::Arc;

/// Parameters of one agent of one trial, SI units, in the order of [`Parameter::ALL`].
pub(super) type Values = [f64; Parameter::COUNT];

/// A value with which nobody can move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Impossible {
    pub(super) agent: AgentId,
    pub(super) parameter: Parameter,
    pub(super) value: f64,
}

/// The laws of all bodies of a scenario, made ready to draw from in every trial.
#[derive(Clone, Debug)]
pub struct Parameters {
    scenario: Arc<Scenario>,
    /// Equal ones once.
    laws: Vec<[Ready; Parameter::COUNT]>,
    /// Whose laws are which.
    laws_of: Vec<u32>,
}

impl Parameters {
    /// Makes the laws of a scenario ready.
    pub(super) fn new(scenario: &Arc<Scenario>) -> Self {
        let mut out = Self { scenario: Arc::clone(scenario), laws: Vec::new(), laws_of: Vec::new() };
        let mut bodies: Vec<&Arc<Body>> = Vec::new();
        for agent in &scenario.agents {
            // Members of one declaration share their body.
            let known = bodies.iter().rposition(|known| Arc::ptr_eq(known, &agent.body));
            let index = known.unwrap_or_else(|| {
                bodies.push(&agent.body);
                out.laws.push(Parameter::ALL.map(|parameter| agent.body[parameter].ready()));
                bodies.len() - 1
            });
            out.laws_of.push(index as u32);
        }
        out
    }

    /// The parameters of an agent, or of the person so many numbers later on its place, as drawn in a trial. A body of several
    /// persons has the mass of them all, their common force and the smaller noise of their mean.
    pub(super) fn draw(&self, (id, later): (AgentId, u32), key: TrialKey) -> Result<Values, Impossible> {
        let agent = &self.scenario.agents[id.0 as usize];
        let laws = &self.laws[self.laws_of[id.0 as usize] as usize];
        let stream = Stream::of(key, agent.entity + later, Purpose::Parameter);
        let shared = agent.start.wants_as.map(|one| Stream::of(key, one, Purpose::Parameter));
        let value = |parameter: Parameter, person: u32| {
            let law = &laws[parameter as usize];
            let stream = shared.as_ref().filter(|_| parameter == Parameter::Speed).unwrap_or(&stream);
            let draw = || law.draw(stream.uniform(agent.body.draw_of(parameter).wrapping_add(person)));
            let value = law.constant().unwrap_or_else(draw);
            if parameter.allows(value) { Ok(value) } else { Err(Impossible { agent: id, parameter, value }) }
        };
        // Parameters that the kind does not have are never read.
        let mut values = [0.0; Parameter::COUNT];
        for parameter in Parameter::of_kind(agent.body.kind) {
            values[parameter as usize] = value(parameter, 0)?;
        }
        if let Some(particle) = agent.particle {
            let persons = particle.persons.max(1);
            let many = f64::from(persons);
            for person in 1..persons {
                values[Parameter::Mass as usize] += value(Parameter::Mass, person)?;
            }
            values[Parameter::Radius as usize] = particle.radius(values[Parameter::Radius as usize]);
            values[Parameter::Tau as usize] *= particle.tau_factor;
            // Groups pass through each other, so as bodies they have no manners. The part of the headway that a follower leaves stays.
            values[Parameter::Headway as usize] *= 1.0 - values[Parameter::Follow as usize];
            for manner in Parameter::MANNERS {
                values[manner as usize] = 0.0;
            }
            values[Parameter::A as usize] *= many;
            values[Parameter::Noise as usize] /= many.sqrt();
        }
        Ok(values)
    }

    /// The same as the agent has them: who goes on as recorded has the recorded speed as driving speed.
    pub(super) fn own(&self, who: (AgentId, u32), key: TrialKey) -> Option<Values> {
        let agent = self.scenario.agents.get(who.0.0 as usize)?;
        let mut values = self.draw(who, key).ok()?;
        let recorded = agent.start.driving().norm();
        if agent.route == Route::Onward && recorded > 0.0 && !agent.start.own_speed {
            values[Parameter::Speed as usize] = recorded;
        }
        Some(values)
    }
}
