//! Uniform numbers of one process at the present ticks of all lanes: Philox4x32-10, vectorised.
//!
//! The counter of a lane is (tick, entity, `Purpose::Process`, trial, branch), its key the seed; so the
//! numbers are those of `Stream::uniform_pair(tick)`, to the last bit (a test holds it).

use crate::base::lanes::{LANES, Lanes};
use crate::base::math;
use crate::base::random::{self, Purpose, Stream, TrialKey, philox};
use crate::kernel::noise::unit_open;
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, Words, ln, parts};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};

const MULTIPLIER: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;
const LOW: u64 = 0xffff_ffff;

/// The draws of one process at the present ticks.
pub(super) struct Draws<'s> {
    pub(super) level: Level,
    pub(super) state: &'s State,
    /// The part of the counter that names the process.
    pub(super) word: u32,
}

impl Draws<'_> {
    /// Two numbers in (0, 1) of each lane.
    #[inline]
    pub(super) fn pair(&self) -> [[f64; LANES]; 2] {
        let state = self.state;
        let seed = state.keys[0].seed;
        let same = state.occupied.iter().all(|lane| state.keys[lane].seed == seed);
        if same {
            let words = [u64::from(self.word); LANES];
            dispatch!(self.level, simd => all::<_, false>(simd, state, &state.ticks, &words))
        } else {
            let mut pair = [[0.5; LANES]; 2];
            for lane in state.occupied.iter() {
                let [first, second] = self.of_lane(lane);
                pair[0][lane] = first;
                pair[1][lane] = second;
            }
            pair
        }
    }

    /// Those of one lane.
    fn of_lane(&self, lane: usize) -> [f64; 2] {
        let stream = Stream::of(self.state.keys[lane], 0, Purpose::Process);
        at(stream, self.state.ticks[lane] as u32, self.word)
    }
}

/// For the draws of these numbers of the entities that the words name, lane by lane: a unit exponential number
/// (by the inverse distribution function) and a uniform one.
#[inline]
pub(super) fn exponentials(
    level: Level,
    state: &State,
    draws: &[u64; LANES],
    words: &[u64; LANES],
) -> [[f64; LANES]; 2] {
    let seed = state.keys[0].seed;
    if state.occupied.iter().all(|lane| state.keys[lane].seed == seed) {
        return dispatch!(level, simd => all::<_, true>(simd, state, draws, words));
    }
    let mut pair = [[0.5; LANES]; 2];
    for lane in state.occupied.iter() {
        let stream = Stream::of(state.keys[lane], 0, Purpose::Process);
        let [first, second] = at(stream, draws[lane] as u32, words[lane] as u32);
        pair[0][lane] = -math::ln(first);
        pair[1][lane] = second;
    }
    pair
}

/// The uniform numbers of one draw of a named entity of a stream's trial.
fn at(stream: Stream, draw: u32, word: u32) -> [f64; 2] {
    let mut counter = stream.counter(draw);
    counter[1] = word;
    let block = philox(counter, stream.key());
    let word = |k: usize| u64::from(block[k]) | u64::from(block[k + 1]) << 32;
    [random::unit_open(word(0)), random::unit_open(word(2))]
}

/// The numbers of all lanes, whose seeds are those of the first. The first is made exponential where `WAIT`.
#[inline(always)]
fn all<S: Simd, const WAIT: bool>(
    simd: S,
    state: &State,
    draws: &[u64; LANES],
    words: &[u64; LANES],
) -> [[f64; LANES]; 2] {
    let mut counter = [[0u64; LANES]; 3];
    for lane in 0..LANES {
        counter[0][lane] = draws[lane] & LOW;
        [counter[1][lane], counter[2][lane]] = trial_words(state.keys[lane]);
    }
    blocks::<_, WAIT>(simd, &counter, words, &round_keys(state.keys[0].seed))
}

/// Keys of the rounds.
pub(super) type RoundKeys = [[u64; 2]; ROUNDS];

/// The keys of the rounds of a seed.
pub(super) fn round_keys(seed: u64) -> RoundKeys {
    let mut key = [seed as u32, (seed >> 32) as u32];
    let mut keys = [[0u64; 2]; ROUNDS];
    for round in &mut keys {
        *round = [u64::from(key[0]), u64::from(key[1])];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    keys
}

/// The two parts of the counter that name a trial.
fn trial_words(key: TrialKey) -> [u64; 2] {
    [key.index & LOW, (key.index >> 32 & 0xffff) | u64::from(key.branch) << 16]
}

/// The two numbers of each lane. Of the counter: the draw, and the two parts of the trial; `words` name the
/// processes.
#[inline(always)]
fn blocks<S: Simd, const WAIT: bool>(
    simd: S,
    counter: &[[u64; LANES]; 3],
    words: &[u64; LANES],
    keys: &RoundKeys,
) -> [[f64; LANES]; 2] {
    let mut out = [Lanes::ZERO; 2];
    for part in parts(simd) {
        let counter =
            [part.words(&counter[0]), part.words(words), part.words(&counter[1]), part.words(&counter[2])];
        let [first, second] = block(part, counter, keys);
        part.store(if WAIT { part.c(0.0) - ln(part, first) } else { first }, &mut out[0]);
        part.store(second, &mut out[1]);
    }
    out.map(|lanes| lanes.0)
}

/// The two numbers of one block of the generator in each lane.
#[inline(always)]
fn block<S: Simd>(part: Part<S>, counter: [Words<S>; 4], keys: &RoundKeys) -> [Doubles<S>; 2] {
    let low = part.word(LOW);
    let mut c = counter;
    // Above its low half a counter word may hold anything between rounds.
    for round in keys {
        let a = (c[0] & low) * part.word(MULTIPLIER[0]);
        let b = (c[2] & low) * part.word(MULTIPLIER[1]);
        c = [(b >> 32) ^ (c[1] ^ part.word(round[0])), b, (a >> 32) ^ (c[3] ^ part.word(round[1])), a];
    }
    [unit_open(part, (c[0] & low) | (c[1] << 32)), unit_open(part, (c[2] & low) | (c[3] << 32))]
}

/// One draw of one process in many trials: its number in the process, the word of the process, the seed.
pub(super) struct Draw<'k> {
    pub(super) number: u64,
    pub(super) word: u64,
    pub(super) keys: &'k RoundKeys,
}

impl Draw<'_> {
    /// The counter of the trials with these indices and branch 0.
    #[inline(always)]
    fn counter<S: Simd>(&self, part: Part<S>, trials: &[u64; LANES]) -> [Words<S>; 4] {
        let trials = part.words(trials);
        let high = (trials >> 32) & part.word(0xffff);
        [part.word(self.number & LOW), part.word(self.word), trials & part.word(LOW), high]
    }

    /// The first number of each trial. Blocks of trials do not wait for one another, so the machine works at many at
    /// once.
    #[inline(always)]
    pub(super) fn uniform<S: Simd>(&self, simd: S, trials: &[[u64; LANES]], out: &mut [Lanes]) {
        for (trials, out) in trials.iter().zip(out) {
            for part in parts(simd) {
                part.store(block(part, self.counter(part, trials), self.keys)[0], out);
            }
        }
    }

    /// Adds to `out` so many strides as the first number of each trial passes of these ends, which ascend.
    #[inline(always)]
    pub(super) fn branch<S: Simd>(
        &self,
        simd: S,
        trials: &[[u64; LANES]],
        ends: &[f64],
        stride: u64,
        out: &mut [[u64; LANES]],
    ) {
        for (trials, out) in trials.iter().zip(out) {
            for part in parts(simd) {
                let number = block(part, self.counter(part, trials), self.keys)[0];
                let mut branch = part.words(out);
                for &end in ends {
                    // Doubles whose bits are those of a whole number; nothing is computed with them.
                    let passed = number.simd_ge(part.c(end));
                    branch += passed.select(part.c(f64::from_bits(stride)), part.c(0.0)).to_bits();
                }
                part.put_words(branch, out);
            }
        }
    }

    /// A unit exponential number of each trial and a uniform one.
    #[inline(always)]
    pub(super) fn exponential<S: Simd>(
        &self,
        simd: S,
        trials: &[[u64; LANES]],
        waits: &mut [Lanes],
        picks: &mut [Lanes],
    ) {
        for ((trials, wait), pick) in trials.iter().zip(waits).zip(picks) {
            for part in parts(simd) {
                let [first, second] = block(part, self.counter(part, trials), self.keys);
                part.store(part.c(0.0) - ln(part, first), wait);
                part.store(second, pick);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::lanes::Mask;
    use crate::kernel::state::Layout;

    #[test]
    fn the_numbers_are_those_of_the_stream_to_the_last_bit() {
        for spread in [0, 1] {
            let mut state = State::new(Layout::Trials, 0);
            state.occupied = Mask::ALL;
            for lane in 0..LANES {
                state.keys[lane] = TrialKey {
                    seed: 0x1234_5678_9abc_def0 ^ (spread * lane as u64),
                    index: 0xffff_ffff_0000 + 7 * lane as u64,
                    branch: lane as u16,
                };
                state.ticks[lane] = 0xffff_fff0 + 5 * lane as u64;
            }
            for entity in [0, 5, 0x00ff_ffff] {
                let word = Stream::of(TrialKey::default(), entity, Purpose::Process).counter(0)[1];
                let waits = exponentials(Level::new(), &state, &state.ticks, &[u64::from(word); LANES]);
                let pair = Draws { level: Level::new(), state: &state, word }.pair();
                for lane in 0..LANES {
                    let stream = Stream::of(state.keys[lane], entity, Purpose::Process);
                    let expected = stream.uniform_pair(state.ticks[lane] as u32);
                    assert_eq!([pair[0][lane], pair[1][lane]], expected);
                    assert_eq!([waits[0][lane], waits[1][lane]], [-math::ln(expected[0]), expected[1]]);
                }
            }
        }
    }
}
