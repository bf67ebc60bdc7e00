//! What compilation yields: worlds to run and questions to answer about them.

pub use crate::compile::context::parts::{Form, Origins, Part};
use crate::compile::context::roster;
pub use crate::compile::context::wording::Texts;
use crate::compile::dimension::Dimension;
use crate::compile::written::Written;
use crate::logic::{Root, Tree};
use crate::model::{AgentId, Body, Bool, Num, Scenario};
use crate::stats::Chosen;
use crate::syntax::source::Span;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Everything a call asks.
#[derive(Clone, Debug)]
pub struct Study {
    /// Title of the scenario.
    pub title: String,
    /// The tracks of recordings that it reads, and which velocities they have: `seen` or `recorded`.
    pub tracks: Vec<(String, &'static str)>,
    /// The presets from which its kinds of people start, in all worlds.
    pub people: BTreeSet<&'static str>,
    /// The scenario under each combination of parameter values that is asked about.
    pub worlds: Vec<World>,
    /// The world that the call is about: with the values of `--set`, of a sweep the first.
    pub base: usize,
    /// The questions, in order of files and of writing; a sweep repeats them for each of its points.
    pub queries: Vec<Query>,
}

/// The scenario under one combination of parameter values, and what is observed in it.
#[derive(Clone, Debug)]
pub struct World {
    /// Values of parameters that were set, as `name`, `value` in the unit of the declaration.
    pub settings: Vec<(String, String)>,
    /// The scenario.
    pub scenario: Arc<Scenario>,
    /// The bodies of the declared kinds that have all parameters, by name.
    pub kinds: BTreeMap<String, Body>,
    /// Truth values observed in each state.
    pub atoms: Vec<Bool>,
    /// How what is observed was written, for witnesses.
    pub texts: Texts,
    /// How the scenario was written, for `smc show`.
    pub written: Written,
    /// Numbers observed in each state.
    pub signals: Vec<Num>,
    /// Formulas and metrics over them.
    pub tree: Tree,
    /// The formulas and metrics that are read from each trace.
    pub columns: Vec<Column>,
    /// Where what can go wrong while a trial runs is written.
    pub origins: Origins,
    /// Where the starts of the people of each declaration are written, by the first of them; ascending.
    pub places: Vec<(AgentId, Span)>,
}

impl World {
    /// The place where the start of an agent is written.
    pub fn place_of(&self, agent: AgentId) -> Option<Span> {
        roster::written(&self.places, agent)
    }
}

/// One thing asked of each trace of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Formula or metric.
    pub root: Root,
    /// As written.
    pub text: String,
}

/// A column of a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Target {
    /// Index of the world.
    pub world: usize,
    /// Index of its column.
    pub column: usize,
}

/// One question.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Query {
    /// Number of the query in the call, from 0; a list of estimates takes several.
    pub index: usize,
    /// Name of the property asked about, if it is one name.
    pub name: Option<String>,
    /// As written.
    pub text: String,
    /// What it is about, as one would say it.
    pub said: Said,
    /// Where.
    #[serde(skip)]
    pub span: Span,
    /// Parameter values that hold for it alone (sweep, `under`).
    pub settings: Vec<(String, String)>,
    /// Values of swept parameters, where the query can be asked at this point of the sweep alone; in a family the
    /// other points count too.
    pub point: Vec<(String, String)>,
    /// What is asked.
    pub ask: Ask,
    /// Where it is asked under every value of a parameter: this is one of them.
    pub every: Option<Every>,
    /// The horizon with its unit, where a formula or metric ranges up to it.
    pub horizon: Option<String>,
    /// What was drawn once for the run, so that its results are about it alone: roadmaps.
    pub given: Option<String>,
}

/// One of several values of a parameter under each of which something is asked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Every {
    /// The parameter.
    pub name: String,
    /// Its values, as written.
    pub values: Vec<String>,
    /// The place of this one among them.
    pub place: usize,
}

/// A measure as one would say it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Said {
    /// `P(safe)`
    pub measure: String,
    /// The event that the check of a quantile is decided by.
    pub event: Option<Event>,
}

/// `metric <= bound`, or with `<`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Event {
    /// What is compared.
    pub metric: String,
    /// `<=` or `<`.
    pub relation: String,
    /// With what.
    pub bound: String,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} {}", self.metric, self.relation, self.bound)
    }
}

/// What is asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ask {
    /// Is a measure above or below a threshold?
    Check {
        /// The measure.
        measure: Measure,
        /// Whether the claim is "at least" (or above) rather than "at most" (or below).
        at_least: bool,
        /// Whether equality counts as satisfied.
        or_equal: bool,
        /// The threshold, SI.
        threshold: f64,
        /// The procedure.
        test: Chosen,
        /// Error of the interval beside the verdict.
        beside: f64,
    },
    /// What is the value of a measure?
    Estimate {
        /// The measure.
        measure: Measure,
        /// The procedure.
        estimator: Chosen,
        /// The column of the level of splitting, if it is that.
        level: Option<usize>,
    },
    /// How do two differ?
    Compare {
        /// First side.
        first: Measure,
        /// Second side.
        second: Measure,
        /// Values of the parameters on each side.
        settings: [Vec<(String, String)>; 2],
        /// Half width of the interval of the difference, or `None` for a fixed number of trials.
        within: Option<f64>,
        /// Error probability.
        delta: f64,
    },
    /// Which option is best?
    Rank {
        /// The options, in order of writing.
        options: Vec<RankOption>,
        /// The score of the first option; that of another is read from its own world.
        measure: Measure,
        /// The procedure; `epsilon` is the loss that does not matter.
        ranking: Chosen,
        /// Under how many values of a parameter each option is asked for its score: the least counts. The options stand one
        /// after the other, each under all values.
        models: usize,
        /// What is asked of the options besides: constraints, or further aims.
        beside: Vec<Beside>,
    },
}

impl Ask {
    /// The column that a check or an estimate is about.
    pub fn target(&self) -> Option<Target> {
        match self {
            Self::Check { measure, .. } | Self::Estimate { measure, .. } => Some(measure.target),
            Self::Rank { .. } | Self::Compare { .. } => None,
        }
    }

    /// The worlds that are asked about.
    pub fn worlds(&self) -> Vec<usize> {
        match self {
            Self::Check { measure, .. } | Self::Estimate { measure, .. } => vec![measure.target.world],
            Self::Rank { options, .. } => options.iter().map(|option| option.target.world).collect(),
            Self::Compare { first, second, .. } => vec![first.target.world, second.target.world],
        }
    }
}

/// An option of a ranking: a world, and a move in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RankOption {
    /// Its name: `heading 15 deg`, `lane = 2 m`.
    pub label: String,
    /// Values of parameters that hold for it alone.
    pub settings: Vec<(String, String)>,
    /// Its world, and the column of its score there.
    pub target: Target,
    /// The columns of what is asked besides.
    pub beside: Vec<usize>,
    /// The declaration of moves and its option that is followed, if any.
    pub advice: Option<(usize, usize)>,
    /// Of options that all carry the certificate, the one with the least number is chosen.
    #[serde(deserialize_with = "or_infinite")]
    pub deviation: f64,
}

/// JSON has no infinity: it is written as `null`.
fn or_infinite<'d, D: Deserializer<'d>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
}

/// What is asked of the options of a ranking besides their score.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beside {
    /// As one would say it: `P(together)`.
    pub said: String,
    /// Which number of the distribution.
    #[serde(flatten)]
    pub kind: MeasureKind,
    /// What for.
    pub role: Role,
}

/// The role of what is asked besides a score.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// An option has to satisfy it.
    Constraint {
        /// Whether it has to be at least the threshold, rather than at most.
        at_least: bool,
        /// The threshold, SI.
        threshold: f64,
        /// `>= 0.9`, as written.
        text: String,
    },
    /// More of it is better.
    Aim {
        /// The loss that does not matter.
        epsilon: f64,
    },
}

/// A number of the distribution of traces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// What is observed of each trace.
    pub target: Target,
    /// Which number of its distribution.
    #[serde(flatten)]
    pub kind: MeasureKind,
}

/// Which number of the distribution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum MeasureKind {
    /// Probability of a formula.
    Probability,
    /// Expectation of a metric, clipped to a range.
    Expectation {
        /// Range, SI.
        range: (f64, f64),
        /// Its dimension.
        dimension: Dimension,
        /// The level above which values count; `None` if all do.
        level: Option<f64>,
    },
    /// Quantile of a metric.
    Quantile {
        /// Level in (0, 1).
        level: f64,
        /// Its dimension.
        dimension: Dimension,
    },
    /// The probability of a formula as a function of its bound: the distribution function of a time.
    Curve {
        /// The bounds, ascending, SI.
        times: Vec<f64>,
        /// Whether the formula holds up to that time (`G`), rather than from then on (`F`).
        falls: bool,
        /// The dimension of the bounds.
        dimension: Dimension,
        /// The name of the bound.
        name: String,
        /// The probability at the last bound: `P(F<=30 s (user in exit))`.
        last: String,
    },
}

impl MeasureKind {
    /// The range of an expectation.
    pub const fn range(&self) -> Option<(f64, f64)> {
        match self {
            Self::Expectation { range, .. } => Some(*range),
            Self::Probability | Self::Quantile { .. } | Self::Curve { .. } => None,
        }
    }

    /// The share of the values that count for an expectation, unless all do.
    pub fn share(&self) -> Option<f64> {
        match self {
            Self::Expectation { level, .. } => level.map(|level| 1.0 - level),
            _ => None,
        }
    }
}
