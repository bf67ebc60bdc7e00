//! Shards: units of work that any machine can do, the files in which their outcomes come back, and an executor that answers
//! from these files.
//!
//! A trial is a pure function of model, seed and index, and so is a run of splitting. A plan deals units out to shards; the
//! outcomes of a shard are a part. Whoever has the parts runs the ordinary session over them: it reads outcomes in the order
//! of their indices, and requests what is not there, which makes the plan of the next round. Nothing here knows of files or
//! processes.

mod part;
mod plan;
mod recorder;
mod shard;
mod stored;
mod table;
mod unit;

pub use part::{Body, Damaged, Head, Part};
pub use plan::{Attempts, Plan};
pub use recorder::Recorder;
pub use shard::run;
pub use stored::Stored;
pub use table::Table;
pub use unit::{Trials, Unit};

pub use super::splitting::{RunRecord, SplitRun};

use crate::base::fingerprint::Fingerprint;
use crate::compile::Study;
use serde::{Deserialize, Serialize};

/// Worlds that the fingerprint of a study is made from, at most.
const PRINTED: usize = 32;

/// What outcomes are of: those of another origin are not comparable.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Version of the program.
    pub version: String,
    /// Fingerprint of what was compiled.
    pub print: String,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Origin {
    /// Of trials of a study. Of many worlds some stand for all.
    pub fn of(study: &Study, seed: u64) -> Self {
        let mut print = Fingerprint::default();
        let every = study.worlds.len().div_ceil(PRINTED).max(1);
        for world in study.worlds.iter().step_by(every) {
            let (tree, columns) = (&world.tree, &world.columns);
            let text = format!("{:?}{:?}{:?}{tree:?}{columns:?}", world.scenario, world.atoms, world.signals);
            print.add(text.as_bytes());
        }
        let print = format!("{} worlds, {print}", study.worlds.len());
        Self { version: env!("CARGO_PKG_VERSION").to_owned(), print, seed }
    }

    /// How another origin differs from this one, in words.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.version != other.version {
            Some(format!("version {} of smc instead of {}", other.version, self.version))
        } else if self.print != other.print {
            Some("another model, or other properties or settings".to_owned())
        } else {
            (self.seed != other.seed).then(|| format!("seed {} instead of {}", other.seed, self.seed))
        }
    }
}
