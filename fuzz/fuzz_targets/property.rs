//! Any bytes as a property file beside a fixed scenario: never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use smc::compile::{Files, Input, compile};
use smc::syntax::parse::{decode, parse_properties, parse_scenario};
use smc::syntax::source::{Source, SourceId};

fuzz_target!(|bytes: &[u8]| {
    let Ok(property) = decode(SourceId(1), "fuzz.bltl", bytes) else { return };
    let scenario = Source::new(SourceId(0), "corridor.scn", include_str!("../../models/corridor.scn"));
    let (model, _) = parse_scenario(&scenario);
    let (questions, _) = parse_properties(&property);
    let sources = [scenario, property];
    let files = Files::default();
    let _ = compile(&Input {
        sources: &sources,
        scenario: &model,
        properties: &[questions],
        files: &files,
        settings: &[],
    });
});
