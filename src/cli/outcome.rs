//! Exit codes.

/// How a call ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exit {
    /// Every check is satisfied, or there was none.
    Fine,
    /// A check is violated.
    Violated,
    /// The call, an input or the model is wrong.
    Wrong,
    /// A check is undecided, and none violated.
    Undecided,
    /// Interrupted.
    Interrupted,
    /// A bug.
    Bug,
}

impl Exit {
    /// The number that the shell sees.
    pub(super) const fn code(self) -> u8 {
        match self {
            Self::Fine => 0,
            Self::Violated => 1,
            Self::Wrong => 2,
            Self::Undecided => 3,
            Self::Interrupted => 130,
            Self::Bug => 70,
        }
    }

    /// The graver of two: 70 > 2 > 130 > 1 > 3 > 0.
    pub(super) fn or(self, other: Self) -> Self {
        let weight = |exit: Self| match exit {
            Self::Fine => 0,
            Self::Undecided => 1,
            Self::Violated => 2,
            Self::Interrupted => 3,
            Self::Wrong => 4,
            Self::Bug => 5,
        };
        if weight(other) > weight(self) { other } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_graver_code_wins() {
        let order = [Exit::Fine, Exit::Undecided, Exit::Violated, Exit::Interrupted, Exit::Wrong, Exit::Bug];
        for (k, a) in order.iter().enumerate() {
            for (l, b) in order.iter().enumerate() {
                assert_eq!(a.or(*b), order[k.max(l)]);
            }
        }
    }
}
