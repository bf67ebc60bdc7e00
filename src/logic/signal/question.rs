//! What a monitor in continuous time is asked, made ready.

use super::cells::Cells;
use super::direct::Direct;
use crate::base::instant::Instant;

/// How the question is answered.
#[derive(Clone, Debug)]
pub(super) enum Way {
    Direct(Direct),
    Cells(Box<Cells>),
}

/// An implication `a => b` whose left side is one of the present state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    /// Where the left side is in the code of the present state.
    pub(super) slot: usize,
    /// The first time at which it is asked about.
    pub(super) first: Instant,
    /// The last one.
    pub(super) last: Instant,
}
