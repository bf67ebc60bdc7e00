//! Where all agents are and how they move: part of the state.

use crate::base::lanes::Lanes;
use crate::kernel::layout::Slot;

/// Positions, velocities and forces of all slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Position, m.
    pub x: Vec<Lanes>,
    /// Position, second coordinate, m.
    pub y: Vec<Lanes>,
    /// Velocity, m/s.
    pub vx: Vec<Lanes>,
    /// Velocity, second component, m/s.
    pub vy: Vec<Lanes>,
    /// Force of everything but contact at the present positions, N; kept from step to step.
    pub fx: Vec<Lanes>,
    /// Force, second component, N.
    pub fy: Vec<Lanes>,
    /// Length of the way gone, m.
    pub travelled: Vec<Lanes>,
}

impl Motion {
    /// So many blocks at rest in the origin.
    pub(super) fn new(blocks: usize) -> Self {
        let zero = || vec![Lanes::ZERO; blocks];
        Self { x: zero(), y: zero(), vx: zero(), vy: zero(), fx: zero(), fy: zero(), travelled: zero() }
    }

    /// At rest in the origin.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        let Self { x, y, vx, vy, fx, fy, travelled } = self;
        for field in [x, y, vx, vy, fx, fy, travelled] {
            field[slot.block].0[slot.lane] = 0.0;
        }
    }
}
