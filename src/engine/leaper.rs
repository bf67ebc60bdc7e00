//! A worker for one small process in continuous time: what a jumper does, with all that can be known beforehand.
//!
//! It takes columns that are one until (or F, G, W) over the variables of a process that has few states. What a state
//! is for a column is known beforehand, and verdicts fall by the rule of the general monitor. Trials of a block jump
//! together, each time all of them. Cells are those of the jumper, to the last bit; what does not fit is left to it.

use super::budget::Budget;
use super::cell::{Block, Cell, Reading};
use super::subject::Subject;
use crate::base::lanes::Lanes;
use crate::kernel::State;
use crate::kernel::process::{Leaps, Sight, Stay};
use crate::logic::{Glance, Sort};

/// Rounds of jumps between two looks at the clock.
const CLOCK_EVERY: u64 = 64;
/// Most columns.
const MOST_COLUMNS: usize = 64;

/// Trials of one process.
pub(super) struct Leaper {
    glances: Vec<Glance>,
    /// What each state is for the columns, state by state.
    sorts: Vec<Sort>,
    /// The columns for which a state may decide before all time is over, bit k for the k-th.
    stirs: Vec<u64>,
    leaps: Option<(u64, Leaps)>,
    /// Of each trial on its way: its place in the block, and the columns that are open.
    open: Vec<(u32, u64)>,
    rounds: u64,
    /// Jumps made, of all trials.
    pub(super) steps: u64,
}

impl Leaper {
    /// A worker for some columns of a subject, if it is made for them.
    pub(super) fn of(subject: &Subject, columns: &[usize]) -> Option<Self> {
        let chain = subject.program.processes.embedded()?;
        let few = (1..=MOST_COLUMNS).contains(&columns.len());
        if !few || !subject.reads_variables_only(columns) {
            return None;
        }
        let mut glances = Vec::new();
        for &column in columns {
            glances.push(subject.signal_monitor(column).ok()?.glance()?);
        }
        let width = columns.len();
        let mut sorts = vec![Sort { hold: true, goal: false }; chain.states() * width];
        let mut stirs = vec![0; chain.states()];
        let view = subject.view(columns);
        let mut state = State::new(subject.program.layout, 0);
        state.variables = vec![Lanes::ZERO; subject.program.scenario.processes.variables.len()];
        let mut sight = Sight::default();
        for &place in chain.reachable() {
            chain.values(place, &mut state.variables, 0);
            view.look(&state, &mut sight);
            let (atoms, signals) = view.of(&state, &mut sight, 0);
            for (k, glance) in glances.iter_mut().enumerate() {
                let sort = glance.sort(atoms, signals);
                sorts[place as usize * width + k] = sort;
                stirs[place as usize] |= u64::from(sort.goal || !sort.hold) << k;
            }
        }
        Some(Self { glances, sorts, stirs, leaps: None, open: Vec::new(), rounds: 0, steps: 0 })
    }

    /// Runs the trials of a block; the budget may say stop, then unfinished ones are dropped.
    pub(super) fn run(&mut self, subject: &Subject, seed: u64, block: &mut Block<'_>, budget: &Budget) {
        let Some(chain) = subject.program.processes.embedded() else { return };
        let leaps = match self.leaps.take() {
            Some((old, leaps)) if old == seed => leaps,
            _ => chain.leaps(seed),
        };
        let (_, leaps) = self.leaps.insert((seed, leaps));
        chain.begin(leaps, block.items.iter().map(|item| item.index));
        let width = self.glances.len();
        let all = u64::MAX >> (MOST_COLUMNS - width);
        self.open.clear();
        self.open.extend((0..block.items.len() as u32).map(|slot| (slot, all)));
        let quiet = self.glances.iter().map(Glance::quiet_until).fold(f64::INFINITY, f64::min);
        while !leaps.is_empty() {
            if budget.is_interrupted() || (self.rounds.is_multiple_of(CLOCK_EVERY) && budget.is_over()) {
                return;
            }
            self.rounds += 1;
            let before = leaps.jumps();
            let exhausted = before + 1 >= subject.most_jumps;
            let mut kept = 0;
            let (open, stirs, sorts, glances) =
                (&mut self.open[..], &self.stirs[..], &self.sorts[..], &self.glances[..]);
            self.steps += chain.jump(leaps, |place, stay| {
                let (slot, mut left) = open[place];
                // A state that lasts no time is as if it had not been.
                let judged = stay.end > stay.since;
                if exhausted || judged && (stirs[stay.state as usize] & left != 0 || stay.end > quiet) {
                    let jumps = before + u64::from(stay.end < f64::INFINITY);
                    let found = Found { sorts: &sorts[stay.state as usize * width..][..width], stay, jumps };
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
struct Found<'s> {
    /// What its state is for the columns.
    sorts: &'s [Sort],
    stay: Stay,
    /// Jumps made when it is judged.
    jumps: u64,
}

impl Found<'_> {
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
            let verdict = glance.verdict(self.sorts[k], self.stay.since, self.stay.end).filter(|_| judged);
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

#[cfg(test)]
mod tests;
