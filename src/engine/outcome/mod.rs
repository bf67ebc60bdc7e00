//! What a run hands over: plain data for reports, without a format.
//!
//! Everything but the times is a function of input, seed and version. Counts are those of consumed trials.

mod certificate;
mod distribution;
mod every;
mod evidence;
mod ranking;
mod witness;

use crate::base::digest::Digest;
use crate::engine::flaw::Flaw;
pub use crate::engine::witness::decider::Decider;
pub use crate::trials::budget::Stop;
pub use certificate::{Certificate, Certified};
pub use distribution::{Curve, CurvePoint, Distribution, Histogram, Quantile, Step};
pub use every::{Every, UnderOne};
pub use evidence::{Evidence, Snapshot, Standing, next_after};
pub use ranking::{Also, RankedOption, Ranking, Status};
pub use witness::{Shows, Witness};

/// Everything one call has computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CallResult {
    /// Title of the scenario, or its file where it has none.
    pub scenario: String,
    /// The tracks that it reads, and which velocities they have: `seen` or `recorded`.
    pub tracks: Vec<(String, &'static str)>,
    /// The presets that say how its people walk.
    pub people: Vec<&'static str>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// Each file that was read and its digest: scenario, properties, then what the scenario names.
    pub inputs: Vec<(String, Digest)>,
    /// Results in the order of the queries; a swept query has one per setting.
    pub results: Vec<QueryResult>,
    /// What the front end says of the inputs: warnings, and where nothing could run, errors.
    pub diagnostics: Vec<Finding>,
    /// Warnings that belong to no query.
    pub warnings: Vec<String>,
    /// Consumed trials; those that several queries share are counted once.
    pub trials: u64,
    /// Whether it was interrupted; the results are what is known so far.
    pub interrupted: bool,
    /// What ended the run early, if anything did.
    pub failure: Option<Failure>,
    /// Command that gives the same results again.
    pub replay: String,
    /// Duration of the whole call, s.
    pub elapsed_s: f64,
}

impl CallResult {
    /// Nothing yet, of this version of the program.
    pub fn of(scenario: impl Into<String>, seed: u64) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { scenario: scenario.into(), seed, version, ..Self::default() }
    }
}

/// Why a run ended before its queries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The call or an input is wrong.
    Input(String),
    /// A trial shows that the model is wrong.
    Model(Box<Flaw>),
    /// Time was up before the first trial.
    Late(String),
    /// A bug in `smc`.
    Bug(String),
}

impl Failure {
    /// What happened.
    pub fn message(&self) -> String {
        match self {
            Self::Input(message) | Self::Late(message) | Self::Bug(message) => message.clone(),
            Self::Model(flaw) => flaw.to_string(),
        }
    }

    /// Whether it is one of `smc`.
    pub const fn is_bug(&self) -> bool {
        matches!(self, Self::Bug(_))
    }
}

/// The result of one query under one setting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QueryResult {
    /// What was asked.
    pub asked: AskedQuery,
    /// The verdict of a `check`; `None` for the other kinds.
    pub verdict: Option<Verdict>,
    /// The certified statement in words.
    pub certifies: String,
    /// The certified statement in numbers; `None` where nothing is certified.
    pub certificate: Option<Certificate>,
    /// The estimate; `None` where there is none (nothing was sampled), infinite where it lies beyond the horizon. Of a `compare`
    /// the difference, of a `rank` the score of the choice.
    pub estimate: Option<f64>,
    /// Lower end of the interval; of what is legal where nothing is known.
    pub low: f64,
    /// Upper end of the interval, or of what is legal; may be infinite.
    pub high: f64,
    /// Of which probability the figures are, where the query names something else: the check of a quantile is decided
    /// as one of `P(metric <= threshold)`.
    pub of: Option<String>,
    /// Unit of the three numbers before; empty for probabilities.
    pub unit: String,
    /// Kind and level of the interval: `time-uniform, 95 %`.
    pub interval: String,
    /// The procedure.
    pub method: Method,
    /// The consumed trials.
    pub consumed: ConsumedTrials,
    /// Why sampling stopped.
    pub stopped_by: Stop,
    /// Command that gives this result again.
    pub replay: String,
    /// Duration, s.
    pub elapsed_s: f64,
    /// The horizon in seconds where the estimate or an end of its interval lies beyond it.
    pub censored: Option<f64>,
    /// Vacuity, suspicious counts, conditions.
    pub warnings: Vec<String>,
    /// Trials that show why.
    pub witnesses: Vec<Witness>,
    /// Details of a `compare`.
    pub compare: Option<Comparison>,
    /// Details of a `rank`.
    pub rank: Option<Ranking>,
    /// Distribution of a metric.
    pub distribution: Option<Distribution>,
    /// What was found under every value of a parameter, where that was asked.
    pub every: Option<Every>,
    /// Details of an estimate by splitting.
    pub rare: Option<Rare>,
    /// How the evidence grew, where that was asked for.
    pub evidence: Option<Evidence>,
    /// How often what the model says was true of people who were recorded; `None` where that is not known.
    pub model: Option<ModelError>,
}

/// How often a property was true of recorded people of whom the model said nearly the same probability.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ModelError {
    /// The place where they were recorded.
    pub site: String,
    /// When, if that is known.
    pub date: Option<String>,
    /// Least probability of these persons.
    pub from: f64,
    /// Largest probability.
    pub to: f64,
    /// How many persons were asked about.
    pub asked: u64,
    /// The number of those of whom the model said such a probability.
    pub persons: u64,
    /// The number of these of whom it was true.
    pub held: u64,
    /// Lower bound of the probability that it is true, 97.5 %.
    pub low: f64,
    /// Upper bound, 97.5 %.
    pub high: f64,
}

impl QueryResult {
    /// The estimate with its interval, if there is one.
    pub fn value(&self) -> Option<Interval> {
        Some(Interval { estimate: self.estimate?, low: self.low, high: self.high })
    }

    /// A result without numbers yet: what is known before the first trial.
    pub fn new(asked: AskedQuery) -> Self {
        Self { asked, low: f64::NEG_INFINITY, high: f64::INFINITY, ..Self::default() }
    }
}

/// The verdict of a `check`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It holds, up to the stated error.
    Satisfied,
    /// It does not hold, up to the stated error.
    Violated,
    /// The budget was too small to say.
    Undecided,
}

impl Verdict {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Satisfied => "satisfied",
            Self::Violated => "violated",
            Self::Undecided => "undecided",
        }
    }
}

/// A procedure and its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Method {
    /// Its name: `sprt`.
    pub name: String,
    /// Its parameters by name, in SI units, in order.
    pub numbers: Vec<(String, f64)>,
}

// A query under one setting, as reports quote it.

/// A query under one setting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AskedQuery {
    /// Its number among the queries of the call, from 0; together with the text it names the query.
    pub index: usize,
    /// Name of the property asked about, if it is one; may repeat.
    pub name: Option<String>,
    /// The query as written.
    pub text: String,
    /// Property file.
    pub file: String,
    /// Line of the query in it, from 1.
    pub line: usize,
    /// What is asked.
    pub kind: Kind,
    /// Values of swept or `under` parameters, as written; may be empty.
    pub settings: Vec<(String, String)>,
    /// The horizon with its unit, `30 s`, where a formula has no bound of its own.
    pub horizon: Option<String>,
    /// What was drawn once for the run, so that the result is about it alone: `the roadmap of planner, seed 0`.
    pub given: Option<String>,
    /// Whether the claim is that the probability which the figures are of is small, so that a trial with the event speaks against it.
    pub against: bool,
}

impl AskedQuery {
    /// A query without name, place or setting.
    pub fn new(index: usize, kind: Kind, text: impl Into<String>) -> Self {
        Self { index, kind, text: text.into(), ..Self::default() }
    }
}

/// What a query asks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Whether a quantity passes a threshold.
    #[default]
    Check,
    /// A quantity.
    Estimate,
    /// The difference of a quantity under two settings.
    Compare,
    /// The best of several moves or values.
    Rank,
    /// Those of several moves or values that none dominates.
    Pareto,
}

impl Kind {
    /// Its keyword.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Check => "check",
            Self::Estimate => "estimate",
            Self::Compare => "compare",
            Self::Rank => "rank",
            Self::Pareto => "pareto",
        }
    }
}

// An estimate by splitting.

/// An estimate by splitting, with the plain trials beside it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Rare {
    /// Independent runs.
    pub runs: u64,
    /// Runs in which no path reached the event.
    pub extinct: u64,
    /// Standard deviation of the estimate of one run.
    pub deviation: f64,
    /// Levels of a run, on average.
    pub levels: f64,
    /// Paths of all runs.
    pub paths: u64,
    /// Steps of the model in all paths.
    pub steps: u64,
    /// Mean of the runs; `None` if they did not come to an end.
    pub estimate: Option<f64>,
    /// Lower end of the asymptotic interval.
    pub low: f64,
    /// Upper end of it.
    pub high: f64,
    /// Lower end of the 99 % interval of the plain trials.
    pub plain_low: f64,
    /// Upper end of it.
    pub plain_high: f64,
    /// Upper bound of the probability, certified by the plain trials alone.
    pub plain_bound: f64,
    /// Lower bound of the probability, certified by the runs.
    pub floor: f64,
    /// Whether the mean of the runs lies in the interval of the plain trials; if not, it is refused.
    pub agrees: bool,
}

// The outcome of a `compare`.

/// The two sides of a `compare`.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The side of `under`.
    pub first: Side,
    /// The side of `with`.
    pub second: Side,
    /// First less second, over pairs of trials with the same random numbers.
    pub difference: Side,
}

/// One side of a comparison, or the difference. Of the difference, `trials` counts pairs, successes those in
/// which only the first holds, and failures those in which only the second does.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// Its settings, as written; for the difference `first - second`.
    pub label: String,
    /// What was measured.
    pub value: Interval,
    /// Its trials.
    pub counts: Counts,
}

// Queries for which time or trials did not suffice.

/// How a query that is no `check` falls short of what it asks, for lack of time or of trials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortfall {
    /// It got no trial.
    NotBegun,
    /// It got fewer trials than it takes.
    Incomplete,
}

impl Shortfall {
    /// Its words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotBegun => "not begun",
            Self::Incomplete => "incomplete",
        }
    }
}

impl QueryResult {
    /// How it falls short of what it asks, if it does. A `check` that does is undecided.
    pub fn shortfall(&self) -> Option<Shortfall> {
        let short = self.stopped_by == Stop::Cap || self.stopped_by.is_early();
        (self.verdict.is_none() && short).then_some(match self.consumed.counts.trials {
            0 => Shortfall::NotBegun,
            _ => Shortfall::Incomplete,
        })
    }
}

// Errors and oddities of the inputs of a call, as reports quote them: plain data, without sources.

/// Where in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spot {
    /// The file as named in the call.
    pub file: String,
    /// Line and column of the first character, both from 1; the column counts characters.
    pub start: (usize, usize),
    /// Line and column one past the last character.
    pub end: (usize, usize),
}

/// One error or warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Whether it is an error, or a warning only.
    pub error: bool,
    /// Its code, such as `E0201`.
    pub code: String,
    /// Its place; `None` for what has none, such as a missing file.
    pub spot: Option<Spot>,
    /// What is wrong.
    pub message: String,
    /// What is said at the mark; may be empty.
    pub label: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Finding {
    /// `error[E0201] at a.bltl:3:8: there is no name …`
    pub fn line(&self) -> String {
        let word = if self.error { "error" } else { "warning" };
        let at = self.spot.as_ref().map_or(String::new(), |spot| {
            let (line, column) = spot.start;
            format!(" at {}:{line}:{column}", spot.file)
        });
        format!("{word}[{}]{at}: {}", self.code, self.message)
    }
}

// A number with an interval.

/// A number with an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub estimate: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

// Consumed trials, by outcome and by what else is counted of them.

/// The trials that a result was computed from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConsumedTrials {
    /// Their number, in all and by outcome.
    pub counts: Counts,
    /// Those clipped by a declared range.
    pub clipped: u64,
    /// Those in which radii were shrunk to part people who overlap at the start.
    pub shrunk: u64,
    /// Those in which somebody had no way to a goal.
    pub no_way: u64,
    /// Steps of the model in all of them.
    pub steps: u64,
}

/// Consumed trials by outcome. Trials with a number instead of a truth value are neither successes nor
/// failures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// All.
    pub trials: u64,
    /// Those in which the formula holds.
    pub successes: u64,
    /// Those in which it does not.
    pub failures: u64,
    /// Those that diverged or hit a cap.
    pub unresolved: u64,
}

impl Counts {
    /// Both together.
    pub(crate) fn and(self, more: Self) -> Self {
        Self {
            trials: self.trials + more.trials,
            successes: self.successes + more.successes,
            failures: self.failures + more.failures,
            unresolved: self.unresolved + more.unresolved,
        }
    }
}
