//! Two texts compiled and run in one go.

use smc::compile::{Files, Input, Study, compile};
use smc::engine::outcome::CallResult;
use smc::engine::{Budget, Call, CommandLine, Nobody, Threads};
use smc::syntax::diagnostic::Severity;
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};

/// Compiles a scenario and properties; the study, or the errors as rendered.
pub(crate) fn compiled(scenario: &str, properties: &str) -> Result<Study, String> {
    let sources =
        [Source::new(SourceId(0), "model.scn", scenario), Source::new(SourceId(1), "prop.bltl", properties)];
    let (scenario, mut diagnostics) = parse_scenario(&sources[0]);
    let (properties, more) = parse_properties(&sources[1]);
    diagnostics.extend(more);
    let input = Input {
        sources: &sources,
        scenario: &scenario,
        properties: &[properties],
        files: &Files::default(),
        settings: &[],
    };
    let (study, found) = compile(&input);
    diagnostics.extend(found);
    study
        .filter(|_| diagnostics.iter().all(|d| d.severity != Severity::Error))
        .ok_or_else(|| render(&diagnostics, &sources, false))
}

/// Runs a study with a seed and at most so many trials of a query.
pub(crate) fn answered(study: &Study, seed: u64, threads: usize, most: u64) -> CallResult {
    let call = Call {
        branch: 0,
        explains: true,
        shows_evidence: false,
        seed,
        line: CommandLine { scenario: "model.scn".to_owned(), ..CommandLine::default() },
        only: Vec::new(),
        place: &|_| (String::new(), 0),
        drivers: &smc::kernel::driver::straight,
    };
    let budget = Budget::new(most, None);
    smc::engine::run(study, &call, &Threads::new(Some(threads)).unwrap(), &budget, &Nobody).unwrap()
}
