//! Two standard normal numbers for each of eight slots: Philox4x32-10 and Box-Muller, vectorised.
//!
//! The counter of a slot is (tick, entity of its agent, `Purpose::Noise`, trial, branch), its key the
//! seed; so the numbers are those of `Stream::normal_pair(tick)`, to the last bit (a test holds it).
//! One draw a step, whatever happens inside the step.

use super::state::{Layout, State};
use super::vector::{Doubles, Part, Words, ln, sin_cos_turn};
use crate::base::lanes::LANES;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::{Parameter, Scenario};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

const MULTIPLIER: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;
const LOW: u64 = 0xffff_ffff;

/// The noise of a scenario.
#[derive(Clone, Debug)]
pub struct Noise {
    /// Whether any velocity fluctuates.
    pub(super) present: bool,
    /// Per agent: its word in the counters.
    pub(super) words: Vec<u32>,
}

impl Noise {
    /// Prepares it.
    pub fn new(scenario: &Scenario) -> Self {
        let agents = scenario.agents.iter();
        let present = agents.clone().any(|agent| agent.body[Parameter::Noise].constant() != Some(0.0));
        Self {
            present: present || scenario.behaviours.change(Parameter::Noise),
            words: agents.map(|agent| word_of(agent.entity)).collect(),
        }
    }
}

/// The part of the counter that names an agent.
pub(super) fn word_of(entity: u32) -> u32 {
    Stream::of(TrialKey::default(), entity, Purpose::Noise).counter(0)[1]
}

/// What the draws of one step have in common.
#[derive(Clone, Debug)]
pub(super) struct Draws {
    /// Keys of the ten rounds.
    keys: [[[u64; LANES]; 2]; ROUNDS],
    /// Counter words 0, 2 and 3.
    counter: [[u64; LANES]; 3],
}

impl Draws {
    /// The draws of the step that starts at the present ticks.
    pub(super) fn at(state: &State) -> Self {
        let mut draws = Self { keys: [[[0; LANES]; 2]; ROUNDS], counter: [[0; LANES]; 3] };
        for slot in 0..LANES {
            let lane = match state.layout {
                Layout::Trials => slot,
                Layout::Agents => 0,
            };
            let stream = Stream::of(state.keys[lane], 0, Purpose::Noise);
            let words = stream.counter(state.ticks[lane] as u32);
            draws.counter[0][slot] = u64::from(words[0]);
            draws.counter[1][slot] = u64::from(words[2]);
            draws.counter[2][slot] = u64::from(words[3]);
            let mut key = stream.key();
            for round in &mut draws.keys {
                round[0][slot] = u64::from(key[0]);
                round[1][slot] = u64::from(key[1]);
                key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
            }
        }
        draws
    }

    /// The two 64-bit words of the slots whose agents have the counter words `agents`.
    #[inline(always)]
    fn words<S: Simd>(&self, part: Part<S>, agents: Words<S>) -> (Words<S>, Words<S>) {
        let low = part.word(LOW);
        let mut c = [
            part.words(&self.counter[0]),
            agents,
            part.words(&self.counter[1]),
            part.words(&self.counter[2]),
        ];
        // Above its low half a counter word may hold anything between rounds: the product takes the low
        // half only, and the end masks it off.
        for key in &self.keys {
            let a = (c[0] & low) * part.word(MULTIPLIER[0]);
            let b = (c[2] & low) * part.word(MULTIPLIER[1]);
            c = [(b >> 32) ^ (c[1] ^ part.words(&key[0])), b, (a >> 32) ^ (c[3] ^ part.words(&key[1])), a];
        }
        ((c[0] & low) | (c[1] << 32), (c[2] & low) | (c[3] << 32))
    }

    /// Two standard normal numbers for each slot.
    #[inline(always)]
    pub(super) fn normals<S: Simd>(&self, part: Part<S>, agents: Words<S>) -> (Doubles<S>, Doubles<S>) {
        let (first, second) = self.words(part, agents);
        let radius = (part.c(-2.0) * ln(part, unit_open(part, first))).sqrt();
        let (sin, cos) = sin_cos_turn(part, unit_open(part, second));
        (radius * cos, radius * sin)
    }
}

/// `base::random::unit_open`.
#[inline(always)]
pub(super) fn unit_open<S: Simd>(part: Part<S>, word: Words<S>) -> Doubles<S> {
    let one_to_two = Doubles::<S>::from_bits((word >> 12) | part.word(0x3ff0_0000_0000_0000));
    (one_to_two - part.c(1.0)) + part.c(f64::EPSILON * 0.5)
}

#[cfg(test)]
mod tests {
    use super::super::vector::parts;
    use super::*;
    use crate::base::lanes::Lanes;
    use fearless_simd::{Level, dispatch};

    #[inline(always)]
    fn pair<S: Simd>(simd: S, draws: &Draws, agents: [u64; LANES]) -> ([f64; LANES], [f64; LANES]) {
        let (mut out_a, mut out_b) = (Lanes::ZERO, Lanes::ZERO);
        for part in parts(simd) {
            let (a, b) = draws.normals(part, part.words(&agents));
            part.store(a, &mut out_a);
            part.store(b, &mut out_b);
        }
        (out_a.0, out_b.0)
    }

    #[test]
    fn the_numbers_are_those_of_the_stream_to_the_last_bit() {
        let mut state = State::new(Layout::Trials, 1);
        for lane in 0..LANES {
            state.keys[lane] = TrialKey {
                seed: 0x1234_5678_9abc_def0 ^ lane as u64,
                index: 0xffff_ffff_0000 + 7 * lane as u64,
                branch: lane as u16,
            };
            state.ticks[lane] = 0xffff_fff0 + 5 * lane as u64;
        }
        for entity in [0, 5, 0x00ff_ffff] {
            let draws = Draws::at(&state);
            let agents = [u64::from(word_of(entity)); LANES];
            let (a, b) = dispatch!(Level::new(), simd => pair(simd, &draws, agents));
            for lane in 0..LANES {
                let stream = Stream::of(state.keys[lane], entity, Purpose::Noise);
                let [c, d] = stream.normal_pair(state.ticks[lane] as u32);
                assert_eq!((a[lane].to_bits(), b[lane].to_bits()), (c.to_bits(), d.to_bits()));
            }
        }
    }
}
