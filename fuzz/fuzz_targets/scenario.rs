//! Any bytes as a scenario: decoded, parsed, compiled, formatted; never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use smc::compile::{Files, Input, compile};
use smc::syntax::parse::{decode, parse_scenario};
use smc::syntax::print::format_scenario;
use smc::syntax::source::SourceId;

fuzz_target!(|bytes: &[u8]| {
    let Ok(source) = decode(SourceId(0), "fuzz.scn", bytes) else { return };
    let (scenario, _) = parse_scenario(&source);
    let _ = format_scenario(&source);
    let sources = [source];
    let files = Files::default();
    let _ = compile(&Input { sources: &sources, scenario: &scenario, properties: &[], files: &files, settings: &[] });
});
