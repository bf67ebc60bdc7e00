//! The parameters of all agents and what follows from them: part of the state.

use crate::base::lanes::Lanes;
use crate::kernel::layout::Slot;
use crate::model::Parameter;
use crate::model::parameter::{Range, Role};
use std::ops::{Index, IndexMut};

/// Parameters of all slots, as drawn or as a behaviour has changed them, SI units. `A` and `A2` are those that are felt:
/// times the attention (of a body that stands for a group also times its persons).
#[derive(Clone, Debug, PartialEq)]
pub struct Bodies {
    values: [Vec<Lanes>; Parameter::COUNT],
    /// What is left of a deviation from the driving velocity after a step, exp(-dt/tau); from `refresh`.
    pub decay: Vec<Lanes>,
    /// Standard deviation that the noise of a step adds, noise sqrt(1 - decay^2), m/s; from `refresh`.
    pub kick: Vec<Lanes>,
    /// Half a step over the mass, s/kg; from `refresh`.
    pub push: Vec<Lanes>,
}

impl Bodies {
    /// Harmless numbers for so many blocks.
    pub(super) fn new(blocks: usize) -> Self {
        let all = |value: f64| vec![Lanes::splat(value); blocks];
        Self {
            values: Parameter::ALL.map(|parameter| all(harmless(parameter))),
            decay: all(1.0),
            kick: all(0.0),
            push: all(0.0),
        }
    }

    /// Puts the values of some parameters, in the order of [`Parameter::ALL`], into a slot. Whether the reach of a force
    /// changed.
    pub(in crate::kernel) fn put(
        &mut self,
        slot: Slot,
        values: &[f64; Parameter::COUNT],
        parameters: impl Iterator<Item = Parameter>,
    ) -> bool {
        let mut reach = false;
        for parameter in parameters {
            let role = parameter.description().role;
            let felt = if role == Role::Strength { values[Parameter::Attention as usize] } else { 1.0 };
            let value = values[parameter as usize] * felt;
            let old = std::mem::replace(&mut self[parameter][slot.block].0[slot.lane], value);
            reach |= role == Role::Reach && old.to_bits() != value.to_bits();
        }
        reach
    }

    /// Harmless numbers in the place of an agent that is not in the scene.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        for parameter in Parameter::ALL {
            self[parameter][slot.block].0[slot.lane] = harmless(parameter);
        }
    }
}

/// A value with which an absent agent disturbs no vector: no force, no division by zero.
fn harmless(parameter: Parameter) -> f64 {
    let divides = parameter.description().range == Range::Positive && parameter != Parameter::Radius;
    if divides { 1.0 } else { 0.0 }
}

impl Index<Parameter> for Bodies {
    type Output = Vec<Lanes>;

    #[inline(always)]
    fn index(&self, parameter: Parameter) -> &Vec<Lanes> {
        &self.values[parameter as usize]
    }
}

impl IndexMut<Parameter> for Bodies {
    #[inline(always)]
    fn index_mut(&mut self, parameter: Parameter) -> &mut Vec<Lanes> {
        &mut self.values[parameter as usize]
    }
}
