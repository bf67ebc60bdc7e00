//! What a query found under every value of a parameter.

use super::{Counts, Interval, Verdict};

/// What a query found under every value of a parameter: the least favourable one stands for all.
#[derive(Clone, Debug, PartialEq)]
pub struct Every {
    /// The parameter.
    pub name: String,
    /// The place of the least favourable value.
    pub least: usize,
    /// What was found under each, in the order of writing.
    pub parts: Vec<UnderOne>,
}

/// What was found under one value.
#[derive(Clone, Debug, PartialEq)]
pub struct UnderOne {
    /// The parameter and its value, as written.
    pub setting: (String, String),
    /// The verdict of a check.
    pub verdict: Option<Verdict>,
    /// The figure; of a ranking that of the choice.
    pub figure: Interval,
    /// Its trials; of a ranking those of all options.
    pub counts: Counts,
    /// Of a ranking the option that did best under this value, and how well.
    pub best: Option<(String, f64)>,
}

impl Every {
    /// The least favourable value, as written.
    pub fn least_value(&self) -> &str {
        self.parts.get(self.least).map_or("", |part| part.setting.1.as_str())
    }
}
