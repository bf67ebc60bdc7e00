//! A worker of the kind that the clock and the size of a scenario need.

use super::batch::Batch;
use super::budget::Budget;
use super::cell::{Block, Item};
use super::chain::{JumpChain, StepChain};
use super::columns::{EventColumns, Finished, StepColumns};
use super::subject::Subject;
use crate::logic::Invalid;

/// Runs trials one after the other.
pub(super) struct Runner<'s> {
    subject: &'s Subject,
    columns: Vec<usize>,
    kind: Kind<'s>,
}

enum Kind<'s> {
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
    /// A worker for some columns of a subject.
    pub(super) fn new(subject: &'s Subject, columns: &[usize]) -> Result<Self, Invalid> {
        let kind = if let Some(chain) = StepChain::of(subject, columns) {
            Kind::StepChain(Box::new(chain))
        } else if let Some(chain) = JumpChain::of(subject, columns) {
            Kind::JumpChain(Box::new(chain))
        } else {
            return Self::general(subject, columns);
        };
        Ok(Self { subject, columns: columns.to_vec(), kind })
    }

    /// A worker that runs trials of every kind.
    pub(super) fn general(subject: &'s Subject, columns: &[usize]) -> Result<Self, Invalid> {
        let program = &subject.program;
        let kind = if program.scenario.clock.is_jumps() {
            Kind::Events(Box::new(Batch::new(program, EventColumns::new(subject, columns)?)))
        } else {
            Kind::Steps(Box::new(Batch::new(program, StepColumns::new(subject, columns)?)))
        };
        Ok(Self { subject, columns: columns.to_vec(), kind })
    }

    /// Whether it observes just these columns.
    pub(super) fn serves(&self, columns: &[usize]) -> bool {
        self.columns == columns
    }

    /// Runs items until `next` gives no more, or the budget says stop; then unfinished trials are cut. One that
    /// takes blocks does nothing here.
    pub(super) fn run(
        &mut self,
        seed: u64,
        next: &mut dyn FnMut() -> Option<(usize, Item)>,
        budget: &Budget,
    ) -> Finished {
        let mut next = || {
            let (place, item) = next()?;
            Some((place, item.address(seed)))
        };
        match &mut self.kind {
            Kind::Steps(batch) => {
                batch.run(&mut next, budget);
                batch.monitors.take()
            }
            Kind::Events(batch) => {
                batch.run(&mut next, budget);
                batch.monitors.take()
            }
            Kind::StepChain(_) | Kind::JumpChain(_) => Finished::default(),
        }
    }

    /// Whether it takes trials in blocks.
    pub(super) fn takes_blocks(&self) -> bool {
        matches!(self.kind, Kind::StepChain(_) | Kind::JumpChain(_))
    }

    /// Runs the trials of a block, if it takes blocks; the budget may say stop, then unfinished ones are dropped.
    pub(super) fn run_block(&mut self, seed: u64, block: &mut Block<'_>, budget: &Budget) {
        match &mut self.kind {
            Kind::StepChain(chain) => chain.run(self.subject, seed, block, budget),
            Kind::JumpChain(chain) => chain.run(self.subject, seed, block, budget),
            Kind::Steps(_) | Kind::Events(_) => {}
        }
    }

    /// Steps or jumps made since this was asked last, of all lanes.
    pub(super) fn take_steps(&mut self) -> u64 {
        std::mem::take(match &mut self.kind {
            Kind::Steps(batch) => &mut batch.steps,
            Kind::Events(batch) => &mut batch.steps,
            Kind::StepChain(chain) => &mut chain.steps,
            Kind::JumpChain(chain) => &mut chain.steps,
        })
    }
}
