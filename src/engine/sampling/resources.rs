//! What sampling runs with.

use crate::engine::sampling::watch::Watch;
use crate::engine::trials::executor::Executor;
use crate::stats::Levels;
use crate::trials::budget::Budget;
use std::cell::RefCell;

/// What runs the trials of a turn, and for how long.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Resources<'a> {
    pub(in crate::engine) executor: &'a dyn Executor,
    /// The levels that were proven so far.
    pub(in crate::engine) levels: &'a RefCell<Levels>,
    /// The budget of the call.
    pub(in crate::engine) budget: &'a Budget,
    /// The share of the time.
    pub(in crate::engine) share: &'a Budget,
    pub(in crate::engine) watch: &'a dyn Watch,
}
