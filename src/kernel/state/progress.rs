//! How far everybody has come on their routes: finished legs, steps, and the length, time and steps of each leg.

use crate::base::lanes::Lanes;
use crate::base::tick::{Clock, Tick};
use crate::kernel::layout::Slot;

/// Numbers of a leg.
pub(in crate::kernel) const MEASURES: usize = 3;

/// The progress of all slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// How many legs are finished; pauses are none.
    pub legs: Vec<Lanes>,
    /// How many whole steps were made.
    pub steps: Vec<Lanes>,
    /// When the last goal is reached and pauses are over, s; infinite before that is known.
    pub done_at: Vec<Lanes>,
    /// Way gone, m, time, ticks, and steps at the beginning of the present leg.
    began: [Vec<Lanes>; MEASURES],
    /// The same of each leg from its beginning to its end, the time in s; infinite until it ends.
    records: Vec<[Vec<Lanes>; MEASURES]>,
}

impl Progress {
    /// Of so many blocks, before any leg.
    pub(super) fn new(blocks: usize) -> Self {
        let all = |value: f64| vec![Lanes::splat(value); blocks];
        let (zero, never) = (all(0.0), all(f64::INFINITY));
        let began = [zero.clone(), zero.clone(), zero.clone()];
        Self { legs: zero.clone(), steps: zero, done_at: never, began, records: Vec::new() }
    }

    /// Puts a slot at the beginning of a route of at most so many legs.
    pub(in crate::kernel) fn begin(&mut self, slot: Slot, legs: usize) {
        while self.records.len() < legs {
            let never = || vec![Lanes::splat(f64::INFINITY); self.legs.len()];
            self.records.push([never(), never(), never()]);
        }
        let Self { legs, steps, done_at, began, records } = self;
        let put = |field: &mut Vec<Lanes>, value: f64| field[slot.block].0[slot.lane] = value;
        [legs, steps].into_iter().chain(began).for_each(|field| put(field, 0.0));
        records.iter_mut().flatten().chain([done_at]).for_each(|field| put(field, f64::INFINITY));
    }

    /// Begins a leg at a way gone, m, and a tick.
    pub(in crate::kernel) fn set_out(&mut self, slot: Slot, travelled: f64, tick: u64) {
        let now = self.now(slot, travelled, tick);
        for (field, value) in self.began.iter_mut().zip(now) {
            field[slot.block].0[slot.lane] = value;
        }
    }

    /// Ends a leg. Its time is a whole number of ticks, converted once: a difference of two times in s would be rounded twice.
    pub(in crate::kernel) fn arrive(&mut self, slot: Slot, travelled: f64, tick: u64, clock: Clock) {
        let Slot { block, lane } = slot;
        let now = self.now(slot, travelled, tick);
        let finished = &mut self.legs[block].0[lane];
        if let Some(record) = self.records.get_mut(*finished as usize) {
            for ((field, value), began) in record.iter_mut().zip(now).zip(&self.began) {
                field[block].0[lane] = value - began[block].0[lane];
            }
            let time = &mut record[1][block].0[lane];
            *time = clock.seconds(Tick(*time as u64));
        }
        *finished += 1.0;
    }

    fn now(&self, slot: Slot, travelled: f64, tick: u64) -> [f64; MEASURES] {
        [travelled, tick as f64, self.steps[slot.block].0[slot.lane]]
    }

    /// A number of a leg, from 0, of all slots; none of a leg that nobody has.
    pub fn record(&self, leg: u32, measure: usize) -> Option<&[Lanes]> {
        self.records.get(leg as usize).map(|record| record[measure].as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::decimal::Decimal;

    #[test]
    fn the_time_of_a_leg_is_a_whole_number_of_steps_whenever_it_begins() {
        for step in ["0.01", "0.02", "0.025", "0.04", "0.05", "0.1"] {
            let step = Decimal::parse(step).unwrap();
            let slot = Slot { block: 0, lane: 3 };
            let mut progress = Progress::new(1);
            for (began, ticks) in (1..600).flat_map(|ticks| [(0, ticks), (37, ticks), (1001, ticks)]) {
                progress.begin(slot, 1);
                progress.set_out(slot, 1.0, began);
                progress.arrive(slot, 2.0, began + ticks, Clock::Stepped(step));
                let wanted = step.mul(Decimal::whole(ticks as i64)).unwrap().to_f64();
                assert_eq!(progress.record(0, 1).unwrap()[0].0[3], wanted, "{ticks} steps of {step} s");
            }
        }
    }
}
