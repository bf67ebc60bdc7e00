//! `smc advise`: advice for one user, a line for each batch of observations.

mod replay;
mod stream;
mod users;

use super::terminal::{Colors, print_to_reader};
use super::values::{Cores, Model, parse_count, parse_duration, parse_moment, parse_user, threads};
use super::{complaint, inputs, output, page};
use crate::advise::{Advice, Adviser, Advising, role};
use crate::data::tracks::{Batch, Velocity};
use crate::engine::{Budget, Threads};
use crate::library::Parsed;
use crate::model::Scene;
use crate::replay::Whose;
use crate::report::advised::{Advised, to_page};
use crate::report::{ExitCode as Exit, advice};
use crate::syntax::diagnostic::Diagnostic;
use crate::trials::budget::DEFAULT_TRIALS;
use clap::Args;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What is kept of a deadline for writing the line.
const RESERVE: Duration = Duration::from_millis(2);

/// Runs the command.
pub(super) fn run(arguments: &AdviseCommand, colors: Colors) -> Exit {
    let Some((parsed, paths)) = inputs::parse_or_tell(&arguments.model, &arguments.properties, colors) else {
        return Exit::Wrong;
    };
    let done =
        output::guard(arguments.report.as_deref(), &paths).and_then(|()| advise(arguments, &parsed, colors));
    complaint::end(done, &parsed.inputs.sources, colors)
}

/// Answers all batches.
fn advise(arguments: &AdviseCommand, parsed: &Parsed, colors: Colors) -> Result<Exit, Diagnostic> {
    let replayed = arguments.tracks.as_ref();
    if let (None, Some(path)) = (replayed, &arguments.report) {
        let hint = format!(
            "declare `tracks lidar = observations \"obs.jsonl\"` in the scenario, and use `--tracks lidar --report {}`",
            path.display()
        );
        return Err(complaint::argument("`--report` needs a recording, and a live stream is none", hint));
    }
    if let (Some(Whose::Everybody), false) = (arguments.user, arguments.follow) {
        let hint = "add `--follow --tracks NAME`, or name one person";
        return Err(complaint::argument("`--user all` compares advised with recorded walks", hint));
    }
    let role = role(&parsed.scenario)?;
    let threads = threads(arguments.cores.threads)?;
    let recording = replayed.map(|name| replay::batches(parsed, name, arguments)).transpose()?;
    if let (Some(Whose::Everybody), Some(recording)) = (arguments.user, &recording) {
        let done = users::everybody(arguments, parsed, &threads, recording);
        return Ok(complaint::end(done.map(|()| Exit::Success), &parsed.inputs.sources, colors));
    }
    let user = if let Some(Whose::Person(id)) = arguments.user { Some(id) } else { None };
    let adviser = Adviser::new(parsed.input(), role, arguments.options(user));
    let mut caller =
        Caller { arguments, adviser, threads: &threads, late: Default::default(), shown: Advised::default() };
    let done = match recording {
        Some(recording) => replay::run(&mut caller, &recording, arguments.span(), true).map(|_| ()),
        None => stream::run(&mut caller),
    };
    let exit = complaint::end(done.map(|()| Exit::Success), &parsed.inputs.sources, colors);
    let Some(path) = &arguments.report else { return Ok(exit) };
    let scenario = caller.adviser.scenario();
    let title = scenario.map(|scenario| scenario.title.clone()).filter(|title| !title.is_empty());
    let advised = Advised {
        title: title.unwrap_or_else(|| arguments.model.scenario.clone()),
        scene: scenario.map_or_else(Scene::default, |scenario| scenario.scene.clone()),
        seed: arguments.seed,
        user: caller.adviser.user(),
        ..caller.shown
    };
    Ok(exit.worse(page::write(path, to_page(advised, &parsed.inputs.sources), colors)))
}

/// What answers batches.
struct Caller<'a> {
    arguments: &'a AdviseCommand,
    adviser: Adviser<'a>,
    threads: &'a Threads,
    /// By how much the last cycles passed the time for their trials.
    late: [Duration; 8],
    /// What the page of the call shows; gathered only for one.
    shown: Advised,
}

impl Caller<'_> {
    /// Answers a complete cycle, with notes on what came before it; false where nobody reads any more.
    fn answer(&mut self, batches: &[Batch], notes: &mut Vec<String>) -> Result<bool, Vec<Diagnostic>> {
        let (found, used) = self.ask(batches, notes)?;
        Ok(self.tell(found, used)?)
    }

    /// The advice of a complete cycle, and how long it took.
    fn ask(
        &mut self,
        batches: &[Batch],
        notes: &mut Vec<String>,
    ) -> Result<(Advice, Duration), Vec<Diagnostic>> {
        #[allow(clippy::disallowed_methods, reason = "the command line keeps deadlines")]
        let started = Instant::now();
        // The second largest: one late cycle is no sign that the next ones will be.
        let mut late = self.late;
        late.sort_unstable();
        let margin = RESERVE.saturating_add(late[late.len() - 2]);
        let limit = self.arguments.deadline.map(|deadline| deadline.saturating_sub(margin).max(deadline / 2));
        let mut budget = Budget::new(DEFAULT_TRIALS, limit);
        budget.max_total = self.arguments.total_trials;
        let mut found = self.adviser.advise(batches, self.threads, &budget)?;
        found.notes.splice(0..0, std::mem::take(notes));
        // Nothing depends on the clock where the number of trials is given.
        if let (Some(limit), None) = (limit, self.arguments.total_trials) {
            let place = found.cycle as usize % self.late.len();
            self.late[place] = started.elapsed().saturating_sub(limit);
        }
        Ok((found, started.elapsed()))
    }

    /// Writes the line of a cycle; false where nobody reads any more.
    fn tell(&mut self, found: Advice, used: Duration) -> Result<bool, Diagnostic> {
        let line = advice::line(&found, self.arguments.velocity(), used.as_secs_f64() * 1e3);
        if self.arguments.report.is_some() {
            self.shown.cycles.push(found);
        }
        print_to_reader(&line)
    }

    /// Whether velocities are differences of positions.
    fn sees(&self) -> bool {
        self.arguments.velocity() == Velocity::Seen
    }
}

// The options of `smc advise`.

/// `smc advise`
#[derive(Args, Debug)]
pub(in crate::cli) struct AdviseCommand {
    /// The model; its moves belong to the user.
    #[command(flatten)]
    pub(in crate::cli) model: Model,
    /// Property files (`.bltl`); the first ranking of moves is asked in each cycle.
    #[arg(required = true)]
    pub(in crate::cli) properties: Vec<String>,
    /// Ask this ranking: the name of its property, or its number in writing order, starting at 0.
    #[arg(long, value_name = "NAME")]
    pub(in crate::cli) only: Option<String>,
    /// Replay these tracks of the model instead of reading batches from standard input.
    #[arg(long, alias = "replay", value_name = "TRACKS")]
    pub(in crate::cli) tracks: Option<String>,
    /// First time of the replay; the beginning by default.
    #[arg(long, value_name = "TIME", requires = "tracks", value_parser = parse_moment)]
    pub(in crate::cli) from: Option<f64>,
    /// Last time of the replay; the end by default.
    #[arg(long, value_name = "TIME", requires = "tracks", value_parser = parse_moment)]
    pub(in crate::cli) to: Option<f64>,
    /// Withhold the ids of all people but the user.
    #[arg(long, requires = "tracks")]
    pub(in crate::cli) anonymous: bool,
    /// Let the user walk as advised instead of as recorded, and compare both at the end.
    #[arg(long, requires = "tracks")]
    pub(in crate::cli) follow: bool,
    /// Also write a self-contained HTML page that plays the recording, with the advice of each cycle.
    #[arg(long, value_name = "FILE.html")]
    pub(in crate::cli) report: Option<PathBuf>,
    /// Id of the user, instead of the id in the model. With `--follow`, `all` asks for each person who walks in turn, and tells what
    /// the advice is worth in a table.
    #[arg(long, value_name = "ID", value_parser = parse_user)]
    pub(in crate::cli) user: Option<Whose>,
    /// Leave out people who are farther from the user than this, in metres: `12m`.
    #[arg(long, value_name = "LENGTH", value_parser = parse_length)]
    pub(in crate::cli) range: Option<f64>,
    /// Time from a complete batch to its advice, such as `100ms`. What is certified by then is said.
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub(in crate::cli) deadline: Option<Duration>,
    /// Largest number of trials of a cycle. Without a deadline, the advice then depends on nothing but the inputs.
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub(in crate::cli) total_trials: Option<u64>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(in crate::cli) seed: u64,
    /// Threads.
    #[command(flatten)]
    pub(in crate::cli) cores: Cores,
    /// Stop at the first line that cannot be read.
    #[arg(long)]
    pub(in crate::cli) strict: bool,
}

impl AdviseCommand {
    /// First and last time of a replay, s.
    fn span(&self) -> (f64, f64) {
        (self.from.unwrap_or(f64::NEG_INFINITY), self.to.unwrap_or(f64::INFINITY))
    }

    /// How somebody is advised.
    fn options(&self, user: Option<u32>) -> Advising {
        Advising { seed: self.seed, user, range: self.range, only: self.only.clone() }
    }

    /// Which velocities are used.
    fn velocity(&self) -> Velocity {
        self.model.velocity.unwrap_or(Velocity::Seen)
    }
}

/// A length in metres: `12m`, `12`.
fn parse_length(text: &str) -> Result<f64, String> {
    let digits = text.strip_suffix('m').unwrap_or(text).trim();
    match digits.parse::<f64>() {
        Ok(length) if length > 0.0 => Ok(length),
        Ok(_) => Err("a range must be positive".to_owned()),
        Err(_) => Err(format!("`{text}` is not a length: write 12m")),
    }
}
