//! A model: a scenario that was understood.

use super::diagnostics::Diagnostics;
use super::front::{Folder, Inputs, Names, load};
use super::options::Options;
use super::own::OwnDrivers;
use super::program::{Programs, playing, unallowed};
use super::refusal::{of_model, refusal, refusals};
use super::report::Report;
use super::trial::Trial;
use super::ways::{is_refused, survey};
use crate::base::digest::Digest;
use crate::base::random::TrialKey;
use crate::compile::{Study, matches};
use crate::engine::outcome::{CallResult, Failure};
use crate::engine::traces::{Traces, simulated, traces};
use crate::engine::{Budget, Call, CommandLine, Fault, Nobody, Watch, no_start, placeable, run};
use crate::gait;
use crate::kernel::driver::Drivers;
use crate::kernel::{Address, Program, start};
use crate::model::Scenario;
use crate::report::html::{MOST_NUMBERS, Page, page};
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
    /// Reads files that were not given.
    reader: Option<Reader>,
    /// Folders for recordings and imports, as `--data` names them.
    data: Vec<String>,
}

/// Reads the bytes of a file by the path that the scenario gives it, or says in a sentence why there are none.
#[derive(Clone)]
struct Reader(Arc<ReadFile>);

/// Reads a file.
type ReadFile = dyn Fn(&str) -> Result<Vec<u8>, String> + Send + Sync;

impl fmt::Debug for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Reader")
    }
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

    /// Files that were not given are read by this; it looks into folders that replay lines name as `--data`.
    #[must_use]
    pub fn reading(
        mut self,
        data: Vec<String>,
        read: impl Fn(&str) -> Result<Vec<u8>, String> + Send + Sync + 'static,
    ) -> Self {
        (self.data, self.reader) = (data, Some(Reader(Arc::new(read))));
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
        let (study, Inputs { sources, diagnostics, .. }) = self.compiled(&[])?;
        let warnings = Diagnostics::new(diagnostics, sources.clone());
        let world = study.worlds.len().saturating_sub(1);
        let last = study.worlds.get(world).ok_or_else(|| warnings.clone())?;
        placeable(last).map_err(|fault| Diagnostics::new(vec![refusal(&fault)], sources))?;
        let programs = self.programs(&study, || false).ok().flatten();
        let scenario = last.scenario.clone();
        Ok(Model { draft: self, scenario, warnings, drivers: None, own: OwnDrivers::default(), programs })
    }

    /// Compiles the scenario, perhaps with property files.
    pub(super) fn compiled(&self, properties: &[(&str, &str)]) -> Result<(Study, Inputs), Diagnostics> {
        let names: Vec<String> = properties.iter().map(|(name, _)| (*name).to_owned()).collect();
        let settings = self.assignments();
        let mut given = Given { draft: self, properties };
        let mut inputs = load(
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
        match inputs.study.take() {
            Some(study) => Ok((study, inputs)),
            None => Err(Diagnostics::new(inputs.diagnostics, inputs.sources)),
        }
    }

    fn assignments(&self) -> Vec<String> {
        self.settings.iter().map(|(name, value)| format!("{name}={value}")).collect()
    }
}

/// The texts and files that a draft holds. The scenario is asked for first.
struct Given<'d> {
    draft: &'d Draft,
    properties: &'d [(&'d str, &'d str)],
}

impl Folder for Given<'_> {
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let properties = self.properties.iter().find(|(known, _)| *known == name);
        let text = properties.map_or(self.draft.text.as_str(), |(_, text)| text);
        Ok(text.as_bytes().to_vec())
    }

    fn file(&mut self, path: &str) -> Result<Vec<u8>, String> {
        match (self.draft.files.get(path), &self.draft.reader) {
            (Some(contents), _) => Ok(contents.clone()),
            (None, Some(Reader(read))) => read(path),
            (None, None) => Err(format!("the contents of `{path}` were not given; call `Draft::file`")),
        }
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
    /// Drivers that some agents have in the place of those.
    pub(super) own: OwnDrivers,
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
        Ok(Self { drivers: self.drivers.clone(), own: self.own.clone(), ..model })
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
        self.check_files(&[(name, properties)], options, &Arc::new(options.budget()), &Nobody)
    }

    /// The same for property files, each with its name and its text. Whoever holds the budget may interrupt the check, which
    /// then reports what it has found so far; whoever watches learns how far it is.
    ///
    /// # Errors
    /// As for one property file.
    pub fn check_files(
        &self,
        properties: &[(&str, &str)],
        options: &Options,
        budget: &Arc<Budget>,
        watch: &dyn Watch,
    ) -> Result<Report, Diagnostics> {
        let threads = options.executor();
        self.ask(properties, options, budget, |asked| {
            let Asked { study, call, inputs, prints, programs } = asked;
            let threads = threads?;
            let mut run = run(study, call, &threads, budget, watch)?;
            run.warnings.extend(programs.iter().flat_map(|programs| programs.doubts()));
            let broken = match &run.failure {
                Some(Failure::Model(flaw)) => Some(of_model(flaw)),
                _ => None,
            };
            let found = inputs.iter().cloned().chain(broken).collect();
            run.inputs = prints.to_vec();
            Ok((run, found))
        })
        .map(|((run, found), sources)| {
            let found = Diagnostics::new(found, sources);
            Report::new(CallResult { diagnostics: found.findings(), ..run }, found)
        })
    }

    /// A report as a page that stands by itself: tables, figures, and a player of the trials behind the results, which run again.
    ///
    /// # Errors
    /// As for the check.
    pub fn page(
        &self,
        properties: &[(&str, &str)],
        options: &Options,
        report: &Report,
    ) -> Result<String, Diagnostics> {
        let (budget, run) = (Arc::new(options.budget()), report.run());
        let traces = self.ask(properties, options, &budget, |asked| {
            Ok(traces(asked.study, run, asked.call, &budget, MOST_NUMBERS))
        });
        traces.map(|(traces, sources)| {
            page(Page { run: run.clone(), sources: &sources, traces, ..Page::default() })
        })
    }

    /// Compiles property files with the scenario, surveys the ways, and does some work on what they ask; and the texts.
    pub(super) fn ask<R>(
        &self,
        properties: &[(&str, &str)],
        options: &Options,
        budget: &Arc<Budget>,
        work: impl FnOnce(&Asked<'_>) -> Result<R, Fault>,
    ) -> Result<(R, Vec<Source>), Diagnostics> {
        let (mut study, Inputs { sources, mut diagnostics, prints, .. }) = self.draft.compiled(properties)?;
        let wrong = |found: Vec<Diagnostic>| Diagnostics::new(found, sources.clone());
        let only = options.chosen(&study).map_err(|error| wrong(vec![error]))?;
        let place = |span: Span| {
            let source = sources.iter().find(|source| source.id == span.source);
            source.map_or((String::new(), 0), |s| (s.name.clone(), s.line_column(span.start).0))
        };
        let ways = Ways::default();
        let doubts =
            if self.drivers.is_none() { survey(&mut study, &only, options.seed, &ways) } else { Vec::new() };
        if is_refused(&doubts) {
            return Err(wrong(doubts));
        }
        diagnostics.extend(doubts);
        let end = Arc::clone(budget);
        let programs =
            self.draft.programs(&study, move || end.is_late()).map_err(|error| wrong(vec![error]))?;
        self.own.condition(&mut study.queries);
        let (make, own, played) = (self.drivers.clone(), self.own.clone(), programs.clone());
        let find = move |scenario: &Scenario, seed: u64| {
            let drivers = match &make {
                Some(make) => make(scenario, seed),
                None => playing(gait::drivers(&ways, scenario, seed), played.as_ref()),
            };
            own.join(drivers, scenario)
        };
        let call = Call {
            seed: options.seed,
            branch: 0,
            explains: true,
            shows_evidence: options.evidence,
            repeats: !self.own.is_empty(),
            line: self.line(properties),
            only,
            place: &place,
            drivers: &find,
        };
        let programs = programs.as_deref();
        let asked = Asked { study: &study, call: &call, inputs: &diagnostics, prints: &prints, programs };
        let done = work(&asked).map_err(|fault| wrong(refusals(&fault)))?;
        Ok((done, sources))
    }

    /// A trial, state by state: the same that a check with this seed reads under this index.
    ///
    /// # Errors
    /// Where the trial cannot start: people find no place.
    pub fn trial(&self, seed: u64, index: u64) -> Result<Trial, Diagnostics> {
        let key = TrialKey { seed, index, branch: 0 };
        Trial::new(self.program(seed), Address::from(key)).map_err(|fault| self.no_trial(index, fault))
    }

    /// Some trials of a seed as a page that stands by itself, with a player.
    ///
    /// # Errors
    /// Where one of them cannot start.
    pub fn play(&self, seed: u64, indices: &[u64]) -> Result<String, Diagnostics> {
        let (program, scenario) = (self.program(seed), &self.scenario);
        let one = |index: &u64| {
            let key = TrialKey { seed, index: *index, branch: 0 };
            let trace = simulated(&program, key.into(), scenario.horizon, |_, _| {});
            trace.map_err(|fault| self.no_trial(*index, fault))
        };
        let list = indices.iter().map(one).collect::<Result<_, _>>()?;
        let replay = self.line(&[]).simulate(&[], seed, indices.first().copied().unwrap_or(0));
        let title = if scenario.title.is_empty() { &self.draft.name } else { &scenario.title };
        let run = CallResult { replay, ..CallResult::of(title, seed) };
        let traces = Traces { list, left_out: 0 };
        Ok(page(Page { run, sources: self.warnings.sources(), traces, ..Page::default() }))
    }

    /// The scenario made ready for the trials of a seed.
    pub fn program(&self, seed: u64) -> Program {
        let drivers = match &self.drivers {
            Some(make) => make(&self.scenario, seed),
            None => playing(gait::drivers(&Ways::default(), &self.scenario, seed), self.programs.as_ref()),
        };
        Program::driven(self.scenario.clone(), self.own.join(drivers, &self.scenario))
    }

    /// Why a trial cannot start.
    pub fn no_trial(&self, index: u64, fault: start::Fault) -> Diagnostics {
        let text = format!("trial {index} cannot start: {}", no_start(&self.scenario, fault));
        Diagnostics::new(vec![Diagnostic::placeless(Code::E0801, text)], Vec::new())
    }

    /// The call of the program that asks the same.
    fn line(&self, properties: &[(&str, &str)]) -> CommandLine {
        CommandLine {
            scenario: self.draft.name.clone(),
            properties: properties.iter().map(|(name, _)| (*name).to_owned()).collect(),
            settings: self.draft.assignments(),
            data: self.draft.data.clone(),
            allow_run: self.draft.runs_in.is_some(),
            ..CommandLine::default()
        }
    }
}

/// Queries that were compiled with their scenario.
pub(super) struct Asked<'a> {
    pub(super) study: &'a Study,
    pub(super) call: &'a Call<'a>,
    /// Warnings about the texts and about ways.
    inputs: &'a [Diagnostic],
    prints: &'a [(String, Digest)],
    programs: Option<&'a Programs>,
}

/// The name of a property text in messages and replay lines.
const PROPERTIES: &str = "model.bltl";
