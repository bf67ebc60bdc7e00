//! What a run hands over: plain data for reports, without a format.
//!
//! Everything but the times is a function of input, seed and version. Counts are those of consumed trials.

mod asked;
mod comparison;
mod counts;
mod distribution;
mod evidence;
mod interval;
mod ranking;
mod rare;
mod witness;

pub use super::certificate::{Certificate, Certified};
pub use super::decider::Decider;
pub use super::finding::{Finding, Spot};
use super::flaw::Flaw;
pub use super::shortfall::Shortfall;
use crate::base::fingerprint::Fingerprint;
pub use asked::{AskedQuery, Kind};
pub use comparison::{Comparison, Side};
pub use counts::{ConsumedTrials, Counts};
pub use distribution::{Distribution, Histogram, Quantile, Step};
pub use evidence::{Evidence, Snapshot, Standing, next_after};
pub use interval::Interval;
pub use ranking::{RankedOption, Ranking, Status};
pub use rare::Rare;
pub use witness::{Shows, Witness};

/// Everything one call has computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CallResult {
    /// Title of the scenario, or its file where it has none.
    pub scenario: String,
    /// The tracks that it reads, and which velocities they have: `seen` or `recorded`.
    pub tracks: Vec<(String, &'static str)>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// Each file that was read and its fingerprint: scenario, properties, then what the scenario names.
    pub inputs: Vec<(String, Fingerprint)>,
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
    /// Whether the claim is that this probability is small, so that a trial with the event speaks against it.
    pub against: bool,
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
    /// Details of an estimate by splitting.
    pub rare: Option<Rare>,
    /// How the evidence grew, where that was asked for.
    pub evidence: Option<Evidence>,
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

/// Why sampling stopped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stop {
    /// A test crossed its boundary.
    Boundary,
    /// The interval, or the gap of a ranking, became as narrow as asked for.
    Width,
    /// More trials of this kind would not help: how the unresolved ones are read decides the verdict, or keeps
    /// the interval wide.
    Unresolved,
    /// The number of trials was planned beforehand.
    #[default]
    Plan,
    /// The largest number of trials was reached.
    Cap,
    /// Time was up.
    Deadline,
    /// Somebody interrupted it.
    Interrupt,
    /// Outcomes of further trials were not there to be merged.
    Missing,
}

impl Stop {
    /// Its word in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Boundary => "boundary",
            Self::Width => "width",
            Self::Unresolved => "unresolved",
            Self::Plan => "plan",
            Self::Cap => "cap",
            Self::Deadline => "deadline",
            Self::Interrupt => "interrupt",
            Self::Missing => "missing",
        }
    }

    /// Whether how many trials were read is no function of the query.
    pub const fn is_early(self) -> bool {
        matches!(self, Self::Deadline | Self::Interrupt | Self::Missing)
    }
}
