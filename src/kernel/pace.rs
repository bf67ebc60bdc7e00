//! How fast anybody may go, or nearly: nobody may step over a wall or a body.
//!
//! What a behaviour computes is bounded by interval arithmetic over the ranges of what it reads.

use crate::base::math::{at_least, at_most};
use crate::model::{
    Amount, Arithmetic, Body, Domain, Function, Law, Num, Parameter, Scenario, TOP_SPEED, VariableId,
};

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
    let (speed, noise) = (largest(scenario, Parameter::Speed), largest(scenario, Parameter::Noise));
    at_most(at_least(start, speed + DEVIATIONS * noise), TOP_SPEED)
}

/// The largest value that a parameter has of its own or takes by a behaviour.
fn largest(scenario: &Scenario, parameter: Parameter) -> f64 {
    let modes = scenario.behaviours.attached.iter().flat_map(|one| &one.conduct.states);
    let changes = modes.flat_map(|mode| &mode.changes).filter(|(changed, _)| *changed == parameter);
    let set = changes.map(|(_, amount)| match amount {
        Amount::Drawn(law) => most(law),
        Amount::Computed(value) => range(scenario, value).1,
    });
    set.fold(own(scenario, parameter).1, at_least)
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

/// The values that a parameter has of anybody's own.
fn own(scenario: &Scenario, parameter: Parameter) -> Range {
    let of: fn(&Body) -> &Law = match parameter {
        Parameter::Speed => |body| &body.speed,
        Parameter::Noise => |body| &body.noise,
        Parameter::Tau => |body| &body.tau,
        Parameter::Lambda => |body| &body.lambda,
        Parameter::Attention => |body| &body.attention,
        _ => return ANYTHING,
    };
    (0.0, scenario.agents.iter().map(|agent| most(of(&agent.body))).fold(0.0, at_least))
}

/// The values of a variable: of a process, or, after these, of a parameter of whoever computes.
fn of_variable(scenario: &Scenario, VariableId(id): VariableId) -> Range {
    let variables = &scenario.processes.variables;
    match variables.get(id as usize) {
        Some(variable) => match variable.domain {
            Domain::Whole { low, high } => (low as f64, high as f64),
            Domain::Truth => (0.0, 1.0),
            Domain::Real => ANYTHING,
        },
        None => Parameter::ALL
            .get(id as usize - variables.len())
            .map_or(ANYTHING, |parameter| own(scenario, *parameter)),
    }
}

/// The values that a number may take.
fn range(scenario: &Scenario, num: &Num) -> Range {
    let of = |num: &Num| range(scenario, num);
    let found = match num {
        Num::Constant(value) => (*value, *value),
        Num::Variable(id) => of_variable(scenario, *id),
        Num::If(_, a, b) => hull([of(a).0, of(a).1, of(b).0, of(b).1]),
        Num::Apply(function, a) => {
            let (low, high) = of(a);
            match function {
                Function::Negate => (-high, -low),
                Function::Abs => (0.0, at_least(low.abs(), high.abs())),
                Function::Sqrt => (0.0, at_least(high, 0.0).sqrt()),
                Function::Sin | Function::Cos => (-1.0, 1.0),
                Function::Floor | Function::Ceil | Function::Round => (low.floor(), high.ceil()),
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
