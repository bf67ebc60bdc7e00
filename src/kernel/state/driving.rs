//! The driving velocities of all agents: part of the state.

use crate::base::lanes::Lanes;
use crate::kernel::layout::Slot;

/// Driving direction and speed of all slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Driving {
    /// Driving direction, a unit vector; it keeps its last value in an agent that stands. Zero in an agent that never had
    /// a direction.
    pub ex: Vec<Lanes>,
    /// Driving direction, second component.
    pub ey: Vec<Lanes>,
    /// Driving speed at present, m/s: that of the body, or 0 in an agent that stands.
    pub speed: Vec<Lanes>,
}

impl Driving {
    /// So many blocks that stand.
    pub(super) fn new(blocks: usize) -> Self {
        let zero = || vec![Lanes::ZERO; blocks];
        Self { ex: vec![Lanes::splat(1.0); blocks], ey: zero(), speed: zero() }
    }

    /// An agent that stands.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        for (field, value) in [(&mut self.ex, 1.0), (&mut self.ey, 0.0), (&mut self.speed, 0.0)] {
            field[slot.block].0[slot.lane] = value;
        }
    }
}
