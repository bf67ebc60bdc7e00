//! Laws against statrs, `rand_distr` and sums over a fine grid of uniform numbers.

use super::*;
use crate::base::random::{Purpose, Sequence, Stream, TrialKey};
use rand_distr::Distribution;
use statrs::distribution::{ContinuousCDF, DiscreteCDF};

fn free(family: Family) -> Law {
    Law::Random { family, low: f64::NEG_INFINITY, high: f64::INFINITY }
}

fn cut(family: Family, low: f64, high: f64) -> Law {
    Law::Random { family, low, high }
}

fn continuous() -> Vec<Family> {
    vec![
        Family::Normal { mean: 1.3, sd: 0.26 },
        Family::LogNormal { mean: 60.0, sd: 12.0 },
        Family::Uniform { low: -2.0, high: 5.0 },
        Family::Exponential { mean: 4.0 },
        Family::Beta { mean: 0.3, sd: 0.1 },
        Family::Gamma { mean: 2.0, sd: 1.5 },
        Family::Weibull { mean: 3.0, sd: 0.8 },
    ]
}

fn discrete() -> Vec<Family> {
    vec![
        Family::UniformInt { low: -3, high: 4 },
        Family::Poisson { mean: 3.5 },
        Family::Poisson { mean: 400.0 },
        Family::Bernoulli { p: 0.3 },
        Family::Choice(vec![(2.0, 0.5), (1.0, 0.2), (7.0, 0.3)]),
    ]
}

/// Mean and standard deviation of draws at the midpoints of `n` cells.
fn moments(law: &Law, n: u32) -> (f64, f64) {
    let draws: Vec<f64> = (0..n).map(|k| law.draw((f64::from(k) + 0.5) / f64::from(n))).collect();
    let mean = draws.iter().sum::<f64>() / f64::from(n);
    let variance = draws.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / f64::from(n);
    (mean, variance.sqrt())
}

#[test]
fn draws_have_the_mean_and_deviation_that_were_asked_for() {
    for family in continuous() {
        let asked = match family {
            Family::Normal { sd, .. }
            | Family::LogNormal { sd, .. }
            | Family::Beta { sd, .. }
            | Family::Gamma { sd, .. }
            | Family::Weibull { sd, .. } => sd,
            Family::Uniform { low, high } => (high - low) / 12f64.sqrt(),
            Family::Exponential { mean } => mean,
            _ => f64::NAN,
        };
        let (mean, sd) = moments(&free(family.clone()), 200_000);
        assert!((mean / family.mean() - 1.0).abs() < 1e-4, "{family:?}: {mean}");
        assert!((sd / asked - 1.0).abs() < 1e-3, "{family:?}: {sd}");
    }
}

type Reference = Box<dyn Fn(f64) -> f64>;

#[test]
fn distribution_functions_agree_with_statrs() {
    let sigma = (1.0 + 0.04f64).ln().sqrt();
    let references: Vec<(Family, Reference)> = vec![
        (Family::Normal { mean: 1.3, sd: 0.26 }, {
            let d = statrs::distribution::Normal::new(1.3, 0.26).unwrap();
            Box::new(move |x| d.cdf(x))
        }),
        (Family::LogNormal { mean: 60.0, sd: 12.0 }, {
            let d = statrs::distribution::LogNormal::new(60f64.ln() - sigma * sigma / 2.0, sigma).unwrap();
            Box::new(move |x| d.cdf(x))
        }),
        (Family::Gamma { mean: 2.0, sd: 1.5 }, {
            let d = statrs::distribution::Gamma::new(4.0 / 2.25, 2.0 / 2.25).unwrap();
            Box::new(move |x| d.cdf(x))
        }),
        (Family::Beta { mean: 0.3, sd: 0.1 }, {
            let d = statrs::distribution::Beta::new(6.0, 14.0).unwrap();
            Box::new(move |x| d.cdf(x))
        }),
        (Family::Poisson { mean: 3.5 }, {
            let d = statrs::distribution::Poisson::new(3.5).unwrap();
            Box::new(move |x: f64| d.cdf(x.floor() as u64))
        }),
    ];
    for (family, reference) in references {
        for k in 1..100 {
            let x = family.quantile(f64::from(k) / 100.0);
            assert!((family.cdf(x) - reference(x)).abs() < 1e-9, "{family:?} {x}");
        }
    }
}

#[test]
fn draws_follow_the_laws_of_rand_distr() {
    let n = 20_000;
    let stream = Stream::of(TrialKey { seed: 11, index: 0, branch: 0 }, 1, Purpose::Test);
    let mut sequence = Sequence::new(stream);
    let shape = 4.542_9;
    let scale = 3.0 / statrs::function::gamma::gamma(1.0 + 1.0 / shape);
    let weibull = rand_distr::Weibull::new(scale, shape).unwrap();
    let gamma = rand_distr::Gamma::new(4.0 / 2.25, 2.25 / 2.0).unwrap();
    let poisson = rand_distr::Poisson::new(3.5).unwrap();
    let cases: [(Family, Vec<f64>); 3] = [
        (Family::Weibull { mean: 3.0, sd: weibull_sd(shape, scale) }, {
            (0..n).map(|_| weibull.sample(&mut sequence)).collect()
        }),
        (Family::Gamma { mean: 2.0, sd: 1.5 }, (0..n).map(|_| gamma.sample(&mut sequence)).collect()),
        (Family::Poisson { mean: 3.5 }, (0..n).map(|_| poisson.sample(&mut sequence)).collect()),
    ];
    for (family, mut draws) in cases {
        draws.sort_by(f64::total_cmp);
        // Kolmogorov's distance; 1.63 / sqrt(n) is passed by chance in one of a hundred samples.
        let distance = (1..n)
            .filter(|k| draws[*k] > draws[*k - 1])
            .map(|k| (family.cdf(draws[k - 1]) - k as f64 / n as f64).abs())
            .fold(0.0, f64::max);
        assert!(distance < 1.63 / f64::sqrt(n as f64), "{family:?}: {distance}");
    }
}

fn weibull_sd(shape: f64, scale: f64) -> f64 {
    use statrs::function::gamma::gamma;
    scale * (gamma(1.0 + 2.0 / shape) - gamma(1.0 + 1.0 / shape).powi(2)).sqrt()
}

#[test]
fn quantiles_are_the_smallest_values_that_reach_the_probability() {
    for family in discrete() {
        for k in 1..200 {
            let p = f64::from(k) / 200.0 - 1e-4;
            let x = family.quantile(p);
            assert!(family.cdf(x) >= p, "{family:?} {p} {x}");
            assert!(family.cdf(x - 1e-9) < p, "{family:?} {p} {x}");
        }
    }
}

#[test]
fn truncation_keeps_the_interval_and_the_conditional_law() {
    let cases = [
        cut(Family::Normal { mean: 1.3, sd: 0.26 }, 0.5, 1.5),
        cut(Family::Normal { mean: 0.0, sd: 1.0 }, 10.0, 12.0),
        cut(Family::Normal { mean: 0.0, sd: 1.0 }, f64::NEG_INFINITY, -20.0),
        cut(Family::LogNormal { mean: 60.0, sd: 12.0 }, 70.0, f64::INFINITY),
        cut(Family::Uniform { low: 0.0, high: 1.0 }, 0.25, 9.0),
        cut(Family::Exponential { mean: 1.0 }, 30.0, 40.0),
        cut(Family::Beta { mean: 0.3, sd: 0.1 }, 0.5, 0.9),
        cut(Family::Gamma { mean: 2.0, sd: 1.5 }, 0.0, 1.0),
        cut(Family::Weibull { mean: 3.0, sd: 0.8 }, 3.5, 6.0),
        cut(Family::UniformInt { low: 1, high: 6 }, 2.5, 5.5),
        cut(Family::Poisson { mean: 3.5 }, 2.0, 6.0),
        cut(Family::Poisson { mean: 3.5 }, 30.0, 40.0),
        cut(Family::Bernoulli { p: 0.3 }, 0.5, 1.0),
        cut(Family::Choice(vec![(2.0, 0.5), (1.0, 0.2), (7.0, 0.3)]), 1.5, 7.0),
    ];
    for law in cases {
        law.validate().unwrap();
        let (low, high) = law.bounds();
        let n = 50_000;
        let (mean, _) = moments(&law, n);
        for k in 0..n {
            let x = law.draw((f64::from(k) + 0.5) / f64::from(n));
            assert!(low <= x && x <= high, "{law:?} {x}");
        }
        let scale = if mean.abs() > 0.1 { mean.abs() } else { 1.0 };
        assert!((mean - law.mean()).abs() < 1e-3 * scale, "{law:?}: {mean} {}", law.mean());
    }
    // Far in the tail the law is nearly exponential with rate 10: P(X > 10.1 | X > 10).
    let far = cut(Family::Normal { mean: 0.0, sd: 1.0 }, 10.0, 12.0);
    let ratio =
        crate::base::special::erfc(10.1 / 2f64.sqrt()) / crate::base::special::erfc(10.0 / 2f64.sqrt());
    assert!((far.draw(1.0 - ratio) - 10.1).abs() < 1e-9);
}

#[test]
fn bad_parameters_are_refused_with_their_numbers() {
    let refused = [
        (free(Family::Normal { mean: 0.0, sd: -1.0 }), "-1"),
        (free(Family::Normal { mean: f64::NAN, sd: 1.0 }), "NaN"),
        (free(Family::LogNormal { mean: -2.0, sd: 1.0 }), "-2"),
        (free(Family::Beta { mean: 0.5, sd: 0.5 }), "0.5"),
        (free(Family::Beta { mean: 1.5, sd: 0.1 }), "1.5"),
        (free(Family::Uniform { low: 2.0, high: 1.0 }), "2"),
        (free(Family::UniformInt { low: 2, high: 1 }), "2"),
        (free(Family::Weibull { mean: 1.0, sd: 1e9 }), "1000000000"),
        (free(Family::Gamma { mean: 80.0, sd: 1e-6 }), "0.000001"),
        (free(Family::Gamma { mean: 1.0, sd: 2e3 }), "1000 times"),
        (free(Family::LogNormal { mean: 1.0, sd: 1e7 }), "1000000 times"),
        (free(Family::Exponential { mean: 0.0 }), "0"),
        (free(Family::Poisson { mean: -1.0 }), "-1"),
        (free(Family::Bernoulli { p: 1.5 }), "1.5"),
        (free(Family::Choice(vec![])), "at least one"),
        (free(Family::Choice(vec![(1.0, 0.5), (2.0, 0.4)])), "0.9"),
        (free(Family::Choice(vec![(1.0, 1.5), (2.0, -0.5)])), "1.5"),
        (cut(Family::Normal { mean: 0.0, sd: 1.0 }, 2.0, 1.0), "2"),
        (cut(Family::Uniform { low: 0.0, high: 1.0 }, 2.0, 3.0), "2"),
        (cut(Family::UniformInt { low: 0, high: 9 }, 1.2, 1.8), "1.2"),
        (cut(Family::Poisson { mean: 2.0 }, -5.0, -1.0), "-5"),
        (cut(Family::Normal { mean: 1.0, sd: 0.0 }, 2.0, 3.0), "2"),
        (Law::Constant(f64::INFINITY), "inf"),
    ];
    for (law, needle) in refused {
        let message = law.validate().expect_err(&format!("{law:?}"));
        assert!(message.contains(needle), "{law:?}: {message}");
    }
    for family in continuous().into_iter().chain(discrete()) {
        assert_eq!(free(family).validate(), Ok(()));
    }
    assert_eq!(free(Family::Normal { mean: 1.0, sd: 0.0 }).validate(), Ok(()));
    assert_eq!(free(Family::Normal { mean: 1.0, sd: 0.0 }).draw(0.3), 1.0);
}
