//! Drawing from a law by the inverse distribution function, truncated or not: one uniform number each.

use super::family::Shape;
use super::{Family, Law, discrete};
use crate::base::math;

/// exp(a) - exp(b) for logarithms a >= b.
fn difference(a: f64, b: f64) -> f64 {
    if a == f64::NEG_INFINITY { 0.0 } else { -math::exp(a) * math::exp_m1(b - a) }
}

/// The mass of [low, high], from whichever tail is small there, and whether that is the upper one.
fn mass(shape: Shape, low: f64, high: f64, biased: bool) -> (f64, bool) {
    let tails = |x| if biased { shape.size_biased_tails(x) } else { shape.tails(x) };
    let (at_low, at_high) = (tails(low), tails(high));
    let upper = at_low.ln_upper < at_low.ln_lower;
    let mass = if upper {
        difference(at_low.ln_upper, at_high.ln_upper)
    } else {
        difference(at_high.ln_lower, at_low.ln_lower)
    };
    (mass, upper)
}

/// P(low <= X <= high) before truncation.
pub(super) fn interval_mass(family: &Family, low: f64, high: f64) -> f64 {
    match (Shape::of(family), family) {
        (Some(Shape::Point(value)), _) => f64::from(low <= value && value <= high),
        (Some(shape), _) => mass(shape, low, high, false).0,
        (None, Family::Poisson { mean }) => {
            let (below, last) = (low.ceil() - 1.0, high.floor());
            if below >= *mean {
                discrete::poisson_upper(*mean, below) - discrete::poisson_upper(*mean, last)
            } else {
                discrete::poisson_cdf(*mean, last) - discrete::poisson_cdf(*mean, below)
            }
        }
        (None, Family::UniformInt { low: first, high: last }) => {
            let (clipped_low, clipped_high) = clip(*first, *last, low, high);
            let count =
                (clipped_high as f64 - clipped_low as f64 + 1.0) / (*last as f64 - *first as f64 + 1.0);
            math::at_least(count, 0.0)
        }
        (None, _) => kept(family, low, high).iter().map(|(_, weight)| weight).sum(),
    }
}

/// The whole numbers of `first ..= last` within [low, high].
fn clip(first: i64, last: i64, low: f64, high: f64) -> (i64, i64) {
    // Casts from double saturate, so that infinite ends do no harm.
    let (low, high) = (low.ceil() as i64, high.floor() as i64);
    (if low > first { low } else { first }, if high < last { high } else { last })
}

/// The listed values within [low, high].
fn kept(family: &Family, low: f64, high: f64) -> Vec<(f64, f64)> {
    let inside = |(value, _): &(f64, f64)| low <= *value && *value <= high;
    match family {
        Family::Bernoulli { p } => [(0.0, 1.0 - p), (1.0, *p)].into_iter().filter(inside).collect(),
        Family::Choice(options) | Family::Multiple { options, .. } => {
            options.iter().copied().filter(inside).collect()
        }
        _ => Vec::new(),
    }
}

/// A law made ready to draw from many times: what does not depend on the uniform number is computed once.
#[derive(Clone, Debug, PartialEq)]
pub struct Ready(Form);

#[derive(Clone, Debug, PartialEq)]
enum Form {
    /// A constant.
    Constant(f64),
    /// A continuous law on its whole support.
    Free(Shape),
    /// A continuous law cut to an interval: the tail at its lower end, the mass inside, and whether the upper
    /// tail is used.
    Cut { shape: Shape, tail: f64, mass: f64, upper: bool, low: f64, high: f64 },
    /// A discrete law.
    Discrete { family: Family, low: f64, high: f64 },
}

impl Ready {
    /// The constant, if it is one.
    pub const fn constant(&self) -> Option<f64> {
        match self.0 {
            Form::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// The value that `uniform`, in (0, 1), is mapped to. NaN for parameters that `validate` refuses.
    pub fn draw(&self, uniform: f64) -> f64 {
        let (value, low, high) = match &self.0 {
            Form::Constant(value) => return *value,
            Form::Free(shape) => return shape.quantile(uniform),
            Form::Cut { shape, tail, mass, upper: true, low, high } => {
                (shape.upper_quantile(tail - uniform * mass), *low, *high)
            }
            Form::Cut { shape, tail, mass, upper: false, low, high } => {
                (shape.quantile(tail + uniform * mass), *low, *high)
            }
            Form::Discrete { family, low, high } => match discrete_draw(family, *low, *high, uniform) {
                Discrete::Exact(value) => return value,
                Discrete::Rounded(value) => (value, *low, *high),
            },
        };
        // Rounding never leaves the interval.
        math::at_most(math::at_least(value, low), high)
    }
}

/// A draw of a discrete law, and whether it can lie outside of the interval by rounding.
enum Discrete {
    Exact(f64),
    Rounded(f64),
}

fn discrete_draw(family: &Family, low: f64, high: f64, uniform: f64) -> Discrete {
    match family {
        Family::UniformInt { low: first, high: last } => {
            let (first, last) = clip(*first, *last, low, high);
            Discrete::Exact(discrete::whole_number(first, last, uniform))
        }
        Family::Poisson { mean } => {
            let below = low.ceil() - 1.0;
            let mass = interval_mass(family, low, high);
            Discrete::Rounded(if below >= *mean {
                let q = discrete::poisson_upper(*mean, below) - uniform * mass;
                discrete::poisson_upper_quantile(*mean, q)
            } else {
                family.quantile(discrete::poisson_cdf(*mean, below) + uniform * mass)
            })
        }
        _ => Discrete::Exact(discrete::pick(&kept(family, low, high), uniform)),
    }
}

impl Law {
    /// The law made ready to draw from many times.
    pub fn ready(&self) -> Ready {
        let (family, low, high) = match self {
            Self::Constant(value) => return Ready(Form::Constant(*value)),
            Self::Random { family, low, high } => (family, *low, *high),
        };
        let free = low == f64::NEG_INFINITY && high == f64::INFINITY;
        Ready(match Shape::of(family) {
            Some(shape) if free => Form::Free(shape),
            Some(shape) => {
                let (mass, upper) = mass(shape, low, high, false);
                let tails = shape.tails(low);
                let tail = if upper { tails.upper() } else { tails.lower() };
                Form::Cut { shape, tail, mass, upper, low, high }
            }
            None => Form::Discrete { family: family.clone(), low, high },
        })
    }

    /// The value that `uniform`, in (0, 1), is mapped to. NaN for parameters that `validate` refuses.
    pub fn draw(&self, uniform: f64) -> f64 {
        self.ready().draw(uniform)
    }

    /// The mean of what is drawn.
    pub fn mean(&self) -> f64 {
        let (family, low, high) = match self {
            Self::Constant(value) => return *value,
            Self::Random { family, low, high } => (family, *low, *high),
        };
        if low == f64::NEG_INFINITY && high == f64::INFINITY {
            return family.mean();
        }
        match (Shape::of(family), family) {
            (Some(Shape::Point(value)), _) => value,
            (Some(Shape::Uniform { low: first, high: last }), _) => {
                0.5 * math::at_least(low, first) + 0.5 * math::at_most(high, last)
            }
            (Some(shape @ Shape::Normal { mean, sd }), _) => {
                let density = |x: f64| {
                    let z = (x - mean) / sd;
                    if z.is_infinite() { 0.0 } else { math::exp(-0.5 * z * z) }
                };
                let scale = sd / (2.0 * std::f64::consts::PI).sqrt();
                mean + scale * (density(low) - density(high)) / mass(shape, low, high, false).0
            }
            (Some(shape), _) => {
                family.mean() * (mass(shape, low, high, true).0 / mass(shape, low, high, false).0)
            }
            (None, Family::UniformInt { low: first, high: last }) => {
                let (first, last) = clip(*first, *last, low, high);
                0.5 * first as f64 + 0.5 * last as f64
            }
            (None, Family::Poisson { mean }) => {
                // k P(X = k) = mean P(X = k - 1).
                mean * interval_mass(family, low - 1.0, high - 1.0) / interval_mass(family, low, high)
            }
            (None, _) => {
                let kept = kept(family, low, high);
                let total: f64 = kept.iter().map(|(_, weight)| weight).sum();
                kept.iter().map(|(value, weight)| value * weight).sum::<f64>() / total
            }
        }
    }

    /// The ends of the values that can be drawn.
    pub fn bounds(&self) -> (f64, f64) {
        match self {
            Self::Constant(value) => (*value, *value),
            Self::Random { family, low, high } => {
                let (first, last) = family.support();
                let (low, high) = (math::at_least(first, *low), math::at_most(last, *high));
                match family {
                    Family::UniformInt { .. } | Family::Poisson { .. } => (low.ceil(), high.floor()),
                    Family::Bernoulli { .. } | Family::Choice(_) | Family::Multiple { .. } => {
                        kept(family, low, high).iter().filter(|(_, weight)| *weight > 0.0).fold(
                            (f64::INFINITY, f64::NEG_INFINITY),
                            |(low, high), (value, _)| {
                                (math::at_most(low, *value), math::at_least(high, *value))
                            },
                        )
                    }
                    _ => (low, high),
                }
            }
        }
    }
}
