//! The number and the place that decided a condition: what a comparison compared, and where the agent was.

use crate::compile::dimension::Dimension;
use crate::engine::answer::words;
use crate::engine::witness::culprits::Search;
use crate::model::{
    AgentId, Arithmetic, Axis, Domain, Field, Fold, Function, Num, Place, Scenario, Separation, Who,
};

/// The agent that decided a condition, and the number that a comparison of it compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Decider {
    /// Its name.
    pub agent: String,
    /// Where it was, m.
    pub place: [f64; 2],
    /// On which level or stairs, if there are levels.
    pub level: Option<String>,
    /// The compared number, SI; none where several were, or none.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// The number that it was compared with, where that is not the same in all states.
    pub against: Option<f64>,
    /// The other agent, where the number is measured from one to another.
    pub other: Option<String>,
    /// Whether the number is a distance to the agent.
    pub is_between: bool,
}

/// What decided, of the agents that were found; none where nobody was.
pub(super) fn decider(search: &Search<'_>) -> Option<Decider> {
    let (id, scenario) = (*search.found().first()?, search.scenario());
    let agent = search.name_of(id)?;
    let place = place_of(search, id)?;
    let level = level_of(search, id);
    let sides = search.compared();
    // A comparison with the present time says no more than when it was made: `done(a)`.
    let compared = sides.filter(|(_, b)| !matches!(b, Num::Time)).and_then(|(a, b)| {
        let dimension = dimension(scenario, a).or_else(|| dimension(scenario, b))?;
        let [value, against] = search.values(&[a.clone(), b.clone()])[..] else { return None };
        let is_fixed = matches!(b, Num::Constant(_));
        (!value.is_nan()).then(|| (value, dimension.to_string(), (!is_fixed).then_some(against)))
    });
    let is_gap = sides.is_some_and(|(a, b)| is_gap(a) || is_gap(b));
    let other = match search.found() {
        [_, other] if is_gap && !search.is_member() => Some(*other),
        _ => sides.and_then(|(a, b)| nearest(search, a).or_else(|| nearest(search, b))),
    };
    let is_between = is_gap && search.is_member();
    let (value, unit, against) = compared.map_or_else(Default::default, |(v, unit, a)| (Some(v), unit, a));
    let other = other.filter(|_| value.is_some()).and_then(|id| search.name_of(id));
    Some(Decider { agent, place, level, value, unit, against, other, is_between })
}

/// A decider before the names of the agents: `: 0.21 m to westbound[6] at (9.2, 1.4) m`, and further agents.
pub(super) fn written(decider: &Decider, others: &[String]) -> String {
    let mut said = String::from(": ");
    if let Some(value) = decider.value {
        said.push_str(&words::brief(value, &decider.unit));
        if let Some(against) = decider.against {
            said = format!("{said} against {}", words::brief(against, &decider.unit));
        }
        said.push_str(if decider.is_between { " to " } else { " of " });
    }
    let [x, y] = decider.place.map(|part| words::number((part * 100.0).round() / 100.0));
    let level = decider.level.as_ref().map_or(String::new(), |level| format!("{level} "));
    said = format!("{said}{} at {level}({x}, {y}) m", decider.agent);
    if let Some(other) = &decider.other {
        said = format!("{said} to {other}");
    }
    for other in
        others.iter().filter(|other| **other != decider.agent && Some(*other) != decider.other.as_ref())
    {
        said = format!("{said}, {other}");
    }
    said
}

fn place_of(search: &Search<'_>, id: AgentId) -> Option<[f64; 2]> {
    let at = |axis| Num::Coordinate(axis, Place::Agent(Who::Agent(id)));
    let place: [f64; 2] = search.values(&[at(Axis::X), at(Axis::Y)]).try_into().ok()?;
    place.iter().all(|part| part.is_finite()).then_some(place)
}

/// The level or stairs on which an agent is.
fn level_of(search: &Search<'_>, id: AgentId) -> Option<String> {
    let islands = &search.scenario().scene.storeys.islands;
    let number = if islands.is_empty() { None } else { Some(Num::Of(Field::Storey, Who::Agent(id))) };
    let island = *search.values(std::slice::from_ref(&number?)).first()?;
    islands.get(island as usize).map(|island| island.name.clone())
}

/// The agent that gives another one its clearance; none where that is a wall.
fn nearest(search: &Search<'_>, num: &Num) -> Option<AgentId> {
    let Num::Of(Field::Separation(Separation::Clearance), Who::Agent(id)) = num else { return None };
    let others = (0..search.scenario().agents.len() as u32).map(AgentId).filter(|other| other != id);
    let others: Vec<AgentId> = others.filter(|other| search.is_there(*other)).collect();
    let radius = |id| Box::new(Num::Of(Field::Radius, Who::Agent(id)));
    let gap = |other: &AgentId| {
        let place = |id| Place::Agent(Who::Agent(id));
        let radii = Num::Combine(Arithmetic::Add, radius(*id), radius(*other));
        Num::Combine(
            Arithmetic::Subtract,
            Box::new(Num::Distance(place(*id), place(*other))),
            Box::new(radii),
        )
    };
    let gaps = search.values(&others.iter().map(gap).collect::<Vec<_>>());
    let clearance = *search.values(std::slice::from_ref(num)).first()?;
    let least = others.into_iter().zip(gaps).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least.1 <= clearance + 1e-9).then_some(least.0)
}

/// Whether a number is measured between two bodies.
fn is_gap(num: &Num) -> bool {
    match num {
        Num::Distance(..) | Num::OfTwo(..) => true,
        Num::Combine(_, a, b) => is_gap(a) || is_gap(b),
        Num::Apply(_, a) | Num::Fold(_, _, a) => is_gap(a),
        _ => false,
    }
}

/// The dimension of a number; none of one that constants alone decide.
fn dimension(scenario: &Scenario, num: &Num) -> Option<Dimension> {
    let of = |num: &Num| dimension(scenario, num);
    Some(match num {
        Num::Constant(_) => return None,
        Num::Time if scenario.clock == crate::base::tick::Clock::Steps => Dimension::STEPS,
        Num::Time => Dimension::TIME,
        Num::Variable(id) => match scenario.processes.variables.get(id.0 as usize)?.domain {
            Domain::Whole { .. } | Domain::Truth => Dimension::NONE,
            Domain::Real => return None,
        },
        Num::Of(field, _) => field.dimension()?,
        Num::OfTwo(pair, ..) => pair.dimension()?,
        Num::OfSet(collective, _) => collective.dimension()?,
        Num::Voronoi(_) => Dimension::DENSITY,
        Num::Coordinate(..) | Num::Distance(..) | Num::Depth(..) => Dimension::LENGTH,
        Num::Apply(Function::Sqrt, a) => of(a)?.root()?,
        Num::Apply(
            Function::Exp | Function::Ln | Function::Sin | Function::Cos | Function::ServiceLevel,
            _,
        )
        | Num::Count(..)
        | Num::Crossings(..) => Dimension::NONE,
        Num::Apply(_, a) | Num::Fold(Fold::Min | Fold::Max | Fold::Sum | Fold::Mean, _, a) => of(a)?,
        Num::Combine(Arithmetic::Multiply, a, b) => of(a)?.times(of(b)?)?,
        Num::Combine(Arithmetic::Divide, a, b) => of(a)?.over(of(b)?)?,
        Num::Combine(Arithmetic::Power, ..) => return None,
        Num::Combine(Arithmetic::Atan2, ..) => Dimension::ANGLE,
        Num::Combine(_, a, b) | Num::If(_, a, b) => of(a).or_else(|| of(b))?,
    })
}
