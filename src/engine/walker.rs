//! A worker for small finite chains: what a worker does, with all that can be known beforehand.
//!
//! It takes columns that are flat formulas over the variables of processes that form one chain. Then a step is a
//! step of the chain, and a monitor a look at the sort of the state. All trials of a block walk together, so that
//! what depends on the tick is the same for all, and those that are decided drop out. Cells are those of the general
//! worker, to the last bit; what does not fit is left to that worker.

use super::budget::Budget;
use super::cell::{Block, Cell, Reading};
use super::subject::Subject;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::compile::study::Root;
use crate::kernel::process::Walk;
use crate::kernel::{Readings, State};
use crate::logic::flat::Present as Reads;
use crate::logic::{Flat, Sort};

/// Steps between two looks at the clock.
const CLOCK_EVERY: u64 = 256;

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

/// The classes of states, to find quickly where something may be decided: some goal is reached, some column stops,
/// and any.
const GOAL: u8 = 1;
const STOP: u8 = 2;
const ANY: u8 = 4;

/// Trials on a chain.
pub(super) struct Walker {
    flats: Vec<Flat>,
    /// By state.
    sorts: Vec<Sorts>,
    classes: Vec<u8>,
    walk: Option<(u64, Walk)>,
    /// The columns that are open, by place in the block.
    open: Vec<u64>,
    rounds: u64,
    /// Steps made, of all trials; those too that lead nowhere and were left out.
    pub(super) steps: u64,
}

/// The present tick for the columns, bit k for the k-th of them.
struct Present {
    tick: u64,
    /// The goal counts.
    begun: u64,
    /// Nothing counts after it.
    over: u64,
    /// To reach the goal makes it false.
    negated: u64,
}

/// One lane of what was read.
struct Lane<'r>(&'r Readings, usize);

impl Reads for Lane<'_> {
    fn atom(&self, atom: usize) -> bool {
        self.0.atoms.get(atom).is_some_and(|lanes| lanes.has(self.1))
    }

    fn signal(&self, signal: usize) -> f64 {
        self.0.signals.get(signal).map_or(f64::NAN, |lanes| lanes.0[self.1])
    }
}

impl Walker {
    /// A worker for some columns of a subject, if it is made for them.
    pub(super) fn of(subject: &Subject, columns: &[usize]) -> Option<Self> {
        let program = &subject.program;
        let chain = program.processes.chain()?;
        let few = (1..=MOST_COLUMNS).contains(&columns.len());
        if program.scenario.clock.is_jumps() || !few || !subject.reads_variables_only(columns) {
            return None;
        }
        let mut flats = Vec::new();
        for &column in columns {
            let Root::Formula(root) = subject.columns[column] else { return None };
            flats.push(Flat::of(&subject.tree, root, subject.horizon, program.scenario.clock)?);
        }
        let mut sorts = vec![Sorts::default(); chain.states()];
        let code = subject.code(columns);
        let mut state = State::new(program.layout, 0);
        state.occupied = Mask::ALL;
        state.variables = vec![Lanes::ZERO; program.scenario.processes.variables.len()];
        let mut readings = Readings::default();
        for eight in chain.reachable().chunks(LANES) {
            for lane in 0..LANES {
                chain.values(eight[lane.min(eight.len() - 1)], &mut state.variables, lane);
            }
            code.run(program, &state, &mut readings);
            if !readings.unresolved.is_empty() {
                return None;
            }
            for (lane, &state) in eight.iter().enumerate() {
                let sorts = &mut sorts[state as usize];
                for (k, flat) in flats.iter().enumerate() {
                    let sort = flat.sort(&subject.tree, &Lane(&readings, lane));
                    sorts.goal |= u64::from(sort.goal) << k;
                    sorts.stop |= u64::from(!sort.hold) << k;
                }
                sorts.stop |= if chain.is_still(state) { STILL } else { 0 };
            }
        }
        // A column that the first state decides needs no walk.
        let first = sorts[chain.initial() as usize];
        let waits = |(k, flat): (usize, &Flat)| flat.verdict(first.sort(k), 0).is_none();
        let some = |bits: u64, class: u8| if bits == 0 { 0 } else { class };
        let class = |sorts: &Sorts| ANY | some(sorts.goal, GOAL) | some(sorts.stop, STOP);
        let classes = sorts.iter().map(class).collect();
        flats.iter().enumerate().all(waits).then(|| Self {
            flats,
            sorts,
            classes,
            walk: None,
            open: Vec::new(),
            rounds: 0,
            steps: 0,
        })
    }

    /// Runs the trials of a block; the budget may say stop, then unfinished ones are dropped.
    pub(super) fn run(&mut self, subject: &Subject, seed: u64, block: &mut Block<'_>, budget: &Budget) {
        let Some(chain) = subject.program.processes.chain() else { return };
        let walk = match self.walk.take() {
            Some((old, walk)) if old == seed => walk,
            _ => chain.walk(seed),
        };
        let (_, walk) = self.walk.insert((seed, walk));
        chain.begin(walk, block.items.iter().map(|item| item.index));
        let all = STILL | (STILL - 1) >> (MOST_COLUMNS - self.flats.len());
        self.open.clear();
        self.open.resize(block.items.len(), all);
        let columns = |is: &dyn Fn(&Flat) -> bool| {
            self.flats.iter().enumerate().map(|(k, flat)| u64::from(is(flat)) << k).sum::<u64>()
        };
        let negated = columns(&Flat::is_negated);
        while !walk.is_empty() {
            if budget.is_interrupted() || (self.rounds.is_multiple_of(CLOCK_EVERY) && budget.is_over()) {
                return;
            }
            self.rounds += 1;
            self.steps += walk.len() as u64;
            chain.step(walk);
            // From here on it is the same tick for all.
            let tick = walk.tick();
            let (begun, over) = (columns(&|flat| flat.has_begun(tick)), columns(&|flat| flat.is_over(tick)));
            let present = Present { tick, begun, over, negated };
            let watch = match (over, begun) {
                (0, 0) => STOP,
                (0, _) => STOP | GOAL,
                _ => ANY,
            };
            let (flats, sorts, open) = (&self.flats[..], &self.sorts[..], &mut self.open[..]);
            let width = flats.len();
            for k in 0..walk.sift(&self.classes, watch) {
                let (slot, state) = walk.sifted(k);
                let place = slot as usize;
                let row = &mut block.cells[place * width..][..width];
                let (left, skipped) = present.settle(flats, sorts[state as usize], open[place], row);
                self.steps += skipped;
                if left > STILL {
                    open[place] = left;
                    walk.put_back((slot, state), block.items[place].index);
                } else {
                    block.finished[place] = true;
                }
            }
        }
    }
}

impl Present {
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

/// The bits of a set, ascending.
#[inline]
fn bits(set: u64) -> impl Iterator<Item = usize> {
    std::iter::successors((set != 0).then_some(set), |left| {
        let left = left & (left - 1);
        (left != 0).then_some(left)
    })
    .map(|left| left.trailing_zeros() as usize)
}

impl Sorts {
    /// What the state is for one column.
    #[inline(always)]
    fn sort(self, column: usize) -> Sort {
        Sort { hold: self.stop >> column & 1 == 0, goal: self.goal >> column & 1 == 1 }
    }
}

#[cfg(test)]
pub(super) mod tests;
