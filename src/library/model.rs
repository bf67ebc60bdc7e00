//! A model: a scenario that was understood.

use super::diagnostics::Diagnostics;
use super::front::{Folder, Inputs, Names, load};
use super::options::Options;
use super::program::{Programs, playing, unallowed};
use super::refusal::{refusal, refusals};
use super::report::Report;
use super::trial::Trial;
use super::ways::{is_refused, survey};
use crate::base::random::TrialKey;
use crate::compile::{Study, matches};
use crate::engine::outcome::CallResult;
use crate::engine::{Call, CommandLine, Nobody, no_start, placeable, run};
use crate::gait;
use crate::kernel::driver::{Drivers, MakeDrivers};
use crate::kernel::{Address, Program};
use crate::model::Scenario;
use crate::route::Ways;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::{Source, Span};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

/// A scenario with what belongs to it, before it is parsed.
///
/// ```
/// use smc::Draft;
///
/// let text = "horizon = 10 steps\nparam n = 3\nprocess p { var x: 0 .. 9 = 0; when x < n -> x = x + 1 }";
/// let model = Draft::new("count.scn", text).set("n", "5").parse().unwrap();
/// assert!(model.check("check P(F<=5 steps (p.x == 5)) >= 0.9", &smc::Options::default()).is_ok());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Draft {
    name: String,
    text: String,
    settings: Vec<(String, String)>,
    files: BTreeMap<String, Vec<u8>>,
    /// Where a program of the scenario may run.
    runs_in: Option<PathBuf>,
}

impl Draft {
    /// A scenario; messages and replay lines call it by this name.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into(), ..Self::default() }
    }

    /// Sets a parameter, as `--set` does: `0.8 /m^2`, `3`, `normal(1 m/s, 0.2 m/s)`, or a sweep, `1 .. 3 by 1`.
    #[must_use]
    pub fn set(mut self, parameter: impl Into<String>, value: impl Into<String>) -> Self {
        let parameter = parameter.into();
        self.settings.retain(|(known, _)| *known != parameter);
        self.settings.push((parameter, value.into()));
        self
    }

    /// Gives the contents of a file that the scenario names: a recording or an import.
    #[must_use]
    pub fn file(mut self, path: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(path.into(), bytes.into());
        self
    }

    /// Lets the program of the scenario run, in a folder.
    #[must_use]
    pub fn allow_run(mut self, folder: impl Into<PathBuf>) -> Self {
        self.runs_in = Some(folder.into());
        self
    }

    /// The programs of a call, if the scenario has one and it may run.
    fn programs(
        &self,
        study: &Study,
        is_over: impl Fn() -> bool + Send + Sync + 'static,
    ) -> Result<Option<Arc<Programs>>, Diagnostic> {
        let Some(error) = unallowed(study) else { return Ok(None) };
        let folder = self.runs_in.as_ref().ok_or(error.hint("call `Draft::allow_run` if you trust it"))?;
        Ok(Some(Arc::new(Programs::new(folder, is_over))))
    }

    /// Parses and compiles the scenario.
    ///
    /// # Errors
    /// All errors of the text, as the command line shows them.
    pub fn parse(self) -> Result<Model, Diagnostics> {
        let (study, sources, warnings) = self.compiled(None)?;
        let scenario = study.worlds.last().map(|world| world.scenario.clone());
        let scenario = scenario.ok_or_else(|| Diagnostics::new(Vec::new(), sources.clone()))?;
        let world = study.worlds.len() - 1;
        placeable(&study.worlds[world]).map_err(|fault| Diagnostics::new(vec![refusal(&fault)], sources))?;
        let programs = self.programs(&study, || false).ok().flatten();
        Ok(Model { draft: self, scenario, warnings, drivers: None, programs })
    }

    /// Compiles the scenario, perhaps with a property file.
    fn compiled(
        &self,
        properties: Option<(&str, &str)>,
    ) -> Result<(Study, Vec<Source>, Diagnostics), Diagnostics> {
        let names: Vec<String> = properties.iter().map(|(name, _)| (*name).to_owned()).collect();
        let settings = self.assignments();
        let mut given = Given { draft: self, properties: properties.map_or("", |(_, text)| text) };
        let Inputs { sources, diagnostics, study, .. } = load(
            Names {
                scenario: &self.name,
                properties: &names,
                settings: &settings,
                setting: "parameter",
                velocity: None,
                models: &[],
                calibration: None,
            },
            &mut given,
        );
        let found = Diagnostics::new(diagnostics, sources.clone());
        study.map_or(Err(found.clone()), |study| Ok((study, sources, found)))
    }

    fn assignments(&self) -> Vec<String> {
        self.settings.iter().map(|(name, value)| format!("{name}={value}")).collect()
    }
}

/// The texts and files that a draft holds. The scenario is asked for first.
struct Given<'d> {
    draft: &'d Draft,
    properties: &'d str,
}

impl Folder for Given<'_> {
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let text = if name == self.draft.name { self.draft.text.as_str() } else { self.properties };
        Ok(text.as_bytes().to_vec())
    }

    fn file(&mut self, path: &str) -> Result<Vec<u8>, String> {
        let contents = self.draft.files.get(path).cloned();
        contents.ok_or_else(|| format!("the contents of `{path}` were not given; call `Draft::file`"))
    }

    fn matching(&mut self, pattern: &str) -> Vec<String> {
        self.draft.files.keys().filter(|path| matches(pattern, path)).cloned().collect()
    }
}

/// A scenario that was understood.
#[derive(Clone)]
pub struct Model {
    draft: Draft,
    scenario: Arc<Scenario>,
    warnings: Diagnostics,
    /// None where all agents find their way.
    drivers: Option<Arc<MakeOwn>>,
    /// Who runs single trials of a program.
    programs: Option<Arc<Programs>>,
}

/// Makes the drivers of a run.
type MakeOwn = dyn Fn(&Scenario, u64) -> Drivers + Send + Sync;

impl fmt::Debug for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Model").field("draft", &self.draft).finish_non_exhaustive()
    }
}

impl Model {
    /// Parses a scenario that names no files and sets no parameters; [`Draft`] does more.
    ///
    /// # Errors
    /// All errors of the text, as the command line shows them.
    pub fn parse(text: &str) -> Result<Self, Diagnostics> {
        Draft::new("model.scn", text).parse()
    }

    /// The same scenario with another value of a parameter.
    ///
    /// # Errors
    /// Where there is no such parameter, or it takes no such value.
    pub fn with(&self, parameter: &str, value: &str) -> Result<Self, Diagnostics> {
        let model = self.draft.clone().set(parameter, value).parse()?;
        Ok(Self { drivers: self.drivers.clone(), ..model })
    }

    /// Gives agents drivers of their own: `make` is called with the scenario and the seed of a run, and says which agents
    /// have which driver instead of finding the shortest ways. All others head straight for the goals of their routes.
    #[must_use]
    pub fn driven(self, make: impl Fn(&Scenario, u64) -> Drivers + Send + Sync + 'static) -> Self {
        Self { drivers: Some(Arc::new(make)), ..self }
    }

    /// What the scenario says, without its language.
    pub fn scenario(&self) -> &Arc<Scenario> {
        &self.scenario
    }

    /// Warnings about the scenario.
    pub fn warnings(&self) -> &Diagnostics {
        &self.warnings
    }

    /// Answers the queries of a property file.
    ///
    /// # Errors
    /// Errors of the text, and what the engine refuses: no room for crowds, a procedure that does not fit. An error of
    /// the model that only a trial shows is part of the report.
    pub fn check(&self, properties: &str, options: &Options) -> Result<Report, Diagnostics> {
        // Property files are told apart from the scenario by their name.
        let name = if self.draft.name == PROPERTIES { "queries.bltl" } else { PROPERTIES };
        let (mut study, sources, warnings) = self.draft.compiled(Some((name, properties)))?;
        let wrong = |found: Vec<Diagnostic>| Diagnostics::new(found, sources.clone());
        let only = options.chosen(&study).map_err(|error| wrong(vec![error]))?;
        let place = |span: Span| {
            let source = sources.iter().find(|source| source.id == span.source);
            source.map_or((String::new(), 0), |s| (s.name.clone(), s.line_column(span.start).0))
        };
        let line = CommandLine {
            scenario: self.draft.name.clone(),
            properties: vec![name.to_owned()],
            settings: self.draft.assignments(),
            ..CommandLine::default()
        };
        let ways = Ways::default();
        let doubts =
            if self.drivers.is_none() { survey(&mut study, &only, options.seed, &ways) } else { Vec::new() };
        if is_refused(&doubts) {
            return Err(wrong(doubts));
        }
        let budget = Arc::new(options.budget());
        let end = Arc::clone(&budget);
        let programs =
            self.draft.programs(&study, move || end.is_late()).map_err(|error| wrong(vec![error]))?;
        let find = move |scenario: &Scenario, seed: u64| {
            playing(gait::drivers(&ways, scenario, seed), programs.as_ref())
        };
        let drivers: &MakeDrivers = match &self.drivers {
            Some(make) => &**make,
            None => &find,
        };
        let call = Call {
            seed: options.seed,
            branch: 0,
            explains: true,
            shows_evidence: false,
            line,
            only,
            place: &place,
            drivers,
        };
        let threads = options.executor().map_err(|fault| wrong(vec![refusal(&fault)]))?;
        let outcome = run(&study, &call, &threads, &budget, &Nobody);
        let run: CallResult = outcome.map_err(|fault| wrong(refusals(&fault)))?;
        let all = warnings.iter().cloned().chain(doubts).collect();
        Ok(Report::new(run, Diagnostics::new(all, sources.clone())))
    }

    /// A trial, state by state: the same that a check with this seed reads under this index.
    ///
    /// # Errors
    /// Where the trial cannot start: people find no place.
    pub fn trial(&self, seed: u64, index: u64) -> Result<Trial, Diagnostics> {
        let program = Program::driven(
            self.scenario.clone(),
            self.drivers.as_ref().map_or_else(
                || playing(gait::drivers(&Ways::default(), &self.scenario, seed), self.programs.as_ref()),
                |make| make(&self.scenario, seed),
            ),
        );
        let key = TrialKey { seed, index, branch: 0 };
        Trial::new(program, Address::from(key)).map_err(|fault| {
            let reason = no_start(&self.scenario, fault);
            let text = format!("trial {index} cannot start: {reason}");
            Diagnostics::new(vec![Diagnostic::placeless(Code::E0801, text)], Vec::new())
        })
    }
}

/// The name of a property text in messages and replay lines.
const PROPERTIES: &str = "model.bltl";
