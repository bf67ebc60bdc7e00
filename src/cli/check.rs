//! `smc check`: decide, estimate, compare, rank.

use super::arguments::{Check, OutputFormat};
use super::deadline::{Deadline, Ended, Phase};
use super::progress::Progress;
use super::ranks::Crew;
use super::shelf::{Shelf, pack};
use super::terminal::{Colors, print, say};
use super::{complaint, inputs, output, ranks};
use crate::base::fingerprint::Fingerprint;
use crate::base::visible::visible;
use crate::compile::Study;
use crate::compile::nearest::nearest;
use crate::engine::budget::DEFAULT_TRIALS;
use crate::engine::outcome::{Failure, Finding, Run};
use crate::engine::{Budget, Call, Fault, Outlook, Ranks, Threads, forecast, run as run_study};
use crate::kernel::driver::straight;
use crate::report::{self, ExitCode as Exit, Format, Palette};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::{Source, Span};
use std::path::Path;
use std::sync::Arc;

/// Runs the command.
pub(super) fn run(arguments: &Check, colors: Colors) -> Exit {
    let mut budget = Budget::new(arguments.max_trials.unwrap_or(DEFAULT_TRIALS), arguments.timeout);
    budget.max_total = arguments.total_trials;
    let budget = Arc::new(budget);
    let deadline = Deadline::watch(&budget, ender(arguments, colors));
    let shelf = if arguments.ranks.is_some() { Shelf::Kept(Vec::new()) } else { Shelf::Files };
    let mut inputs = inputs::load_from(shelf, &arguments.model, &arguments.properties);
    let shelf = std::mem::replace(&mut inputs.shelf, Shelf::Files);
    if inputs.study.is_none() {
        deadline.enter(Phase::Printing);
    }
    super::diagnose(&inputs, colors);
    let overwritten = output::guard(arguments.report.as_deref(), &inputs.paths).err();
    let desk = Desk {
        arguments,
        colors,
        deadline: deadline.clone(),
        sources: &inputs.sources,
        findings: inputs::findings(&inputs.diagnostics, &inputs.sources),
        errors: inputs.errors,
        prints: inputs.prints.clone(),
        page: arguments.report.as_deref().filter(|_| overwritten.is_none()),
    };
    if let Some(error) = overwritten {
        return desk.refuse(error);
    }
    let Some(study) = &inputs.study else { return desk.refused() };
    let only = match chosen(study, &arguments.only) {
        Ok(only) => only,
        Err(error) => return desk.refuse(error),
    };
    if arguments.threads == Some(0) {
        return desk.refuse(complaint::argument("`--threads 0` runs nothing", "it takes a number from 1"));
    }
    let most = most_threads();
    if arguments.threads.is_some_and(|threads| threads > most) {
        say(&format!(
            "warning: {most} threads are as many as help here; results are the same with any number\n"
        ));
    }
    let threads = arguments.threads.unwrap_or_else(cores).min(most);
    let crew = match crew(arguments, study, &shelf, threads, &budget) {
        Ok(crew) => crew,
        Err(error) => return desk.refuse(error),
    };
    drop(shelf);
    let place = |span: Span| locate(&inputs.sources, span);
    let call = Call {
        seed: arguments.seed,
        command: command("check", arguments, true),
        point: command("check", arguments, false),
        simulate: command("simulate", arguments, false),
        only,
        place: &place,
        drivers: &straight,
        file: arguments.model.scenario.clone(),
    };
    if arguments.forecast {
        deadline.enter(Phase::Sampling);
        return match forecast(study, &call, crew.executor(), &budget) {
            Ok(outlook) => desk.tell(&outlook),
            Err(fault) => desk.fault(&fault),
        };
    }
    let progress = Progress::new(arguments.quiet, deadline);
    match run_study(study, &call, crew.executor(), &budget, &progress) {
        Ok(mut run) => {
            // An interruption ends ranks too.
            if !run.interrupted {
                run.warnings.extend(crew.warnings());
            }
            drop(crew);
            desk.finish(run)
        }
        Err(fault) => desk.fault(&fault),
    }
}

/// Those who run the trials of a call.
fn crew(
    arguments: &Check,
    study: &Study,
    shelf: &Shelf,
    threads: usize,
    budget: &Budget,
) -> Result<Crew, Diagnostic> {
    let own = Threads::new(Some(threads))
        .map_err(|error| complaint::refusal(&Fault::Threads(error.to_string())))?;
    let Some(count) = arguments.ranks.map(usize::from) else { return Ok(Crew::Alone(own)) };
    let each = (threads / count).max(1);
    let packed = pack(&arguments.model, &arguments.properties, shelf);
    let (children, lines) = ranks::start(count)
        .map_err(|reason| complaint::argument(reason, "leave `--ranks` out: threads do the same"))?;
    let ranks =
        Ranks::new(lines, study, packed, each, own, budget).map_err(|fault| complaint::refusal(&fault))?;
    Ok(Crew::Led { ranks: Box::new(ranks), _children: children })
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// So many threads are run at most: each has trials of its own to begin and to throw away.
fn most_threads() -> usize {
    (2 * cores()).max(16)
}

/// Where what a call has to say is handed out, in the format that was asked for.
struct Desk<'a> {
    arguments: &'a Check,
    colors: Colors,
    deadline: Deadline,
    sources: &'a [Source],
    findings: Vec<Finding>,
    /// How many errors there are.
    errors: usize,
    prints: Vec<(String, Fingerprint)>,
    /// The page that is written beside.
    page: Option<&'a Path>,
}

impl Desk<'_> {
    /// Prints a forecast.
    fn tell(self, outlook: &Outlook) -> Exit {
        self.deadline.enter(Phase::Printing);
        let text = match self.arguments.format {
            OutputFormat::Json => report::outlook::json(outlook),
            OutputFormat::Text => visible(&report::outlook::text(outlook)).into_owned(),
            OutputFormat::Junit | OutputFormat::Github => {
                return self.refuse(complaint::argument(
                    "`--forecast` is no result of a test",
                    "it is written as `--format text` or `--format json`",
                ));
            }
        };
        match print(&text) {
            Ok(()) => Exit::Success,
            Err(reason) => self.refuse(complaint::output(reason)),
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

    /// The inputs are wrong; standard error has said how.
    fn refused(self) -> Exit {
        let first = self.findings.iter().find(|finding| finding.error);
        let first = first.map_or_else(|| "the inputs are wrong".to_owned(), Finding::line);
        let reason = match self.errors.saturating_sub(1) {
            0 => first,
            1 => format!("{first} (and 1 more error)"),
            more => format!("{first} (and {more} more errors)"),
        };
        self.hand_out(reason)
    }

    /// Nothing could be run.
    fn fault(self, fault: &Fault) -> Exit {
        self.refuse_for(&complaint::refusals(fault))
    }

    /// A report of a run that never began, in formats for machines; people have read it already.
    fn hand_out(self, reason: String) -> Exit {
        let run = Run {
            scenario: self.arguments.model.scenario.clone(),
            seed: self.arguments.seed,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            inputs: self.prints,
            diagnostics: self.findings,
            failure: Some(Failure::Input(reason)),
            replay: format!("{} --seed {}", command("check", self.arguments, true), self.arguments.seed),
            ..Run::default()
        };
        if self.arguments.format != OutputFormat::Text
            && let Err(reason) = print(&report::render(&run, format(self.arguments.format), Palette::PLAIN))
        {
            complaint::tell(&complaint::output(reason), &[], self.colors);
        }
        page(self.page, &run, self.colors);
        Exit::Wrong
    }

    /// Prints the results of a run.
    fn finish(mut self, run: Run) -> Exit {
        self.deadline.enter(Phase::Printing);
        let broken = match &run.failure {
            Some(Failure::Model(flaw)) => Some(complaint::of_model(flaw)),
            _ => None,
        };
        self.findings.extend(inputs::findings(broken.as_slice(), self.sources));
        let run = Run { inputs: self.prints, diagnostics: self.findings, ..run };
        let palette = if self.colors.out { Palette::ANSI } else { Palette::PLAIN };
        let mut exit = report::exit_code(&run);
        if let Err(reason) = print(&report::render(&run, format(self.arguments.format), palette)) {
            complaint::tell(&complaint::output(reason), &[], self.colors);
            exit = exit.worse(Exit::Wrong);
        }
        if let Some(error) = &broken {
            complaint::tell(error, self.sources, self.colors);
        }
        exit.worse(page(self.page, &run, self.colors))
    }
}

/// What reports that a call ended before its first trial, on standard error and in formats for machines.
fn ender(arguments: &Check, colors: Colors) -> impl Fn(Ended) -> Exit + Clone + Send + 'static {
    let run = Run {
        scenario: arguments.model.scenario.clone(),
        seed: arguments.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        replay: format!("{} --seed {}", command("check", arguments, true), arguments.seed),
        ..Run::default()
    };
    let chosen = arguments.format;
    move |ended| {
        let mut run = run.clone();
        let error = match ended {
            Ended::Late => {
                let error = complaint::late();
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
pub(super) fn misused(chosen: OutputFormat, message: &str) {
    let error = Diagnostic::placeless(Code::E0705, message);
    let run = Run {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        diagnostics: inputs::findings(&[error], &[]),
        failure: Some(Failure::Input(message.to_owned())),
        ..Run::default()
    };
    for_machines(chosen, &run);
}

/// A report of a call that ended without results, in formats for machines.
pub(super) fn without_results(chosen: OutputFormat, scenario: String, seed: u64, failure: Failure) {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    for_machines(chosen, &Run { scenario, seed, version, failure: Some(failure), ..Run::default() });
}

fn for_machines(chosen: OutputFormat, run: &Run) {
    if chosen != OutputFormat::Text {
        let _ = print(&report::render(run, format(chosen), Palette::PLAIN));
    }
}

const fn format(chosen: OutputFormat) -> Format {
    match chosen {
        OutputFormat::Text => Format::Text,
        OutputFormat::Json => Format::Json,
        OutputFormat::Junit => Format::Junit,
        OutputFormat::Github => Format::Github,
    }
}

/// Writes the page that was asked for, if one was.
fn page(path: Option<&Path>, run: &Run, colors: Colors) -> Exit {
    let Some(path) = path else { return Exit::Success };
    let text = report::render(run, Format::Html, Palette::PLAIN);
    let Err(error) = output::write(path, |out| out.write_all(text.as_bytes())) else { return Exit::Success };
    let error = format!("`{}` cannot be written: {error}", path.display());
    complaint::tell(&complaint::output(error), &[], colors);
    Exit::Wrong
}

/// Indices of the queries that `--only` names.
#[allow(clippy::result_large_err, reason = "called once")]
fn chosen(study: &Study, only: &[String]) -> Result<Vec<usize>, Diagnostic> {
    let mut chosen = Vec::new();
    for wanted in only {
        let number = wanted.parse::<usize>().ok();
        let found: Vec<usize> = study
            .queries
            .iter()
            .filter(|q| Some(q.index) == number || q.name.as_deref() == Some(wanted.as_str()))
            .map(|q| q.index)
            .collect();
        if found.is_empty() {
            let mut names: Vec<&str> = study.queries.iter().filter_map(|q| q.name.as_deref()).collect();
            names.sort_unstable();
            names.dedup();
            let last = study.queries.iter().map(|q| q.index).max().unwrap_or(0);
            let near = nearest(wanted, names.iter().copied());
            let hint = match near {
                Some(near) => format!("did you mean `{near}`?"),
                None if names.is_empty() => format!("queries are numbered from 0 to {last}"),
                None => format!("queries are numbered from 0 to {last}, and are about {}", names.join(", ")),
            };
            return Err(complaint::argument(
                match number {
                    Some(number) => format!("`--only {number}`: there is no query {number}"),
                    None => format!("`--only {wanted}`: no query is about `{wanted}`"),
                },
                hint,
            ));
        }
        chosen.extend(found);
    }
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

/// File and line of a place.
fn locate(sources: &[Source], span: Span) -> (String, usize) {
    let source = sources.iter().find(|s| s.id == span.source);
    source.map_or((String::new(), 0), |s| (s.name.clone(), s.line_column(span.start).0))
}

/// The call up to its options, as a shell would take it, with its sweeps or without them.
fn command(verb: &str, arguments: &Check, sweeps: bool) -> String {
    let mut words = vec!["smc".to_owned(), verb.to_owned(), named(&arguments.model.scenario)];
    if verb == "check" {
        words.extend(arguments.properties.iter().map(|p| named(p)));
    }
    for set in &arguments.model.set {
        // A trial, or a query, belongs to one setting; that of a sweep is named with it.
        if sweeps || !set.contains("..") {
            words.push("--set".to_owned());
            words.push(quoted(set));
        }
    }
    for data in &arguments.model.data {
        words.push("--data".to_owned());
        words.push(quoted(&data.display().to_string()));
    }
    words.join(" ")
}

/// The name of a file as a shell would take it, and not for an option; `-` alone is the standard input.
fn named(file: &str) -> String {
    if file.len() > 1 && file.starts_with('-') { quoted(&format!("./{file}")) } else { quoted(file) }
}

/// A word as a shell would take it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        assert_eq!(quoted("models/a.scn"), "models/a.scn");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!([named("-"), named("-a b"), named("a-b")], ["-", "'./-a b'", "a-b"]);
    }
}
