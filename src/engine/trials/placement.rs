//! Whether everybody can be placed, as far as areas tell: known before anything is drawn.

use crate::compile::Starts;
use crate::compile::study::{Query, Study, World};
use crate::engine::fault::Fault;
use crate::kernel::start;
use crate::model::{AgentId, Scenario};
use crate::syntax::source::Span;
use std::collections::BTreeSet;

/// Whether everybody in a world can be placed.
pub fn placeable(world: &World) -> Result<(), Fault> {
    crowds(&world.scenario, |agent| world.place_of(agent)).into_iter().next().map_or(Ok(()), Err)
}

/// Whether everybody in the worlds that some queries ask about can be placed; all places where not are told at once.
pub(in crate::engine) fn all_placeable(study: &Study, asked: &[&Query]) -> Result<(), Fault> {
    let asked: BTreeSet<usize> = asked.iter().flat_map(|query| query.ask.worlds()).collect();
    let worlds = asked.into_iter().filter_map(|world| study.worlds.get(world));
    let found = once(worlds.flat_map(|world| crowds(&world.scenario, |agent| world.place_of(agent))));
    if found.is_empty() { Ok(()) } else { Err(Fault::Crowded(found)) }
}

/// All places where more people are to start than fit, in worlds of which perhaps no more is known.
pub fn overfull_starts(starts: &[Starts]) -> Vec<Fault> {
    once(starts.iter().flat_map(|starts| crowds(&starts.scenario, |agent| starts.place_of(agent))))
}

/// One fault a place: worlds may be alike.
fn once(all: impl Iterator<Item = Fault>) -> Vec<Fault> {
    let mut kept: Vec<Fault> = Vec::new();
    let place = |fault: &Fault| match fault {
        Fault::Placement { place, .. } => *place,
        _ => None,
    };
    for fault in all {
        if !kept
            .iter()
            .any(|known| *known == fault || place(known).is_some() && place(known) == place(&fault))
        {
            kept.push(fault);
        }
    }
    kept
}

/// The places of a scenario where more people are to start than fit.
fn crowds(scenario: &Scenario, place_of: impl Fn(AgentId) -> Option<Span>) -> Vec<Fault> {
    let fault = |crowding: &start::Crowding| {
        let place = crowding.agents.first().and_then(|agent| place_of(*agent));
        Fault::Placement { reason: crowded(scenario, crowding), place }
    };
    start::check_area(scenario).iter().map(fault).collect()
}

/// More people than fit, in words.
fn crowded(scenario: &Scenario, crowding: &start::Crowding) -> String {
    let names: Vec<&str> = crowding
        .agents
        .iter()
        .filter_map(|id| scenario.agents.get(id.0 as usize))
        .map(|a| a.name.as_str())
        .collect();
    let who = match names.as_slice() {
        [] => "nobody".to_owned(),
        [one] => (*one).to_owned(),
        [first, .., last] => format!("{first} to {last} ({} agents)", names.len()),
    };
    let (bodies, free) = (crowding.bodies, crowding.free);
    let all = |least: &str| {
        format!(
            "{who} cannot be placed: their bodies need {least}{bodies:.2} m^2, and the start area has room for {free:.2} m^2"
        )
    };
    match crowding.share.map(|share| (100.0 * share).round()) {
        None => all("at least "),
        Some(100.0..) => all(""),
        Some(share) => format!(
            "{who} cannot be placed: their bodies need {bodies:.2} m^2 of the {free:.2} m^2 in the start area, of which at most {share} % can be filled"
        ),
    }
}
