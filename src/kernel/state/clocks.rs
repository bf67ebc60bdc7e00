//! The clocks of processes with rates and delays, as part of the state of a batch of trials.

use crate::base::instant::Instant;
use crate::base::lanes::{LANES, Lanes, Mask};

/// When everything that waits will happen.
///
/// Each process has one clock for all its commands with rates and one for each command with a delay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clocks {
    /// When each clock rings, s; infinite where it does not run.
    pub(in crate::kernel) due: Vec<Lanes>,
    /// What each is later than that, s: what rounding took off; 0 where `is_exact` is not.
    pub(in crate::kernel) rests: Vec<Lanes>,
    /// Of a race: its rate, 1/s.
    pub(in crate::kernel) rate: Vec<Lanes>,
    /// Of a race: what was left of its exponential number when the rate last changed.
    pub(in crate::kernel) fuel: Vec<Lanes>,
    /// The number in (0, 1) that decides what happens.
    pub(in crate::kernel) pick: Vec<Lanes>,
    /// Of each process: races begun so far.
    pub(in crate::kernel) races: Vec<[u32; LANES]>,
    /// Of each process: delays drawn so far.
    pub(in crate::kernel) delays: Vec<[u32; LANES]>,
    /// Of each process: jumps so far, modulo 2^32.
    pub(in crate::kernel) fired: Vec<[u32; LANES]>,
    /// Of each process that is a table: its present row.
    pub(in crate::kernel) rows: Vec<[u32; LANES]>,
    /// Time of the last jump, s.
    pub now: [f64; LANES],
    /// What it is later than that, s.
    rest: [f64; LANES],
    /// Whether sums of times are exact: in continuous time with delays.
    is_exact: bool,
    /// Jumps since the start of the trial.
    pub jumps: [u64; LANES],
    /// How many of the last jumps were at the present time.
    pub(in crate::kernel) crowd: [u32; LANES],
    /// Lanes in which more happened between two steps than is followed.
    pub jammed: Mask,
    /// Of these the process that jumped most often in that step.
    pub(in crate::kernel) jammer: [usize; LANES],
    /// Lanes whose clocks have not been set yet.
    pub(in crate::kernel) fresh: Mask,
}

impl Clocks {
    /// A trial begins in a lane.
    pub(in crate::kernel) fn load(&mut self, clocks: usize, processes: usize, is_exact: bool, lane: usize) {
        self.is_exact = is_exact;
        for (list, value) in [
            (&mut self.due, f64::INFINITY),
            (&mut self.rests, 0.0),
            (&mut self.rate, 0.0),
            (&mut self.fuel, 0.0),
            (&mut self.pick, 0.0),
        ] {
            list.resize(clocks, Lanes::ZERO);
            for lanes in list {
                lanes.0[lane] = value;
            }
        }
        for list in [&mut self.races, &mut self.delays, &mut self.fired, &mut self.rows] {
            list.resize(processes, [0; LANES]);
            for lanes in list {
                lanes[lane] = 0;
            }
        }
        (self.now[lane], self.rest[lane]) = (0.0, 0.0);
        self.jumps[lane] = 0;
        self.crowd[lane] = 0;
        self.jammed &= !Mask::lane(lane);
        self.fresh |= Mask::lane(lane);
    }

    /// Remembers for some lanes which process has jumped most often since.
    pub(in crate::kernel) fn blame(&mut self, since: &[[u32; LANES]], lanes: Mask) {
        for lane in lanes.iter() {
            let jumps =
                |k: usize| self.fired[k][lane].wrapping_sub(since.get(k).map_or(0, |fired| fired[lane]));
            let most = (0..self.fired.len()).max_by_key(|&k| (jumps(k), std::cmp::Reverse(k)));
            self.jammer[lane] = most.unwrap_or(0);
        }
    }

    /// The time of the last jump of a lane.
    pub fn instant(&self, lane: usize) -> Instant {
        let now = self.now[lane];
        if self.is_exact { Instant { seconds: now, rest: self.rest[lane] } } else { Instant::from(now) }
    }

    /// A clock rings: it is as late as it says.
    #[inline]
    pub(in crate::kernel) fn reach(&mut self, clock: usize, lane: usize) {
        self.now[lane] = self.due[clock].0[lane];
        self.rest[lane] = self.rests[clock].0[lane];
    }

    /// Sets a clock to a time that came by chance, not before the present.
    #[inline]
    pub(in crate::kernel) fn set(&mut self, clock: usize, lane: usize, due: f64) {
        self.due[clock].0[lane] = due;
        if self.is_exact {
            self.rests[clock].0[lane] = if due == self.now[lane] { self.rest[lane] } else { 0.0 };
        }
    }

    /// Sets a clock to a time after the present, exactly.
    #[inline]
    pub(in crate::kernel) fn set_after(&mut self, clock: usize, lane: usize, wait: Instant) {
        let now = Instant { seconds: self.now[lane], rest: self.rest[lane] };
        let due = now.after(wait);
        (self.due[clock].0[lane], self.rests[clock].0[lane]) = (due.seconds, due.rest);
    }

    /// The clock that rings first in each lane, and when.
    #[inline(always)]
    pub(in crate::kernel) fn first(&self) -> ([usize; LANES], [f64; LANES]) {
        let (mut which, mut when) = ([0; LANES], [f64::INFINITY; LANES]);
        for (k, due) in self.due.iter().enumerate() {
            for lane in 0..LANES {
                let sooner = due.0[lane] < when[lane];
                which[lane] = if sooner { k } else { which[lane] };
                when[lane] = if sooner { due.0[lane] } else { when[lane] };
            }
        }
        if self.is_exact {
            for lane in 0..LANES {
                // Of several that round alike the first by what rounding took off; of those at one time the first there is.
                let of = |k: usize| Instant { seconds: self.due[k].0[lane], rest: self.rests[k].0[lane] };
                let alike = (0..self.due.len()).filter(|k| self.due[*k].0[lane] == when[lane]);
                which[lane] =
                    alike.fold(which[lane], |first, k| if of(k).is_before(of(first)) { k } else { first });
            }
        }
        (which, when)
    }
}
