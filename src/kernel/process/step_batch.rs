//! Many trials on a chain side by side, all at the same tick.
//!
//! Those that have ended are taken out and the others move up, so no lane is idle; and the numbers of all of them are
//! drawn in one go, before anybody moves.

use super::chain::{Chain, Steps};
use super::draws::{Draw, RoundKeys, round_keys};
use crate::base::lanes::{LANES, Lanes};
use fearless_simd::{Simd, dispatch};

/// The lanes of a block.
const SLOTS: [u32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7];

/// Trials of a chain side by side, eight to a block. Places beyond the last trial walk on somewhere.
#[derive(Clone, Debug)]
pub struct StepBatch {
    /// How many trials are left.
    len: usize,
    /// Steps made by each of them.
    tick: u64,
    /// Their indices.
    trials: Vec<[u64; LANES]>,
    states: Vec<[u32; LANES]>,
    /// Their numbers in the list that began.
    slots: Vec<[u32; LANES]>,
    /// Number and state of those taken out last.
    sifted: Vec<(u32, u32)>,
    /// Room for the next states, and for one number or branch of each trial.
    next: Vec<[u32; LANES]>,
    numbers: Vec<Lanes>,
    branches: Vec<[u64; LANES]>,
    keys: RoundKeys,
}

impl Chain {
    /// The trials with these indices begin; those of before are gone.
    pub fn begin(&self, batch: &mut StepBatch, trials: impl ExactSizeIterator<Item = u64>) {
        let blocks = trials.len().div_ceil(LANES);
        (batch.len, batch.tick) = (trials.len(), 0);
        batch.trials.resize(blocks, [0; LANES]);
        batch.states.clear();
        batch.states.resize(blocks, [self.space.initial(); LANES]);
        batch.slots.clear();
        batch.slots.extend((0..blocks as u32).map(|block| SLOTS.map(|lane| block * LANES as u32 + lane)));
        batch.sifted.resize(batch.len, (0, 0));
        batch.next.resize(blocks, [self.space.initial(); LANES]);
        batch.numbers.resize(blocks, Lanes::ZERO);
        batch.branches.resize(blocks, [0; LANES]);
        for (place, trial) in batch.trials.as_flattened_mut().iter_mut().zip(trials) {
            *place = trial;
        }
    }

    /// One step of all trials.
    #[inline]
    pub fn step(&self, batch: &mut StepBatch) {
        dispatch!(self.level, simd => advance(simd, self, batch));
        batch.tick += 1;
    }
}

impl StepBatch {
    /// No trials yet.
    pub fn new(seed: u64) -> Self {
        Self {
            len: 0,
            tick: 0,
            trials: Vec::new(),
            states: Vec::new(),
            slots: Vec::new(),
            sifted: Vec::new(),
            next: Vec::new(),
            numbers: Vec::new(),
            branches: Vec::new(),
            keys: round_keys(seed),
        }
    }

    /// How many trials are left.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no trial is left.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Steps made by each trial.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Takes out the trials whose states are of a class that has a bit of `watch`; how many. The others keep their
    /// order.
    #[inline]
    pub fn sift(&mut self, classes: &[u8], watch: u8) -> usize {
        let all = self.len;
        let trials = &mut self.trials.as_flattened_mut()[..all];
        let states = &mut self.states.as_flattened_mut()[..all];
        let slots = &mut self.slots.as_flattened_mut()[..all];
        let sifted = &mut self.sifted[..all];
        let mut kept = 0;
        // Each is written to the next free place of both lists, and one of them goes on: no jump depends on chance.
        for place in 0..all {
            let (trial, state, slot) = (trials[place], states[place], slots[place]);
            sifted[place - kept] = (slot, state);
            (trials[kept], states[kept], slots[kept]) = (trial, state, slot);
            kept += usize::from(classes[state as usize] & watch == 0);
        }
        self.len = kept;
        all - kept
    }

    /// The number in the list that began, and the state, of one of those taken out last.
    pub fn sifted(&self, k: usize) -> (u32, u32) {
        self.sifted[k]
    }

    /// A trial that was taken out goes on: its number in the list, its state and its index.
    pub fn put_back(&mut self, (slot, state): (u32, u32), trial: u64) {
        let place = self.len;
        self.trials.as_flattened_mut()[place] = trial;
        self.states.as_flattened_mut()[place] = state;
        self.slots.as_flattened_mut()[place] = slot;
        self.len += 1;
    }
}

#[inline(always)]
fn advance<S: Simd>(simd: S, chain: &Chain, batch: &mut StepBatch) {
    let blocks = batch.len.div_ceil(LANES);
    let StepBatch { len, tick, trials, states, next, numbers, branches, keys, .. } = batch;
    let (old, trials) = (&states[..blocks], &trials[..blocks]);
    let (next, numbers, branches) = (&mut next[..blocks], &mut numbers[..blocks], &mut branches[..blocks]);
    let open = open_in(chain, &old.as_flattened()[..*len]);
    let draw = |steps: &Steps| Draw { number: *tick, word: steps.word, keys };
    // Where no trial needs a number, none is drawn: numbers have addresses, none is used up.
    let needed = |k: usize| open >> k.min(63) & 1 == 1;
    if let Some(joint) = &chain.joint {
        branches.fill([0; LANES]);
        for (k, steps) in chain.steps.iter().enumerate().filter(|(k, _)| needed(*k)) {
            if let Some(ends) = &steps.common {
                pass(simd, &draw(steps), trials, ends, joint.strides[k], branches);
            }
        }
        joint.take(old, next, branches);
    } else {
        next.copy_from_slice(old);
        for (k, steps) in chain.steps.iter().enumerate() {
            if !needed(k) {
                for (state, next) in old.as_flattened().iter().zip(next.as_flattened_mut()) {
                    *next = next.wrapping_add_signed(steps.moves[*state as usize * steps.most]);
                }
            } else if let Some(ends) = &steps.common {
                branches.fill([0; LANES]);
                pass(simd, &draw(steps), trials, ends, 1, branches);
                steps.take(old, next, branches);
            } else {
                draw(steps).uniform(simd, trials, numbers);
                steps.apply(steps.most, old, next, numbers);
            }
        }
    }
    std::mem::swap(states, &mut batch.next);
}

/// The processes that some of these states leave to chance, bit by bit.
#[inline(always)]
fn open_in(chain: &Chain, states: &[u32]) -> u64 {
    let all = u64::MAX >> (64 - chain.steps.len().clamp(1, 64));
    let mut open = 0;
    for &state in states {
        open |= chain.open[state as usize];
        if open == all {
            break;
        }
    }
    open
}

/// Adds the strides of the branches that the numbers choose.
#[inline(always)]
fn pass<S: Simd>(
    simd: S,
    draw: &Draw<'_>,
    trials: &[[u64; LANES]],
    ends: &[f64],
    stride: u64,
    branches: &mut [[u64; LANES]],
) {
    // Compiled for a coin and for a choice of four.
    match *ends {
        [half] => draw.branch(simd, trials, &[half], stride, branches),
        [a, b, c] => draw.branch(simd, trials, &[a, b, c], stride, branches),
        ref ends => draw.branch(simd, trials, ends, stride, branches),
    }
}
