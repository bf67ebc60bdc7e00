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
    /// One over the largest driving speed that the headway to those ahead allows, s/m; 0 where nobody is. Kept from step to
    /// step with the forces.
    pub slowness: Vec<Lanes>,
    /// Where an agent that stands came or comes to rest, m; infinite in one that does not stand.
    pub rest_x: Vec<Lanes>,
    /// The second coordinate.
    pub rest_y: Vec<Lanes>,
}

impl Driving {
    /// So many blocks that stand.
    pub(super) fn new(blocks: usize) -> Self {
        let zero = || vec![Lanes::ZERO; blocks];
        let nowhere = || vec![Lanes::splat(f64::INFINITY); blocks];
        Self {
            ex: vec![Lanes::splat(1.0); blocks],
            ey: zero(),
            speed: zero(),
            slowness: zero(),
            rest_x: nowhere(),
            rest_y: nowhere(),
        }
    }

    /// An agent that stands.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        for (field, value) in
            [(&mut self.ex, 1.0), (&mut self.ey, 0.0), (&mut self.speed, 0.0), (&mut self.slowness, 0.0)]
        {
            field[slot.block].0[slot.lane] = value;
        }
        self.move_on(slot);
    }

    /// An agent that is no longer where it stood.
    pub(in crate::kernel) fn move_on(&mut self, slot: Slot) {
        for field in [&mut self.rest_x, &mut self.rest_y] {
            field[slot.block].0[slot.lane] = f64::INFINITY;
        }
    }
}
