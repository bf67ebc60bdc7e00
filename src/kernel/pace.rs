//! How fast anybody may go, or nearly: nobody may step over a wall or a body.
//!
//! What a behaviour computes is bounded by interval arithmetic over the ranges of what it reads.

use crate::base::math::{at_least, at_most};
use crate::model::{
    Amount, Arithmetic, Body, Conduct, Domain, Function, Law, Num, Parameter, Route, Scenario, TOP_SPEED,
    VariableId,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Share of draws from a law without an upper end that are slower than its fastest.
const NEARLY_ALL: f64 = 1.0 - 1e-9;
/// Standard deviations of the noise that are foreseen.
const DEVIATIONS: f64 = 6.0;
/// What may be anything.
const ANYTHING: Range = (f64::NEG_INFINITY, f64::INFINITY);

/// Least and largest value.
type Range = (f64, f64);

/// The largest speed that somebody has of their own or by a behaviour, m/s, with the largest noise; beyond the top speed
/// a trial ends anyhow.
pub(super) fn fastest(scenario: &Scenario) -> f64 {
    let start = scenario.agents.iter().map(|agent| agent.start.velocity.norm()).fold(0.0, at_least);
    let pace = Pace::of(scenario);
    let (speed, noise) = (pace.largest(Parameter::Speed), pace.largest(Parameter::Noise));
    at_most(at_least(start, speed + DEVIATIONS * noise), TOP_SPEED)
}

/// What the parameters of a scenario may be.
struct Pace<'s> {
    scenario: &'s Scenario,
    /// The values that parameters have of anybody's own, in the order of [`Parameter::ALL`].
    own: [Range; Parameter::ALL.len()],
}

impl<'s> Pace<'s> {
    fn of(scenario: &'s Scenario) -> Self {
        // Thousands may share one body.
        let mut bodies: BTreeMap<*const Body, [f64; Parameter::ALL.len()]> = BTreeMap::new();
        let mut own = [0.0; Parameter::ALL.len()];
        for agent in &scenario.agents {
            let body = bodies.entry(Arc::as_ptr(&agent.body)).or_insert_with(|| {
                Parameter::ALL.map(|parameter| {
                    if is_asked_for(parameter) { most(&agent.body[parameter]) } else { f64::INFINITY }
                })
            });
            // As they are drawn: who goes on as recorded has the recorded speed, and several as one body a longer
            // relaxation time.
            let recorded = if agent.route == Route::Onward { agent.start.driving().norm() } else { 0.0 };
            let factor = agent.particle.map_or(1.0, |particle| particle.tau_factor);
            for (largest, (parameter, value)) in own.iter_mut().zip(Parameter::ALL.iter().zip(body)) {
                let value = match parameter {
                    Parameter::Speed => at_least(*value, recorded),
                    Parameter::Tau => *value * factor,
                    _ => *value,
                };
                *largest = at_least(*largest, value);
            }
        }
        let ranges = own.map(|largest| if largest.is_finite() { (0.0, largest) } else { ANYTHING });
        Self { scenario, own: ranges }
    }

    /// The largest value that a parameter has of its own or takes by a behaviour.
    fn largest(&self, parameter: Parameter) -> f64 {
        let mut seen: BTreeSet<*const Conduct> = BTreeSet::new();
        let attached = self.scenario.behaviours.attached.iter();
        let conducts = attached.map(|one| &one.conduct).filter(|conduct| seen.insert(Arc::as_ptr(conduct)));
        let changes = conducts.flat_map(|conduct| &conduct.states).flat_map(|mode| &mode.changes);
        let set = changes.filter(|(changed, _)| *changed == parameter).map(|(_, amount)| match amount {
            Amount::Drawn(law) => most(law),
            Amount::Computed(value) => self.range(value).1,
        });
        set.fold(self.own_range(parameter).1, at_least)
    }

    /// The values that a parameter has of anybody's own.
    fn own_range(&self, parameter: Parameter) -> Range {
        let known = Parameter::ALL.iter().zip(self.own).find(|(one, _)| **one == parameter);
        known.map_or(ANYTHING, |(_, range)| range)
    }

    /// The values of a variable: of a process, or, after these, of a parameter of whoever computes.
    fn of_variable(&self, VariableId(id): VariableId) -> Range {
        let variables = &self.scenario.processes.variables;
        match variables.get(id as usize) {
            Some(variable) => match variable.domain {
                Domain::Whole { low, high } => (low as f64, high as f64),
                Domain::Truth => (0.0, 1.0),
                Domain::Real => ANYTHING,
            },
            None => self.own.get(id as usize - variables.len()).copied().unwrap_or(ANYTHING),
        }
    }

    /// The values that a number may take.
    fn range(&self, num: &Num) -> Range {
        let of = |num: &Num| self.range(num);
        let found = match num {
            Num::Constant(value) => (*value, *value),
            Num::Variable(id) => self.of_variable(*id),
            Num::If(_, a, b) => {
                let ((a, b), (c, d)) = (of(a), of(b));
                hull([a, b, c, d])
            }
            Num::Apply(function, a) => {
                let (low, high) = of(a);
                match function {
                    Function::Negate => (-high, -low),
                    Function::Abs => (0.0, at_least(low.abs(), high.abs())),
                    Function::Sqrt => (0.0, at_least(high, 0.0).sqrt()),
                    Function::Sin | Function::Cos => (-1.0, 1.0),
                    Function::Floor | Function::Ceil | Function::Round => (low.floor(), high.ceil()),
                    Function::ServiceLevel => (1.0, 6.0),
                    Function::Exp | Function::Ln => ANYTHING,
                }
            }
            Num::Combine(operation, a, b) => {
                let ((a, b), (c, d)) = (of(a), of(b));
                match operation {
                    Arithmetic::Add => (a + c, b + d),
                    Arithmetic::Subtract => (a - d, b - c),
                    Arithmetic::Multiply => hull([a * c, a * d, b * c, b * d]),
                    Arithmetic::Divide if c > 0.0 || d < 0.0 => hull([a / c, a / d, b / c, b / d]),
                    Arithmetic::Min => (at_most(a, c), at_most(b, d)),
                    Arithmetic::Max => (at_least(a, c), at_least(b, d)),
                    _ => ANYTHING,
                }
            }
            _ => ANYTHING,
        };
        if found.0.is_nan() || found.1.is_nan() { ANYTHING } else { found }
    }
}

/// Whether anybody asks for the largest value of a parameter.
fn is_asked_for(parameter: Parameter) -> bool {
    use Parameter::{Attention, Lambda, Noise, Speed, Tau};
    matches!(parameter, Speed | Noise | Tau | Lambda | Attention)
}

/// The largest value of a law, or nearly.
fn most(law: &Law) -> f64 {
    match law.bounds() {
        (_, high) if high.is_finite() => high,
        _ => match law {
            Law::Random { family, .. } => family.quantile(NEARLY_ALL),
            Law::Constant(value) => *value,
        },
    }
}

/// From the least to the largest; anything where one is no number.
fn hull(values: [f64; 4]) -> Range {
    if values.iter().any(|value| value.is_nan()) {
        return ANYTHING;
    }
    (
        values.iter().copied().fold(f64::INFINITY, at_most),
        values.iter().copied().fold(f64::NEG_INFINITY, at_least),
    )
}

#[cfg(test)]
mod tests;
