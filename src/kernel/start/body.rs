//! The parameters of a body, drawn from their laws.

use super::Fault;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::law::Ready;
use crate::model::{Agent, AgentId, Body, Parameter};

/// Parameters of one agent of one trial, SI units, in the order of [`Parameter::ALL`].
pub(in crate::kernel) type Values = [f64; Parameter::COUNT];

/// The laws of a body, made ready to draw from in every trial.
#[derive(Clone, Debug)]
pub(super) struct Laws([Ready; Parameter::COUNT]);

impl Laws {
    /// Makes the laws of a body ready.
    pub(super) fn new(body: &Body) -> Self {
        Self(Parameter::ALL.map(|parameter| body[parameter].ready()))
    }

    /// Draws the parameters of one agent of one trial, whose stable number is `entity`. A body of several persons has the mass
    /// of them all, their common force and the smaller noise of their mean.
    pub(super) fn draw(
        &self,
        id: AgentId,
        agent: &Agent,
        entity: u32,
        key: TrialKey,
    ) -> Result<Values, Fault> {
        let stream = Stream::of(key, entity, Purpose::Parameter);
        let value = |parameter: Parameter, person: u32| {
            let law = &self.0[parameter as usize];
            let draw = || law.draw(stream.uniform(parameter.draw().wrapping_add(person)));
            let value = law.constant().unwrap_or_else(draw);
            if parameter.allows(value) {
                Ok(value)
            } else {
                Err(Fault::Parameter { agent: id, name: parameter.name(), value })
            }
        };
        let mut values = [0.0; Parameter::COUNT];
        for parameter in Parameter::ALL {
            values[parameter as usize] = value(parameter, 0)?;
        }
        if let Some(particle) = agent.particle {
            let persons = particle.persons.max(1);
            let many = f64::from(persons);
            for person in 1..persons {
                values[Parameter::Mass as usize] += value(Parameter::Mass, person)?;
            }
            values[Parameter::Radius as usize] *= particle.radius_factor;
            values[Parameter::Tau as usize] *= particle.tau_factor;
            values[Parameter::A as usize] *= many;
            values[Parameter::Noise as usize] /= many.sqrt();
        }
        Ok(values)
    }
}
