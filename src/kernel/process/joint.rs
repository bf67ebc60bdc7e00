//! The processes of a chain as one table: for each state and each combination of branches the state that follows.
//!
//! Where each process takes its branches with the same probabilities in all states, the numbers of all processes can be
//! drawn before anybody looks at a state, and one look at the table replaces one for each process.

use super::chain::Steps;
use crate::base::lanes::LANES;

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
    pub(super) fn of(steps: &[Steps], states: usize) -> Option<Self> {
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
