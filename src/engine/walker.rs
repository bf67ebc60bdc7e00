//! A worker for small finite chains: what a worker does, with all that can be known beforehand.
//!
//! It takes columns that are flat formulas over the variables of processes that form one chain. Then a step is a
//! step of the chain, and a monitor a look at the sort of the state. Cells are those of the general worker, to the
//! last bit; what does not fit is left to that worker.

use super::budget::Budget;
use super::cell::{Cell, Item, Reading};
use super::subject::Subject;
use super::worker::Finished;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::TrialKey;
use crate::compile::study::Root;
use crate::kernel::process::{Chain, Walk};
use crate::kernel::{Readings, State};
use crate::logic::{Flat, Present, Sort};

/// Steps between two looks at the clock.
const CLOCK_EVERY: u32 = 256;

/// A column: its formula, and what each state is for it.
struct Glance {
    flat: Flat,
    sorts: Vec<Sort>,
    /// Lanes in which it is open.
    open: Mask,
}

/// Eight lanes on a chain.
pub(super) struct Walker {
    columns: Vec<usize>,
    glances: Vec<Glance>,
    /// Places of the items of the lanes in the request.
    places: [usize; LANES],
    /// Steps made, of all lanes.
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
        if program.scenario.clock.is_jumps() || columns.is_empty() || !subject.reads_variables_only(columns) {
            return None;
        }
        let mut glances = Vec::new();
        for &column in columns {
            let Root::Formula(root) = subject.columns[column] else { return None };
            let flat = Flat::of(&subject.tree, root, subject.horizon, program.scenario.clock)?;
            let sorts = vec![Sort { hold: false, goal: false }; chain.states()];
            glances.push(Glance { flat, sorts, open: Mask::NONE });
        }
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
            for (lane, &place) in eight.iter().enumerate() {
                for glance in &mut glances {
                    glance.sorts[place as usize] = glance.flat.sort(&subject.tree, &Lane(&readings, lane));
                }
            }
        }
        // A column that the first state decides needs no walk.
        let first = chain.initial() as usize;
        let waits = glances.iter().all(|glance| glance.flat.verdict(glance.sorts[first], 0).is_none());
        waits.then(|| Self { columns: columns.to_vec(), glances, places: [0; LANES], steps: 0 })
    }

    /// Whether it observes just these columns.
    pub(super) fn serves(&self, columns: &[usize]) -> bool {
        self.columns == columns
    }

    /// Runs items until `next` gives no more, or the budget says stop; then unfinished trials are dropped.
    pub(super) fn run(
        &mut self,
        subject: &Subject,
        seed: u64,
        next: &mut dyn FnMut() -> Option<(usize, Item)>,
        budget: &Budget,
    ) -> Finished {
        let mut finished = Finished::default();
        let Some(chain) = subject.program.processes.chain() else { return finished };
        let width = self.columns.len();
        let mut cells = vec![Cell::BLANK; LANES * width];
        let mut walk = chain.walk(seed);
        let mut occupied = Mask::NONE;
        let mut rounds = 0u32;
        for glance in &mut self.glances {
            glance.open = Mask::NONE;
        }
        for lane in 0..LANES {
            occupied |= self.load(chain, &mut walk, lane, seed, next);
        }
        while !occupied.is_empty() {
            rounds = rounds.wrapping_add(1);
            if budget.is_interrupted() || (rounds.is_multiple_of(CLOCK_EVERY) && budget.is_over()) {
                return finished;
            }
            self.steps += u64::from(occupied.0.count_ones());
            chain.step(&mut walk);
            let ended = self.look(&walk, &mut cells) & occupied;
            for lane in ended.iter() {
                finished.push(self.places[lane], &cells[lane * width..][..width]);
                occupied &= !Mask::lane(lane);
                occupied |= self.load(chain, &mut walk, lane, seed, next);
            }
        }
        finished
    }

    /// Gives a lane its next trial; the lane, if there was one.
    #[inline]
    fn load(
        &mut self,
        chain: &Chain,
        walk: &mut Walk,
        lane: usize,
        seed: u64,
        next: &mut dyn FnMut() -> Option<(usize, Item)>,
    ) -> Mask {
        let Some((place, item)) = next() else { return Mask::NONE };
        chain.load(walk, lane, TrialKey { seed, index: item.index, branch: 0 });
        self.places[lane] = place;
        for glance in &mut self.glances {
            glance.open |= Mask::lane(lane);
        }
        Mask::lane(lane)
    }

    /// Looks at the present states; the lanes in which no column is open.
    #[inline]
    fn look(&mut self, walk: &Walk, cells: &mut [Cell]) -> Mask {
        let width = self.columns.len();
        let mut open = Mask::NONE;
        for (column, glance) in self.glances.iter_mut().enumerate() {
            let (mut decided, mut truth) = (0u8, 0u8);
            for lane in 0..LANES {
                let sort = glance.sorts[walk.states[lane] as usize];
                let verdict = glance.flat.verdict(sort, walk.ticks[lane]);
                decided |= u8::from(verdict.is_some()) << lane;
                truth |= u8::from(verdict == Some(true)) << lane;
            }
            let fresh = Mask(decided) & glance.open;
            glance.open &= !fresh;
            for lane in fresh.iter() {
                let reading = Reading::Truth(Mask(truth).has(lane));
                cells[lane * width + column] = Cell { reading, steps: walk.ticks[lane], ..Cell::BLANK };
            }
            open |= glance.open;
        }
        !open
    }
}

#[cfg(test)]
mod tests;
