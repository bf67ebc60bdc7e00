//! Small finite processes as one Markov chain: a row of numbers for each state.
//!
//! The variables of all processes together are the mixed-radix digits of one number, the state. For each process
//! and state it is known where the branches end in (0, 1], and by how much each branch moves that number. All
//! processes look at the old state and write variables of their own, so their moves add up. Numbers come from the
//! same addresses as elsewhere, and pass the same ends: a walk visits the states that the general path visits.

use super::space::{MOST_WAYS, NEVER, Space};
use super::{Form, Machine};
use crate::base::lanes::{LANES, Lanes};
use crate::model::Domain;
use fearless_simd::Level;
use std::collections::BTreeSet;

/// What a process does in each state.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// The part of the counter that names the process.
    pub(super) word: u64,
    /// Most branches in a state; each state has so many places.
    pub(super) most: usize,
    /// Whether chance decides, by state.
    pub(super) open: Vec<bool>,
    /// Where each branch ends in (0, 1], state by state.
    ends: Vec<f64>,
    /// The same ends but the last, where all states in which chance decides have them in common.
    pub(super) common: Option<Vec<f64>>,
    /// What each branch adds to the number of the state; without chance all do the same.
    pub(super) moves: Vec<i32>,
}

/// Processes as one chain.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Its states.
    pub space: Space,
    pub(super) steps: Vec<Steps>,
    /// Bit k of a state: whether chance decides in the k-th process; the last bit stands for all beyond.
    pub(super) open: Vec<u64>,
    /// All processes together, if that is a small table.
    pub(super) joint: Option<Joint>,
    pub(super) level: Level,
}

impl Chain {
    /// The chain of these processes, if they are tables and few states are reachable, none of them with an error.
    pub(super) fn of(machines: &[Machine], initial: &[f64], domains: &[Domain]) -> Option<Self> {
        let mut tables = Vec::new();
        let mut written = BTreeSet::new();
        for machine in machines {
            let Form::Table(table) = &machine.form else { return None };
            if !table.written().iter().all(|&variable| written.insert(variable)) {
                return None;
            }
            tables.push((machine.word, table));
        }
        let mut found: Vec<Vec<Vec<(f64, i32)>>> = vec![Vec::new(); tables.len()];
        let mut ways = 0;
        let space = Space::explore(initial, domains, |keys, state, values| {
            let mut targets = vec![state as i32];
            for (found, (_, table)) in found.iter_mut().zip(&tables) {
                found.resize(keys.rows() as usize, Vec::new());
                let by = |target: u32| target as i32 - state as i32;
                let branches = keys.targets(table, state, values)?;
                let branches: Vec<_> = branches.into_iter().map(|(end, target)| (end, by(target))).collect();
                targets = targets.iter().flat_map(|t| branches.iter().map(move |(_, by)| t + by)).collect();
                targets.sort_unstable();
                targets.dedup();
                ways += targets.len();
                if ways > MOST_WAYS {
                    return None;
                }
                found[state as usize] = branches;
            }
            Some(targets.into_iter().map(|target| target as u32).collect())
        })?;
        let states = space.states();
        let steps = found.iter().zip(&tables).map(|(found, (word, _))| Steps::of(*word, found));
        let steps: Vec<Steps> = steps.collect();
        let open = |state: usize| {
            steps
                .iter()
                .enumerate()
                .map(|(k, steps)| u64::from(steps.open[state]) << k.min(63))
                .fold(0, |a, b| a | b)
        };
        let open = (0..states).map(open).collect();
        let joint = Joint::of(&steps, states);
        Some(Self { space, steps, open, joint, level: Level::new() })
    }

    /// The same chain for the plainest vectors of the machine.
    pub(super) fn at_baseline(mut self) -> Self {
        self.level = Level::baseline();
        self
    }

    /// Whether a trial never leaves a state, and nothing is left to chance in it.
    pub fn is_still(&self, state: u32) -> bool {
        let state = state as usize;
        self.steps.iter().all(|steps| !steps.open[state] && steps.moves[state * steps.most] == 0)
    }
}

impl Steps {
    fn of(word: u32, found: &[Vec<(f64, i32)>]) -> Self {
        let most = found.iter().map(Vec::len).max().unwrap_or(1).max(1);
        let mut ends = vec![NEVER; found.len() * most];
        let mut moves = vec![0; found.len() * most];
        for (state, branches) in found.iter().enumerate() {
            if let [(_, by)] = branches[..] {
                moves[state * most..][..most].fill(by);
            }
            for (k, &(end, by)) in branches.iter().enumerate() {
                moves[state * most + k] = by;
                // The last branch takes all that is left.
                if k + 1 < branches.len() {
                    ends[state * most + k] = end;
                }
            }
        }
        let open: Vec<bool> = found.iter().map(|branches| branches.len() > 1).collect();
        let mut chances = ends.chunks(most).zip(&open).filter(|(_, open)| **open).map(|(ends, _)| ends);
        let first = chances.next().unwrap_or(&[NEVER]);
        let common = chances.all(|ends| ends == first).then(|| first[..first.len() - 1].to_vec());
        Self { word: u64::from(word), most, open, common, ends, moves }
    }

    /// Adds the moves of these branches.
    #[inline(always)]
    pub(super) fn take(&self, old: &[[u32; LANES]], next: &mut [[u32; LANES]], branches: &[[u64; LANES]]) {
        for ((old, next), branches) in old.iter().zip(next).zip(branches) {
            for lane in 0..LANES {
                let place = old[lane] as usize * self.most + branches[lane] as usize;
                next[lane] = next[lane].wrapping_add_signed(self.moves[place]);
            }
        }
    }

    /// Adds the moves that the numbers choose.
    #[inline(always)]
    pub(super) fn apply(
        &self,
        most: usize,
        old: &[[u32; LANES]],
        next: &mut [[u32; LANES]],
        numbers: &[Lanes],
    ) {
        for ((old, next), numbers) in old.iter().zip(next).zip(numbers) {
            for lane in 0..LANES {
                let first = old[lane] as usize * most;
                // Ends ascend, so the branch is the number of ends passed: no jump depends on chance.
                let ends = self.ends[first..first + most - 1].iter();
                let branch: usize = ends.map(|&end| usize::from(numbers.0[lane] >= end)).sum();
                next[lane] = next[lane].wrapping_add_signed(self.moves[first + branch]);
            }
        }
    }
}

// The processes of a chain as one table: for each state and each combination of branches the state that follows.
//
// Where each process takes its branches with the same probabilities in all states, the numbers of all processes can be
// drawn before anybody looks at a state, and one look at the table replaces one for each process.

/// Most entries, so that the table stays near the core.
const MOST_ENTRIES: usize = 1 << 14;

/// The table.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    /// What one more of a branch adds to the number of a combination, process by process.
    pub(super) strides: Vec<u64>,
    /// Combinations of branches.
    width: usize,
    /// The state after each state and combination.
    next: Vec<u32>,
}

impl Joint {
    /// The table of these processes, if it is small and they all have their ends in common.
    fn of(steps: &[Steps], states: usize) -> Option<Self> {
        let mut strides = Vec::new();
        let mut width = 1usize;
        for process in steps {
            process.common.as_ref()?;
            strides.push(width as u64);
            width = width.checked_mul(process.most)?;
        }
        if width.checked_mul(states)? > MOST_ENTRIES {
            return None;
        }
        let entry = |state: usize, combination: usize| {
            let by = steps.iter().zip(&strides).map(|(process, &stride)| {
                let branch = combination / stride as usize % process.most;
                process.moves[state * process.most + branch]
            });
            // States out of reach have no moves, and stay where they are.
            by.fold(state as u32, u32::wrapping_add_signed)
        };
        let next = (0..states).flat_map(|state| (0..width).map(move |k| (state, k)));
        let next = next.map(|(state, k)| entry(state, k)).collect();
        Some(Self { strides, width, next })
    }

    /// The states that follow.
    #[inline(always)]
    pub(super) fn take(
        &self,
        old: &[[u32; LANES]],
        next: &mut [[u32; LANES]],
        combinations: &[[u64; LANES]],
    ) {
        for ((old, next), combinations) in old.iter().zip(next).zip(combinations) {
            for lane in 0..LANES {
                next[lane] = self.next[old[lane] as usize * self.width + combinations[lane] as usize];
            }
        }
    }
}
