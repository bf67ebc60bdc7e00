//! One process with rates and few states: the Markov chain of its jumps, and how long it stays in each state.
//!
//! It waits for the n-th unit exponential number over the rate of its state, and the number beside it chooses the
//! next state. Only its own jumps change its rate, so nothing of a number is ever left over; times, ways and the
//! addresses of numbers are those of the general path, to the last bit. Many trials jump side by side, all for the
//! n-th time: those that have ended are taken out, and the numbers of all are drawn in one go, logarithms too.

use super::draws::{Draw, RoundKeys, round_keys};
use super::space::{MOST_WAYS, NEVER, Space};
use super::table::Table;
use crate::base::lanes::{LANES, Lanes};
use crate::model::Domain;
use fearless_simd::{Level, dispatch};

/// Most jumps that a trial is expected to make. Below it a wait that is lost beside the time it is added to is so
/// rare that they never come in the rows that are an error of the model.
const MOST_EXPECTED: f64 = 1e9;

/// Where a state leads to.
#[derive(Clone, Copy, Debug)]
struct Way {
    /// The end of its share of (0, 1].
    end: f64,
    target: u32,
}

/// A process as the chain of its jumps.
#[derive(Clone, Debug)]
pub struct Embedded {
    /// Its states.
    pub space: Space,
    /// The part of the counter that names the process.
    word: u64,
    /// How long it stays in each state on the average, s.
    means: Vec<f64>,
    /// Each state has so many places for ways.
    most: usize,
    /// State by state; the last one of a state takes all that is left.
    ways: Vec<Way>,
    /// The horizon, s.
    until: f64,
    level: Level,
}

/// Trials side by side, eight to a block. Places beyond the last trial hold anything.
#[derive(Clone, Debug)]
pub struct JumpBatch {
    /// How many trials are left.
    len: usize,
    /// Jumps made by each of them.
    jumps: u64,
    /// Their indices.
    trials: Vec<[u64; LANES]>,
    states: Vec<[u32; LANES]>,
    /// When each came to its state, s.
    since: Vec<[f64; LANES]>,
    /// Room for the numbers of all trials.
    waits: Vec<Lanes>,
    picks: Vec<Lanes>,
    keys: RoundKeys,
}

/// What a trial does: it stays in a state, and leaves it or not.
#[derive(Clone, Copy, Debug)]
pub struct Stay {
    /// The state.
    pub state: u32,
    /// Since when, s.
    pub since: f64,
    /// Until when, s; infinite if it lasts beyond the horizon.
    pub end: f64,
}

impl Embedded {
    /// The chain of a table, if few states are there and no reachable one has an error. `until` is the horizon, s.
    pub(super) fn of(
        (word, table): (u64, &Table),
        initial: &[f64],
        domains: &[Domain],
        until: f64,
    ) -> Option<Self> {
        let (mut found, mut means) = (Vec::new(), Vec::new());
        let space = Space::explore(initial, domains, |keys, state, values| {
            found.resize(keys.rows() as usize, Vec::new());
            means.resize(keys.rows() as usize, f64::INFINITY);
            let (total, mean) = table.total(table.keys.row(values, 0)).ok()?;
            if total * until > MOST_EXPECTED {
                return None;
            }
            let ways = keys.targets(table, state, values)?;
            let targets = ways.iter().map(|(_, target)| *target).collect();
            (means[state as usize], found[state as usize]) = (mean, ways);
            Some(targets)
        })?;
        let most = found.iter().map(Vec::len).max().unwrap_or(1).max(1);
        let states = space.states();
        if states * most > MOST_WAYS {
            return None;
        }
        let mut ways = Vec::with_capacity(states * most);
        for (state, found) in found.into_iter().enumerate() {
            let last = found.len().saturating_sub(1);
            for place in 0..most {
                let (end, target) = found.get(place).copied().unwrap_or((NEVER, state as u32));
                ways.push(Way { end: if place < last { end } else { NEVER }, target });
            }
        }
        Some(Self { space, word, means, most, ways, until, level: Level::new() })
    }

    /// The same chain for the plainest vectors of the machine.
    pub(super) fn at_baseline(mut self) -> Self {
        self.level = Level::baseline();
        self
    }

    /// The trials with these indices begin; those of before are gone.
    pub fn begin(&self, batch: &mut JumpBatch, trials: impl ExactSizeIterator<Item = u64>) {
        let blocks = trials.len().div_ceil(LANES);
        (batch.len, batch.jumps) = (trials.len(), 0);
        batch.trials.resize(blocks, [0; LANES]);
        for (place, trial) in batch.trials.as_flattened_mut().iter_mut().zip(trials) {
            *place = trial;
        }
        batch.states.clear();
        batch.states.resize(blocks, [self.space.initial(); LANES]);
        batch.since.clear();
        batch.since.resize(blocks, [0.0; LANES]);
        batch.waits.resize(blocks, Lanes::ZERO);
        batch.picks.resize(blocks, Lanes::ZERO);
    }

    /// The next jump of all trials. Of each the place and the stay that ends are shown, in order; it goes on if it
    /// jumps and `goes_on` says so. How many jumped.
    #[inline(always)]
    pub fn jump(&self, batch: &mut JumpBatch, mut goes_on: impl FnMut(usize, Stay) -> bool) -> u64 {
        let blocks = batch.len.div_ceil(LANES);
        let JumpBatch { len, jumps, trials, states, since, waits, picks, keys } = batch;
        let draw = Draw { number: *jumps, word: self.word, keys };
        dispatch!(self.level, simd => draw.exponential(
            simd,
            &trials[..blocks],
            &mut waits[..blocks],
            &mut picks[..blocks]
        ));
        let (trials, states) = (trials.as_flattened_mut(), states.as_flattened_mut());
        let since = since.as_flattened_mut();
        let (mut kept, mut jumped) = (0, 0);
        // Each is written to the next free place, and the place is kept or not: no jump depends on chance.
        for place in 0..*len {
            let (block, lane) = (place / LANES, place % LANES);
            let (state, began) = (states[place], since[place]);
            let due = began + waits[block].0[lane] * self.means[state as usize];
            let leaves = due <= self.until;
            let end = if leaves { due } else { f64::INFINITY };
            let first = state as usize * self.most;
            let ways = &self.ways[first..first + self.most];
            let pick = picks[block].0[lane];
            // Ends ascend, so the way is the number of ends passed.
            let way: usize = ways.iter().map(|way| usize::from(pick >= way.end)).sum();
            (trials[kept], states[kept], since[kept]) = (trials[place], ways[way].target, due);
            let stays = leaves & goes_on(place, Stay { state, since: began, end });
            jumped += u64::from(leaves);
            kept += usize::from(stays);
        }
        *len = kept;
        *jumps += 1;
        jumped
    }
}

impl JumpBatch {
    /// No trials yet.
    pub fn new(seed: u64) -> Self {
        Self {
            len: 0,
            jumps: 0,
            trials: Vec::new(),
            states: Vec::new(),
            since: Vec::new(),
            waits: Vec::new(),
            picks: Vec::new(),
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

    /// Jumps made by each trial.
    pub fn jumps(&self) -> u64 {
        self.jumps
    }
}
