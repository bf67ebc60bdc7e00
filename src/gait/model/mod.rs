//! Gait learned from recorded steps (Agethen, Gaisbauer, Manns, Link, Rukzio 2018, sections 3.4 and 4.1, and what the method lacks
//! as printed: a noise term, the duration, first steps of their own, correlated residuals and differences between people).
//!
//! A step is a row of eleven numbers (`columns`). Rows of each foot are centered, scaled and projected on components
//! (`basis`) after the offset of their subject was taken off (`people`). A first step is drawn from a kernel density (`density`), each
//! other one from a Gaussian process on the step before it (`likelihood`, `process`, `transition`) plus a residual
//! (`nearest`). `fit` puts them together, `person` draws, `file` writes and reads, `score` compares with steps
//! that were held out.

mod basis;
mod columns;
mod density;
mod factor;
mod file;
mod fit;
mod likelihood;
#[cfg(test)]
mod made;
mod nearest;
mod options;
mod people;
mod person;
mod process;
mod sample;
mod score;
mod summary;
mod transition;

pub use file::{FIT_AGAIN, FORMAT, FileError, VERSION};
pub use fit::fit;
pub use options::{FitError, Method, Options, Residuals, Warning};
pub use person::Person;
pub use score::{Coverage, Scores, folds, score};
pub use summary::{FootSummary, Shares, Summary};

use super::Foot;
use basis::Basis;
use columns::{COLUMNS, Columns};
use density::Density;
use nearest::Pairs;
use people::People;
use serde::{Deserialize, Serialize};
use transition::Transition;

/// What was learned of one foot.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Side {
    /// Components of its steps.
    basis: Basis,
    /// Its first steps.
    first: Density,
    /// From a step with this foot to the next one.
    transition: Transition,
    /// Residuals of the next steps, in scaled columns of the other foot.
    pairs: Pairs,
    /// Vectors whose sum with standard normal factors is a residual where the factor of the variances is `usual`.
    gaussian: Vec<Columns>,
    /// Mean factor of the variances.
    usual: f64,
}

/// A learned gait: what a `.gait` file has.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LearnedGait {
    /// Where its steps are from.
    pub source: String,
    /// What their license asks for.
    pub license: String,
    as_published: bool,
    residuals: Residuals,
    people: People,
    /// Left, right.
    sides: [Side; 2],
}

/// The largest number of a model: products of so large numbers stay finite.
const LARGEST: f64 = 1e12;

/// Whether a number can be a variance or a unit.
fn is_positive(value: f64) -> bool {
    (1e-15..=LARGEST).contains(&value)
}

impl LearnedGait {
    fn side(&self, foot: Foot) -> &Side {
        &self.sides[usize::from(foot == Foot::Right)]
    }

    /// Whether all lists fit together and all variances and units are positive, so that drawing and scoring cannot fail.
    fn fits(&self) -> bool {
        let components = self.sides.each_ref().map(|s| s.basis.components());
        let basis = |b: &Basis| {
            (1..=COLUMNS).contains(&b.components())
                && b.spread.len() == b.components()
                && b.spread.iter().copied().all(is_positive)
                && b.scale.iter().all(|s| *s == 0.0 || is_positive(*s))
        };
        let side = |s: &Side, here: usize, next: usize| {
            basis(&s.basis)
                && !s.first.steps.is_empty()
                && s.first.kernel.len() <= COLUMNS
                && s.transition.fits(here + 1, next)
                && !s.pairs.residuals.is_empty()
                && s.pairs.places.len() == s.pairs.residuals.len() * (here + 1)
                && s.gaussian.len() <= COLUMNS
                && is_positive(s.usual)
        };
        self.people.loadings.len() <= COLUMNS
            && self.people.within.iter().chain(&self.people.between).all(|v| *v >= 0.0)
            && side(&self.sides[0], components[0], components[1])
            && side(&self.sides[1], components[1], components[0])
    }
}
