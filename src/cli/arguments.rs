//! The command line as typed: data only.

use super::advise::AdviseCommand;
use super::gait::GaitCommand;
use super::infer::InferCommand;
use super::measure::MeasureCommand;
use super::path::PathCommand;
use super::plot::PlotCommand;
use super::replay::{CalibrateCommand, EvaluateCommand, FitCommand, MonitorCommand};
use super::simulate::choice::Keep;
use super::simulate::destination::left_out;
use super::terminal::ColorChoice;
use super::values::{
    Cores, Destination, Limit, Model, Print, TextFormat, parse_count, parse_moment, parse_positive,
    parse_quiet, parse_share, parse_threads, parse_trials,
};
use super::walk::WalkCommand;
use crate::data::table::{FORMATS, TraceFormat};
use clap::builder::{NonEmptyStringValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Command, CommandFactory, Parser, Subcommand, ValueEnum};
use std::num::NonZeroU64;
use std::path::PathBuf;

/// Statistical model checking of people in motion.
#[derive(Debug, Parser)]
#[command(name = "smc", version, about, long_about = None, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 satisfied, 1 violated, 2 wrong call or input, 3 undecided, 4 short of time or trials, 130 interrupted, 70 a bug.\n\
    Start with: smc check models/hall.scn properties/hall.bltl"
)]
pub(super) struct Arguments {
    /// The verb.
    #[command(subcommand)]
    pub(super) verb: Verb,
    /// When to color the output.
    #[arg(long, global = true, value_enum, default_value_t = ColorChoice::Auto)]
    pub(super) color: ColorChoice,
}

/// Verbs.
#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Answer the queries of property files about a scenario: decide, estimate, compare, rank.
    Check(Box<Check>),
    /// Show how a scenario and its property files were understood.
    Show(Show),
    /// Verify a certificate: recompute its results from their outcomes, and run some of its trials again.
    Verify(Box<VerifyCommand>),
    /// Draw a figure of results as SVG: a sweep, a ranking, a distribution, how evidence grew, calibration.
    Plot(PlotCommand),
    /// Run trials of a scenario and write their traces.
    Simulate(Box<Simulate>),
    /// Write the paths and speed profiles of walkers that plan.
    Path(Box<PathCommand>),
    /// Run many trials and write how agents walk, leg by leg: lengths, times, steps, traces, a picture.
    Walk(Box<WalkCommand>),
    /// Infer traces and groups from a recording or a table of observations.
    Infer(Box<InferCommand>),
    /// Measure densities, flows, speeds and encounters of a recording, frame by frame.
    Measure(Box<MeasureCommand>),
    /// Ask the formulas of property files of a recording itself: what people did.
    Monitor(Box<MonitorCommand>),
    /// Compare the predictions of a model with what happened in a recording.
    Evaluate(Box<EvaluateCommand>),
    /// Measure how often verdicts of a model are true of people who were recorded.
    Calibrate(Box<CalibrateCommand>),
    /// Fit parameters of a model to a recording.
    Fit(Box<FitCommand>),
    /// Advise a user while others are observed: rank moves for each batch of observations.
    Advise(Box<AdviseCommand>),
    /// Detect a change of the probability of recorded or streamed outcomes.
    Drift(Drift),
    /// Cut motion capture into steps; learn gaits from them, show, draw, score and compare these.
    #[command(subcommand)]
    Gait(Box<GaitCommand>),
    /// Run a shard of a plan, on any machine, and write its part.
    Shard(Box<ShardCommand>),
    /// Answer the queries from the parts of shards in a folder, DIR; if parts are missing, write the plan of a further round there.
    Merge(Box<Merge>),
    /// Format scenarios and property files; comments are kept.
    Fmt(Format),
    /// Explain a code of an error or warning, such as E0303, a procedure or a function.
    Explain(Explain),
    /// Serve an editor: errors while typing, names, formats, and verdicts in the margin.
    Lsp,
    /// Write completions for a shell to standard output.
    Completions(Completions),
    /// Write man pages into a directory.
    Man(Man),
}

/// The verbs in groups, as the help shows them.
const GROUPS: [(&str, &[&str]); 7] = [
    ("Ask", &["check", "verify", "show", "plot"]),
    ("Look", &["simulate", "path", "walk"]),
    ("Recordings", &["infer", "measure", "monitor", "evaluate", "calibrate", "fit", "advise", "drift"]),
    ("Gait", &["gait"]),
    ("Large runs", &["shard", "merge"]),
    ("Files", &["fmt", "explain", "lsp"]),
    ("Shell", &["completions", "man"]),
];

/// The command line, with its verbs in groups.
pub(super) fn definition() -> Command {
    // Without a scenario the first property file stands in its place.
    let all = Arguments::command().mut_subcommand("check", |check| {
        check.mut_arg("properties", |files| files.required(false).required_unless_present("outcomes"))
    });
    let mut list = String::new();
    for (group, verbs) in GROUPS {
        list += &format!("{group}:\n");
        for verb in verbs {
            let about = all.find_subcommand(verb).and_then(Command::get_about).map(ToString::to_string);
            list += &format!("  {verb:<12} {}\n", about.unwrap_or_default());
        }
        list.push('\n');
    }
    all.help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{list}Options:\n{{options}}{{after-help}}"
    ))
}

/// What is asked, and how it is reported.
#[derive(Args, Debug)]
pub(super) struct Questions {
    /// The model.
    #[command(flatten)]
    pub(super) model: Model,
    /// Property files (`.bltl`), or `-` for standard input.
    #[arg(required = true)]
    pub(super) properties: Vec<String>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Threads.
    #[command(flatten)]
    pub(super) cores: Cores,
    /// Largest number of trials of a query (of a ranking: of an option); one million by default.
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub(super) max_trials: Option<u64>,
    /// Largest number of trials of a ranking, over all its options.
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub(super) total_trials: Option<u64>,
    /// Format of the results on standard output: `text` (unless set), `verbose`, `brief`, `json`, `csv`, `junit` or `github`. With a file,
    /// as in `--format csv=results.csv`, they are also written there. May be given several times.
    #[arg(long, value_name = "FORMAT[=FILE]")]
    pub(super) format: Vec<Destination>,
    /// How much of the text is printed.
    #[command(flatten)]
    pub(super) detail: Detail,
    /// Also write a self-contained HTML page with charts and a player of the trials behind the results.
    #[arg(long, value_name = "FILE.html")]
    pub(super) report: Option<PathBuf>,
    /// Also say in JSON how the evidence grew, for `smc plot --figure evidence`; `--report` shows it, too.
    #[arg(long)]
    pub(super) evidence: bool,
    /// Answer only this query: the name of its property, or its number in writing order, starting at 0 (each measure of a
    /// list has its own number). May be given several times.
    #[arg(long, value_name = "NAME")]
    pub(super) only: Vec<String>,
    /// Largest number of shards of a round, 100 by default; with `--launch local` the largest number of threads.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) shards: Option<u32>,
    /// Show no progress and no forecast on standard error.
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// How much of the text is printed.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct Detail {
    /// Print the procedure of each query with all its numbers, too, as `--format verbose` does.
    #[arg(short, long)]
    pub(super) verbose: bool,
    /// Print one line a query, as `--format brief` does.
    #[arg(long)]
    pub(super) brief: bool,
}

/// `smc check`
#[derive(Args, Debug)]
#[command(override_usage = "smc check [OPTIONS] <SCENARIO | --outcomes TABLE> <PROPERTIES>...")]
pub(super) struct Check {
    /// What is asked.
    #[command(flatten)]
    pub(super) questions: Questions,
    /// The time that it may take.
    #[command(flatten)]
    pub(super) limit: Limit,
    /// Only forecast the number of trials and the time of each query; runs the first few trials.
    #[arg(long, conflicts_with_all = ["timeout", "report", "launch"])]
    pub(super) forecast: bool,
    /// Run the trials in shards: `local` (threads), `hq` (`HyperQueue`), `slurm`, `k8s` (prints a job for Kubernetes), or a
    /// command in which `{shard}`, `{count}`, `{last}`, `{plan}` and `{parts}` are replaced. Never changes a result.
    #[arg(long, value_name = "ENGINE|COMMAND", value_parser = NonEmptyStringValueParser::new())]
    pub(super) launch: Option<String>,
    /// Write a certificate: a file by which a stranger checks the results, with `smc verify` or `tools/verify.py`.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["launch", "forecast", "outcomes"])]
    pub(super) certificate: Option<PathBuf>,
    /// Folder of the parts that shards write; it is kept, so that a call can go on where another one ended.
    #[arg(long, value_name = "DIR", requires = "launch")]
    pub(super) parts: Option<PathBuf>,
    /// Ask about outcomes that exist already instead of a scenario: a table with the columns `trial`, `query` and `value`, or `-`
    /// for standard input. Each name in `query` is one in the property files.
    #[arg(
        long,
        value_name = "TABLE",
        conflicts_with_all = ["launch", "forecast", "timeout", "set", "data", "models", "calibration", "velocity", "allow_run"]
    )]
    pub(super) outcomes: Option<String>,
}

/// `smc verify`
#[derive(Args, Debug)]
#[command(override_usage = "smc verify [OPTIONS] <CERTIFICATE> [<SCENARIO> <PROPERTIES>...]")]
pub(super) struct VerifyCommand {
    /// The certificate.
    pub(super) certificate: String,
    /// The scenario and its property files, if they are to be compared with those of the certificate, too.
    #[arg(value_name = "FILE")]
    pub(super) files: Vec<String>,
    /// Run so many trials again, which are drawn at random from all of the certificate, and compare their outcomes.
    #[arg(long, value_name = "N", value_parser = parse_count, requires = "files")]
    pub(super) audit: Option<u64>,
    /// Draw the trials of the audit by this number, to repeat one; a number of the system unless set.
    #[arg(long, value_name = "SEED", requires = "audit")]
    pub(super) audit_seed: Option<u64>,
    /// Also search this folder for recordings and imports. May be given several times.
    #[arg(long, value_name = "DIR")]
    pub(super) data: Vec<PathBuf>,
    /// The file of `smc calibrate` that the call had.
    #[arg(long, value_name = "FILE")]
    pub(super) calibration: Option<String>,
    /// Let the program of a scenario run.
    #[arg(long)]
    pub(super) allow_run: bool,
    /// Threads.
    #[command(flatten)]
    pub(super) cores: Cores,
    /// Format on standard output.
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

/// `smc merge`
#[derive(Args, Debug)]
#[command(override_usage = "smc merge [OPTIONS] <SCENARIO> <PROPERTIES>... <DIR>")]
pub(super) struct Merge {
    /// What is asked; the last property file is the folder.
    #[command(flatten)]
    pub(super) questions: Questions,
    /// Taken from the end of the property files.
    #[arg(skip)]
    pub(super) folder: PathBuf,
}

/// `smc shard`
#[derive(Args, Debug)]
pub(super) struct ShardCommand {
    /// The model.
    #[command(flatten)]
    pub(super) model: Model,
    /// Property files (`.bltl`).
    #[arg(required = true)]
    pub(super) properties: Vec<String>,
    /// The plan of the round.
    #[arg(long, value_name = "PLAN.json")]
    pub(super) round: PathBuf,
    /// Number of the shard, from 0.
    #[arg(long, value_name = "I")]
    pub(super) index: usize,
    /// Folder of the parts.
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: PathBuf,
    /// Number of threads; one by default, because queues count cores.
    #[arg(short = 'j', long, default_value = "1", value_parser = parse_threads)]
    pub(super) threads: usize,
}

/// `smc simulate`
#[derive(Args, Debug)]
pub(super) struct Simulate {
    /// The model.
    #[command(flatten)]
    pub(super) model: Model,
    /// The time that the call may take.
    #[command(flatten)]
    pub(super) limit: Limit,
    /// Property files (`.bltl`) for `--keep`.
    #[arg(requires = "keep")]
    pub(super) properties: Vec<String>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Index of the first trial.
    #[arg(long, default_value_t = 0, value_name = "INDEX")]
    pub(super) trial: u64,
    /// Number of trials.
    #[arg(short = 'n', long, default_value = "1", value_name = "N", value_parser = parse_trials)]
    pub(super) trials: NonZeroU64,
    /// Follow a move or a path, named as in a ranking: `heading 15 deg`, `stop`, `route left`, `path 2`.
    #[arg(long = "move", visible_alias = "path", value_name = "MOVE")]
    pub(super) advice: Option<String>,
    /// Write only every N-th state.
    #[arg(long, default_value = "1", value_name = "N", value_parser = parse_positive)]
    pub(super) every: NonZeroU64,
    /// Stop at this time instead of the horizon: `2.5s`; a number without a unit is in seconds.
    #[arg(long, value_name = "TIME", value_parser = parse_moment)]
    pub(super) until: Option<f64>,
    /// Keep only the trials in which the formula of a check is false (`violated`) or true (`satisfied`). Of several checks
    /// one is meant by the name of its property or its number: `violated=safe`.
    #[arg(long, value_name = "WHICH[=NAME]", requires = "properties")]
    pub(super) keep: Option<Keep>,
    /// Format of the table. By default the ending of the file shows it, and standard output is `csv`.
    #[arg(long, value_name = "FORMAT", value_parser = trace_formats())]
    pub(super) format: Option<&'static TraceFormat>,
    /// Say nothing of the trials that `--keep` looked at.
    #[arg(short, long)]
    pub(super) quiet: bool,
    /// File to write; standard output by default. `{trial}` in the name stands for the number of the trial, so that each has
    /// its own file.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Write a self-contained HTML page that plays the trials; the table is then written only with `--output`.
    #[arg(long, value_name = "FILE.html")]
    pub(super) report: Option<PathBuf>,
}

/// The names of the formats of traces, each with what it is.
fn trace_formats() -> impl TypedValueParser<Value = &'static TraceFormat> {
    let names = FORMATS.iter().map(|format| PossibleValue::new(format.name).help(format.meaning));
    PossibleValuesParser::new(names).try_map(|name| {
        let format = FORMATS.iter().find(|format| format.name == name).ok_or("unknown format")?;
        if format.open.is_some() { Ok(format) } else { Err(left_out(format)) }
    })
}

/// `smc drift`
#[derive(Args, Debug)]
pub(super) struct Drift {
    /// Outcomes, one per line (`0`, `1`, `false`, `true`), or a table of comma-separated values; `-` for standard input.
    pub(super) file: String,
    /// Probability of success before the change: `0.95` or `95%`.
    #[arg(long, value_parser = parse_share, value_name = "P")]
    pub(super) before: f64,
    /// Probability of success after the change to detect.
    #[arg(long, value_parser = parse_share, value_name = "P")]
    pub(super) after: f64,
    /// Smallest average number of outcomes before a false alarm; 1000 by default.
    #[arg(long, value_name = "N", conflicts_with = "threshold", value_parser = parse_quiet)]
    pub(super) false_alarm: Option<f64>,
    /// Threshold of the sum: the logarithm of the number of outcomes before a false alarm.
    #[arg(long, value_name = "H")]
    pub(super) threshold: Option<f64>,
    /// Column of a table: its name, or its number, starting at 1.
    #[arg(long, value_name = "COLUMN")]
    pub(super) column: Option<String>,
    /// Stop at the first alarm.
    #[arg(long)]
    pub(super) first: bool,
    /// Format on standard output; `json` writes one object per line, the summary last.
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

/// `smc show`
#[derive(Args, Debug)]
pub(super) struct Show {
    /// The model.
    #[command(flatten)]
    pub(super) model: Model,
    /// The time that the call may take.
    #[command(flatten)]
    pub(super) limit: Limit,
    /// Property files (`.bltl`).
    pub(super) properties: Vec<String>,
    /// `text` describes the scenario, `svg` draws its plan with the shortest ways.
    #[arg(long, value_enum, default_value_t = ShowFormat::Text)]
    pub(super) format: ShowFormat,
    /// How wide a picture is.
    #[command(flatten)]
    pub(super) print: Print,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

/// Formats of `smc show`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ShowFormat {
    /// For people.
    Text,
    /// The plan of the scene.
    Svg,
}

/// `smc fmt`
#[derive(Args, Debug)]
pub(super) struct Format {
    /// Files to format; `-` reads standard input and writes standard output.
    #[arg(required = true)]
    pub(super) files: Vec<String>,
    /// Change nothing; exit with 1 if a file is not formatted.
    #[arg(long)]
    pub(super) check: bool,
    /// Language of standard input; detected by default.
    #[arg(long, value_enum)]
    pub(super) language: Option<Language>,
}

/// Languages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Language {
    /// A scenario.
    Scn,
    /// Properties.
    Bltl,
}

/// `smc explain`
#[derive(Args, Debug)]
pub(super) struct Explain {
    /// A code such as `E0303`, a procedure such as `sprt` or a function such as `clearance`; without it, a list of all.
    pub(super) name: Option<String>,
}

/// `smc completions`
#[derive(Args, Debug)]
pub(super) struct Completions {
    /// The shell.
    pub(super) shell: clap_complete::Shell,
}

/// `smc man`
#[derive(Args, Debug)]
pub(super) struct Man {
    /// The directory.
    pub(super) directory: PathBuf,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_consistent() {
        definition().debug_assert();
    }

    #[test]
    fn each_verb_is_in_one_group() {
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, verbs)| *verbs).copied().collect();
        let all = definition();
        let mut verbs: Vec<&str> = all.get_subcommands().map(Command::get_name).collect();
        grouped.sort_unstable();
        verbs.sort_unstable();
        assert_eq!(grouped, verbs);
    }
}
