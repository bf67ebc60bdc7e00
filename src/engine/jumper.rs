//! A worker in continuous time: a batch of lanes that runs one trial after the other, from jump to jump.
//!
//! A state is judged when the next one comes, because one that lasts no time is as if it had not been; so a
//! decision shows at the first jump after it, or at the horizon. A lane whose monitors have decided takes the next trial.

use super::budget::Budget;
use super::cell::{Cell, Item, Reading};
use super::onlooker::Onlooker;
use super::subject::Subject;
use super::worker::Finished;
use crate::base::lanes::{LANES, Mask};
use crate::base::random::TrialKey;
use crate::kernel::process::{Sight, View};
use crate::kernel::{Scratch, State, dynamics, start};
use crate::logic::Invalid;

/// Rounds between two looks at the clock.
const CLOCK_EVERY: u32 = 256;

/// A batch of lanes with the monitors of some columns.
pub(super) struct Jumper {
    columns: Vec<usize>,
    state: State,
    scratch: Scratch,
    view: View,
    sight: Sight,
    /// Lane by lane, one a column.
    monitors: Vec<Onlooker>,
    /// The place of the item that each lane is busy with.
    busy: [Option<usize>; LANES],
    /// Columns that are not decided in each lane.
    open: [usize; LANES],
    /// Most jumps of a trial.
    most: u64,
    /// Jumps made, of all lanes.
    pub(super) steps: u64,
}

impl Jumper {
    /// A worker for some columns of a subject.
    pub(super) fn new(subject: &Subject, columns: &[usize]) -> Result<Self, Invalid> {
        let mut one = Vec::with_capacity(columns.len());
        for &column in columns {
            one.push(Onlooker::of(subject, column)?);
        }
        Ok(Self {
            columns: columns.to_vec(),
            state: State::new(subject.program.layout, 0),
            scratch: Scratch::new(),
            view: subject.view(columns),
            sight: Sight::default(),
            monitors: (0..LANES).flat_map(|_| one.iter().cloned()).collect(),
            busy: [None; LANES],
            open: [0; LANES],
            most: subject.most_jumps,
            steps: 0,
        })
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
        let program = &subject.program;
        let width = self.columns.len();
        let mut finished = Finished::default();
        let mut cells = vec![Cell::BLANK; LANES * width];
        let mut rounds = 0u32;
        let mut exhausted = false;
        loop {
            let mut loaded = Mask::NONE;
            for lane in 0..LANES {
                while self.busy[lane].is_none() && !exhausted {
                    let Some((place, item)) = next() else {
                        exhausted = true;
                        break;
                    };
                    let key = TrialKey { seed, index: item.index, branch: 0 };
                    if start::load(program, &mut self.state, lane, key, item.advice).is_err() {
                        // A trial that cannot start is unresolved in every column.
                        finished.push(place, &vec![Cell::BLANK; width]);
                        continue;
                    }
                    cells[lane * width..][..width].fill(Cell::OPEN);
                    self.busy[lane] = Some(place);
                    self.open[lane] = width;
                    loaded |= Mask::lane(lane);
                }
            }
            if !loaded.is_empty() {
                self.view.look(&self.state, &mut self.sight);
                for lane in loaded.iter() {
                    let (atoms, signals) = self.view.of(&self.state, &mut self.sight, lane);
                    for monitor in &mut self.monitors[lane * width..][..width] {
                        monitor.start();
                        monitor.jump(0.0, atoms, signals);
                    }
                }
            }
            if self.state.occupied.is_empty() {
                return finished;
            }
            let jumped = dynamics::jump(program, &mut self.state, &mut self.scratch);
            self.steps += u64::from(jumped.0.count_ones());
            self.view.look(&self.state, &mut self.sight);
            for lane in self.state.occupied.iter() {
                let row = &mut cells[lane * width..][..width];
                self.observe(lane, jumped.has(lane), row);
                if self.open[lane] == 0
                    && let Some(place) = self.busy[lane].take()
                {
                    finished.push(place, row);
                    self.state.occupied &= !Mask::lane(lane);
                }
            }
            rounds += 1;
            if budget.is_interrupted() || (rounds.is_multiple_of(CLOCK_EVERY) && budget.is_over()) {
                for (lane, busy) in self.busy.iter_mut().enumerate() {
                    let row = &cells[lane * width..][..width];
                    finished.cut.extend(busy.take().map(|place| (place, row.to_vec())));
                }
                self.state.occupied = Mask::NONE;
                return finished;
            }
        }
    }

    /// Shows the state of a lane to its monitors and fills the cells of those that are decided.
    #[inline]
    fn observe(&mut self, lane: usize, jumped: bool, row: &mut [Cell]) {
        let width = row.len();
        let faulty = self.state.faulty.has(lane);
        let (now, jumps) = (self.state.clocks.instant(lane), self.state.clocks.jumps[lane]);
        let (atoms, signals) = self.view.of(&self.state, &mut self.sight, lane);
        let monitors = &mut self.monitors[lane * width..][..width];
        for (monitor, cell) in monitors.iter_mut().zip(row) {
            if !cell.is_open() {
                continue;
            }
            let found = match (jumped || faulty, faulty) {
                (true, false) => match monitor.jump(now, atoms, signals) {
                    None if jumps < self.most => continue,
                    None => Reading::Unresolved,
                    Some(reading) => reading,
                },
                // What was decided before the error stays decided.
                (_, true) => monitor.jump(now, atoms, signals).unwrap_or(Reading::Faulty),
                (false, false) => monitor.finish(),
            };
            *cell = Cell { reading: found, steps: jumps, triggered: monitor.triggered(), shrunk: false };
            self.open[lane] -= 1;
        }
    }
}
