//! On which level or stairs everybody is, as part of the state of a batch of trials.

use super::{Bodies, Slot};
use crate::base::lanes::Lanes;
use crate::model::Parameter;

/// Where everybody is among levels and stairs, by block; empty without levels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Whereabouts {
    /// Number of the island.
    pub island: Vec<Lanes>,
    /// Where the origin of its coordinates lies in the plane, m.
    pub origin_x: Vec<Lanes>,
    /// The second coordinate.
    pub origin_y: Vec<Lanes>,
    /// The speed there, as a share of that on a level.
    pub(in crate::kernel) share: Vec<Lanes>,
}

impl Whereabouts {
    /// Makes room for so many blocks of people who are on a level.
    pub(in crate::kernel) fn reserve(&mut self, blocks: usize) {
        for field in [&mut self.island, &mut self.origin_x, &mut self.origin_y] {
            field.resize(blocks, Lanes::ZERO);
        }
        self.share.resize(blocks, Lanes::splat(1.0));
    }

    /// Slows down who was given a driving speed as on a level.
    pub(in crate::kernel) fn slow(&self, bodies: &mut Bodies, slot: Slot) {
        if let Some(share) = self.share.get(slot.block) {
            bodies[Parameter::Speed][slot.block].0[slot.lane] *= share.0[slot.lane];
        }
    }
}
