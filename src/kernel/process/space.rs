//! The states of few variables with few values, numbered, and those of them that trials may visit.

use super::keys::Keys;
use super::table::Table;
use crate::base::lanes::Lanes;
use crate::model::{Domain, VariableId};
use std::collections::BTreeSet;

/// Most states, reachable or not.
const MOST_STATES: u64 = 1 << 14;
/// Most ways from state to state.
pub(super) const MOST_WAYS: usize = 1 << 17;
/// No number in (0, 1) passes it.
pub(super) const NEVER: f64 = 2.0;

/// The states of a chain. Values of variables are the mixed-radix digits of the number of a state.
#[derive(Clone, Debug)]
pub struct Space {
    keys: Keys,
    /// The first state, and after it all others that some trial may visit.
    reachable: Vec<u32>,
}

impl Space {
    /// The states that are reached from the initial values; none if there are too many, or `targets` says so. That yields
    /// the states that follow one whose values lie in lane 0 of the variables, and leaves these as they were.
    pub(super) fn explore(
        initial: &[f64],
        domains: &[Domain],
        mut targets: impl FnMut(&Keys, u32, &mut [Lanes]) -> Option<Vec<u32>>,
    ) -> Option<Self> {
        let all: BTreeSet<VariableId> = (0..domains.len() as u32).map(VariableId).collect();
        let keys = Keys::of(&all, domains, MOST_STATES)?;
        let mut values: Vec<Lanes> = initial.iter().map(|&value| Lanes::splat(value)).collect();
        let start = u32::try_from(keys.row(&values, 0)).ok()?;
        let mut seen = vec![false; keys.rows() as usize];
        *seen.get_mut(start as usize)? = true;
        let mut reachable = vec![start];
        let mut done = 0;
        while let Some(&state) = reachable.get(done) {
            done += 1;
            keys.put(u64::from(state), &mut values, 0);
            for target in targets(&keys, state, &mut values)? {
                if !std::mem::replace(seen.get_mut(target as usize)?, true) {
                    reachable.push(target);
                }
            }
        }
        Some(Self { keys, reachable })
    }

    /// Number of states, reachable or not: a state is a number below it.
    pub fn states(&self) -> usize {
        self.keys.rows() as usize
    }

    /// The state in which trials begin.
    pub fn initial(&self) -> u32 {
        self.reachable[0]
    }

    /// The states that some trial may visit.
    pub fn reachable(&self) -> &[u32] {
        &self.reachable
    }

    /// Puts the values of a state into a lane of all variables.
    pub fn values(&self, state: u32, variables: &mut [Lanes], lane: usize) {
        self.keys.put(u64::from(state), variables, lane);
    }
}

impl Keys {
    /// Where a process leads to from a state whose values lie in lane 0: where the share of each way ends in (0, 1], and the
    /// state; none if there is an error among the ways.
    pub(super) fn targets(&self, table: &Table, state: u32, values: &mut [Lanes]) -> Option<Vec<(f64, u32)>> {
        let mut found = Vec::new();
        for (end, new) in table.outcomes(table.keys.row(values, 0))? {
            for (variable, value) in new {
                values[variable as usize].0[0] = value;
            }
            found.push((end, u32::try_from(self.row(values, 0)).ok()?));
            self.put(u64::from(state), values, 0);
        }
        Some(found)
    }
}
