//! What a run hands over: plain data for reports, without a format.
//!
//! Everything but the times is a function of input, seed and version. Counts are those of consumed trials.

pub use super::certificate::{Certificate, Certified};
pub use super::decider::Decider;
pub use super::finding::{Finding, Spot};
use super::flaw::Flaw;
pub use super::shortfall::Shortfall;
use crate::base::fingerprint::Fingerprint;

/// Everything one call has computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// Title of the scenario, or its file where it has none.
    pub scenario: String,
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
#[derive(Clone, Debug, PartialEq)]
pub struct QueryResult {
    /// Number of the query among those of the call, from 0; together with the text it names the query.
    pub index: usize,
    /// Name of the property asked about, if it is one; may repeat.
    pub name: Option<String>,
    /// The query as written.
    pub query: String,
    /// Property file.
    pub file: String,
    /// Line of the query in it, from 1.
    pub line: usize,
    /// What was asked.
    pub kind: Kind,
    /// Values of swept or `under` parameters, as written; may be empty.
    pub settings: Vec<(String, String)>,
    /// The verdict of a `check`; `None` for the other kinds.
    pub verdict: Option<Verdict>,
    /// The certified statement in words.
    pub certifies: String,
    /// The certified statement in numbers; `None` where nothing is certified.
    pub certificate: Option<Certificate>,
    /// The horizon with its unit, `30 s`, where a formula has no bound of its own.
    pub horizon: Option<String>,
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
    /// Consumed trials.
    pub counts: Counts,
    /// Trials clipped by a declared range.
    pub clipped: u64,
    /// Steps of the model in the consumed trials.
    pub steps: u64,
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
    /// Trials in which radii were shrunk to part people who overlap at the start.
    pub shrunk: u64,
    /// Trials in which somebody had no way to a goal.
    pub no_way: u64,
    /// Details of an estimate by splitting.
    pub rare: Option<Rare>,
}

impl QueryResult {
    /// A result without numbers yet: what is known before the first trial.
    pub fn new(index: usize, kind: Kind, query: impl Into<String>) -> Self {
        Self {
            index,
            name: None,
            query: query.into(),
            file: String::new(),
            line: 0,
            kind,
            settings: Vec::new(),
            verdict: None,
            certifies: String::new(),
            certificate: None,
            horizon: None,
            estimate: None,
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            of: None,
            against: false,
            unit: String::new(),
            interval: String::new(),
            method: Method::default(),
            counts: Counts::default(),
            clipped: 0,
            steps: 0,
            stopped_by: Stop::Plan,
            replay: String::new(),
            elapsed_s: 0.0,
            censored: None,
            warnings: Vec::new(),
            witnesses: Vec::new(),
            compare: None,
            rank: None,
            distribution: None,
            shrunk: 0,
            no_way: 0,
            rare: None,
        }
    }
}

/// What a query asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Whether a quantity passes a threshold.
    Check,
    /// A quantity.
    Estimate,
    /// The difference of a quantity under two settings.
    Compare,
    /// The best of several moves or values.
    Rank,
}

impl Kind {
    /// Its keyword.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Check => "check",
            Self::Estimate => "estimate",
            Self::Compare => "compare",
            Self::Rank => "rank",
        }
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

/// Consumed trials by outcome. Trials with a number instead of a truth value are neither successes nor
/// failures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

/// Why sampling stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stop {
    /// A test crossed its boundary.
    Boundary,
    /// The interval, or the gap of a ranking, became as narrow as asked for.
    Width,
    /// More trials of this kind would not help: how the unresolved ones are read decides the verdict, or keeps
    /// the interval wide.
    Unresolved,
    /// The number of trials was planned beforehand.
    Plan,
    /// The largest number of trials was reached.
    Cap,
    /// Time was up.
    Deadline,
    /// Somebody interrupted it.
    Interrupt,
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
        }
    }
}

/// What a witness is one of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shows {
    /// The first trial in which the formula fails, or in which the metric lies on the failing side.
    Fails,
    /// The first trial in which the formula holds, or in which the metric lies on the passing side.
    Holds,
    /// The trial with the smallest value of the metric, the first of several.
    Lowest,
    /// The trial with the largest value of the metric, the first of several.
    Highest,
}

impl Shows {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fails => "fails",
            Self::Holds => "holds",
            Self::Lowest => "lowest",
            Self::Highest => "highest",
        }
    }
}

/// A trial that shows why.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// What it is one of.
    pub shows: Shows,
    /// Index of the trial.
    pub trial: u64,
    /// Value of the metric, SI; `None` of a formula.
    pub value: Option<f64>,
    /// When the formula was decided, or the metric got its value.
    pub time: f64,
    /// Unit of the time: `s`, or `steps` where steps have no length.
    pub unit: &'static str,
    /// The atom or number that decided it, with its agents.
    pub what: String,
    /// The agent that decided it, with the number that was compared.
    pub decider: Option<Decider>,
    /// Command that shows the trial.
    pub command: String,
}

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

/// The outcome of a `rank`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    /// The recommended option; `None` where nothing was sampled, or no trial is resolved.
    pub choice: Option<String>,
    /// Certified: the choice is at most so much worse than the best. All that there can be where nothing is known yet;
    /// infinite where nothing is chosen.
    pub gap: f64,
    /// Whether other options carry the same certificate.
    pub tied: bool,
    /// All options, best first.
    pub options: Vec<RankedOption>,
}

/// One option of a ranking.
#[derive(Clone, Debug, PartialEq)]
pub struct RankedOption {
    /// Its name.
    pub label: String,
    /// Values of ranked parameters, as written.
    pub settings: Vec<(String, String)>,
    /// Its score.
    pub value: Interval,
    /// Its trials.
    pub counts: Counts,
    /// What is known of it.
    pub status: Status,
}

/// What is known of an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// The recommended one.
    Chosen,
    /// It carries the same certificate as the choice: it, too, is at most the wanted loss worse than the best.
    Tied,
    /// Shown to be worse than another option, which led when that was shown.
    Beaten,
    /// Neither: it may be the best by no more than the certified gap, and may be much worse.
    Open,
}

impl Status {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Chosen => "chosen",
            Self::Tied => "tied",
            Self::Beaten => "beaten",
            Self::Open => "open",
        }
    }
}

/// How the values of a metric are distributed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// Counts in bins of equal width.
    pub histogram: Option<Histogram>,
    /// Quantiles, by level ascending.
    pub quantiles: Vec<Quantile>,
    /// The empirical distribution function, at a hundred shares at most.
    pub empirical: Vec<Step>,
    /// The true function is nowhere farther than this from the empirical one, with the error of the result (Dvoretzky,
    /// Kiefer, Wolfowitz; Massart), however unresolved trials are read. `None` where the number of trials depends on
    /// the values.
    pub band: Option<f64>,
}

/// A step of the empirical distribution function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// A value; infinite beyond the horizon.
    pub value: f64,
    /// Share of the resolved trials with at most this value.
    pub share: f64,
}

/// Counts in bins of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Lower end of the first bin.
    pub low: f64,
    /// Upper end of the last bin.
    pub high: f64,
    /// Trials per bin.
    pub counts: Vec<u64>,
    /// Trials with the value -∞: a difference of times of which the second does not come.
    pub below: u64,
    /// Trials with the value ∞.
    pub beyond: u64,
}

/// One quantile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantile {
    /// Its level, in (0, 1).
    pub level: f64,
    /// Its value; infinite beyond the horizon.
    pub value: Interval,
}

/// An estimate by splitting, with the plain trials beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
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
