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
use crate::logic::{Flat, Present, Sort};

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

/// What a trial came to at a step: its place in the block, its state, the columns that were open, and those of them
/// that are decided now.
#[derive(Clone, Copy, Debug, Default)]
struct Event {
    slot: u32,
    state: u32,
    open: u64,
    fresh: u64,
}

/// Trials on a chain.
pub(super) struct Walker {
    columns: Vec<usize>,
    flats: Vec<Flat>,
    /// By state.
    sorts: Vec<Sorts>,
    walk: Option<(u64, Walk)>,
    /// Of each trial on its way: its place in the block, and the columns that are open.
    open: Vec<(u32, u64)>,
    /// What happened at a step.
    events: Vec<Event>,
    rounds: u64,
    /// Steps made, of all trials; those too that lead nowhere and were left out.
    pub(super) steps: u64,
}

/// One lane of what was read.
struct Lane<'r>(&'r Readings, usize);

impl Present for Lane<'_> {
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
        flats.iter().enumerate().all(waits).then(|| Self {
            columns: columns.to_vec(),
            flats,
            sorts,
            walk: None,
            open: Vec::new(),
            events: Vec::new(),
            rounds: 0,
            steps: 0,
        })
    }

    /// Whether it observes just these columns.
    pub(super) fn serves(&self, columns: &[usize]) -> bool {
        self.columns == columns
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
        let all = STILL | (STILL - 1) >> (MOST_COLUMNS - self.columns.len());
        self.open.clear();
        self.open.extend((0..block.items.len() as u32).map(|slot| (slot, all)));
        self.events.resize(block.items.len(), Event::default());
        while !walk.is_empty() {
            if budget.is_interrupted() || (self.rounds.is_multiple_of(CLOCK_EVERY) && budget.is_over()) {
                return;
            }
            self.rounds += 1;
            self.steps += walk.len() as u64;
            chain.step(walk);
            let tick = walk.tick();
            // From here on it is the same tick for all.
            let columns = |is: &dyn Fn(&Flat) -> bool| {
                self.flats.iter().enumerate().map(|(k, flat)| u64::from(is(flat)) << k).sum::<u64>()
            };
            let (begun, over) = (columns(&|flat| flat.has_begun(tick)), columns(&|flat| flat.is_over(tick)));
            let (open, events, sorts) = (&mut self.open[..], &mut self.events[..], &self.sorts[..]);
            let (mut kept, mut happened) = (0, 0);
            walk.retain(|place, state| {
                let (slot, before) = open[place];
                let sorts = sorts[state as usize];
                let fresh = (sorts.goal & begun | sorts.stop | over) & before;
                let left = before & !fresh;
                open[kept] = (slot, left);
                events[happened] = Event { slot, state, open: before, fresh };
                happened += usize::from(fresh != 0);
                // Some column is open, and the trial may leave its state.
                let stays = left > STILL;
                kept += usize::from(stays);
                stays
            });
            for k in 0..happened {
                let event = self.events[k];
                self.steps += settle(&self.flats, self.sorts[event.state as usize], event, tick, block);
            }
        }
    }
}

impl Sorts {
    /// What the state is for one column.
    #[inline(always)]
    fn sort(self, column: usize) -> Sort {
        Sort { hold: self.stop >> column & 1 == 0, goal: self.goal >> column & 1 == 1 }
    }
}

/// Fills the cells of the columns that are decided at a tick; how many steps were left out.
#[inline]
fn settle(flats: &[Flat], sorts: Sorts, event: Event, tick: u64, block: &mut Block<'_>) -> u64 {
    let still = event.fresh & STILL != 0;
    let decided = if still { event.open } else { event.fresh };
    let mut last = tick;
    let row = &mut block.cells[event.slot as usize * flats.len()..][..flats.len()];
    for (k, (flat, cell)) in flats.iter().zip(row).enumerate() {
        if decided >> k & 1 == 1 {
            // A state that is never left decides at a tick that is known.
            let at = if event.fresh >> k & 1 == 1 { tick } else { flat.settled(sorts.sort(k), tick) };
            let truth = flat.verdict(sorts.sort(k), at) == Some(true);
            *cell = Cell { reading: Reading::Truth(truth), steps: at, ..Cell::BLANK };
            last = last.max(at);
        }
    }
    if still || event.open & !event.fresh == STILL {
        block.finished[event.slot as usize] = true;
    }
    last - tick
}

#[cfg(test)]
pub(super) mod tests;
