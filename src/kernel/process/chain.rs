//! Small finite processes as one Markov chain: a row of numbers for each state.
//!
//! The variables of all processes together are the mixed-radix digits of one number, the state. For each process
//! and state it is known where the branches end in (0, 1], and by how much each branch moves that number. All
//! processes look at the old state and write variables of their own, so their moves add up. Numbers come from the
//! same addresses as elsewhere, and pass the same ends: a walk visits the states that the general path visits.
//!
//! Many trials walk side by side, all at the same tick. Those that have ended are taken out and the others move
//! up, so no lane is idle; and the numbers of all of them are drawn in one go, before anybody moves.

use super::draws::{Draw, RoundKeys, round_keys};
use super::keys::Keys;
use super::{Form, Machine};
use crate::base::lanes::{LANES, Lanes};
use crate::model::{Domain, VariableId};
use fearless_simd::{Level, Simd, dispatch};
use std::collections::BTreeSet;

/// Most states, reachable or not.
const MOST_STATES: u64 = 1 << 14;
/// Most ways from state to state.
const MOST_WAYS: usize = 1 << 17;
/// No number in (0, 1) passes it.
const NEVER: f64 = 2.0;

/// What a process does in each state.
#[derive(Clone, Debug)]
struct Steps {
    /// The part of the counter that names the process.
    word: u64,
    /// Most branches in a state; each state has so many places.
    most: usize,
    /// Whether chance decides, by state.
    open: Vec<bool>,
    /// Where each branch ends in (0, 1], state by state.
    ends: Vec<f64>,
    /// What each branch adds to the number of the state.
    moves: Vec<i32>,
}

/// Processes as one chain.
#[derive(Clone, Debug)]
pub struct Chain {
    keys: Keys,
    steps: Vec<Steps>,
    initial: u32,
    reachable: Vec<u32>,
    level: Level,
}

/// Trials of a chain side by side, eight to a block. Places beyond the last trial walk on somewhere.
#[derive(Clone, Debug)]
pub struct Walk {
    /// How many trials are left.
    len: usize,
    /// Steps made by each of them.
    tick: u64,
    /// Their indices.
    trials: Vec<[u64; LANES]>,
    states: Vec<[u32; LANES]>,
    /// Room for the next states, and for one number of each trial.
    next: Vec<[u32; LANES]>,
    numbers: Vec<Lanes>,
    keys: RoundKeys,
}

impl Chain {
    /// The chain of these processes, if they are tables and few states are reachable, none of them with an error.
    pub(super) fn of(machines: &[Machine], initial: &[f64], domains: &[Domain]) -> Option<Self> {
        let mut tables = Vec::new();
        let mut written = BTreeSet::new();
        for machine in machines {
            let Form::Table(table) = &machine.form else { return None };
            if !table.written().iter().all(|&variable| written.insert(variable)) {
                return None;
            }
            tables.push((machine.word, table));
        }
        let all: BTreeSet<VariableId> = (0..domains.len() as u32).map(VariableId).collect();
        let keys = Keys::of(&all, domains, MOST_STATES)?;
        let states = keys.rows() as usize;
        let mut values: Vec<Lanes> = initial.iter().map(|&value| Lanes::splat(value)).collect();
        let start = u32::try_from(keys.row(&values, 0)).ok()?;
        let mut seen = vec![false; states];
        *seen.get_mut(start as usize)? = true;
        let mut reachable = vec![start];
        let mut found: Vec<Vec<Vec<(f64, i32)>>> = vec![vec![Vec::new(); states]; tables.len()];
        let (mut done, mut ways) = (0, 0usize);
        while let Some(&state) = reachable.get(done) {
            done += 1;
            keys.put(u64::from(state), &mut values, 0);
            let old: Vec<f64> = values.iter().map(|lanes| lanes.0[0]).collect();
            let mut targets = vec![state as i32];
            for (found, (_, table)) in found.iter_mut().zip(&tables) {
                let mut branches = Vec::new();
                for (end, new) in table.outcomes(&old)? {
                    for &(variable, value) in &new {
                        values[variable as usize].0[0] = value;
                    }
                    branches.push((end, keys.row(&values, 0) as i32 - state as i32));
                    for &(variable, _) in &new {
                        values[variable as usize].0[0] = old[variable as usize];
                    }
                }
                targets = targets.iter().flat_map(|t| branches.iter().map(move |(_, by)| t + by)).collect();
                targets.sort_unstable();
                targets.dedup();
                ways += targets.len();
                if ways > MOST_WAYS {
                    return None;
                }
                found[state as usize] = branches;
            }
            for target in targets {
                let place = usize::try_from(target).ok().filter(|&place| place < states)?;
                if !std::mem::replace(&mut seen[place], true) {
                    reachable.push(target as u32);
                }
            }
        }
        let steps = found.iter().zip(&tables).map(|(found, (word, _))| Steps::of(*word, found));
        Some(Self { steps: steps.collect(), keys, initial: start, reachable, level: Level::new() })
    }

    /// The same chain for the plainest vectors of the machine.
    pub(super) fn at_baseline(mut self) -> Self {
        self.level = Level::baseline();
        self
    }

    /// Number of states, reachable or not: a state is a number below it.
    pub fn states(&self) -> usize {
        self.keys.rows() as usize
    }

    /// The state in which trials begin.
    pub fn initial(&self) -> u32 {
        self.initial
    }

    /// The states that some trial may visit.
    pub fn reachable(&self) -> &[u32] {
        &self.reachable
    }

    /// Puts the values of a state into a lane of all variables.
    pub fn values(&self, state: u32, variables: &mut [Lanes], lane: usize) {
        self.keys.put(u64::from(state), variables, lane);
    }

    /// Whether a trial never leaves a state, and nothing is left to chance in it.
    pub fn is_still(&self, state: u32) -> bool {
        let state = state as usize;
        self.steps.iter().all(|steps| !steps.open[state] && steps.moves[state * steps.most] == 0)
    }

    /// A walk without trials.
    pub fn walk(&self, seed: u64) -> Walk {
        Walk {
            len: 0,
            tick: 0,
            trials: Vec::new(),
            states: Vec::new(),
            next: Vec::new(),
            numbers: Vec::new(),
            keys: round_keys(seed),
        }
    }

    /// The trials with these indices begin; those of before are gone.
    pub fn begin(&self, walk: &mut Walk, trials: impl ExactSizeIterator<Item = u64>) {
        let blocks = trials.len().div_ceil(LANES);
        (walk.len, walk.tick) = (trials.len(), 0);
        walk.trials.resize(blocks, [0; LANES]);
        walk.states.clear();
        walk.states.resize(blocks, [self.initial; LANES]);
        walk.next.resize(blocks, [self.initial; LANES]);
        walk.numbers.resize(blocks, Lanes::ZERO);
        for (place, trial) in walk.trials.as_flattened_mut().iter_mut().zip(trials) {
            *place = trial;
        }
    }

    /// One step of all trials.
    #[inline]
    pub fn step(&self, walk: &mut Walk) {
        dispatch!(self.level, simd => advance(simd, self, walk));
        walk.tick += 1;
    }
}

impl Walk {
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

    /// Shows the places and states of all trials, in order, and keeps those for which `stays`.
    #[inline(always)]
    pub fn retain(&mut self, mut stays: impl FnMut(usize, u32) -> bool) {
        let (trials, states) = (self.trials.as_flattened_mut(), self.states.as_flattened_mut());
        let mut kept = 0;
        // Each is written to the next free place, and the place is kept or not: no jump depends on chance.
        for place in 0..self.len {
            let state = states[place];
            (trials[kept], states[kept]) = (trials[place], state);
            kept += usize::from(stays(place, state));
        }
        self.len = kept;
    }
}

impl Steps {
    fn of(word: u32, found: &[Vec<(f64, i32)>]) -> Self {
        let most = found.iter().map(Vec::len).max().unwrap_or(1).max(1);
        let mut ends = vec![NEVER; found.len() * most];
        let mut moves = vec![0; found.len() * most];
        for (state, branches) in found.iter().enumerate() {
            for (k, &(end, by)) in branches.iter().enumerate() {
                moves[state * most + k] = by;
                // The last branch takes all that is left.
                if k + 1 < branches.len() {
                    ends[state * most + k] = end;
                }
            }
        }
        let open = found.iter().map(|branches| branches.len() > 1).collect();
        Self { word: u64::from(word), most, open, ends, moves }
    }

    /// Adds the moves that the numbers choose.
    #[inline(always)]
    fn apply(&self, most: usize, old: &[[u32; LANES]], next: &mut [[u32; LANES]], numbers: &[Lanes]) {
        for ((old, next), numbers) in old.iter().zip(next).zip(numbers) {
            for lane in 0..LANES {
                let first = old[lane] as usize * most;
                // Ends ascend, so the branch is the number of ends passed: no jump depends on chance.
                let ends = self.ends[first..first + most - 1].iter();
                let branch: usize = ends.map(|&end| usize::from(numbers.0[lane] >= end)).sum();
                next[lane] = next[lane].wrapping_add_signed(self.moves[first + branch]);
            }
        }
    }
}

#[inline(always)]
fn advance<S: Simd>(simd: S, chain: &Chain, walk: &mut Walk) {
    let blocks = walk.len.div_ceil(LANES);
    let Walk { len, tick, trials, states, next, numbers, keys } = walk;
    let (old, next, numbers) = (&states[..blocks], &mut next[..blocks], &mut numbers[..blocks]);
    next.copy_from_slice(old);
    for steps in &chain.steps {
        // Where no trial needs a number, none is drawn: numbers have addresses, none is used up.
        if old.as_flattened()[..*len].iter().any(|&state| steps.open[state as usize]) {
            let draw = Draw { number: *tick, word: steps.word, keys };
            draw.uniform(simd, &trials[..blocks], numbers);
            // Compiled for the common numbers of branches.
            match steps.most {
                2 => steps.apply(2, old, next, numbers),
                3 => steps.apply(3, old, next, numbers),
                4 => steps.apply(4, old, next, numbers),
                most => steps.apply(most, old, next, numbers),
            }
        } else {
            for (state, next) in old.as_flattened().iter().zip(next.as_flattened_mut()) {
                *next = next.wrapping_add_signed(steps.moves[*state as usize * steps.most]);
            }
        }
    }
    std::mem::swap(states, &mut walk.next);
}
