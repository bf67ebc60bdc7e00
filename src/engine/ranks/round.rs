//! A round of trials that is leased out in pieces: what is still to be leased, and what has come back.

use crate::engine::cell::{Cell, Item};
use crate::engine::executor::{Cells, Job};
use std::ops::Range;
use std::sync::atomic::Ordering;

/// A round on its way.
pub(super) struct Round<'r, 's> {
    /// Number of the world.
    pub(super) world: usize,
    /// Prepared world and columns.
    pub(super) job: &'r Job<'s>,
    /// The trials.
    pub(super) items: &'r [Item],
    /// What they yielded.
    pub(super) cells: Cells,
    /// Trials that have not come back.
    pub(super) open: usize,
    /// The first trial that was never leased.
    next: usize,
    /// Leases that were lost.
    lost: Vec<Range<usize>>,
}

impl<'r, 's> Round<'r, 's> {
    /// A round of which nothing is leased yet.
    pub(super) fn new(world: usize, job: &'r Job<'s>, items: &'r [Item]) -> Self {
        let cells = job.cells(items.len(), false);
        Self { world, job, items, cells, open: items.len(), next: 0, lost: Vec::new() }
    }

    /// How many were never leased.
    pub(super) fn untouched(&self) -> usize {
        self.items.len() - self.next
    }

    /// The next trials to lease: those of a lease that was lost, else at most so many others. Says whether they were
    /// leased before.
    pub(super) fn take(&mut self, size: usize) -> Option<(Range<usize>, bool)> {
        while let Some(lost) = self.lost.pop() {
            if self.is_open(&lost) {
                return Some((lost, true));
            }
        }
        let from = self.next;
        self.next = from.saturating_add(size).min(self.items.len());
        (from < self.next).then_some((from..self.next, false))
    }

    /// Whether some of these trials have not come back.
    pub(super) fn is_open(&self, places: &Range<usize>) -> bool {
        places.clone().any(|place| self.cells.row(place).is_none())
    }

    /// A lease does not come back.
    pub(super) fn lose(&mut self, places: Range<usize>) {
        self.lost.push(places);
    }

    /// A lease came back: of each trial whether it was finished, and the cells of those that were. Trials that had come
    /// back before are as they were. False where that does not fit the lease; nothing is taken then.
    pub(super) fn receive(&mut self, places: &Range<usize>, finished: &[bool], cells: &[Cell]) -> bool {
        let width = self.job.columns.len();
        let count = finished.iter().filter(|finished| **finished).count();
        if finished.len() != places.len() || cells.len() != count * width {
            return false;
        }
        let back = places.clone().zip(finished).filter_map(|(place, finished)| finished.then_some(place));
        for (place, row) in back.zip(cells.chunks_exact(width.max(1))) {
            if self.cells.row(place).is_none() {
                self.open -= 1;
                self.cells.put(place, row);
            }
        }
        true
    }

    /// So many steps were made.
    pub(super) fn add_steps(&self, steps: u64) {
        self.job.steps.fetch_add(steps, Ordering::Relaxed);
    }

    /// The places that have not come back.
    pub(super) fn rest(&self) -> Vec<usize> {
        (0..self.items.len()).filter(|place| self.cells.row(*place).is_none()).collect()
    }
}
