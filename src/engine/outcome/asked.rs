//! What was asked: a query under one setting, as reports quote it.

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
