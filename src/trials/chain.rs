//! Runners for small chains: they do what a batch does, with all that can be known beforehand.
//!
//! They take columns that are one until (or F, G, W) over the variables of processes that form one chain: a chain of steps, or
//! with one process in continuous time the chain of its jumps. What each state is for a column is known beforehand. All
//! trials of a block go side by side, and those that are decided drop out. Cells are those of the general batch, to the last
//! bit; what does not fit is left to that.

use super::budget::Budget;
use super::cell::{Block, Cell, Reading};
use super::setup::Setup;
use crate::base::lanes::Lanes;
use crate::kernel::State;
use crate::kernel::process::{JumpBatch, Space, Stay, StepBatch, ViewReadings};
use crate::logic::Root;
use crate::logic::{Flat, Glance, Sort};

/// Steps, and rounds of jumps, between two looks at the clock.
const STEPS_BETWEEN_LOOKS: u64 = 256;
const JUMPS_BETWEEN_LOOKS: u64 = 64;

/// Most columns. The last bit of a set of columns says that the trial never leaves its state.
const MOST_COLUMNS: usize = 63;
/// That bit.
const STILL: u64 = 1 << MOST_COLUMNS;

/// What a state is for the columns, bit k for the k-th of them.
#[derive(Clone, Copy, Debug, Default)]
struct Sorts {
    /// The goal is reached.
    goal: u64,
    /// What must be so up to the goal is not so; or the trial never leaves the state.
    stop: u64,
}

impl Sorts {
    /// What the states that trials may visit are for some columns; `sort` says so for one of them and what is observed.
    fn of(
        setup: &Setup,
        columns: &[usize],
        space: &Space,
        mut sort: impl FnMut(usize, &[bool], &[f64]) -> Sort,
    ) -> Vec<Self> {
        let view = setup.view(columns);
        let mut state = State::new(setup.program.layout, 0);
        state.variables = vec![Lanes::ZERO; setup.program.scenario.processes.variables.len()];
        let mut seen = ViewReadings::default();
        let mut all = vec![Self::default(); space.states()];
        for &place in space.reachable() {
            space.values(place, &mut state.variables, 0);
            view.look(&state, &mut seen);
            let (atoms, signals) = view.of(&state, &mut seen, 0);
            let sorts = &mut all[place as usize];
            for k in 0..columns.len() {
                let sort = sort(k, atoms, signals);
                sorts.goal |= u64::from(sort.goal) << k;
                sorts.stop |= u64::from(!sort.hold) << k;
            }
        }
        all
    }

    /// What the state is for one column.
    #[inline(always)]
    fn sort(self, column: usize) -> Sort {
        Sort { hold: self.stop >> column & 1 == 0, goal: self.goal >> column & 1 == 1 }
    }
}

/// Whether a runner of a chain may take these columns.
fn fits(setup: &Setup, columns: &[usize]) -> bool {
    (1..=MOST_COLUMNS).contains(&columns.len()) && setup.reads_variables_only(columns)
}

/// The classes of states, to find quickly where something may be decided: some goal is reached, some column stops,
/// and any.
const GOAL: u8 = 1;
const STOP: u8 = 2;
const ANY: u8 = 4;

/// Trials on a chain of steps.
pub struct StepChain {
    flats: Vec<Flat>,
    /// By state.
    sorts: Vec<Sorts>,
    classes: Vec<u8>,
    trials: Option<(u64, StepBatch)>,
    /// The columns that are open, by place in the block.
    open: Vec<u64>,
    rounds: u64,
    /// Steps made, of all trials; those too that lead nowhere and were left out.
    pub steps: u64,
}

/// The batch of the last block, or a new one for another seed.
fn batch<B>(last: &mut Option<(u64, B)>, seed: u64, new: impl FnOnce(u64) -> B) -> &mut B {
    let kept = last.take().filter(|(old, _)| *old == seed);
    &mut last.insert(kept.unwrap_or_else(|| (seed, new(seed)))).1
}

/// Whether a block ends before its trials do. The clock is read once in so many rounds.
fn is_cut(budget: &Budget, rounds: u64, between_looks: u64) -> bool {
    budget.is_interrupted() || (rounds.is_multiple_of(between_looks) && budget.is_over())
}

/// The present tick for the columns, bit k for the k-th of them.
struct AtTick {
    tick: u64,
    /// The goal counts.
    begun: u64,
    /// Nothing counts after it.
    over: u64,
    /// To reach the goal makes it false.
    negated: u64,
}

impl StepChain {
    /// A runner for some columns of a setup, if it is made for them.
    pub fn of(setup: &Setup, columns: &[usize]) -> Option<Self> {
        let chain = setup.program.processes.chain().filter(|_| fits(setup, columns))?;
        let clock = setup.program.scenario.clock;
        let flat = |column: &usize| {
            let Root::Formula(root) = setup.columns[*column] else { return None };
            Flat::of(&setup.tree, root, setup.horizon, clock)
        };
        let mut flats = columns.iter().map(flat).collect::<Option<Vec<Flat>>>()?;
        let sort = |k: usize, atoms: &[bool], signals: &[f64]| flats[k].sort(atoms, signals);
        let mut sorts = Sorts::of(setup, columns, &chain.space, sort);
        for &state in chain.space.reachable() {
            sorts[state as usize].stop |= if chain.is_still(state) { STILL } else { 0 };
        }
        // A column that the first state decides needs no steps.
        let first = sorts[chain.space.initial() as usize];
        let waits = |(k, flat): (usize, &Flat)| flat.verdict(first.sort(k), 0).is_none();
        let some = |bits: u64, class: u8| if bits == 0 { 0 } else { class };
        let class = |sorts: &Sorts| ANY | some(sorts.goal, GOAL) | some(sorts.stop, STOP);
        let classes = sorts.iter().map(class).collect();
        flats.iter().enumerate().all(waits).then(|| Self {
            flats,
            sorts,
            classes,
            trials: None,
            open: Vec::new(),
            rounds: 0,
            steps: 0,
        })
    }

    /// Runs the trials of a block; the budget may say stop, then unfinished ones are dropped.
    pub fn run(&mut self, setup: &Setup, seed: u64, block: &mut Block<'_>, budget: &Budget) {
        let Some(chain) = setup.program.processes.chain() else { return };
        let trials = batch(&mut self.trials, seed, StepBatch::new);
        chain.begin(trials, block.items.iter().map(|item| item.index));
        let all = STILL | (STILL - 1) >> (MOST_COLUMNS - self.flats.len());
        self.open.clear();
        self.open.resize(block.items.len(), all);
        let columns = |is: &dyn Fn(&Flat) -> bool| {
            self.flats.iter().enumerate().map(|(k, flat)| u64::from(is(flat)) << k).sum::<u64>()
        };
        let negated = columns(&Flat::is_negated);
        while !trials.is_empty() {
            if is_cut(budget, self.rounds, STEPS_BETWEEN_LOOKS) {
                return;
            }
            self.rounds += 1;
            self.steps += trials.len() as u64;
            chain.step(trials);
            // From here on it is the same tick for all.
            let tick = trials.tick();
            let (begun, over) = (columns(&|flat| flat.has_begun(tick)), columns(&|flat| flat.is_over(tick)));
            let present = AtTick { tick, begun, over, negated };
            let watch = match (over, begun) {
                (0, 0) => STOP,
                (0, _) => STOP | GOAL,
                _ => ANY,
            };
            let (flats, sorts, open) = (&self.flats[..], &self.sorts[..], &mut self.open[..]);
            let width = flats.len();
            for k in 0..trials.sift(&self.classes, watch) {
                let (slot, state) = trials.sifted(k);
                let place = slot as usize;
                let row = &mut block.cells[place * width..][..width];
                let (left, skipped) = present.settle(flats, sorts[state as usize], open[place], row);
                self.steps += skipped;
                if left > STILL {
                    open[place] = left;
                    trials.put_back((slot, state), block.items[place].index);
                } else {
                    block.finished[place] = true;
                }
            }
        }
    }
}

impl AtTick {
    /// Fills the cells of the columns that a state decides. Which columns are open after it, and how many steps were
    /// left out.
    #[inline]
    fn settle(&self, flats: &[Flat], sorts: Sorts, open: u64, row: &mut [Cell]) -> (u64, u64) {
        let reached = sorts.goal & self.begun;
        let fresh = (reached | sorts.stop | self.over) & open;
        let left = open & !fresh;
        for k in bits(fresh & !STILL) {
            let reading = Reading::Truth((reached ^ self.negated) >> k & 1 == 1);
            row[k] = Cell { reading, steps: self.tick, ..Cell::BLANK };
        }
        if left & STILL != 0 || left == 0 {
            return (left, 0);
        }
        // A state that is never left decides the others at ticks that are known.
        let mut last = self.tick;
        for k in bits(left) {
            let (flat, sort) = (&flats[k], sorts.sort(k));
            let at = flat.settled(sort, self.tick);
            let reading = Reading::Truth(flat.verdict(sort, at) == Some(true));
            row[k] = Cell { reading, steps: at, ..Cell::BLANK };
            last = last.max(at);
        }
        (0, last - self.tick)
    }
}

/// Trials on the chain of jumps of one process.
pub struct JumpChain {
    glances: Vec<Glance>,
    /// By state.
    sorts: Vec<Sorts>,
    trials: Option<(u64, JumpBatch)>,
    /// Of each trial that goes on: its place in the block, and the columns that are open.
    open: Vec<(u32, u64)>,
    rounds: u64,
    /// Jumps made, of all trials.
    pub steps: u64,
}

impl JumpChain {
    /// A runner for some columns of a setup, if it is made for them.
    pub fn of(setup: &Setup, columns: &[usize]) -> Option<Self> {
        let chain = setup.program.processes.embedded().filter(|_| fits(setup, columns))?;
        let glance = |column: &usize| setup.signal_monitor(*column).ok()?.glance();
        let mut glances = columns.iter().map(glance).collect::<Option<Vec<Glance>>>()?;
        let sort = |k: usize, atoms: &[bool], signals: &[f64]| glances[k].sort(atoms, signals);
        let sorts = Sorts::of(setup, columns, &chain.space, sort);
        Some(Self { glances, sorts, trials: None, open: Vec::new(), rounds: 0, steps: 0 })
    }

    /// Runs the trials of a block; the budget may say stop, then unfinished ones are dropped.
    pub fn run(&mut self, setup: &Setup, seed: u64, block: &mut Block<'_>, budget: &Budget) {
        let Some(chain) = setup.program.processes.embedded() else { return };
        let trials = batch(&mut self.trials, seed, JumpBatch::new);
        chain.begin(trials, block.items.iter().map(|item| item.index));
        let width = self.glances.len();
        let all = (STILL - 1) >> (MOST_COLUMNS - width);
        self.open.clear();
        self.open.extend((0..block.items.len() as u32).map(|slot| (slot, all)));
        let quiet = self.glances.iter().map(Glance::quiet_until).fold(f64::INFINITY, f64::min);
        while !trials.is_empty() {
            if is_cut(budget, self.rounds, JUMPS_BETWEEN_LOOKS) {
                return;
            }
            self.rounds += 1;
            let before = trials.jumps();
            let exhausted = before + 1 >= setup.most_jumps;
            let mut kept = 0;
            let (open, sorts, glances) = (&mut self.open[..], &self.sorts[..], &self.glances[..]);
            self.steps += chain.jump(trials, |place, stay| {
                let (slot, mut left) = open[place];
                // A state that lasts no time is as if it had not been.
                let (judged, sorts) = (stay.end > stay.since, sorts[stay.state as usize]);
                if exhausted || judged && ((sorts.goal | sorts.stop) & left != 0 || stay.end > quiet) {
                    let jumps = before + u64::from(stay.end < f64::INFINITY);
                    let found = EndedStay { sorts, stay, jumps };
                    let row = &mut block.cells[slot as usize * width..][..width];
                    left = found.settle(glances, left, row, exhausted);
                    if left == 0 {
                        block.finished[slot as usize] = true;
                    }
                }
                open[kept] = (slot, left);
                kept += usize::from(left != 0 && stay.end < f64::INFINITY);
                left != 0
            });
        }
    }
}

/// A stay that may decide something.
struct EndedStay {
    /// What its state is for the columns.
    sorts: Sorts,
    stay: Stay,
    /// Jumps made when it is judged.
    jumps: u64,
}

impl EndedStay {
    /// Fills the cells of the columns that it decides; those that are open after it. A trial that has made too many
    /// jumps is unresolved in what is left.
    #[inline]
    fn settle(&self, glances: &[Glance], open: u64, row: &mut [Cell], exhausted: bool) -> u64 {
        let mut left = open;
        for (k, (glance, cell)) in glances.iter().zip(row).enumerate() {
            if open >> k & 1 == 0 {
                continue;
            }
            let judged = self.stay.end > self.stay.since;
            let verdict =
                glance.verdict(self.sorts.sort(k), self.stay.since, self.stay.end).filter(|_| judged);
            let reading = match verdict {
                Some(truth) => Reading::Truth(truth),
                None if exhausted => Reading::Unresolved,
                None => continue,
            };
            *cell = Cell { reading, steps: self.jumps, ..Cell::BLANK };
            left &= !(1 << k);
        }
        left
    }
}

/// The bits of a set, ascending.
#[inline]
fn bits(set: u64) -> impl Iterator<Item = usize> {
    std::iter::successors((set != 0).then_some(set), |left| {
        let left = left & (left - 1);
        (left != 0).then_some(left)
    })
    .map(|left| left.trailing_zeros() as usize)
}
