//! What the eight slots of a block are, and where an agent of a trial is kept.

use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};

/// What the eight slots of a block are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// One agent in eight trials: block `agent`, slot `lane`.
    Trials,
    /// Eight agents of one trial: block `agent / 8`, slot `agent % 8`; only lane 0 is in use.
    Agents,
}

/// Where an agent of a trial is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Block.
    pub block: usize,
    /// Place in the block.
    pub lane: usize,
}

impl Slot {
    /// The number of a field here.
    #[inline(always)]
    pub fn of(self, field: &[Lanes]) -> f64 {
        field[self.block].0[self.lane]
    }

    /// The vector of two fields here.
    #[inline(always)]
    pub fn vector(self, x: &[Lanes], y: &[Lanes]) -> Vec2 {
        Vec2::new(self.of(x), self.of(y))
    }
}

impl Layout {
    /// The lane of the trial that a slot of this lane belongs to.
    #[inline(always)]
    pub fn trial_of(self, lane: usize) -> usize {
        match self {
            Self::Trials => lane,
            Self::Agents => 0,
        }
    }

    /// The agent in a slot.
    #[inline(always)]
    pub fn agent_of(self, Slot { block, lane }: Slot) -> usize {
        match self {
            Self::Trials => block,
            Self::Agents => block * LANES + lane,
        }
    }

    /// The slots of a block that belong to the trials of some lanes.
    #[inline(always)]
    pub fn slots_of(self, lanes: Mask) -> Mask {
        match self {
            Self::Trials => lanes,
            Self::Agents if lanes.has(0) => Mask::ALL,
            Self::Agents => Mask::NONE,
        }
    }

    /// Number of blocks that so many agents need.
    pub(super) fn blocks(self, agents: usize) -> usize {
        match self {
            Self::Trials => agents,
            Self::Agents => agents.div_ceil(LANES),
        }
    }
}
