//! The address of a path: under which key its random numbers are drawn, from which time on: a tick, or in continuous
//! time the bits of a number of seconds, which are never negative and so order alike.
//!
//! A trial is a pure function of its key, so that a path is continued from any of its states by running it
//! again up to there and changing the key: nothing has to be kept, and the state is the same to the last bit.

use crate::base::random::TrialKey;

/// The address of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Path {
    /// The key of its start.
    pub(super) first: TrialKey,
    /// Times and the keys in force after them, ascending.
    pub(super) changes: Vec<(u64, TrialKey)>,
}

impl Path {
    /// From the beginning.
    pub(super) const fn anew(key: TrialKey) -> Self {
        Self { first: key, changes: Vec::new() }
    }

    /// The same up to the state at `time`, with fresh random numbers afterwards.
    pub(super) fn branch(&self, time: u64, key: TrialKey) -> Self {
        let mut changes: Vec<_> = self.changes.iter().copied().filter(|(from, _)| *from < time).collect();
        changes.push((time, key));
        Self { first: self.first, changes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_branch_forgets_what_came_later() {
        let key = |index| TrialKey { seed: 0, index, branch: 1 };
        let child = Path::anew(key(0)).branch(10, key(1)).branch(20, key(2)).branch(10, key(3));
        assert_eq!(child, Path { first: key(0), changes: vec![(10, key(3))] });
        assert_eq!(Path::anew(key(0)).branch(0, key(1)).changes, [(0, key(1))]);
    }
}
