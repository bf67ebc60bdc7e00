//! The clocks of processes with rates and delays, as part of the state of a batch of trials.

use crate::base::lanes::{LANES, Lanes, Mask};

/// When everything that waits will happen.
///
/// Each process has one clock for all its commands with rates and one for each command with a delay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clocks {
    /// When each clock rings, s; infinite where it does not run.
    pub(super) due: Vec<Lanes>,
    /// Of a race: its rate, 1/s.
    pub(super) rate: Vec<Lanes>,
    /// Of a race: what was left of its exponential number when the rate last changed.
    pub(super) fuel: Vec<Lanes>,
    /// The number in (0, 1) that decides what happens.
    pub(super) pick: Vec<Lanes>,
    /// Of each process: races begun so far.
    pub(super) races: Vec<[u32; LANES]>,
    /// Of each process: delays drawn so far.
    pub(super) delays: Vec<[u32; LANES]>,
    /// Of each process that is a table: its present row.
    pub(super) rows: Vec<[u32; LANES]>,
    /// Time of the last jump, s.
    pub now: [f64; LANES],
    /// Jumps since the start of the trial.
    pub jumps: [u64; LANES],
    /// How many of the last jumps were at the present time.
    pub(super) crowd: [u32; LANES],
    /// Lanes in which more happened between two steps than is followed.
    pub jammed: Mask,
    /// Of these the process that jumps most.
    pub(super) jammer: [usize; LANES],
    /// Lanes whose clocks have not been set yet.
    pub(super) fresh: Mask,
}

impl Clocks {
    /// A trial begins in a lane.
    pub(super) fn load(&mut self, clocks: usize, processes: usize, lane: usize) {
        for (list, value) in [
            (&mut self.due, f64::INFINITY),
            (&mut self.rate, 0.0),
            (&mut self.fuel, 0.0),
            (&mut self.pick, 0.0),
        ] {
            list.resize(clocks, Lanes::ZERO);
            for lanes in list {
                lanes.0[lane] = value;
            }
        }
        for list in [&mut self.races, &mut self.delays, &mut self.rows] {
            list.resize(processes, [0; LANES]);
            for lanes in list {
                lanes[lane] = 0;
            }
        }
        self.now[lane] = 0.0;
        self.jumps[lane] = 0;
        self.crowd[lane] = 0;
        self.jammed &= !Mask::lane(lane);
        self.fresh |= Mask::lane(lane);
    }

    /// How often each process has begun to wait, lane by lane.
    pub(super) fn waits(&self) -> Vec<[u64; LANES]> {
        let both = self.races.iter().zip(&self.delays);
        let sum = |races: &[u32; LANES], delays: &[u32; LANES]| {
            std::array::from_fn(|lane| u64::from(races[lane]) + u64::from(delays[lane]))
        };
        both.map(|(races, delays)| sum(races, delays)).collect()
    }

    /// Remembers for some lanes which process has waited most often since.
    pub(super) fn blame(&mut self, before: &[[u64; LANES]], lanes: Mask) {
        let now = self.waits();
        for lane in lanes.iter() {
            let more = |k: &usize| (now[*k][lane] - before[*k][lane], std::cmp::Reverse(*k));
            self.jammer[lane] = (0..now.len()).max_by_key(more).unwrap_or(0);
        }
    }

    /// The clock that rings first in each lane, and when.
    #[inline(always)]
    pub(super) fn first(&self) -> ([usize; LANES], [f64; LANES]) {
        let (mut which, mut when) = ([0; LANES], [f64::INFINITY; LANES]);
        for (k, due) in self.due.iter().enumerate() {
            for lane in 0..LANES {
                let sooner = due.0[lane] < when[lane];
                which[lane] = if sooner { k } else { which[lane] };
                when[lane] = if sooner { due.0[lane] } else { when[lane] };
            }
        }
        (which, when)
    }
}
