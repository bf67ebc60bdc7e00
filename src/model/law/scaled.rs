//! Multiples of a distribution: `poisson(4) * 1 s` is a whole number of seconds.
//!
//! Continuous families stay what they are. Counts become lists of values, which remember what they are multiples of: of a
//! Poisson law up to where both tails are beyond what a uniform number of 52 bits can reach.

use super::{Family, discrete};

/// What is left out of a Poisson law at either end.
const TAIL: f64 = 1e-18;
/// Most values of a list.
const MOST_VALUES: usize = 4096;

impl Family {
    /// The law of `by` times the variable, `by` positive. `None` where it has too many values, or is a beta law: that
    /// lies in (0, 1).
    pub fn scaled(&self, by: f64) -> Option<Self> {
        Some(match *self {
            Self::Normal { mean, sd } => Self::Normal { mean: mean * by, sd: sd * by },
            Self::LogNormal { mean, sd } => Self::LogNormal { mean: mean * by, sd: sd * by },
            Self::Gamma { mean, sd } => Self::Gamma { mean: mean * by, sd: sd * by },
            Self::Weibull { mean, sd } => Self::Weibull { mean: mean * by, sd: sd * by },
            Self::Uniform { low, high } => Self::Uniform { low: low * by, high: high * by },
            Self::Exponential { mean } => Self::Exponential { mean: mean * by },
            Self::Choice(ref options) => Self::Choice(times(options, by)),
            Self::Multiple { ref of, by: first, ref options } => {
                Self::Multiple { of: of.clone(), by: first * by, options: times(options, by) }
            }
            Self::Bernoulli { p } => self.multiple(by, vec![(0.0, 1.0 - p), (by, p)]),
            Self::UniformInt { low, high } => {
                let count = usize::try_from(high.checked_sub(low)?).ok()?.checked_add(1)?;
                if count > MOST_VALUES {
                    return None;
                }
                self.multiple(by, (low..=high).map(|k| (k as f64 * by, 1.0 / count as f64)).collect())
            }
            Self::Poisson { mean } => {
                let first = discrete::quantile(self, TAIL);
                let last = discrete::poisson_upper_quantile(mean, TAIL);
                let count = (last - first + 1.0) as usize;
                if !last.is_finite() || count > MOST_VALUES {
                    return None;
                }
                let share = |k: f64| {
                    // The difference of the smaller tails, so that nothing cancels.
                    if k > mean {
                        discrete::poisson_upper(mean, k - 1.0) - discrete::poisson_upper(mean, k)
                    } else {
                        discrete::poisson_cdf(mean, k) - discrete::poisson_cdf(mean, k - 1.0)
                    }
                };
                let value = |k: usize| first + k as f64;
                self.multiple(by, (0..count).map(|k| (value(k) * by, share(value(k)))).collect())
            }
            Self::Beta { .. } => return None,
        })
    }

    fn multiple(&self, by: f64, options: Vec<(f64, f64)>) -> Self {
        Self::Multiple { of: Box::new(self.clone()), by, options }
    }
}

fn times(options: &[(f64, f64)], by: f64) -> Vec<(f64, f64)> {
    options.iter().map(|(value, weight)| (value * by, *weight)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Law;

    /// What it remembers changes no draw: it is drawn as the list is.
    #[test]
    fn a_multiple_is_drawn_as_its_list() {
        for family in [
            Family::Bernoulli { p: 0.3 },
            Family::UniformInt { low: -2, high: 6 },
            Family::Poisson { mean: 4.0 },
        ] {
            let Some(Family::Multiple { of, by, options }) = family.scaled(0.7) else { panic!("{family:?}") };
            assert_eq!((*of, by), (family.clone(), 0.7));
            for (low, high) in [(f64::NEG_INFINITY, f64::INFINITY), (0.0, 3.0)] {
                let multiple = Law::Random { family: family.scaled(0.7).unwrap(), low, high };
                let list = Law::Random { family: Family::Choice(options.clone()), low, high };
                assert_eq!(multiple.validate(), list.validate());
                assert_eq!(multiple.bounds(), list.bounds());
                let (one, other) = (multiple.ready(), list.ready());
                for k in 0..1000 {
                    let u = (f64::from(k) + 0.5) / 1000.0;
                    assert_eq!(one.draw(u).to_bits(), other.draw(u).to_bits(), "{family:?} at {u}");
                }
            }
        }
    }

    #[test]
    fn quantiles_scale() {
        let families = [
            Family::Normal { mean: 3.0, sd: 1.0 },
            Family::LogNormal { mean: 3.0, sd: 1.0 },
            Family::Gamma { mean: 3.0, sd: 1.0 },
            Family::Weibull { mean: 3.0, sd: 1.0 },
            Family::Uniform { low: 1.0, high: 4.0 },
            Family::Exponential { mean: 3.0 },
            Family::Choice(vec![(1.0, 0.25), (5.0, 0.75)]),
            Family::Bernoulli { p: 0.3 },
            Family::UniformInt { low: 1, high: 6 },
            Family::Poisson { mean: 0.2 },
            Family::Poisson { mean: 4.0 },
            Family::Poisson { mean: 900.0 },
        ];
        for family in families {
            let scaled = family.scaled(60.0).unwrap();
            for k in 1..400 {
                // Off the steps of the discrete ones, where rounding decides.
                let u = (f64::from(k) + 0.123) / 401.0;
                let (plain, minutes) = (family.quantile(u), scaled.quantile(u));
                assert!((minutes - 60.0 * plain).abs() <= 1e-9 * (1.0 + minutes.abs()), "{family:?} at {u}");
            }
        }
        let twice = Family::Poisson { mean: 4.0 }.scaled(2.0).and_then(|family| family.scaled(3.0)).unwrap();
        assert_eq!(twice.quantile(0.7), 6.0 * Family::Poisson { mean: 4.0 }.quantile(0.7));
        assert_eq!(Family::Beta { mean: 0.5, sd: 0.1 }.scaled(2.0), None);
        assert_eq!(Family::UniformInt { low: 0, high: 10_000 }.scaled(2.0), None);
        assert_eq!(Family::Poisson { mean: 1e9 }.scaled(2.0), None);
    }
}
