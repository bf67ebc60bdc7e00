//! Counter-based random numbers: Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers:
//! as easy as 1, 2, 3", SC 2011).
//!
//! First rule of the kernel: a trial is a pure function of (model, seed, trial index). Every draw is
//! addressed, never consumed: the key is the seed; the counter is the number of the draw, its entity, purpose, trial
//! and branch. So adding an agent, a query or a move changes no other draw, and trials can run in any order on any
//! machine.

use super::math;
use std::convert::Infallible;

/// Name of the generator, for reports.
pub const GENERATOR: &str = "philox4x32-10";
/// Version of the addresses of draws: which counter belongs to which draw. It changes when a seed stops giving the same
/// numbers.
pub const LAYOUT: u32 = 1;

const MULTIPLIER: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

/// One block of Philox4x32-10.
#[inline(always)]
pub fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for round in 0..ROUNDS {
        if round > 0 {
            key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
        }
        let a = u64::from(MULTIPLIER[0]) * u64::from(counter[0]);
        let b = u64::from(MULTIPLIER[1]) * u64::from(counter[2]);
        counter = [
            (b >> 32) as u32 ^ counter[1] ^ key[0],
            b as u32,
            (a >> 32) as u32 ^ counter[3] ^ key[1],
            a as u32,
        ];
    }
    counter
}

/// The purpose of a draw. The number is part of the counter: never renumber, only append.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Purpose {
    /// Where an agent starts.
    Placement = 1,
    /// The noise on an agent's velocity, one block a step.
    Noise = 2,
    /// A parameter of an agent; the draw index is the hash of the parameter's name.
    Parameter = 3,
    /// A choice of a process or behaviour.
    Process = 4,
    /// Whether advice is followed.
    Decision = 5,
    /// Times between arrivals of a source.
    Arrival = 6,
    /// Waiting times and random times of processes.
    Delay = 7,
    /// Pauses on a route.
    Pause = 8,
    /// Draws of statistical procedures.
    Procedure = 9,
    /// Drawn once per run (roadmaps, learned gaits).
    Run = 10,
    /// Plans: goal points and knots of speed profiles.
    Plan = 11,
    /// Steps of walkers that step.
    Step = 12,
    /// First centroids of groups of people.
    Group = 13,
    /// Persons of a resample of the bootstrap.
    Resample = 14,
    /// Individuals of a search for parameters, and who is held out of it.
    Search = 15,
    /// Times at which doors open and close.
    Door = 16,
    /// Trials that a verifier runs again.
    Audit = 17,
    /// Synthetic data and tests.
    Test = 255,
}

/// The address of one trial: seed, index, branch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct TrialKey {
    /// Seed of the run; the key of the generator.
    pub seed: u64,
    /// Index of the trial, below `MOST_TRIALS`.
    pub index: u64,
    /// Replica of splitting or replanning cycle; 0 for the trial itself.
    pub branch: u16,
}

/// Trials of a seed: an index has 48 bits of a counter.
pub const MOST_TRIALS: u64 = 1 << 48;

/// The stream of one entity of one trial for one purpose. Copying it is free; it holds no state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    key: [u32; 2],
    entity_and_purpose: u32,
    trial: [u32; 2],
}

impl Stream {
    /// The stream of `entity` (24 bits) for `purpose` in `trial`.
    #[inline]
    pub const fn of(trial: TrialKey, entity: u32, purpose: Purpose) -> Self {
        Self {
            key: [trial.seed as u32, (trial.seed >> 32) as u32],
            entity_and_purpose: (entity & 0x00ff_ffff) | (purpose as u32) << 24,
            trial: [trial.index as u32, ((trial.index >> 32) as u32 & 0xffff) | (trial.branch as u32) << 16],
        }
    }

    /// Key of the generator, low word first.
    pub const fn key(self) -> [u32; 2] {
        self.key
    }

    /// The block's counter: draw, entity and purpose, trial (low), trial (high) and branch.
    #[inline(always)]
    pub const fn counter(self, draw: u32) -> [u32; 4] {
        [draw, self.entity_and_purpose, self.trial[0], self.trial[1]]
    }

    /// The two 64-bit words of draw number `draw`.
    #[inline(always)]
    pub fn words(self, draw: u32) -> [u64; 2] {
        let b = philox(self.counter(draw), self.key);
        [u64::from(b[0]) | u64::from(b[1]) << 32, u64::from(b[2]) | u64::from(b[3]) << 32]
    }

    /// A number in the open interval (0, 1), from the first word.
    #[inline(always)]
    pub fn uniform(self, draw: u32) -> f64 {
        unit_open(self.words(draw)[0])
    }

    /// Two independent numbers in (0, 1).
    #[inline(always)]
    pub fn uniform_pair(self, draw: u32) -> [f64; 2] {
        let w = self.words(draw);
        [unit_open(w[0]), unit_open(w[1])]
    }

    /// Two independent standard normal numbers (Box and Muller 1958).
    #[inline(always)]
    pub fn normal_pair(self, draw: u32) -> [f64; 2] {
        let w = self.words(draw);
        box_muller(w[0], w[1])
    }
}

/// The top 52 bits of a word, centred in their cell: never 0, never 1.
#[inline(always)]
pub fn unit_open(word: u64) -> f64 {
    // 1.m - 1 is exact; half a cell is added so that the ends are never reached.
    let one_to_two = f64::from_bits((word >> 12) | 0x3ff0_0000_0000_0000);
    (one_to_two - 1.0) + f64::EPSILON * 0.5
}

/// Two standard normal numbers from two words. The second word gives the angle.
#[inline(always)]
pub fn box_muller(first: u64, second: u64) -> [f64; 2] {
    let radius = (-2.0 * math::ln(unit_open(first))).sqrt();
    let (sin, cos) = math::sin_cos_turn(unit_open(second));
    [radius * cos, radius * sin]
}

/// A name's 64-bit hash (FNV-1a, Fowler, Noll, Vo): the same on every machine and in every version.
pub const fn name_hash(name: &str) -> u64 {
    let bytes = name.as_bytes();
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    let mut k = 0;
    while k < bytes.len() {
        hash = (hash ^ bytes[k] as u64).wrapping_mul(0x0000_0100_0000_01b3);
        k += 1;
    }
    // FNV mixes its low bits best; fold the high half in once more.
    hash ^ hash >> 29
}

/// A stream read in order, for code that takes any generator of the `rand` crates, such as a driver of one's own that draws by a law of
/// `rand_distr`. The draws belong to a trial and a person, so each trial can be repeated alone.
///
/// ```
/// use rand_distr::{Distribution, Gamma};
/// use smc_core::base::random::{Purpose, Sequence, Stream, TrialKey};
///
/// let key = TrialKey { seed: 7, index: 12, branch: 0 };
/// let mut draws = Sequence::new(Stream::of(key, 3, Purpose::Test));
/// let reaction: f64 = Gamma::new(4.0, 0.2).unwrap().sample(&mut draws);
/// assert!(reaction > 0.0 && reaction < 10.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    stream: Stream,
    next: u64,
}

impl Sequence {
    /// Starts at the first word of `stream`.
    pub const fn new(stream: Stream) -> Self {
        Self { stream, next: 0 }
    }

    fn word(&mut self) -> u64 {
        let word = self.stream.words((self.next / 2) as u32)[(self.next % 2) as usize];
        self.next += 1;
        word
    }
}

impl rand::rand_core::TryRng for Sequence {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.word() as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.word())
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            let word = self.word().to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known-answer vectors of the Random123 distribution (test T17).
    #[test]
    fn philox_meets_the_known_answers() {
        assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(
            philox([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox([0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344], [0xa409_3822, 0x299f_31d0]),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn uniform_numbers_never_reach_the_ends() {
        assert!(unit_open(0) > 0.0);
        assert!(unit_open(u64::MAX) < 1.0);
    }

    #[test]
    fn normal_numbers_have_mean_zero_and_variance_one() {
        let stream = Stream::of(TrialKey { seed: 7, index: 3, branch: 0 }, 5, Purpose::Test);
        let n = 100_000;
        let (mut sum, mut squares, mut cross) = (0.0, 0.0, 0.0);
        for draw in 0..n {
            let [a, b] = stream.normal_pair(draw);
            sum += a + b;
            squares += a * a + b * b;
            cross += a * b;
        }
        let n = f64::from(n);
        assert!((sum / (2.0 * n)).abs() < 0.01);
        assert!((squares / (2.0 * n) - 1.0).abs() < 0.015);
        assert!((cross / n).abs() < 0.015);
    }

    #[test]
    fn streams_differ_by_every_part_of_their_address() {
        let trial = TrialKey { seed: 1, index: 1, branch: 0 };
        let base = Stream::of(trial, 1, Purpose::Noise).words(0);
        let others = [
            Stream::of(TrialKey { seed: 2, ..trial }, 1, Purpose::Noise).words(0),
            Stream::of(TrialKey { index: 1 << 40, ..trial }, 1, Purpose::Noise).words(0),
            Stream::of(TrialKey { branch: 1, ..trial }, 1, Purpose::Noise).words(0),
            Stream::of(trial, 2, Purpose::Noise).words(0),
            Stream::of(trial, 1, Purpose::Placement).words(0),
            Stream::of(trial, 1, Purpose::Noise).words(1),
        ];
        assert!(others.iter().all(|w| *w != base));
    }
}
