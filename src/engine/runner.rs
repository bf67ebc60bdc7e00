//! A worker of whatever kind the clock of a scenario needs.

use super::budget::Budget;
use super::cell::{Block, Item};
use super::jumper::Jumper;
use super::leaper::Leaper;
use super::subject::Subject;
use super::walker::Walker;
use super::worker::{Finished, Worker};
use crate::logic::Invalid;

/// Runs trials one after the other.
pub(super) enum Runner {
    /// From step to step.
    Steps(Box<Worker>),
    /// From state to state of a small finite chain.
    Walks(Box<Walker>),
    /// From jump to jump.
    Jumps(Box<Jumper>),
    /// From jump to jump of one small process.
    Leaps(Box<Leaper>),
}

impl Runner {
    /// A worker for some columns of a subject.
    pub(super) fn new(subject: &Subject, columns: &[usize]) -> Result<Self, Invalid> {
        Ok(if subject.program.scenario.clock.is_jumps() {
            match Leaper::of(subject, columns) {
                Some(leaper) => Self::Leaps(Box::new(leaper)),
                None => Self::Jumps(Box::new(Jumper::new(subject, columns)?)),
            }
        } else if let Some(walker) = Walker::of(subject, columns) {
            Self::Walks(Box::new(walker))
        } else {
            Self::Steps(Box::new(Worker::new(subject, columns)?))
        })
    }

    /// Whether it observes just these columns.
    pub(super) fn serves(&self, columns: &[usize]) -> bool {
        match self {
            Self::Steps(worker) => worker.serves(columns),
            Self::Walks(walker) => walker.serves(columns),
            Self::Jumps(jumper) => jumper.serves(columns),
            Self::Leaps(leaper) => leaper.serves(columns),
        }
    }

    /// Runs items until `next` gives no more, or the budget says stop; then unfinished trials are dropped. One that
    /// takes blocks does nothing here.
    pub(super) fn run(
        &mut self,
        subject: &Subject,
        seed: u64,
        next: &mut dyn FnMut() -> Option<(usize, Item)>,
        budget: &Budget,
    ) -> Finished {
        match self {
            Self::Steps(worker) => worker.run(subject, seed, next, budget),
            Self::Walks(_) | Self::Leaps(_) => Finished::default(),
            Self::Jumps(jumper) => jumper.run(subject, seed, next, budget),
        }
    }

    /// Whether it takes trials in blocks.
    pub(super) fn takes_blocks(&self) -> bool {
        matches!(self, Self::Walks(_) | Self::Leaps(_))
    }

    /// Runs the trials of a block, if it takes blocks; the budget may say stop, then unfinished ones are dropped.
    pub(super) fn run_block(&mut self, subject: &Subject, seed: u64, block: &mut Block<'_>, budget: &Budget) {
        match self {
            Self::Walks(walker) => walker.run(subject, seed, block, budget),
            Self::Leaps(leaper) => leaper.run(subject, seed, block, budget),
            Self::Steps(_) | Self::Jumps(_) => {}
        }
    }

    /// Steps or jumps made since this was asked last, of all lanes.
    pub(super) fn take_steps(&mut self) -> u64 {
        std::mem::take(match self {
            Self::Steps(worker) => &mut worker.steps,
            Self::Walks(walker) => &mut walker.steps,
            Self::Jumps(jumper) => &mut jumper.steps,
            Self::Leaps(leaper) => &mut leaper.steps,
        })
    }
}
