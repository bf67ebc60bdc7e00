//! Where everyone is on the way: kept in the state, one entry a slot.

use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::layout::Layout;

/// Where one agent of one trial is on its route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Index into the scenario's stages.
    pub(in crate::kernel) stage: u32,
    /// Tick at which a pause ends.
    pub(in crate::kernel) until: u64,
    /// Tick at which advice ends; 0 without any.
    pub(in crate::kernel) advised_until: u64,
    /// Driving direction under advice; zero for a stop.
    pub(in crate::kernel) advice: Vec2,
    /// Where the present leg began, m.
    pub(in crate::kernel) origin: Vec2,
    /// Direction of someone without a goal, and whether they move.
    pub(in crate::kernel) onward: (Vec2, bool),
    /// Which time a detour is taken; 0 on the own route. Addresses its pauses.
    pub(in crate::kernel) round: u32,
}

impl Default for Way {
    fn default() -> Self {
        let zero = Vec2::zeros();
        Self {
            stage: 0,
            until: 0,
            advised_until: 0,
            advice: zero,
            origin: zero,
            onward: (zero, false),
            round: 0,
        }
    }
}

/// Where a route is gone on with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::kernel) struct Halt {
    /// Index into the scenario's stages.
    pub(in crate::kernel) stage: u32,
    /// Ticks that are left of a pause which had begun.
    pub(in crate::kernel) left: Option<u64>,
}

impl Halt {
    /// Before a stage.
    pub(in crate::kernel) fn before(stage: u32) -> Self {
        Self { stage, left: None }
    }
}

/// The slots of a block that are on the same stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::kernel) struct Party {
    pub(in crate::kernel) stage: u32,
    pub(in crate::kernel) slots: Mask,
}

/// The ways of a batch of trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Routes {
    ways: Vec<[Way; LANES]>,
    /// Parties of each block, those in use first.
    parties: Vec<([Party; LANES], usize)>,
    /// Slots under advice.
    pub(in crate::kernel) advised: Vec<Mask>,
    /// Where the present leg began, in lanes, m.
    pub(in crate::kernel) from_x: Vec<Lanes>,
    /// Where the present leg began, second coordinate, m.
    pub(in crate::kernel) from_y: Vec<Lanes>,
}

impl Routes {
    /// Ways of so many blocks, all at their beginning.
    pub fn new(blocks: usize) -> Self {
        let mut parties = [Party::default(); LANES];
        parties[0].slots = Mask::ALL;
        Self {
            ways: vec![[Way::default(); LANES]; blocks],
            parties: vec![(parties, 1); blocks],
            advised: vec![Mask::NONE; blocks],
            from_x: vec![Lanes::ZERO; blocks],
            from_y: vec![Lanes::ZERO; blocks],
        }
    }

    /// The way of one slot.
    pub fn way(&self, block: usize, lane: usize) -> Way {
        self.ways[block][lane]
    }

    /// Puts a way into a slot; with [`Routes::way`] this saves and restores a trial.
    pub fn set_way(&mut self, block: usize, lane: usize, way: Way) {
        let moved = self.ways[block][lane].stage != way.stage;
        self.ways[block][lane] = way;
        self.from_x[block].0[lane] = way.origin.x;
        self.from_y[block].0[lane] = way.origin.y;
        let slot = Mask::lane(lane);
        let advised = if way.advised_until > 0 { slot } else { Mask::NONE };
        self.advised[block] = self.advised[block] & !slot | advised;
        if moved {
            self.gather(block);
        }
    }

    /// Collects the slots that are on the same stage, in order of their first slot.
    fn gather(&mut self, block: usize) {
        let (parties, count) = &mut self.parties[block];
        *count = 0;
        for (lane, way) in self.ways[block].iter().enumerate() {
            let known = parties[..*count].iter_mut().find(|party| party.stage == way.stage);
            if let Some(party) = known {
                party.slots |= Mask::lane(lane);
            } else {
                parties[*count] = Party { stage: way.stage, slots: Mask::lane(lane) };
                *count += 1;
            }
        }
    }

    /// How many parties a block has.
    #[inline(always)]
    pub(in crate::kernel) fn count(&self, block: usize) -> usize {
        self.parties[block].1
    }

    /// One party of a block.
    #[inline(always)]
    pub(in crate::kernel) fn party(&self, block: usize, number: usize) -> Party {
        self.parties[block].0[number]
    }

    /// Number of blocks.
    pub(in crate::kernel) fn blocks(&self) -> usize {
        self.ways.len()
    }

    /// The slots among these whose advice ends with the present tick.
    #[inline(always)]
    pub(in crate::kernel) fn advice_over(
        &self,
        block: usize,
        slots: Mask,
        now: (Layout, &[u64; LANES]),
    ) -> Mask {
        let advised = slots & self.advised[block];
        if advised.is_empty() { Mask::NONE } else { self.over(block, advised, now, |way| way.advised_until) }
    }

    /// The slots among these whose pause ends with the present tick.
    pub(in crate::kernel) fn pause_over(
        &self,
        block: usize,
        slots: Mask,
        now: (Layout, &[u64; LANES]),
    ) -> Mask {
        self.over(block, slots, now, |way| way.until)
    }

    fn over(
        &self,
        block: usize,
        slots: Mask,
        (layout, ticks): (Layout, &[u64; LANES]),
        end: impl Fn(&Way) -> u64,
    ) -> Mask {
        let ended = |&lane: &usize| ticks[layout.trial_of(lane)] >= end(&self.ways[block][lane]);
        slots.iter().filter(ended).fold(Mask::NONE, |mask, lane| mask | Mask::lane(lane))
    }
}
