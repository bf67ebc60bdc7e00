//! The outcome of a `rank`.

use super::Counts;
use super::{Interval, Side};

/// The outcome of a `rank`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    /// The recommended option; `None` where nothing was sampled, or no trial is resolved.
    pub choice: Option<String>,
    /// The agent's doing where the choice does not say it: `waits 2 s, then takes its own way`.
    pub means: Option<String>,
    /// Certified: the choice is at most so much worse than the best. All that there can be where nothing is known yet;
    /// infinite where nothing is chosen.
    pub gap: f64,
    /// Whether other options carry the same certificate.
    pub tied: bool,
    /// What the scores of the options are: `P(safe)`.
    pub aim: String,
    /// Whether no option satisfies the constraints, certainly.
    pub is_empty: bool,
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
    /// Its score under each of several models; empty for one.
    pub under: Vec<Side>,
    /// What was asked of it besides: constraints, or further aims.
    pub also: Vec<Also>,
}

/// What was asked of an option besides its score.
#[derive(Clone, Debug, PartialEq)]
pub struct Also {
    /// What it is: `P(together)`, or a constraint: `P(together) >= 0.9`.
    pub what: String,
    /// Its unit; empty for probabilities.
    pub unit: String,
    /// Its value.
    pub value: Interval,
    /// Whether the option satisfies it, if it is a constraint and that is known.
    pub holds: Option<bool>,
}

/// What is known of an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// The recommended one.
    Chosen,
    /// It carries the same certificate as the choice: it, too, is at most the wanted loss worse than the best.
    Tied,
    /// Shown to be worse than another option, by paired trials or by the intervals of the two.
    Beaten,
    /// One of those that none dominates: each rival is worse in some aim, or better in none by its width.
    Front,
    /// It violates a constraint.
    Excluded,
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
            Self::Front => "front",
            Self::Excluded => "excluded",
            Self::Open => "open",
        }
    }
}
