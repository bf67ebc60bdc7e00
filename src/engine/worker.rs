//! A worker: a batch of lanes that runs one trial after the other.
//!
//! A lane whose monitors have decided takes the next trial while the others go on (rule 3: stop early).

use super::budget::{Budget, steps_between_looks};
use super::cell::{Cell, Item, Reading};
use super::subject::{Sheet, Subject};
use crate::base::lanes::{LANES, Mask};
use crate::base::random::TrialKey;
use crate::kernel::{Readings, Scratch, State, dynamics, start};
use crate::logic::Invalid;

/// What a lane is busy with.
#[derive(Clone, Copy, Debug)]
struct Busy {
    /// Place of the item in the request.
    place: usize,
    /// Whether radii were shrunk at its start.
    shrunk: bool,
    /// Columns not decided yet.
    open: usize,
}

/// A batch of lanes with the monitors of some columns.
pub(super) struct Worker {
    columns: Vec<usize>,
    state: State,
    scratch: Scratch,
    sheets: Vec<Sheet>,
    readings: Vec<Readings>,
    busy: [Option<Busy>; LANES],
    /// For each column, the lanes in which it is decided.
    settled: Vec<Mask>,
    /// Steps made, of all lanes.
    pub(super) steps: u64,
}

/// Finished trials: the places of their items, and for each as many cells as there are columns.
#[derive(Debug, Default)]
pub(super) struct Finished {
    /// Places of the items.
    pub(super) places: Vec<usize>,
    /// The cells, trial by trial.
    pub(super) cells: Vec<Cell>,
    /// Trials that were cut: the place of each item, and its cells.
    pub(super) cut: Vec<(usize, Vec<Cell>)>,
}

impl Finished {
    pub(super) fn push(&mut self, place: usize, cells: &[Cell]) {
        self.places.push(place);
        self.cells.extend_from_slice(cells);
    }
}

impl Worker {
    /// A worker for some columns of a subject.
    pub(super) fn new(subject: &Subject, columns: &[usize]) -> Result<Self, Invalid> {
        let sheets = subject.sheets(columns)?;
        let program = &subject.program;
        Ok(Self {
            columns: columns.to_vec(),
            state: State::new(program.layout, program.scenario.agents.len()),
            scratch: Scratch::new(),
            readings: sheets.iter().map(|_| Readings::default()).collect(),
            sheets,
            busy: [None; LANES],
            settled: vec![Mask::NONE; columns.len()],
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
        let mut finished = Finished::default();
        let width = self.columns.len();
        // Lane by lane, one cell a column.
        let mut cells = vec![Cell::BLANK; LANES * width];
        let mut exhausted = false;
        let (mut rounds, clock_every) = (0u32, steps_between_looks(program.scenario.agents.len()));
        loop {
            if !exhausted {
                let mut loaded = Mask::NONE;
                for lane in 0..self.state.width() {
                    while self.busy[lane].is_none() && !exhausted {
                        let Some((place, item)) = next() else {
                            exhausted = true;
                            break;
                        };
                        let key = TrialKey { seed, index: item.index, branch: 0 };
                        let shrunk = match start::load(program, &mut self.state, lane, key, item.advice) {
                            Ok(start) => !start.shrunk.is_empty(),
                            Err(_) => {
                                // A trial that cannot start is unresolved in every column.
                                finished.places.push(place);
                                finished.cells.resize(finished.cells.len() + width, Cell::BLANK);
                                continue;
                            }
                        };
                        cells[lane * width..][..width].fill(Cell { shrunk, ..Cell::BLANK });
                        self.busy[lane] = Some(Busy { place, shrunk, open: width });
                        loaded |= Mask::lane(lane);
                        for sheet in &mut self.sheets {
                            for observer in &mut sheet.observers {
                                observer.start(lane);
                            }
                        }
                    }
                }
                for settled in &mut self.settled {
                    *settled &= !loaded;
                }
                if !loaded.is_empty() {
                    dynamics::refresh(program, &mut self.state, &mut self.scratch, loaded);
                }
            }
            if self.state.occupied.is_empty() {
                return finished;
            }
            self.observe(subject, &mut cells, &mut finished);
            rounds += 1;
            if budget.is_interrupted() || (rounds.is_multiple_of(clock_every) && budget.is_over()) {
                self.cut_all(&mut cells, &mut finished);
                return finished;
            }
            if !self.state.occupied.is_empty() {
                self.steps += u64::from(self.state.occupied.0.count_ones());
                dynamics::step(program, &mut self.state, &mut self.scratch);
            }
        }
    }

    /// Ends all trials; what is decided in them is kept.
    fn cut_all(&mut self, cells: &mut [Cell], finished: &mut Finished) {
        let width = self.columns.len();
        for (lane, busy) in self.busy.iter_mut().enumerate() {
            let Some(busy) = busy.take() else { continue };
            let row = &mut cells[lane * width..][..width];
            for (cell, settled) in row.iter_mut().zip(&self.settled) {
                if !settled.has(lane) {
                    *cell = Cell::OPEN;
                }
            }
            finished.cut.push((busy.place, row.to_vec()));
        }
        self.state.occupied = Mask::NONE;
    }

    /// Shows the present states to the monitors and ends trials that are decided.
    fn observe(&mut self, subject: &Subject, cells: &mut [Cell], finished: &mut Finished) {
        let width = self.columns.len();
        // Nothing more can be seen of a trial that diverged, or in which the model is wrong.
        let faulty = self.state.faulty & self.state.occupied;
        let diverged = ((self.state.diverged | self.state.queues.full) & self.state.occupied) | faulty;
        let watched = self.state.occupied & !diverged;
        let mut touched = diverged;
        let near = self.sheets.iter().any(|sheet| sheet.code.asks_who_is_near());
        let close = if near { self.scratch.close(&self.state) } else { None };
        for (sheet, readings) in self.sheets.iter_mut().zip(&mut self.readings) {
            sheet.code.run_close(&subject.program, &self.state, close, readings);
            // Without a value where one is needed, nothing more can be said.
            let lost = sheet.lost(readings, &self.state.ticks) & watched;
            for (k, observer) in sheet.observers.iter_mut().enumerate() {
                let place = sheet.places[k];
                let gone = if sheet.follows[k] { self.state.queues.reused & watched } else { Mask::NONE };
                let lost = lost | gone;
                let open = watched & !lost & !self.settled[place];
                if !open.is_empty() {
                    observer.observe(open, readings);
                }
                let decided = (observer.decided() & open) | (lost & !self.settled[place]);
                if decided.is_empty() {
                    continue;
                }
                touched |= decided;
                self.settled[place] |= decided;
                for lane in decided.iter() {
                    let Some(busy) = &mut self.busy[lane] else { continue };
                    busy.open -= 1;
                    let reading = if lost.has(lane) { Reading::Unresolved } else { observer.reading(lane) };
                    cells[lane * width + place] = Cell {
                        reading,
                        steps: self.state.ticks[lane],
                        triggered: observer.triggered(lane),
                        shrunk: busy.shrunk,
                    };
                }
            }
        }
        for lane in touched.iter() {
            let Some(busy) = self.busy[lane] else { continue };
            if busy.open == 0 || diverged.has(lane) {
                let row = &mut cells[lane * width..][..width];
                for sheet in &self.sheets {
                    for (observer, &place) in sheet.observers.iter().zip(&sheet.places) {
                        if self.settled[place].has(lane) {
                            continue;
                        }
                        let cell = &mut row[place];
                        cell.steps = self.state.ticks[lane];
                        // What its monitors saw before it went astray they have seen.
                        cell.triggered = observer.triggered(lane);
                        if faulty.has(lane) {
                            cell.reading = Reading::Faulty;
                        }
                    }
                }
                finished.push(busy.place, row);
                self.busy[lane] = None;
                self.state.occupied &= !Mask::lane(lane);
            }
        }
    }
}
