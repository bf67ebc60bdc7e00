//! Two texts compiled and run in one go.

use smc::compile::{Files, Input, Request, Study, compile, own_errors, requests};
use smc::engine::outcome::CallResult;
use smc::engine::{Budget, Call, CommandLine, Nobody, Threads};
use smc::syntax::diagnostic::{Diagnostic, Severity};
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};

/// Two texts and all that the front end says of them.
pub(crate) struct Front {
    pub(crate) sources: Vec<Source>,
    /// What the parser has found.
    pub(crate) misread: Vec<Diagnostic>,
    /// What the compiler has found.
    pub(crate) found: Vec<Diagnostic>,
    /// The same without what follows from errors of the parser.
    pub(crate) own: Vec<Diagnostic>,
    pub(crate) study: Option<Study>,
}

impl Front {
    /// Parses and compiles a scenario and properties; `files` gives what the scenario names.
    pub(crate) fn of(scenario: &str, properties: &str, files: impl FnOnce(Vec<Request>) -> Files) -> Self {
        let sources = vec![
            Source::new(SourceId(0), "model.scn", scenario),
            Source::new(SourceId(1), "prop.bltl", properties),
        ];
        let (scenario, mut misread) = parse_scenario(&sources[0]);
        let (properties, more) = parse_properties(&sources[1]);
        misread.extend(more);
        let (files, properties) = (files(requests(&scenario)), [properties]);
        let input = Input {
            sources: &sources,
            scenario: &scenario,
            properties: &properties,
            files: &files,
            settings: &[],
        };
        let (study, found) = compile(&input);
        let own = own_errors(found.clone(), &misread, &input);
        Self { sources, misread, found, own, study }
    }

    /// The same of texts that name no files.
    pub(crate) fn plain(scenario: &str, properties: &str) -> Self {
        Self::of(scenario, properties, |_| Files::default())
    }

    /// All that was found, in its order.
    pub(crate) fn said(&self) -> Vec<Diagnostic> {
        [self.misread.as_slice(), &self.found].concat()
    }
}

/// Compiles a scenario and properties; the study, or the errors as rendered.
pub(crate) fn compiled(scenario: &str, properties: &str) -> Result<Study, String> {
    let front = Front::plain(scenario, properties);
    let said = front.said();
    let is_right = said.iter().all(|one| one.severity != Severity::Error);
    front.study.filter(|_| is_right).ok_or_else(|| render(&said, &front.sources, false))
}

/// Runs a study with a seed and at most so many trials of a query.
pub(crate) fn answered(study: &Study, seed: u64, threads: usize, most: u64) -> CallResult {
    let call = Call {
        branch: 0,
        explains: true,
        shows_evidence: false,
        repeats: false,
        seed,
        line: CommandLine { scenario: "model.scn".to_owned(), ..CommandLine::default() },
        only: Vec::new(),
        place: &|_| (String::new(), 0),
        drivers: &smc::kernel::driver::straight,
    };
    let budget = Budget::new(most, None);
    smc::engine::run(study, &call, &Threads::new(Some(threads)).unwrap(), &budget, &Nobody).unwrap()
}
