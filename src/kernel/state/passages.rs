//! Who has crossed which line and when, and how long everybody has been in which region: what the past of a trial is to
//! formulas. Only what some formula asks for is kept.

use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::layout::Slot;
use crate::model::{LineId, RegionId, Scene};

/// The crossings of lines and the times in regions of a batch of trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Passages {
    /// By line.
    crossings: Vec<Crossings>,
    /// By region: of each slot, the steps that began in it. Empty where no formula asks for them.
    stays: Vec<Vec<Lanes>>,
}

/// The crossings of a line. Empty where no formula counts them.
#[derive(Clone, Debug, Default, PartialEq)]
struct Crossings {
    /// The slots whose agents have crossed.
    who: Vec<Mask>,
    /// Trial by trial the ticks at which somebody crossed for the first time, ascending.
    when: [Vec<u64>; LANES],
}

impl Passages {
    /// A trial begins in a lane of a batch of so many blocks, and has these slots of each.
    pub(in crate::kernel) fn load(&mut self, scene: &Scene, blocks: usize, (lane, slots): (usize, Mask)) {
        if scene.counted.is_empty() && scene.timed.is_empty() {
            return;
        }
        self.crossings.resize_with(scene.lines.len(), Crossings::default);
        self.stays.resize_with(scene.regions.len(), Vec::new);
        for id in &scene.counted {
            let crossings = &mut self.crossings[id.0 as usize];
            crossings.who.resize(blocks, Mask::NONE);
            crossings.who.iter_mut().for_each(|who| *who &= !slots);
            crossings.when[lane].clear();
        }
        for id in &scene.timed {
            let stays = &mut self.stays[id.0 as usize];
            stays.resize(blocks, Lanes::ZERO);
            for stays in stays {
                slots.iter().for_each(|lane| stays.0[lane] = 0.0);
            }
        }
    }

    /// Another agent has a slot.
    pub(in crate::kernel) fn begin(&mut self, slot: Slot) {
        for who in self.crossings.iter_mut().filter_map(|crossings| crossings.who.get_mut(slot.block)) {
            *who &= !Mask::lane(slot.lane);
        }
        for stays in self.stays.iter_mut().filter_map(|stays| stays.get_mut(slot.block)) {
            stays.0[slot.lane] = 0.0;
        }
    }

    /// The slots of a block whose agents have not crossed a line yet.
    pub(in crate::kernel) fn not_across(&self, line: LineId, block: usize) -> Mask {
        !self.crossings[line.0 as usize].who[block]
    }

    /// The agent of a slot crosses a line at a tick of the trial in a lane.
    pub(in crate::kernel) fn cross(&mut self, line: LineId, slot: Slot, (lane, tick): (usize, u64)) {
        let crossings = &mut self.crossings[line.0 as usize];
        crossings.who[slot.block] |= Mask::lane(slot.lane);
        crossings.when[lane].push(tick);
    }

    /// Some slots of a block have begun a step in a region.
    pub(in crate::kernel) fn stay(&mut self, region: RegionId, block: usize, slots: Mask) {
        for lane in slots.iter() {
            self.stays[region.0 as usize][block].0[lane] += 1.0;
        }
    }

    /// How many agents have crossed a line in the trial in a lane: all, or those of the last ticks up to now.
    pub fn count(&self, line: u32, lane: usize, last: Option<(u64, u64)>) -> usize {
        let Some(crossings) = self.crossings.get(line as usize) else { return 0 };
        let when = &crossings.when[lane];
        let before = last.map_or(0, |(now, ticks)| {
            // Nobody crosses at tick 0.
            when.partition_point(|&tick| tick <= now.saturating_sub(ticks))
        });
        when.len() - before
    }

    /// The steps that began in a region, of all slots; none where they are not counted.
    pub fn stays(&self, region: RegionId) -> Option<&[Lanes]> {
        self.stays.get(region.0 as usize).map(Vec::as_slice).filter(|stays| !stays.is_empty())
    }
}
