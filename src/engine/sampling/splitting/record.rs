//! A run of splitting as a unit of work: a function of the model, the seed and these numbers, so it can be made anywhere.

use crate::stats::Invalid;
use crate::stats::splitting::{Adaptive, Effort, Rule, Scheme};
use serde::{Deserialize, Serialize};

/// A run of splitting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SplitRun {
    /// Number of the world.
    pub world: usize,
    /// Column of the formula, and of the robustness that is its level.
    pub columns: [usize; 2],
    /// The rule of its query.
    pub rule: Rule,
    /// Number of the run, from 1; the one after the last finds levels for the others.
    pub branch: u16,
    /// Whether lost paths are read as reaching the event.
    pub lost_reaches: bool,
    /// Levels that are known beforehand.
    pub levels: Vec<f64>,
}

/// What a run came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Its paths.
    pub paths: u64,
    /// Steps of them.
    pub steps: u64,
    /// Paths that diverged.
    pub lost: u64,
    /// Its estimate.
    pub estimate: f64,
    /// Its levels.
    pub levels: Vec<f64>,
}

impl SplitRun {
    /// How it finds and uses its levels.
    pub(super) fn scheme(&self, seed: u64) -> Result<Box<dyn Scheme>, Invalid> {
        let (rule, replicas) = (self.rule, self.rule.replicas as usize);
        Ok(if rule.adaptive {
            Box::new(Adaptive::new(replicas, rule.kill as usize, seed, self.branch)?)
        } else if u64::from(self.branch) > rule.runs {
            // A pilot run finds the levels; its own estimate is not used.
            Box::new(Adaptive::new(replicas, (3 * replicas / 4).max(1), seed, self.branch)?)
        } else {
            Box::new(Effort::new(replicas, self.levels.clone(), seed, self.branch)?)
        })
    }
}
