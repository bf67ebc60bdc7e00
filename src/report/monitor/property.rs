//! One property over all instants of a recording.

use super::{InstantVerdict, MonitoredInstant};
use crate::stats::bootstrap::{Bootstrap, DRAWS, Estimate, ratio};
use std::collections::BTreeMap;

/// How often a property was satisfied.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitoredProperty {
    /// Its name.
    pub name: String,
    /// Number of instants at which it is satisfied.
    pub satisfied: u64,
    /// Number of instants at which it is violated.
    pub violated: u64,
    /// Number of instants at which it is unresolved.
    pub unresolved: u64,
    /// The reasons of unresolved instants, with their numbers.
    pub reasons: BTreeMap<&'static str, u64>,
    /// Number of persons with an instant.
    pub persons: u64,
    /// Share of satisfied among resolved instants, with an interval over persons; `None` if no instant is resolved.
    pub share: Option<Estimate>,
}

impl MonitoredProperty {
    /// The summary of property number `index`.
    pub fn of(name: &str, index: usize, instants: &[MonitoredInstant], confidence: f64) -> Self {
        let mut parts = BTreeMap::<u32, [f64; 2]>::new();
        let mut reasons = BTreeMap::new();
        let (mut satisfied, mut violated, mut unresolved) = (0, 0, 0);
        for instant in instants {
            let [yes, resolved] = parts.entry(instant.person).or_default();
            match instant.verdicts.get(index) {
                Some(InstantVerdict::True) => {
                    satisfied += 1;
                    *yes += 1.0;
                    *resolved += 1.0;
                }
                Some(InstantVerdict::False) => {
                    violated += 1;
                    *resolved += 1.0;
                }
                Some(InstantVerdict::Unresolved(reason)) => {
                    unresolved += 1;
                    *reasons.entry(*reason).or_default() += 1;
                }
                None => {}
            }
        }
        let parts: Vec<[f64; 2]> = parts.into_values().collect();
        let bootstrap = Bootstrap { persons: parts.len(), draws: DRAWS, seed: 0, confidence };
        let share = bootstrap.estimate(ratio(&parts));
        let (name, persons) = (name.to_owned(), parts.len() as u64);
        Self { name, satisfied, violated, unresolved, reasons, persons, share }
    }

    /// Number of instants.
    pub const fn instants(&self) -> u64 {
        self.satisfied + self.violated + self.unresolved
    }
}
