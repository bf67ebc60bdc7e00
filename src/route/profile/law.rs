//! Laws of the speed at a knot.

use super::stretch::Infeasible;
use crate::base::math::{exp, ln};
use crate::base::special::normal_quantile;

/// How a varied profile draws the speed at a knot from the interval of legal speeds there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// A normal speed, cut to the legal interval.
    Preferred {
        /// Its mean before the cut, m/s.
        speed: f64,
        /// Its standard deviation before the cut, as a share of the mean.
        spread: f64,
    },
    /// A uniform square of the speed. It gives slow walks: the median takes 1.5 to 2 times the least time.
    Uniform,
}

/// Share of the largest acceleration with which a preferred speed is taken up: at least, and how much more at most.
const RAMP: (f64, f64) = (0.4, 0.6);

impl Law {
    /// How far it is from a speed with this square until the preferred one is reached, with a share of the largest acceleration
    /// that follows from a uniform number, m; none where no speed is preferred.
    pub(super) fn ramp(self, square: f64, along: f64, uniform: f64) -> Option<f64> {
        match self {
            Self::Preferred { speed, .. } => {
                Some((speed * speed - square).abs() / (2.0 * along * (RAMP.0 + RAMP.1 * uniform)))
            }
            Self::Uniform => None,
        }
    }

    /// Whether its numbers are valid.
    pub(super) fn check(self) -> Result<(), Infeasible> {
        match self {
            Self::Preferred { speed, spread }
                if !(speed > 0.0 && speed.is_finite() && spread >= 0.0 && spread.is_finite()) =>
            {
                Err(Infeasible::Law { speed, spread })
            }
            _ => Ok(()),
        }
    }

    /// A square of the speed in [low, high], m^2/s^2, from a uniform number.
    pub(super) fn draw(self, (low, high): (f64, f64), uniform: f64) -> f64 {
        let square = match self {
            Self::Uniform => low + uniform * (high - low),
            Self::Preferred { speed, spread } => {
                let deviation = speed * spread;
                let [from, to] = [low, high].map(f64::sqrt);
                let v = if deviation > 0.0 {
                    let [from, to] = [from, to].map(|v| (v - speed) / deviation);
                    speed + deviation * cut_normal(from, to, uniform)
                } else {
                    speed.max(from).min(to)
                };
                v * v
            }
        };
        square.max(low).min(high)
    }
}

/// The distribution function of the normal law for z <= 0 within 1e-8 of its value: Hart, "Computer Approximations" (1968),
/// no. 5666, and beyond its range a continued fraction, both as in West, "Better approximations to cumulative normal
/// functions", Wilmott (2005).
fn lower_tail(z: f64) -> f64 {
    const TOP: [f64; 7] = [
        220.206_867_912_376,
        221.213_596_169_931,
        112.079_291_497_871,
        33.912_866_078_383,
        6.373_962_203_531_65,
        0.700_383_064_443_688,
        3.526_249_659_989_11e-2,
    ];
    const BOTTOM: [f64; 8] = [
        440.413_735_824_752,
        793.826_512_519_948,
        637.333_633_378_831,
        296.564_248_779_674,
        86.780_732_202_946_1,
        16.064_177_579_207,
        1.755_667_163_182_64,
        8.838_834_764_831_84e-2,
    ];
    const ROOT_TWO_PI: f64 = 2.506_628_274_631_000_5;
    let (x, density) = (-z, exp(-0.5 * z * z));
    if x < 7.071_067_811_865_47 {
        let sum = |terms: &[f64]| terms.iter().rev().fold(0.0, |sum, term| sum * x + term);
        return density * sum(&TOP) / sum(&BOTTOM);
    }
    density / ROOT_TWO_PI / (1..=5).rev().fold(x + 0.65, |below, k| x + f64::from(k) / below)
}

/// Below this the distribution function of the normal law leaves the range of doubles.
const FAR: f64 = -37.0;

/// The quantile of a standard normal number cut to [from, to].
fn cut_normal(from: f64, to: f64, p: f64) -> f64 {
    // Doubles resolve a lower tail, but not an upper one: 1 - 1e-20 is 1.
    if from + to > 0.0 {
        return -cut_normal(-to, -from, 1.0 - p);
    }
    if to > FAR {
        let up_to = if to > 0.0 { 1.0 - lower_tail(-to) } else { lower_tail(to) };
        let below = lower_tail(from);
        return normal_quantile(below + p * (up_to - below));
    }
    // So far out z^2 / 2 is an exponential number within a thousandth.
    let kept = exp(0.5 * (to - from) * (to + from));
    -(to * to - 2.0 * ln(kept + p * (1.0 - kept))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::special::normal::normal_tails;

    /// Ends of intervals: around the mean, beside it, and far out on both sides.
    const INTERVALS: [(f64, f64); 7] =
        [(-1.0, 2.0), (0.5, 0.6), (-9.5, -6.0), (7.0, 20.0), (-3.0, 30.0), (-60.0, -45.0), (50.0, 51.0)];

    /// The integral of the density from `from` to `to` relative to its value at the end next to 0, by Simpson's rule.
    fn mass(from: f64, to: f64, scale: f64) -> f64 {
        let n = 20_000;
        let width = (to - from) / f64::from(n);
        let density = |k: i32| {
            let z = from + f64::from(k) * width;
            exp(0.5 * (scale - z * z))
        };
        let inner: f64 = (1..n).map(|k| density(k) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
        (density(0) + inner + density(n)) * width / 3.0
    }

    #[test]
    fn lower_tail_agrees_with_the_incomplete_gamma_function() {
        for k in 0..3700 {
            let z = -0.01 * f64::from(k);
            let error = lower_tail(z) / normal_tails(z).lower() - 1.0;
            assert!(error.abs() < 1e-8, "{z}: {error:e}");
        }
    }

    #[test]
    fn cut_normal_is_the_quantile() {
        for (from, to) in INTERVALS {
            let nearest = 0f64.max(from).min(to);
            let scale = nearest * nearest;
            let all = mass(from, to, scale);
            for p in [1e-3, 0.1, 0.5, 0.9, 0.999] {
                let z = cut_normal(from, to, p);
                let tolerance = if nearest.abs() > -FAR { 1e-3 } else { 1e-7 };
                assert!((mass(from, z, scale) / all - p).abs() < tolerance, "{from} {to} {p}: {z}");
            }
        }
    }

    #[test]
    fn draws_stay_inside_and_rise_with_the_number() {
        let laws = [0.0, 0.01, 0.2, 3.0].map(|spread| Law::Preferred { speed: 1.34, spread });
        for law in laws.into_iter().chain([Law::Uniform]) {
            for interval in [(0.0, 0.0), (0.01, 0.02), (1e-12, 2.25), (2.0, 100.0), (1.7, 1.7 + 1e-15)] {
                let drawn: Vec<f64> =
                    (0..=100).map(|k| law.draw(interval, (f64::from(k) + 0.5) / 101.0)).collect();
                assert!(drawn.iter().all(|u| (interval.0..=interval.1).contains(u)), "{law:?} {interval:?}");
                assert!(drawn.windows(2).all(|w| w[0] <= w[1] + 1e-14 * w[1]), "{law:?} {interval:?}");
            }
        }
    }
}
