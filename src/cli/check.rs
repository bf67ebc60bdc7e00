//! `smc check`: decide, estimate, compare, rank.

use super::arguments::{Check, Questions};
use super::deadline::{Deadline, Ended, Phase};
use super::launch::Launcher;
use super::merge::Rounds;
use super::outcomes::Given;
use super::parts::PartsFolder;
use super::progress::Progress;
use super::terminal::{Colors, print, say};
use super::values::Destination;
use super::{complaint, inputs, output, page, values};
use crate::base::digest::Digest;
use crate::base::visible::visible;
use crate::engine::outcome::{CallResult, Failure, Finding};
use crate::engine::shards::{Kept, Origin, Part, Recorder, Stored};
use crate::engine::traces::{Traces, traces};
use crate::engine::{Budget, Call, CallForecast, CommandLine, Outcomes, forecast, run as run_study};
use crate::library::program::playing;
use crate::model::Scenario;
use crate::report::html::Page;
use crate::report::{ExitCode as Exit, Format, Palette};
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::{Source, Span};
use crate::trials::budget::DEFAULT_TRIALS;
use crate::{gait, library, report};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where outcomes come from: trials that are run or launched, or the parts in a folder.
pub(super) enum Way<'a> {
    Check(&'a Check),
    Merge(&'a Path),
}

/// Runs the command.
pub(super) fn run(arguments: &Questions, way: &Way<'_>, colors: Colors) -> Exit {
    let (timeout, is_forecast, launch) = match way {
        Way::Check(check) => (check.limit.timeout, check.forecast, check.launch.as_deref()),
        Way::Merge(_) => (None, false, None),
    };
    let mut budget = Budget::new(arguments.max_trials.unwrap_or(DEFAULT_TRIALS), timeout);
    budget.max_total = arguments.total_trials;
    let budget = Arc::new(budget);
    let deadline = Deadline::watch(&budget, ender(arguments, colors));
    let table = match way {
        Way::Check(Check { outcomes: Some(table), .. }) => Some(Given::open(table)),
        _ => None,
    };
    let (given, unread) = match table.transpose() {
        Ok(given) => (given, None),
        Err(error) => (None, Some(error)),
    };
    let inputs::Loaded { mut inputs, paths } = match &unread {
        Some(_) => inputs::Loaded::default(),
        None => {
            let written = given.as_ref().map(Given::scenario);
            inputs::load_with(&arguments.model, &arguments.properties, written)
        }
    };
    if let Some(given) = &given {
        given.own(&mut inputs);
    }
    if inputs.study.is_none() {
        deadline.enter(Phase::Printing);
    }
    complaint::diagnose(&inputs, colors);
    let outputs = Outputs::new(&arguments.format, short(arguments), arguments.report.as_deref(), &paths);
    let mut study = inputs.study.take();
    let mut reporter = Reporter {
        arguments,
        colors,
        deadline: deadline.clone(),
        sources: &inputs.sources,
        findings: inputs::findings(&inputs.diagnostics, &inputs.sources),
        errors: inputs.errors,
        prints: inputs.prints.clone(),
        outputs: Outputs { screen: screen(arguments), files: Vec::new(), page: None },
    };
    match outputs {
        Ok(outputs) => reporter.outputs = outputs,
        Err(error) => return reporter.refuse(error),
    }
    if let Some(error) = unread {
        return reporter.refuse(error);
    }
    let Some(study) = &mut study else { return reporter.refused() };
    let only = match library::chosen(study, &arguments.only) {
        Ok(only) => only,
        Err(error) => return reporter.refuse(error),
    };
    let origin = Origin::of(study, arguments.seed);
    let ways = Ways::default();
    let doubts = library::survey(study, &only, arguments.seed, &ways);
    if library::is_refused(&doubts) {
        return reporter.refuse_for(&doubts);
    }
    reporter.warn(&doubts);
    let programs = match inputs::programs(&arguments.model, study, {
        let budget = Arc::clone(&budget);
        move || budget.is_late()
    }) {
        Ok(programs) => programs,
        Err(error) => return reporter.refuse(error),
    };
    if let Some(Err(error)) = given.as_ref().map(|given| given.settle(study)) {
        return reporter.refuse(error);
    }
    let is_given = given.is_some();
    let certificate = match way {
        Way::Check(check) => check.certificate.as_deref(),
        Way::Merge(_) => None,
    };
    if let Err(error) = output::guard(certificate, &paths) {
        return reporter.refuse(error);
    }
    let kept = certificate.map(|_| Kept::default());
    let most = most_threads();
    if arguments.cores.threads.is_some_and(|threads| threads > most) {
        say(&format!(
            "warning: more than {most} threads are not faster on this machine, so {most} are used; results do not change\n"
        ));
    }
    let is_local = launch == Some("local");
    let shards = arguments.shards.map(|shards| shards as usize);
    // Shards of this process are its threads.
    let fewest = shards.filter(|_| is_local).unwrap_or(most);
    let threads = arguments.cores.threads.unwrap_or_else(cores).min(most).min(fewest);
    let executor = match values::threads(Some(threads)) {
        Ok(executor) => executor,
        Err(error) => return reporter.refuse(error),
    };
    let place = |span: Span| locate(&inputs.sources, span);
    let players = programs.clone();
    let drivers =
        move |scenario: &Scenario, seed: u64| playing(gait::drivers(&ways, scenario, seed), players.as_ref());
    let call = || Call {
        seed: arguments.seed,
        branch: 0,
        explains: !is_given,
        shows_evidence: arguments.evidence || arguments.report.is_some(),
        repeats: false,
        line: CommandLine { outcomes: is_given, ..line(arguments) },
        only: only.clone(),
        place: &place,
        drivers: &drivers,
    };
    if is_forecast {
        deadline.enter(Phase::Sampling);
        return match forecast(study, &call(), &executor, &budget) {
            Ok(total) => reporter.tell(&total),
            Err(fault) => reporter.refuse_for(&library::refusals(&fault)),
        };
    }
    let progress = Progress::new(arguments.quiet, deadline);
    let scenario = study.worlds.first().map(|world| Arc::clone(&world.scenario));
    let result = if let (Some(given), Some(scenario)) = (given, scenario) {
        let work = |outcomes: &Outcomes<'_>| run_study(study, &call(), outcomes, &budget, &progress);
        given.run(&scenario, &executor, work).map(Some)
    } else if let Some(kept) = &kept {
        let keep = |part: &Part| kept.keep(part);
        let recorder = Recorder::new(Stored::nothing(&executor), &executor, origin, &keep);
        let run = run_study(study, &call(), &recorder, &budget, &progress);
        recorder.flush(budget.elapsed());
        run.map(Some).map_err(|fault| library::refusals(&fault))
    } else if let Way::Check(Check { launch: None, .. }) = way {
        let run = run_study(study, &call(), &executor, &budget, &progress);
        run.map(Some).map_err(|fault| library::refusals(&fault))
    } else {
        let mut warn = |warnings: &[Diagnostic]| complaint::tell_all(warnings, &[], colors);
        let mut rounds = Rounds {
            study,
            call: call(),
            origin,
            budget: &budget,
            threads: &executor,
            shards: shards.unwrap_or(100),
            progress: &progress,
            warn: &mut warn,
        };
        let launcher = launch.map(|engine| Launcher { engine, line: line(arguments), jobs: threads });
        folder(way).and_then(|mut folder| match &launcher {
            Some(_) if is_local => rounds.record(&mut folder).map(Some),
            launcher => rounds.run(&mut folder, launcher.as_ref()),
        })
    };
    match result {
        Ok(Some(mut run)) => {
            for result in &mut run.results {
                result.model = inputs.calibration.as_ref().and_then(|known| known.about(result));
            }
            run.warnings.extend(programs.iter().flat_map(|programs| programs.doubts()));
            run.inputs.clone_from(&reporter.prints);
            if let (Some(kept), Some(path)) = (&kept, certificate) {
                let text = report::certificate::text(study, &call(), &budget, &run, kept);
                if let Err(error) = output::save(path, text.as_bytes()) {
                    return reporter.refuse(error);
                }
            }
            let room = report::html::MOST_NUMBERS;
            let is_shown = reporter.outputs.page.is_some() && !is_given;
            let shown = is_shown.then(|| traces(study, &run, &call(), &budget, room));
            reporter.finish(run, shown.unwrap_or_default())
        }
        Ok(None) => Exit::Success,
        Err(errors) => reporter.refuse_for(&errors),
    }
}

/// The folder of the parts of a call.
fn folder(way: &Way<'_>) -> Result<PartsFolder, Vec<Diagnostic>> {
    let named = match way {
        Way::Merge(folder) if !folder.is_dir() => {
            return Err(complaint::input(format!("the folder `{}` does not exist", folder.display())).into());
        }
        Way::Merge(folder) => Some(folder.to_path_buf()),
        // What is printed for Kubernetes is run later.
        Way::Check(Check { launch: Some(engine), parts: None, .. }) if engine == "k8s" => {
            Some("parts".into())
        }
        Way::Check(check) => check.parts.clone(),
    };
    let is_kept = named.is_some();
    // Other machines find it where they find the model.
    let path = named.unwrap_or_else(|| format!(".smc-parts-{}", std::process::id()).into());
    Ok(PartsFolder::new(path, is_kept)?)
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// So many threads are run at most: each has trials of its own to begin and to throw away.
fn most_threads() -> usize {
    (2 * cores()).max(16)
}

/// Writes the output of a call in the requested format.
struct Reporter<'a> {
    arguments: &'a Questions,
    colors: Colors,
    deadline: Deadline,
    sources: &'a [Source],
    findings: Vec<Finding>,
    /// How many errors there are.
    errors: usize,
    prints: Vec<(String, Digest)>,
    /// Where the results go.
    outputs: Outputs,
}

impl Reporter<'_> {
    /// Prints a forecast.
    fn tell(self, total: &CallForecast) -> Exit {
        self.deadline.enter(Phase::Printing);
        let text = match self.outputs.screen {
            Format::Json => report::forecast::json(total),
            Format::Text | Format::Verbose => visible(&report::forecast::text(total)).into_owned(),
            _ => {
                let title = "`--forecast` supports only `--format text` and `--format json`";
                return self.refuse(complaint::argument(title, "write `--format text` or `--format json`"));
            }
        };
        match print(&text) {
            Ok(()) => Exit::Success,
            Err(error) => self.refuse(error),
        }
    }

    /// The call is wrong, or nothing could be run.
    fn refuse(self, error: Diagnostic) -> Exit {
        self.refuse_for(&[error])
    }

    /// The same for several reasons.
    fn refuse_for(mut self, errors: &[Diagnostic]) -> Exit {
        self.deadline.enter(Phase::Printing);
        complaint::tell_all(errors, self.sources, self.colors);
        self.findings.extend(inputs::findings(errors, self.sources));
        self.errors += errors.len();
        self.refused()
    }

    /// Warnings that are known before the first trial.
    fn warn(&mut self, warnings: &[Diagnostic]) {
        if !warnings.is_empty() {
            complaint::tell_all(warnings, self.sources, self.colors);
            self.findings.extend(inputs::findings(warnings, self.sources));
        }
    }

    /// The inputs are wrong; standard error has said how.
    fn refused(self) -> Exit {
        let first = self.findings.iter().find(|finding| finding.error);
        let first = first.map_or_else(|| "the inputs have errors".to_owned(), Finding::line);
        let reason = match self.errors.saturating_sub(1) {
            0 => first,
            1 => format!("{first} (and 1 more error)"),
            more => format!("{first} (and {more} more errors)"),
        };
        self.hand_out(reason)
    }

    /// A report of a run that never began, in formats for machines; people have read it already.
    fn hand_out(mut self, reason: String) -> Exit {
        let run = CallResult {
            inputs: std::mem::take(&mut self.prints),
            diagnostics: std::mem::take(&mut self.findings),
            failure: Some(Failure::Input(reason)),
            ..blank(self.arguments)
        };
        if self.outputs.screen.is_for_programs()
            && let Err(error) = print(&report::render(&run, self.outputs.screen, Palette::PLAIN))
        {
            complaint::tell(&error, &[], self.colors);
        }
        self.write(run, Traces::default());
        Exit::Wrong
    }

    /// Writes the files that were asked for.
    fn write(&self, run: CallResult, traces: Traces) -> Exit {
        let mut exit = Exit::Success;
        for (format, path) in &self.outputs.files {
            let text = report::render(&run, *format, Palette::PLAIN);
            let saved = output::save(path, text.as_bytes());
            exit = exit.worse(complaint::end(saved.map(|()| Exit::Success), &[], self.colors));
        }
        let Some(path) = &self.outputs.page else { return exit };
        let page = Page { run, sources: self.sources, traces, ..Page::default() };
        exit.worse(page::write(path, page, self.colors))
    }

    /// Prints the results of a run.
    fn finish(mut self, run: CallResult, traces: Traces) -> Exit {
        self.deadline.enter(Phase::Printing);
        let broken = match &run.failure {
            Some(Failure::Model(flaw)) => Some(library::of_model(flaw)),
            _ => None,
        };
        self.findings.extend(inputs::findings(broken.as_slice(), self.sources));
        let (inputs, diagnostics) = (std::mem::take(&mut self.prints), std::mem::take(&mut self.findings));
        let run = CallResult { inputs, diagnostics, ..run };
        let palette = if self.colors.out { Palette::ANSI } else { Palette::PLAIN };
        let mut exit = report::exit_code(&run);
        let printed = print(&report::render(&run, self.outputs.screen, palette));
        exit = exit.worse(complaint::end(printed.map(|()| Exit::Success), &[], self.colors));
        if let Some(error) = &broken {
            complaint::tell(error, self.sources, self.colors);
        }
        exit.worse(self.write(run, traces))
    }
}

/// Reports that a call ended before its first trial, on standard error and in formats for machines.
fn ender(arguments: &Questions, colors: Colors) -> impl Fn(Ended) -> Exit + Clone + Send + 'static {
    let run = blank(arguments);
    let chosen = screen(arguments);
    move |ended| {
        let mut run = run.clone();
        let error = match ended {
            Ended::Late => {
                let error = complaint::late(" before the first trial");
                run.diagnostics = inputs::findings(std::slice::from_ref(&error), &[]);
                run.failure = Some(Failure::Late(error.title.clone()));
                error
            }
            Ended::Interrupted => {
                run.interrupted = true;
                complaint::interrupted()
            }
        };
        complaint::tell(&error, &[], colors);
        let exit = report::exit_code(&run);
        for_machines(chosen, &run);
        exit
    }
}

/// A report of a call whose command line cannot be understood, in formats for machines.
pub(super) fn misused(chosen: Format, error: &Diagnostic) {
    let run = CallResult {
        diagnostics: inputs::findings(std::slice::from_ref(error), &[]),
        failure: Some(Failure::Input(error.title.clone())),
        ..CallResult::of("", 0)
    };
    for_machines(chosen, &run);
}

/// A report of a call that ended without results, in formats for machines.
pub(super) fn without_results(chosen: Format, scenario: String, seed: u64, failure: Failure) {
    for_machines(chosen, &CallResult { failure: Some(failure), ..CallResult::of(scenario, seed) });
}

/// What is known of a call before its first trial.
fn blank(arguments: &Questions) -> CallResult {
    let replay = format!("{} --seed {}", line(arguments).check(), arguments.seed);
    CallResult { replay, ..CallResult::of(&arguments.model.scenario, arguments.seed) }
}

fn for_machines(chosen: Format, run: &CallResult) {
    if chosen.is_for_programs() {
        let _ = print(&report::render(run, chosen, Palette::PLAIN));
    }
}

/// The format for standard output that has an option of its own.
fn short(arguments: &Questions) -> Option<Format> {
    let chosen = [(arguments.detail.brief, Format::Brief), (arguments.detail.verbose, Format::Verbose)];
    chosen.into_iter().find_map(|(is_chosen, format)| is_chosen.then_some(format))
}

/// The format that a call prints.
pub(super) fn screen(arguments: &Questions) -> Format {
    let printed = arguments.format.iter().find(|destination| destination.file.is_none());
    printed.map(|one| one.format).or_else(|| short(arguments)).unwrap_or_default()
}

/// File and line of a place.
fn locate(sources: &[Source], span: Span) -> (String, usize) {
    let source = sources.iter().find(|s| s.id == span.source);
    source.map_or((String::new(), 0), |s| (s.name.clone(), s.line_column(span.start).0))
}

/// The files and settings of the call.
fn line(arguments: &Questions) -> CommandLine {
    let line = page::line(&arguments.model);
    let properties = arguments.properties.iter().map(|path| page::relative(path)).collect();
    CommandLine { properties, ..line }
}

// The places and formats of the results of a call: one goes to standard output, each of the others into a file.

/// Format of what a call prints, and the files that it writes.
#[derive(Clone, Debug)]
struct Outputs {
    pub(super) screen: Format,
    pub(super) files: Vec<(Format, PathBuf)>,
    /// The page of charts and traces.
    pub(super) page: Option<PathBuf>,
}

impl Outputs {
    /// As the options of a call say.
    ///
    /// # Errors
    /// Two formats want standard output or one file, or a file is one that the call reads.
    fn new(
        chosen: &[Destination],
        short: Option<Format>,
        page: Option<&Path>,
        inputs: &[PathBuf],
    ) -> Result<Self, Diagnostic> {
        let printed = chosen.iter().filter(|destination| destination.file.is_none()).map(|one| one.format);
        let mut printed = printed.chain(short);
        let screen = printed.next().unwrap_or(Format::Text);
        if printed.next().is_some() {
            return Err(complaint::argument(
                "two formats are for standard output",
                "write one of them into a file: `--format json=results.json`",
            ));
        }
        let files: Vec<_> = chosen.iter().filter_map(|one| Some((one.format, one.file.clone()?))).collect();
        let names: Vec<Option<&Path>> =
            files.iter().map(|(_, file)| Some(file.as_path())).chain([page]).collect();
        output::guard_all(&names, inputs)?;
        Ok(Self { screen, files, page: page.map(Path::to_owned) })
    }
}
