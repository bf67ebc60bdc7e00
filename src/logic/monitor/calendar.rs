//! When cells begin and end: each lane's own positions against the batch's steps.

use super::cell::Cell;
use crate::base::lanes::{LANES, Mask};

/// What happens to a cell at a position of a trial, before the state there is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Turn {
    /// The first position it is asked about.
    Begin,
    /// The last one.
    Last,
    /// The one after the last.
    Past,
    /// Nothing can be open any more.
    End,
    /// The state at the horizon.
    Horizon,
}

/// The turns of a trial in order, and how far each lane has come.
#[derive(Clone, Debug)]
pub(super) struct Calendar {
    turns: Box<[(u64, Turn, usize)]>,
    next: [usize; LANES],
    /// The batch's step of each lane's first state.
    pub(super) starts: [u64; LANES],
    /// The batch's step of each lane's next turn.
    due: [u64; LANES],
    /// The earliest of them.
    earliest: u64,
}

impl Calendar {
    pub(super) fn new(mut turns: Vec<(u64, Turn, usize)>) -> Self {
        turns.sort_unstable();
        Self {
            turns: turns.into_boxed_slice(),
            next: [0; LANES],
            starts: [0; LANES],
            due: [u64::MAX; LANES],
            earliest: u64::MAX,
        }
    }

    /// The trial of a lane shows its first state at step `now`.
    pub(super) fn start(&mut self, lane: usize, now: u64) {
        self.starts[lane] = now;
        self.next[lane] = 0;
        self.due[lane] = self.turns.first().map_or(u64::MAX, |turn| now.saturating_add(turn.0));
        self.refresh();
    }

    /// The trials of these lanes are over.
    pub(super) fn stop(&mut self, lanes: Mask) {
        for lane in lanes.iter() {
            self.due[lane] = u64::MAX;
        }
        self.refresh();
    }

    fn refresh(&mut self) {
        self.earliest = self.due.iter().copied().fold(u64::MAX, u64::min);
    }

    /// Takes the turns that are due at step `now`; the lanes that see the horizon's state.
    #[inline(always)]
    pub(super) fn advance(&mut self, now: u64, cells: &mut [Cell]) -> u8 {
        if now < self.earliest { 0 } else { self.turn(now, cells) }
    }

    fn turn(&mut self, now: u64, cells: &mut [Cell]) -> u8 {
        let mut ending = 0;
        for lane in 0..LANES {
            let bit = 1u8 << lane;
            while self.due[lane] <= now {
                if let Some(&(_, turn, cell)) = self.turns.get(self.next[lane]) {
                    match (turn, cells.get_mut(cell)) {
                        (Turn::Horizon, _) => ending |= bit,
                        (Turn::Begin, Some(cell)) => {
                            cell.live |= bit;
                            cell.need |= bit;
                        }
                        (Turn::Last, Some(cell)) => cell.last |= bit,
                        (Turn::Past, Some(cell)) => {
                            cell.need &= !bit;
                            cell.last &= !bit;
                        }
                        (Turn::End, Some(cell)) => cell.live &= !bit,
                        (_, None) => {}
                    }
                }
                self.next[lane] += 1;
                let next = self.turns.get(self.next[lane]);
                self.due[lane] = next.map_or(u64::MAX, |turn| self.starts[lane].saturating_add(turn.0));
            }
        }
        self.refresh();
        ending
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.turns)
    }
}
