//! What there is to say of a procedure besides its rule: its name, its arguments, its guarantee, how many trials it is
//! likely to take, and how it is made. The compiler, reports, forecasts and `smc explain` read [`super::PROCEDURES`].

use super::ranking::Ranking;
use super::{AnyEstimator, AnyTest, Bounded, Hypothesis, Interval, Invalid, PROCEDURES, Sequential, UNNAMED};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A kind of query that can name procedures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Serves {
    /// `check P(…)` and `check Q(…)`.
    Check,
    /// `estimate P(…)`.
    Probability,
    /// `estimate E(…)`.
    Expectation,
    /// `estimate CVaR(…)`.
    Tail,
    /// `estimate Q(…)`.
    Quantile,
    /// `estimate P(…) for …`.
    Curve,
    /// `rank`.
    Ranking,
}

impl fmt::Display for Serves {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Check => "check P(…), check Q(…)",
            Self::Probability => "estimate P(…)",
            Self::Expectation => "estimate E(…)",
            Self::Tail => "estimate CVaR(…)",
            Self::Quantile => "estimate Q(…)",
            Self::Curve => "estimate P(…) for t in …",
            Self::Ranking => "rank moves of …",
        })
    }
}

/// A number that a procedure takes, as `name = value`.
#[derive(Clone, Copy, Debug)]
pub struct Argument {
    /// Its name.
    pub name: &'static str,
    /// Its range and its default.
    pub kind: Kind,
}

/// The range and the default of an argument.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// The error on one side of a test. Default: that of the query.
    Side,
    /// The error of an interval or a choice, which the estimates of one query share. Default: that of the query.
    Error,
    /// Half width of an indifference region, at least this. Required.
    Indifference(f64),
    /// Half width in the unit of the measure. Default: `within`.
    Width,
    /// Half width relative to the measure. Default: `within`.
    Relative,
    /// A number of trials fixed in advance, at most this. Required.
    Trials(u64),
    /// Another number. Its largest value and its default may depend on the arguments before it.
    Number {
        /// Whether it is whole.
        whole: bool,
        /// Least value.
        low: f64,
        /// Largest value.
        high: fn(&[f64]) -> f64,
        /// The value unless it is given.
        default: fn(&[f64]) -> f64,
        /// The argument that the largest value depends on.
        bounded_by: Option<usize>,
    },
}

/// `alpha`, `beta` and `delta`: errors that `confidence` states as well.
pub const ERRORS: [&str; 3] = [ALPHA.name, BETA.name, DELTA.name];

pub(super) const ALPHA: Argument = Argument { name: "alpha", kind: Kind::Side };
pub(super) const BETA: Argument = Argument { name: "beta", kind: Kind::Side };
pub(super) const DELTA: Argument = Argument { name: "delta", kind: Kind::Error };
pub(super) const EPSILON: Argument = Argument { name: "epsilon", kind: Kind::Width };

impl Argument {
    pub(super) const fn indifference(least: f64) -> Self {
        Self { name: "indifference", kind: Kind::Indifference(least) }
    }

    pub(super) const fn trials(most: u64) -> Self {
        Self { name: "trials", kind: Kind::Trials(most) }
    }

    /// Whether `confidence` states it as well.
    pub const fn is_error(self) -> bool {
        matches!(self.kind, Kind::Side | Kind::Error)
    }

    /// Range and default, for the page of its procedure; `before` are the defaults of the arguments before it.
    fn range(self, before: &[f64]) -> String {
        match self.kind {
            Kind::Side | Kind::Error => "above 0, below 0.5; default: 1 - confidence".to_owned(),
            Kind::Indifference(least) => {
                let least = if least > 0.0 { format!("at least {least}") } else { "above 0".to_owned() };
                format!("{least}; the region around the threshold lies inside (0, 1); required")
            }
            Kind::Width => "in the unit of the measure; default: `within`".to_owned(),
            Kind::Relative => "from 0.0001 to 0.999; default: `within`".to_owned(),
            Kind::Trials(most) => format!("a whole number from 1 to {:e}; required", most as f64),
            Kind::Number { low, high, default, .. } => {
                let number = self.kind.noun();
                format!("{number} from {low} to {}; default: {}", high(before), default(before))
            }
        }
    }
}

impl Kind {
    /// `a whole number`, or `a number`.
    pub const fn noun(self) -> &'static str {
        if matches!(self, Self::Number { whole: false, .. }) { "a number" } else { "a whole number" }
    }
}

/// The ends of the range of a metric.
pub type Range = (f64, f64);

/// The threshold that a test decides about.
#[derive(Clone, Copy, Debug)]
pub struct Against {
    /// Which side the threshold is on.
    pub hypothesis: Hypothesis,
    /// The threshold.
    pub theta: f64,
}

/// An estimator of a metric with a range, of its largest share if there is one, from the values of its arguments.
pub type MakeBounded = fn(Range, Option<f64>, &[f64]) -> Result<Bounded, Invalid>;

/// How a procedure is made from the values of its arguments.
#[derive(Clone, Copy, Debug)]
pub enum Make {
    /// A test of a probability.
    Test(fn(Against, &[f64]) -> Result<Sequential<AnyTest>, Invalid>),
    /// An estimator of a probability; the seed addresses what it draws for itself.
    Estimator(fn(&[f64], u64) -> Result<Sequential<AnyEstimator>, Invalid>),
    /// An estimator of the mean of a metric with a range, or of its largest share.
    Mean(MakeBounded),
    /// Order statistics, or the band around the distribution function.
    Quantile {
        /// Whether it is the band, which holds all quantiles at once.
        band: bool,
    },
    /// The band around the distribution function of a time.
    Curve,
    /// Importance splitting.
    Splitting {
        /// Whether levels are found on the way (else by a pilot run, with as many paths at each).
        adaptive: bool,
    },
    /// A ranking.
    Ranking(Ranking),
}

/// What the truth may be, for a forecast.
#[derive(Clone, Copy, Debug)]
pub struct Guess {
    /// The share of successes.
    pub share: f64,
    /// The mean of the metric.
    pub mean: f64,
    /// Its variance.
    pub variance: f64,
    /// The threshold of a check.
    pub theta: f64,
    /// The length of the range of the metric.
    pub range: f64,
    /// The share of the largest values that count; 1 if all do.
    pub tail: f64,
}

/// How many trials a procedure is likely to take, where that depends on the truth.
#[derive(Clone, Copy, Debug)]
pub struct Forecast {
    /// The expected number, from the values of the arguments.
    pub trials: fn(&[f64], &Guess) -> f64,
    /// Factors on it for what runs at one truth scatter, fewer and more.
    pub scatter: (f64, f64),
}

/// Factors of tests.
pub(super) const TEST_SCATTER: (f64, f64) = (0.25, 3.0);

/// A procedure as it is named, made, forecast and explained.
#[derive(Debug)]
pub struct Spec {
    /// Its name after `by`.
    pub name: &'static str,
    /// Its name in reports.
    pub reported: &'static str,
    /// The query that can name it.
    pub serves: Serves,
    /// Its arguments.
    pub arguments: &'static [Argument],
    /// What it is, for `smc show`: values of arguments stand in braces.
    pub summary: &'static str,
    /// What it guarantees.
    pub guarantee: &'static str,
    /// How it is made.
    pub make: Make,
    /// How many trials it takes, if that depends on the truth.
    pub forecast: Option<Forecast>,
}

impl Spec {
    /// The procedure of that name for a kind of query.
    pub fn find(name: &str, serves: Serves) -> Option<&'static Self> {
        PROCEDURES.iter().copied().find(|spec| spec.name == name && spec.serves == serves)
    }

    /// The names for a kind of query.
    pub fn names(serves: Serves) -> impl Iterator<Item = &'static str> {
        PROCEDURES.iter().filter(move |spec| spec.serves == serves).map(|spec| spec.name)
    }

    /// With values for its arguments, in their order.
    pub fn with(&'static self, values: impl Into<Vec<f64>>) -> Chosen {
        Chosen { spec: self, values: values.into() }
    }

    /// `sprt(alpha, beta, indifference)`
    pub fn signature(&self) -> String {
        let names: Vec<&str> = self.arguments.iter().map(|argument| argument.name).collect();
        format!("{}({})", self.name, names.join(", "))
    }

    /// What `smc explain` prints of it.
    pub fn page(&self) -> String {
        let mut page = format!("{} by {}\n\n{}.\n", self.serves, self.signature(), self.guarantee);
        let mut before = Vec::new();
        for argument in self.arguments {
            page.push_str(&format!("\n  {:<13} {}", argument.name, argument.range(&before)));
            before.push(if let Kind::Number { default, .. } = argument.kind {
                default(&before)
            } else {
                0.0
            });
        }
        page + "\n"
    }
}

/// A procedure with the values of its arguments.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "Written", try_from = "Written")]
pub struct Chosen {
    /// The procedure.
    pub spec: &'static Spec,
    /// The value of each argument.
    pub values: Vec<f64>,
}

impl PartialEq for Chosen {
    fn eq(&self, other: &Self) -> bool {
        let name = |chosen: &Self| (chosen.spec.name, chosen.spec.reported);
        name(self) == name(other) && self.values == other.values
    }
}

impl Chosen {
    /// Arguments with their values.
    pub fn numbers(&self) -> impl Iterator<Item = (Argument, f64)> {
        self.spec.arguments.iter().copied().zip(self.values.iter().copied())
    }

    /// The value of an argument; 0 of one that it does not have.
    pub fn value(&self, name: &str) -> f64 {
        self.numbers().find(|(argument, _)| argument.name == name).map_or(0.0, |(_, value)| value)
    }

    /// The half width that is asked for, around an interval.
    pub fn width(&self, interval: Interval) -> Option<f64> {
        self.numbers().find_map(|(argument, value)| match argument.kind {
            Kind::Width => Some(value),
            Kind::Relative => Some(value * interval.middle()),
            _ => None,
        })
    }
}

/// The same in a file.
#[derive(Serialize, Deserialize)]
struct Written {
    serves: Serves,
    name: String,
    values: Vec<f64>,
}

impl From<Chosen> for Written {
    fn from(Chosen { spec, values }: Chosen) -> Self {
        Self { serves: spec.serves, name: spec.name.to_owned(), values }
    }
}

impl TryFrom<Written> for Chosen {
    type Error = String;

    fn try_from(Written { serves, name, values }: Written) -> Result<Self, String> {
        let fits = |spec: &&&Spec| {
            spec.name == name && spec.serves == serves && spec.arguments.len() == values.len()
        };
        let spec = PROCEDURES.iter().chain(UNNAMED).find(fits);
        Ok(spec
            .ok_or_else(|| format!("`{name}` is no procedure with {} arguments", values.len()))?
            .with(values))
    }
}
