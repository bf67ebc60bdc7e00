//! Whether the step is short enough for the forces of the scenario.
//!
//! A body of mass m that touches n others feels a social force that falls with n A/B a metre. Steps of more than
//! 2/sqrt(n A/(m B)) let it swing farther from one to the next (the bound of the Störmer-Verlet method). Where bodies
//! collide at their driving speed, the n/2 in front overlap by a depth d, at which the force falls with A/B exp(d/B) a metre.
//! Compression and friction are advanced in sub-steps and set no bound, and driving is solved exactly: a fifth of tau
//! is where the speed of dense streams begins to depend on the step. Without forces the gap to those ahead takes the time gap
//! to relax, so that a fifth of it is the bound likewise. Of a law counts the value that one draw in 740 goes beyond, as 3
//! standard deviations of a normal one.

use crate::base::decimal::Decimal;
use crate::base::math::{at_least, at_most, exp};
use crate::base::tick::Clock;
use crate::compile::context::{Context, symbols::Meaning};
use crate::model::{Agent, AgentId, Kind, Parameter};
use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::collections::BTreeMap;

/// Discs of one size that can touch another one at once.
const MOST_NEIGHBOURS: usize = 6;
/// Share of draws below the least value that counts.
const RARE: f64 = 0.00135;
/// Parts into which a step is cut so that what was a whole number of steps stays one, and decimals end.
const PARTS: [i64; 5] = [1, 2, 4, 5, 8];

/// The longest steps for a body, s.
#[derive(Clone, Copy)]
struct Longest {
    force: f64,
    relaxation: f64,
    /// The time of which that is a fifth.
    time: Parameter,
    /// How deep bodies overlap that collide, m, if that is what sets the bound; else 0.
    depth: f64,
}

impl Longest {
    /// For someone who can touch so many others at once.
    fn of(agent: &Agent, neighbours: usize) -> Self {
        let least = |parameter| agent.body[parameter].draw(RARE);
        let most = |parameter| agent.body[parameter].draw(1.0 - RARE);
        // A body of several persons has their mass and their force.
        let mass = least(Parameter::Mass);
        let terms =
            [(Parameter::A, Parameter::B), (Parameter::A2, Parameter::B2)].map(|(a, b)| (most(a), least(b)));
        let slope = |depth: f64| terms.iter().map(|(a, b)| a / b * exp(depth / b)).sum::<f64>();
        // The depth at which compression (of one person, also in a particle) and social force have taken up the kinetic energy,
        // at most the radius.
        let persons = agent.particle.map_or(1.0, |particle| f64::from(particle.persons));
        let (k1, kinetic) =
            (least(Parameter::K1) / persons, 0.5 * mass * most(Parameter::Speed) * most(Parameter::Speed));
        let energy = |depth: f64| {
            0.5 * k1 * depth * depth + terms.iter().map(|(a, b)| a * b * (exp(depth / b) - 1.0)).sum::<f64>()
        };
        let (mut depth, mut half) = (0.0, most(Parameter::Radius));
        for _ in 0..30 {
            half *= 0.5;
            depth += if energy(depth + half) < kinetic { half } else { 0.0 };
        }
        let (at_rest, colliding) =
            (neighbours as f64 * slope(0.0), neighbours.div_ceil(2) as f64 * slope(depth));
        let rate = most(Parameter::Attention) * at_least(at_rest, colliding) / mass;
        let time = if agent.body.kind == Kind::Cfs { Parameter::TimeGap } else { Parameter::Tau };
        let slower = agent.particle.map_or(1.0, |particle| particle.tau_factor);
        Self {
            force: 2.0 / at_least(rate, 0.0).sqrt(),
            relaxation: slower * least(time) / 5.0,
            time,
            depth: if colliding > at_rest { depth } else { 0.0 },
        }
    }

    fn both(self) -> f64 {
        at_most(self.force, self.relaxation)
    }
}

/// Warns of a step that is too long for the forces of some kinds.
pub(crate) fn check_step(context: &mut Context<'_>, file: &ScenarioFile, agents: &[Agent]) {
    let Clock::Stepped(step) = context.time.clock else { return };
    let setting = file.items.iter().find_map(|item| match item {
        Item::Setting { name, value } if name.name == "step" => Some(value.span),
        _ => None,
    });
    let others = agents.len().saturating_sub(1) + context.scene.barriers.len();
    let neighbours = others.min(MOST_NEIGHBOURS);
    let mut kinds: BTreeMap<&str, Longest> = BTreeMap::new();
    for item in &file.items {
        let (name, kind) = match item {
            Item::Agents(decl) => (&decl.name, &decl.kind),
            Item::Group(decl) => (&decl.name, &decl.kind),
            Item::Source(decl) => (&decl.name, &decl.kind),
            _ => continue,
        };
        let members = match context.names.scopes[0].get(&name.name).map(|entry| &entry.meaning) {
            Some(Meaning::Agent(one)) => std::slice::from_ref(one),
            Some(Meaning::Agents { members, .. }) => members,
            _ => continue,
        };
        // All who are declared together have one body.
        let Some(agent) = members.first().and_then(|&AgentId(id)| agents.get(id as usize)) else {
            continue;
        };
        let longest = Longest::of(agent, neighbours);
        if longest.both() < step.to_f64() {
            let known = kinds.entry(&kind.name).or_insert(longest);
            if longest.both() < known.both() {
                *known = longest;
            }
        }
    }
    let (Some(span), Some(first)) = (setting, kinds.values().next().copied()) else { return };
    let strictest = kinds.values().fold(first, |a, b| if b.both() < a.both() { *b } else { a });
    let named = |(kind, longest): (&&str, &Longest)| {
        format!("`{kind}` (at most {} s)", (longest.both() * 1e4).floor() / 1e4)
    };
    let names: Vec<String> = kinds.iter().map(named).collect();
    let text = format!("a step of {step} s is too long for {}", names.join(" and "));
    let mut warning = Diagnostic::warning(Code::W0801, span, text);
    let reason = if strictest.force >= strictest.relaxation {
        match strictest.time {
            Parameter::TimeGap => {
                "the longest step for the gap to those ahead is a fifth of `time_gap`".to_owned()
            }
            _ => "the longest step for the driving force is a fifth of `tau`".to_owned(),
        }
    } else if strictest.depth > 0.0 {
        format!(
            "the longest step for bodies that collide at their driving speed and overlap by {:.2} m is 2 / sqrt(n A exp({:.2} m / B) / (m B)) with n = {}",
            strictest.depth,
            strictest.depth,
            neighbours.div_ceil(2)
        )
    } else {
        format!("the longest step for touching bodies is 2 / sqrt(n A / (m B)) with n = {neighbours}")
    };
    if let Some(shorter) = shorter(step, strictest.both()) {
        warning = warning.hint(format!("write `step = {shorter}`: {reason}"));
    }
    context.note(warning);
}

/// A part of a step that is no longer than a limit, as it is written.
fn shorter(step: Decimal, limit: f64) -> Option<String> {
    let powers = std::iter::successors(Some(1_i64), |power| power.checked_mul(10)).take(12);
    let parts = powers.flat_map(|power| PARTS.map(|part| part * power));
    let fits = |part: &Decimal| part.to_f64() <= limit;
    let part = parts.filter_map(|count| step.div(Decimal::whole(count))).find(fits)?;
    let ends = Decimal::parse(&part.to_string()) == Some(part);
    Some(if ends { format!("{part} s") } else { format!("{} s / {}", part.numerator(), part.denominator()) })
}
