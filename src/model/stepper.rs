//! How walkers of a stepped kind step (Agethen et al. 2018): all that is no parameter of a body.

use super::law::{Family, Law};
use super::parameter::Parameter;
use std::sync::Arc;

/// How the walkers of a kind step.
#[derive(Clone, Debug, PartialEq)]
pub struct Stepper {
    /// Where the steps come from.
    pub gait: GaitRule,
    /// How steps are chosen.
    pub search: SearchRule,
    /// Whether the kind sets the free speed; else a learned gait has its own.
    pub sets_speed: bool,
}

/// Where steps come from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum GaitRule {
    /// Published relations between stature, speed and steps.
    #[default]
    Synthetic,
    /// A file that `smc gait fit` has made.
    Learned {
        /// As the scenario names it.
        file: String,
        /// Its contents.
        text: Arc<str>,
    },
}

/// How steps are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchRule {
    /// One after another, each out of some candidates.
    Guided {
        /// How many there are for each step.
        candidates: u32,
    },
    /// All steps to the goal at once (hybrid A*).
    HybridAStar {
        /// Side of a cell, m.
        cell: f64,
        /// First steps that are tried.
        starters: u32,
        /// Steps that are tried after each.
        successors: u32,
    },
    /// Straight along the shortest path over the cells of a grid, in even steps.
    GridAStar,
    /// As `HybridAStar` in the paper: straight distances, end points, cells alone.
    AsPublished,
}

impl Default for SearchRule {
    fn default() -> Self {
        Self::Guided { candidates: 24 }
    }
}

/// A distribution of statures, m, cut to those of people unless it is cut already.
pub fn stature(law: Law) -> Law {
    match law {
        Law::Random { family, low: f64::NEG_INFINITY, high: f64::INFINITY } => {
            Law::Random { family, low: 1.0, high: 2.5 }
        }
        other => other,
    }
}

/// The law of a parameter that a stepped kind leaves open: stature and free speed of adults (Weidmann 1993), and a body.
pub fn stepped_default(parameter: Parameter) -> Option<Law> {
    let normal = |mean: f64, sd: f64, low: f64, high: f64| {
        Some(Law::Random { family: Family::Normal { mean, sd }, low, high })
    };
    match parameter {
        Parameter::Radius => Some(Law::Constant(0.25)),
        Parameter::Mass => Some(Law::Constant(80.0)),
        Parameter::Height => normal(1.72, 0.09, 1.3, 2.2),
        Parameter::Speed => normal(1.34, 0.26, 0.5, 2.2),
        _ => None,
    }
}
