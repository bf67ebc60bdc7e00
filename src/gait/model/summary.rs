//! What a model says about itself: what `smc gait show` prints.

use super::columns::{COLUMNS, Columns, DURATION, LENGTH};
use super::transition::Transition;
use super::{LearnedGait, Residuals};
use serde::Serialize;

/// A model in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Where its steps are from.
    pub source: String,
    /// What their license asks for.
    pub license: String,
    /// Whether it is the model as published.
    pub as_published: bool,
    /// How steps vary about their mean.
    pub residuals: Residuals,
    /// Subjects and their steps that have steps before and after them.
    pub subjects: Vec<(String, usize)>,
    /// Shares of the variance of the length of a step.
    pub length: Shares,
    /// Shares of the variance of its duration.
    pub duration: Shares,
    /// Mean shares of all columns that vary.
    pub columns: Shares,
    /// Left, right.
    pub feet: [FootSummary; 2],
}

/// How a variance divides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shares {
    /// Between the steps of one subject (intra-subject).
    pub within: f64,
    /// Between the means of subjects (inter-subject).
    pub between: f64,
}

/// One foot in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FootSummary {
    /// First steps in the density.
    pub first_steps: usize,
    /// Pairs that begin with this foot.
    pub pairs: usize,
    /// Components that are kept.
    pub components: usize,
    /// Shares of the variance of all components.
    pub explained: Vec<f64>,
    /// Length scales of the components and of the mark of a first step; empty for a linear model.
    pub length_scales: Vec<f64>,
    /// Variance of the noise over that of the signal.
    pub noise: f64,
    /// Variance of the signal of each component of the next step (of the residuals for a linear model).
    pub variances: Vec<f64>,
    /// Points of the posterior.
    pub points: usize,
    /// Logarithm of the marginal likelihood, nats for each number.
    pub log_likelihood: Option<f64>,
}

impl LearnedGait {
    /// The model in numbers.
    pub fn show(&self) -> Summary {
        let people = &self.people;
        let column = |k: usize| {
            let all = people.within[k] + people.between[k];
            let between = if all > 0.0 { people.between[k] / all } else { 0.0 };
            Shares { within: 1.0 - between, between }
        };
        let all: Columns = std::array::from_fn(|k| column(k).between);
        let between = all.iter().sum::<f64>() / COLUMNS as f64;
        let foot = |side: &super::Side| {
            let mut foot = FootSummary {
                first_steps: side.first.steps.len(),
                pairs: side.pairs.residuals.len(),
                components: side.basis.components(),
                explained: side.basis.explained.clone(),
                length_scales: Vec::new(),
                noise: 0.0,
                variances: side.transition.variances().to_vec(),
                points: 0,
                log_likelihood: None,
            };
            if let Transition::Process(process) = &side.transition {
                foot.length_scales.clone_from(&process.lengths);
                foot.noise = process.noise;
                foot.points = process.points.first().map_or(0, Vec::len);
                foot.log_likelihood = Some(process.log_likelihood);
            }
            foot
        };
        Summary {
            source: self.source.clone(),
            license: self.license.clone(),
            as_published: self.as_published,
            residuals: self.residuals,
            subjects: people.subjects.iter().map(|s| (s.name.clone(), s.steps)).collect(),
            length: column(LENGTH),
            duration: column(DURATION),
            columns: Shares { within: 1.0 - between, between },
            feet: self.sides.each_ref().map(foot),
        }
    }
}
