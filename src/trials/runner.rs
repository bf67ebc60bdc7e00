//! A worker of the kind that the clock and the size of a scenario need.

use super::batch::Batch;
use super::budget::Budget;
use super::cell::{Block, Item, Series};
use super::chain::{JumpChain, StepChain};
use super::columns::{EventColumns, Finished, StepColumns};
use super::setup::Setup;
use crate::logic::Invalid;

/// Runs trials one after the other.
pub struct Runner<'s> {
    setup: &'s Setup,
    columns: Vec<usize>,
    kind: RunnerKind<'s>,
}

enum RunnerKind<'s> {
    /// From step to step.
    Steps(Box<Batch<'s, StepColumns>>),
    /// From jump to jump.
    Events(Box<Batch<'s, EventColumns>>),
    /// From step to step of a small chain.
    StepChain(Box<StepChain>),
    /// From jump to jump of a small chain.
    JumpChain(Box<JumpChain>),
}

impl<'s> Runner<'s> {
    /// A worker for some columns of a setup.
    pub fn new(setup: &'s Setup, columns: &[usize]) -> Result<Self, Invalid> {
        let kind = if let Some(chain) = StepChain::of(setup, columns) {
            RunnerKind::StepChain(Box::new(chain))
        } else if let Some(chain) = JumpChain::of(setup, columns) {
            RunnerKind::JumpChain(Box::new(chain))
        } else {
            return Self::general(setup, columns);
        };
        Ok(Self { setup, columns: columns.to_vec(), kind })
    }

    /// A worker that runs trials of every kind.
    pub fn general(setup: &'s Setup, columns: &[usize]) -> Result<Self, Invalid> {
        let program = &setup.program;
        let kind = if program.scenario.clock.is_jumps() {
            RunnerKind::Events(Box::new(Batch::new(program, EventColumns::new(setup, columns)?)))
        } else {
            RunnerKind::Steps(Box::new(Batch::new(program, StepColumns::new(setup, columns)?)))
        };
        Ok(Self { setup, columns: columns.to_vec(), kind })
    }

    /// So many threads of the pool of the calling one share each trial of a large crowd.
    pub fn share(&mut self, threads: usize) {
        if let RunnerKind::Steps(batch) = &mut self.kind {
            batch.share(threads);
        }
    }

    /// Whether it observes just these columns.
    pub fn serves(&self, columns: &[usize]) -> bool {
        self.columns == columns
    }

    /// Runs items until `next` gives no more, or the budget says stop; then unfinished trials are cut. One that
    /// takes blocks does nothing here.
    pub fn run(
        &mut self,
        series: impl Into<Series>,
        next: &mut dyn FnMut() -> Option<(usize, Item)>,
        budget: &Budget,
    ) -> Finished {
        let series = series.into();
        let mut next = || {
            let (place, item) = next()?;
            Some((place, item.address(series)))
        };
        match &mut self.kind {
            RunnerKind::Steps(batch) => {
                batch.run(&mut next, budget);
                batch.monitors.take()
            }
            RunnerKind::Events(batch) => {
                batch.run(&mut next, budget);
                batch.monitors.take()
            }
            RunnerKind::StepChain(_) | RunnerKind::JumpChain(_) => Finished::default(),
        }
    }

    /// Whether it takes trials in blocks.
    pub fn takes_blocks(&self) -> bool {
        matches!(self.kind, RunnerKind::StepChain(_) | RunnerKind::JumpChain(_))
    }

    /// Runs the trials of a block, if it takes blocks; the budget may say stop, then unfinished ones are dropped.
    pub fn run_block(&mut self, series: impl Into<Series>, block: &mut Block<'_>, budget: &Budget) {
        // Nobody moves in a chain: nobody is advised again and again.
        let Series { seed, .. } = series.into();
        match &mut self.kind {
            RunnerKind::StepChain(chain) => chain.run(self.setup, seed, block, budget),
            RunnerKind::JumpChain(chain) => chain.run(self.setup, seed, block, budget),
            RunnerKind::Steps(_) | RunnerKind::Events(_) => {}
        }
    }

    /// Steps or jumps made since this was asked last, of all lanes.
    pub fn take_steps(&mut self) -> u64 {
        std::mem::take(match &mut self.kind {
            RunnerKind::Steps(batch) => &mut batch.steps,
            RunnerKind::Events(batch) => &mut batch.steps,
            RunnerKind::StepChain(chain) => &mut chain.steps,
            RunnerKind::JumpChain(chain) => &mut chain.steps,
        })
    }
}
