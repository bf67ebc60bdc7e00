//! Which doors are closed in each trial, and when they open and close.

use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::layout::Layout;

/// The doors that may change, of all trials of a batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClosedDoors {
    /// The closed ones in the trial of each lane: bit k is the k-th door.
    pub sets: [u32; LANES],
    /// From which tick on each is open, and closed, in the trial of each lane; infinite where never, or by a condition.
    pub times: Vec<[Lanes; 2]>,
}

impl ClosedDoors {
    /// The lanes in which a door is closed; all or none in one large crowd.
    #[inline(always)]
    pub(in crate::kernel) fn lanes(&self, door: usize, layout: Layout) -> Mask {
        let closed = |lane: usize| u8::from(self.sets[layout.trial_of(lane)] >> door & 1 == 1) << lane;
        Mask((0..LANES).fold(0, |bits, lane| bits | closed(lane)))
    }

    /// The different sets of closed doors with the lanes of each, and how many there are.
    #[inline(always)]
    pub(in crate::kernel) fn each(&self, layout: Layout) -> ([(u32, Mask); LANES], usize) {
        let mut out = [(0, Mask::ALL); LANES];
        if self.times.is_empty() {
            return (out, 1);
        }
        let mut count = 0;
        for lane in 0..LANES {
            let (set, here) = (self.sets[layout.trial_of(lane)], Mask::lane(lane));
            match out[..count].iter_mut().find(|(known, _)| *known == set) {
                Some((_, lanes)) => *lanes |= here,
                None => {
                    out[count] = (set, here);
                    count += 1;
                }
            }
        }
        (out, count)
    }
}
