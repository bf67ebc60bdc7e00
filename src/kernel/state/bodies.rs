//! The parameters of all agents and what follows from them: part of the state.

use crate::base::lanes::Lanes;
use crate::base::math;
use crate::kernel::layout::Slot;
use crate::kernel::speed::FORGETS;
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

    /// Works out what follows from the parameters of a slot for steps of `dt` seconds. Driving, noise and forces change no
    /// velocity of an agent that moves by itself, or that is of the collision-free speed model.
    pub(super) fn prepare(&mut self, Slot { block, lane }: Slot, dt: f64, by_itself: bool) {
        let of = |parameter| self[parameter][block].0[lane];
        let decay = math::exp(-dt / of(Parameter::Tau));
        let kick = of(Parameter::Noise) * (1.0 - decay * decay).sqrt();
        let push = 0.5 * dt / of(Parameter::Mass);
        let speed = of(Parameter::SwerveRange) > 0.0;
        let found = match (by_itself, speed) {
            (true, _) => (1.0, 0.0, 0.0),
            (false, true) => {
                let left = math::exp(-dt / FORGETS);
                (1.0, of(Parameter::Noise) * (1.0 - left * left).sqrt(), 0.0)
            }
            (false, false) => (decay, kick, push),
        };
        (self.decay[block].0[lane], self.kick[block].0[lane], self.push[block].0[lane]) = found;
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
    // A range of 0 says that an agent is of another model.
    let is_safe = matches!(parameter, Parameter::Radius | Parameter::SwerveRange | Parameter::WallRange);
    let divides = parameter.description().range == Range::Positive && !is_safe;
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
