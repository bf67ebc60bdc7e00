//! The parameters of all agents and what follows from them: part of the state.

use crate::base::lanes::Lanes;
use crate::kernel::layout::Slot;
use crate::model::Parameter;
use std::ops::{Index, IndexMut};

/// Parameters of all slots, as drawn or as a behaviour has changed them, SI units. `A` and `A2` are those that are felt:
/// times the attention (of a body that stands for a group also times its persons).
#[derive(Clone, Debug, PartialEq)]
pub struct Bodies {
    values: [Vec<Lanes>; Parameter::ALL.len()],
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

    /// Harmless numbers in the place of an agent that is not in the scene.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        for parameter in Parameter::ALL {
            self[parameter][slot.block].0[slot.lane] = harmless(parameter);
        }
    }
}

/// A value with which an absent agent disturbs no vector: no force, no division by zero.
fn harmless(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Mass
        | Parameter::Tau
        | Parameter::B
        | Parameter::Lambda
        | Parameter::B2
        | Parameter::Lambda2 => 1.0,
        _ => 0.0,
    }
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
