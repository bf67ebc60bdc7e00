//! Batches of paths: they run the paths of a round, whichever thread and lane takes which.

use super::path::Path;
use super::paths::{Ended, PathResult, Paths};
use crate::engine::fault::Fault;
use crate::engine::trials::executor::Executor;
use crate::engine::trials::prepared::PreparedWorld;
use crate::kernel::Address;
use crate::trials::batch::Batch;
use crate::trials::budget::Budget;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Batches that are warm, for one formula of a prepared world.
pub(super) struct Batches<'s> {
    prepared: &'s PreparedWorld,
    /// Column of the formula, and of the robustness that is its level.
    columns: [usize; 2],
    warm: Mutex<Vec<Batch<'s, Paths<'s>>>>,
}

impl<'s> Batches<'s> {
    pub(super) const fn new(prepared: &'s PreparedWorld, columns: [usize; 2]) -> Self {
        Self { prepared, columns, warm: Mutex::new(Vec::new()) }
    }

    fn batch(&self) -> Result<Batch<'s, Paths<'s>>, Fault> {
        if let Some(warm) = self.warm.lock().ok().and_then(|mut list| list.pop()) {
            return Ok(warm);
        }
        Ok(Batch::new(&self.prepared.program, Paths::new(self.prepared, self.columns)?))
    }

    /// Runs all paths; `None` where the budget said stop first. Which thread and which lane runs a path leaves no trace.
    pub(super) fn run(
        &self,
        paths: &[Path],
        executor: &dyn Executor,
        budget: &Budget,
    ) -> Result<Option<Vec<PathResult>>, Fault> {
        let next = AtomicUsize::new(0);
        let broken = AtomicBool::new(false);
        let ended: Mutex<Ended> = Mutex::new(Vec::with_capacity(paths.len()));
        executor.everywhere(&|| {
            let mut take = || {
                if broken.load(Ordering::Relaxed) || budget.must_stop() {
                    return None;
                }
                let place = next.fetch_add(1, Ordering::Relaxed);
                let Path { first, changes } = paths.get(place)?;
                Some((place, Address { key: *first, advice: None, changes }))
            };
            let list = match self.batch() {
                Ok(mut batch) => {
                    batch.run(&mut take, budget);
                    let list = std::mem::take(&mut batch.monitors.ended);
                    if let Ok(mut warm) = self.warm.lock() {
                        warm.push(batch);
                    }
                    list
                }
                Err(fault) => vec![(0, Err(fault))],
            };
            if list.iter().any(|(_, path)| path.is_err()) {
                broken.store(true, Ordering::Relaxed);
            }
            if let Ok(mut ended) = ended.lock() {
                ended.extend(list);
            }
        });
        // Places are handed out in order, and each batch ends its paths: of several faults the first is reported, whichever
        // thread met it.
        let mut list = ended.into_inner().unwrap_or_default();
        list.sort_unstable_by_key(|(place, _)| *place);
        let found = list.into_iter().map(|(_, path)| path).collect::<Result<Vec<_>, Fault>>()?;
        Ok((found.len() == paths.len()).then_some(found))
    }
}
