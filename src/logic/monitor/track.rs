//! What is known of one part of a formula at each of its last positions, for eight lanes.
//!
//! Lanes are trials that started at different steps of the batch. Rings are indexed by the batch's own
//! step count, so that one byte holds the same moment of eight trials and a window is the same stretch
//! of bytes for all of them.

use crate::base::lanes::{LANES, Lanes};

/// Positions that were settled in this step: how many steps back, and the lanes that turned true or
/// false (of a number: `t` holds the lanes in which it became known).
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    pub(super) back: u32,
    pub(super) t: u8,
    pub(super) f: u8,
}

/// Three-valued truths: true where `t`, false where `f`, open where neither. Both mark a lane whose trial
/// never had that position.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    t: Box<[u8]>,
    f: Box<[u8]>,
    need: Box<[u8]>,
    /// Settled in this step, needed positions only.
    pub(super) changes: Vec<Change>,
}

impl Track {
    /// A track of at least `states` positions. Nothing is allocated later: each entry of `changes`
    /// settles a lane of a position.
    pub(super) fn new(states: usize, with_changes: bool) -> Self {
        let size = states.next_power_of_two();
        let ring = |fill: u8| vec![fill; size].into_boxed_slice();
        let changes = Vec::with_capacity(if with_changes { size * LANES } else { 0 });
        Self { t: ring(0xff), f: ring(0xff), need: ring(0), changes }
    }

    #[inline(always)]
    fn slot(&self, at: u64) -> usize {
        at as usize & self.t.len().wrapping_sub(1)
    }

    /// Opens position `now` for the lanes that are not `void`.
    #[inline(always)]
    pub(super) fn begin(&mut self, now: u64, void: u8, need: u8) {
        let k = self.slot(now);
        self.t[k] = void;
        self.f[k] = void;
        self.need[k] = need;
        self.changes.clear();
    }

    /// Stores a truth that is known at once.
    #[inline(always)]
    pub(super) fn store(&mut self, now: u64, t: u8) {
        let k = self.slot(now);
        self.t[k] = t;
        self.f[k] = !t;
    }

    /// The lanes in which position `at` is still open.
    #[inline(always)]
    pub(super) fn open(&self, at: u64, now: u64) -> u8 {
        if now.wrapping_sub(at) >= self.t.len() as u64 {
            return 0;
        }
        let k = self.slot(at);
        !(self.t[k] | self.f[k])
    }

    /// True and false lanes of a position.
    #[inline(always)]
    pub(super) fn planes(&self, at: u64) -> (u8, u8) {
        let k = self.slot(at);
        (self.t[k], self.f[k])
    }

    /// Settles a position in lanes in which it is open.
    #[inline(always)]
    pub(super) fn settle(&mut self, at: u64, now: u64, t: u8, f: u8) {
        let k = self.slot(at);
        self.t[k] |= t;
        self.f[k] |= f;
        let (t, f) = (t & self.need[k], f & self.need[k]);
        if t | f != 0 {
            self.changes.push(Change { back: now.wrapping_sub(at) as u32, t, f });
        }
    }

    /// Brings the changes into ascending order of position.
    #[inline(always)]
    pub(super) fn ascend(&mut self) {
        if self.changes.len() > 1 {
            self.changes.sort_unstable_by_key(|change| std::cmp::Reverse(change.back));
        }
    }

    /// New trials start in these lanes: they never had the positions before.
    pub(super) fn void(&mut self, lanes: u8) {
        for k in 0..self.t.len() {
            self.t[k] |= lanes;
            self.f[k] |= lanes;
            self.need[k] &= !lanes;
        }
    }

    /// Whether there is a ring at all.
    #[inline(always)]
    pub(super) fn is_kept(&self) -> bool {
        !self.t.is_empty()
    }

    /// The lanes in which a position is needed.
    pub(super) fn needed(&self, at: u64) -> u8 {
        self.need[self.slot(at)]
    }

    /// Bytes on the heap.
    pub(super) fn bytes(&self) -> usize {
        3 * self.t.len() + self.changes.capacity() * size_of::<Change>()
    }
}

/// Numbers that are known or still open, beside a track whose true lanes are those where it is known.
#[derive(Clone, Debug, Default)]
pub(super) struct Numbers {
    values: Box<[Lanes]>,
}

impl Numbers {
    /// Numbers of at least `states` positions.
    pub(super) fn new(states: usize) -> Self {
        Self { values: vec![Lanes::ZERO; states.next_power_of_two()].into_boxed_slice() }
    }

    /// The number at a position.
    #[inline(always)]
    pub(super) fn at(&self, at: u64) -> Lanes {
        self.values[at as usize & self.values.len().wrapping_sub(1)]
    }

    /// Stores the number of some lanes.
    #[inline(always)]
    pub(super) fn store(&mut self, at: u64, lanes: u8, value: Lanes) {
        let k = at as usize & self.values.len().wrapping_sub(1);
        self.values[k] = select(lanes, value, self.values[k]);
    }

    /// Whether there is a ring at all.
    #[inline(always)]
    pub(super) fn is_kept(&self) -> bool {
        !self.values.is_empty()
    }

    /// Bytes on the heap.
    pub(super) fn bytes(&self) -> usize {
        self.values.len() * size_of::<Lanes>()
    }
}

/// The first number in the lanes of the set, the second in the others.
#[inline(always)]
pub(super) fn select(lanes: u8, yes: Lanes, no: Lanes) -> Lanes {
    let mut out = no;
    for k in 0..LANES {
        out.0[k] = if lanes >> k & 1 == 1 { yes.0[k] } else { no.0[k] };
    }
    out
}
