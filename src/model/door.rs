//! Doors that open and close during a trial.

use super::expression::Bool;
use super::law::Law;
use std::sync::OnceLock;

/// Most doors of a scene that may change.
pub const MOST_DOORS: usize = 6;

/// A door that opens and closes during a trial. It is an opening in its wall; while it is closed, the barrier that the scene
/// has for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Door {
    /// Stable number; addresses its draws.
    pub entity: u32,
    /// When it is closed.
    pub shut: Shut,
}

/// When a door is closed.
#[derive(Clone, Debug, PartialEq)]
pub enum Shut {
    /// While a condition holds.
    While(Bool),
    /// From a time on, and open from another time on; `None`: never. Before the first of them it is what it is not then.
    Times {
        /// When it opens, s.
        opens: Option<Law>,
        /// When it closes, s.
        closes: Option<Law>,
    },
}

/// What depends on which doors are closed: made for each set of them when it is first needed. Bit k of a set is the k-th door.
#[derive(Clone, Debug)]
pub struct ByDoors<T>(Vec<OnceLock<T>>);

impl<T> ByDoors<T> {
    /// For so many doors.
    pub fn new(doors: usize) -> Self {
        Self((0..1_usize << doors.min(MOST_DOORS)).map(|_| OnceLock::new()).collect())
    }

    /// What belongs to a set of closed doors; `make` makes it.
    #[inline]
    pub fn of(&self, closed: u32, make: impl FnOnce() -> T) -> &T {
        self.0[closed as usize].get_or_init(make)
    }
}
