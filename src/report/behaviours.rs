//! Behaviours as they were understood, for `smc show`.

use super::model::{law, number, way};
use crate::compile::study::World;
use crate::model::{
    AgentId, Amount, Arithmetic, Attached, Function, Num, Parameter, Scenario, Transition, Trigger,
};
use std::fmt::Write;

/// The behaviours of an agent.
pub(super) fn describe(out: &mut String, world: &World, id: AgentId) {
    let scenario = &*world.scenario;
    let attached = scenario.behaviours.of(id);
    for one in attached {
        let declared = &scenario.behaviours.declared[one.behaviour.0 as usize];
        let place = one.behaviour.0 as usize;
        let empty = Vec::new();
        let arguments = world.written.arguments.get(place).unwrap_or(&empty);
        let conditions = world.written.conditions.get(place).unwrap_or(&empty);
        let call = world.written.with.get(&(id, one.behaviour)).unwrap_or(&declared.name);
        // The conditions below speak of arguments by their names.
        let named =
            if arguments.is_empty() { String::new() } else { format!(" (its {})", arguments.join(", ")) };
        let _ = writeln!(out, "      with {call}{named}");
        for (name, mode) in declared.states.iter().zip(&one.conduct.states) {
            let mut parts: Vec<String> = mode
                .changes
                .iter()
                .map(|(parameter, amount)| {
                    let unit = &parameter.unit();
                    let value = match amount {
                        Amount::Drawn(value) => law(value, unit),
                        Amount::Computed(num) => match num {
                            Num::Constant(value) if !unit.is_empty() => format!("{} {unit}", number(*value)),
                            num => expression(scenario, num),
                        },
                    };
                    format!("{} = {value}", parameter.name())
                })
                .collect();
            parts.extend(mode.route.as_ref().map(|route| way(scenario, route)));
            parts.extend(
                mode.transitions.iter().map(|t| transition(scenario, &declared.states, conditions, t)),
            );
            let _ = writeln!(out, "        {name}: {}", parts.join("; "));
        }
        if let Some(advice) = advice(scenario, one) {
            let _ = writeln!(out, "        on advice: {advice}");
        }
    }
}

fn advice(scenario: &Scenario, one: &Attached) -> Option<String> {
    let choices: Vec<String> = one
        .conduct
        .advice
        .iter()
        .map(|(weight, follow)| {
            format!("{}: {}", expression(scenario, weight), if *follow { "follow" } else { "ignore" })
        })
        .collect();
    (!choices.is_empty()).then(|| choices.join(" | "))
}

fn transition(scenario: &Scenario, states: &[String], written: &[String], transition: &Transition) -> String {
    let when = match &transition.trigger {
        Trigger::After(time) => format!("after {}", law(time, "s")),
        Trigger::When(guard) => format!("when {}", written.get(*guard as usize).map_or("…", String::as_str)),
    };
    let name = |at: u32| states.get(at as usize).map_or("", String::as_str);
    let targets: Vec<String> = match transition.targets.as_slice() {
        [(_, only)] => vec![name(*only).to_owned()],
        several => {
            several.iter().map(|(w, at)| format!("{}: {}", expression(scenario, w), name(*at))).collect()
        }
    };
    format!("{when} -> {}", targets.join(" | "))
}

/// An expression over processes and own parameters.
fn expression(scenario: &Scenario, num: &Num) -> String {
    let inner = |num: &Num| expression(scenario, num);
    let side = |num: &Num| match num {
        Num::Combine(operator, ..) if !matches!(operator, Arithmetic::Min | Arithmetic::Max) => {
            format!("({})", inner(num))
        }
        Num::Apply(Function::Negate, _) => format!("({})", inner(num)),
        Num::Constant(value) if *value < 0.0 => format!("({})", inner(num)),
        num => inner(num),
    };
    match num {
        Num::Constant(value) => number(*value),
        Num::Variable(id) => {
            let (at, variables) = (id.0 as usize, &scenario.processes.variables);
            match variables.get(at) {
                Some(variable) => variable.name.clone(),
                None => Parameter::ALL.get(at - variables.len()).map_or("", |own| own.name()).to_owned(),
            }
        }
        Num::Combine(operator, a, b) => {
            let sign = match operator {
                Arithmetic::Add => "+",
                Arithmetic::Subtract => "-",
                Arithmetic::Multiply => "*",
                Arithmetic::Divide => "/",
                Arithmetic::Power => "^",
                Arithmetic::Min => return format!("min({}, {})", inner(a), inner(b)),
                Arithmetic::Max => return format!("max({}, {})", inner(a), inner(b)),
                Arithmetic::Atan2 | Arithmetic::Modulo | Arithmetic::Agree => return "…".to_owned(),
            };
            format!("{} {sign} {}", side(a), side(b))
        }
        Num::Apply(Function::Negate, a) => format!("-{}", side(a)),
        _ => "…".to_owned(),
    }
}
