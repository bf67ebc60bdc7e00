//! One process with rates and few states: the Markov chain of its jumps, and how long it stays in each state.
//!
//! It waits for the n-th unit exponential number over the rate of its state, and the number beside it chooses the
//! next state. Only its own jumps change its rate, so nothing of a number is ever left over; times, ways and the
//! addresses of numbers are those of the general path, to the last bit. Many trials jump side by side, all for the
//! n-th time: those that have ended are taken out, and the numbers of all are drawn in one go, logarithms too.

use super::draws::{Draw, RoundKeys, round_keys};
use super::keys::Keys;
use super::rates::Rates;
use crate::base::lanes::{LANES, Lanes};
use crate::model::{Domain, VariableId};
use fearless_simd::{Level, dispatch};
use std::collections::BTreeSet;

/// Most states, reachable or not.
const MOST_STATES: u64 = 1 << 14;
/// Most places for ways.
const MOST_WAYS: usize = 1 << 17;
/// No number in (0, 1) passes it.
const NEVER: f64 = 2.0;
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
    keys: Keys,
    /// The part of the counter that names the process.
    word: u64,
    initial: u32,
    reachable: Vec<u32>,
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
pub struct Leaps {
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
        (word, table): (u64, &Rates),
        initial: &[f64],
        domains: &[Domain],
        until: f64,
    ) -> Option<Self> {
        let all: BTreeSet<VariableId> = (0..domains.len() as u32).map(VariableId).collect();
        let keys = Keys::of(&all, domains, MOST_STATES)?;
        let states = keys.rows() as usize;
        let mut values: Vec<Lanes> = initial.iter().map(|&value| Lanes::splat(value)).collect();
        let start = keys.row(&values, 0);
        let mut found: Vec<Option<Vec<(f64, usize)>>> = vec![None; states];
        *found.get_mut(start)? = Some(Vec::new());
        let mut means = vec![f64::INFINITY; states];
        let mut reachable = vec![start as u32];
        let (mut done, mut most) = (0, 1);
        while let Some(&state) = reachable.get(done) {
            done += 1;
            keys.put(u64::from(state), &mut values, 0);
            let row = table.keys.row(&values, 0);
            let (total, mean) = table.total(row).ok()?;
            if total * until > MOST_EXPECTED {
                return None;
            }
            means[state as usize] = mean;
            let mut ways = Vec::new();
            for (end, new) in table.outcomes(row)? {
                for (variable, value) in new {
                    values[variable as usize].0[0] = value;
                }
                let target = keys.row(&values, 0);
                ways.push((end, target));
                keys.put(u64::from(state), &mut values, 0);
                if found.get(target)?.is_none() {
                    found[target] = Some(Vec::new());
                    reachable.push(target as u32);
                }
            }
            most = most.max(ways.len());
            found[state as usize] = Some(ways);
        }
        if states * most > MOST_WAYS {
            return None;
        }
        let mut ways = Vec::with_capacity(states * most);
        for (state, found) in found.into_iter().enumerate() {
            let found = found.unwrap_or_default();
            let last = found.len().saturating_sub(1);
            for place in 0..most {
                let (end, target) = found.get(place).copied().unwrap_or((NEVER, state));
                ways.push(Way { end: if place < last { end } else { NEVER }, target: target as u32 });
            }
        }
        let initial = start as u32;
        let level = Level::new();
        Some(Self { keys, word, initial, reachable, means, most, ways, until, level })
    }

    /// The same chain for the plainest vectors of the machine.
    pub(super) fn at_baseline(mut self) -> Self {
        self.level = Level::baseline();
        self
    }

    /// Number of states, reachable or not: a state is a number below it.
    pub fn states(&self) -> usize {
        self.means.len()
    }

    /// The states that some trial may visit.
    pub fn reachable(&self) -> &[u32] {
        &self.reachable
    }

    /// Puts the values of a state into a lane of all variables.
    pub fn values(&self, state: u32, variables: &mut [Lanes], lane: usize) {
        self.keys.put(u64::from(state), variables, lane);
    }

    /// No trials yet.
    pub fn leaps(&self, seed: u64) -> Leaps {
        Leaps {
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

    /// The trials with these indices begin; those of before are gone.
    pub fn begin(&self, leaps: &mut Leaps, trials: impl ExactSizeIterator<Item = u64>) {
        let blocks = trials.len().div_ceil(LANES);
        (leaps.len, leaps.jumps) = (trials.len(), 0);
        leaps.trials.resize(blocks, [0; LANES]);
        for (place, trial) in leaps.trials.as_flattened_mut().iter_mut().zip(trials) {
            *place = trial;
        }
        leaps.states.clear();
        leaps.states.resize(blocks, [self.initial; LANES]);
        leaps.since.clear();
        leaps.since.resize(blocks, [0.0; LANES]);
        leaps.waits.resize(blocks, Lanes::ZERO);
        leaps.picks.resize(blocks, Lanes::ZERO);
    }

    /// The next jump of all trials. Of each the place and the stay that ends are shown, in order; it goes on if it
    /// jumps and `goes_on` says so. How many jumped.
    #[inline(always)]
    pub fn jump(&self, leaps: &mut Leaps, mut goes_on: impl FnMut(usize, Stay) -> bool) -> u64 {
        let blocks = leaps.len.div_ceil(LANES);
        let Leaps { len, jumps, trials, states, since, waits, picks, keys } = leaps;
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

impl Leaps {
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
