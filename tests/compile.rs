//! Scenarios and property files through the front end: what is understood, and what is refused.

#![allow(clippy::disallowed_methods, reason = "a test opens the files that a scenario names")]

use smc::compile::study::Ask;
use smc::compile::{Files, Input, Study, compile, requests};
use smc::model::{AgentId, Bool, Who};
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

/// Somebody alone and two more, with parameters.
const THREE: &str = "scenario \"three\"\nhorizon = 2 s\nstep = 0.1 s\nparam n = 1\nparam m = 1\n\
    scene { region hall: rect (0, 0) .. (10, 10) }\nkind adult: sfm preset helbing2000\n\
    agent me: adult { at = (1, 1)  route = hall }\nagents crowd[2]: adult { at = uniform in hall  route = hall }\n";

fn understood(scenario: &str, properties: &str) -> Study {
    let (study, found) = compiled(scenario, properties);
    study.unwrap_or_else(|| panic!("{found}"))
}

fn refused(scenario: &str, properties: &str, code: &str) {
    let (study, found) = compiled(scenario, properties);
    assert!(study.is_none() && found.contains(&format!("error[{code}]")), "{properties}\n{found}");
}

#[test]
fn the_others_are_counted_without_the_one() {
    let asked = |who: &str| understood(THREE, &format!("estimate P({who} in hall)")).worlds[0].atoms.clone();
    for (who, id) in [
        ("others(me)[1]", 1),
        ("others(me)[2]", 2),
        ("others(crowd[1])[1]", 0),
        ("others(crowd[1])[2]", 2),
        ("others(crowd[2])[2]", 1),
    ] {
        let atoms = asked(who);
        assert!(
            matches!(atoms[..], [Bool::In(Who::Agent(AgentId(found)), _)] if found == id),
            "{who}: {atoms:?}"
        );
    }
    refused(THREE, "estimate P(others(me)[3] in hall)", "E0212");
    refused(THREE, "estimate P(forall a in crowd: others(a)[1] in hall)", "E0304");
    // Where each has a formula of its own, it is known who is left out.
    let study = understood(THREE, "estimate P(forall a in crowd: F<=1 s (others(a)[2] in hall))");
    let ids: Vec<u32> = study.worlds[0]
        .atoms
        .iter()
        .map(|atom| if let Bool::In(Who::Agent(id), _) = atom { id.0 } else { panic!("{atom:?}") })
        .collect();
    assert_eq!(ids, [2, 1]);
}

#[test]
fn what_a_comparison_sets_at_its_end_holds_on_both_sides() {
    for (query, expected) in [
        ("under n = 2 with n = 3 under m = 4", [vec![("m", "4"), ("n", "2")], vec![("m", "4"), ("n", "3")]]),
        ("under n = m with n = 3 under m = 4", [vec![("m", "4"), ("n", "4")], vec![("m", "4"), ("n", "3")]]),
        ("under n = 2 with n = 3 under n = 4", [vec![("n", "2")], vec![("n", "3")]]),
        ("under n = 2 with m = 3 under n = 4", [vec![("n", "2")], vec![("m", "3"), ("n", "4")]]),
    ] {
        let study = understood(THREE, &format!("compare P(x(me) > n * m * 1 m) {query}"));
        let Ask::Compare { first, second, .. } = &study.queries[0].ask else { panic!("{query}") };
        for (side, expected) in [first, second].into_iter().zip(expected) {
            let settings = &study.worlds[side.target.world].settings;
            let settings: Vec<_> =
                settings.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
            assert_eq!(settings, expected, "{query}");
        }
    }
}

#[test]
fn the_sides_of_a_comparison_have_one_range() {
    let query = |high: &str| format!("compare E(x(me) at end) in 0 m .. {high} under n = 4 with n = 1");
    refused(THREE, &query("n * 1 m"), "E0605");
    for high in ["9 m", "m * 1 m"] {
        understood(THREE, &query(high));
    }
}

#[test]
fn numbers_of_people_suffice_for_all_who_may_come() {
    // About 1000 come; more than 1024 do in every fifth trial, more than 2048 in none.
    for (limit, most) in [(100, 2048), (999, 2048), (1000, 2048), (1024, 2048), (3000, 4096)] {
        let text = format!(
            "{THREE}source doors: adult {{ at = uniform in hall  every = exponential(0.1 s)  route = hall  limit = {limit} }}"
        )
        .replace("horizon = 2 s", "horizon = 100 s");
        let study = understood(&text, "");
        assert_eq!(study.worlds[0].scenario.sources[0].most, most, "{limit}");
    }
}
