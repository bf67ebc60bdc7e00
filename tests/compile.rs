//! Scenarios and property files through the front end: what is understood, and what is refused.

#![allow(clippy::disallowed_methods, reason = "a test opens the files that a scenario names")]

use smc::compile::{Files, Input, Study, compile, requests};
use smc::syntax::diagnostic::Diagnostic;
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};

/// Compiles two texts; diagnostics as rendered.
fn compiled(scenario: &str, properties: &str) -> (Option<Study>, String) {
    let sources =
        [Source::new(SourceId(0), "model.scn", scenario), Source::new(SourceId(1), "prop.bltl", properties)];
    let (scenario, mut diagnostics): (_, Vec<Diagnostic>) = parse_scenario(&sources[0]);
    let (properties, more) = parse_properties(&sources[1]);
    diagnostics.extend(more);
    let mut files = Files::default();
    for request in requests(&scenario) {
        let path = format!("{}/../shared/data/eth-biwi/{}", env!("CARGO_MANIFEST_DIR"), request.path);
        files.insert(request.path.clone(), std::fs::read(&path).map_err(|e| e.to_string()));
    }
    let input = Input {
        sources: &sources,
        scenario: &scenario,
        properties: &[properties],
        files: &files,
        settings: &[],
    };
    let (study, found) = compile(&input);
    diagnostics.extend(found);
    (study, render(&diagnostics, &sources, false))
}

#[test]
fn the_corridor_is_understood() {
    let (study, found) =
        compiled(include_str!("../models/corridor.scn"), include_str!("../properties/corridor.bltl"));
    let study = study.expect("no error");
    assert_eq!(found, "");
    assert_eq!(study.title, "Corridor with an oncoming crowd");
    // user, two friends, round(0.4 /m^2 * 11 m * 3.4 m) = 15 oncoming
    assert_eq!(study.worlds[0].scenario.agents.len(), 18);
    assert_eq!(study.worlds.len(), 3, "the plain one and two sides of the comparison");
    assert_eq!(study.queries.len(), 8);
    assert_eq!(study.worlds[0].scenario.moves[0].options.len(), 10);
}
