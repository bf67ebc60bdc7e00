//! The monitors of plain trials: they watch some columns, and fill one cell of each in every trial.

use super::batch::Monitors;
use super::cell::{Cell, Reading};
use super::group::ColumnGroup;
use super::observer::SignalObserver;
use super::setup::Setup;
use crate::base::lanes::{LANES, Mask};
use crate::kernel::Run;
use crate::kernel::process::{View, ViewReadings};
use crate::logic::Invalid;

/// Finished trials: the places of their items, and for each as many cells as there are columns.
#[derive(Debug, Default)]
pub struct Finished {
    /// Places of the items.
    pub places: Vec<usize>,
    /// The cells, trial by trial.
    pub cells: Vec<Cell>,
    /// Trials that were cut: the place of each item, and its cells.
    pub cut: Vec<(usize, Vec<Cell>)>,
}

impl Finished {
    fn push(&mut self, place: usize, cells: &[Cell]) {
        self.places.push(place);
        self.cells.extend_from_slice(cells);
    }
}

/// The cells of all lanes, and those of finished trials.
struct Rows {
    /// Number of columns.
    width: usize,
    /// Lane by lane.
    cells: Vec<Cell>,
    /// Columns of each lane that are not decided yet.
    open: [usize; LANES],
    finished: Finished,
}

impl Rows {
    fn new(width: usize) -> Self {
        let cells = vec![Cell::BLANK; LANES * width];
        Self { width, cells, open: [0; LANES], finished: Finished::default() }
    }

    fn start(&mut self, lane: usize, cell: Cell) {
        self.row(lane).fill(cell);
        self.open[lane] = self.width;
    }

    fn row(&mut self, lane: usize) -> &mut [Cell] {
        &mut self.cells[lane * self.width..][..self.width]
    }

    /// Of these lanes those in which all columns are decided.
    fn decided(&self, lanes: Mask) -> Mask {
        let decided = lanes.iter().filter(|lane| self.open[*lane] == 0);
        decided.fold(Mask::NONE, |all, lane| all | Mask::lane(lane))
    }

    fn finish(&mut self, place: usize, lane: usize) {
        self.finished.push(place, &self.cells[lane * self.width..][..self.width]);
    }

    fn cut(&mut self, place: usize, lane: usize) {
        let row = self.row(lane).to_vec();
        self.finished.cut.push((place, row));
    }

    /// A trial that cannot start is unresolved in every column.
    fn refuse(&mut self, place: usize) {
        self.finished.push(place, &vec![Cell::BLANK; self.width]);
    }
}

/// From step to step.
pub struct StepColumns {
    groups: Vec<ColumnGroup>,
    /// For each column, the lanes in which it is decided.
    settled: Vec<Mask>,
    rows: Rows,
}

impl StepColumns {
    /// Monitors of some columns of a setup.
    pub fn new(setup: &Setup, columns: &[usize]) -> Result<Self, Invalid> {
        let settled = vec![Mask::NONE; columns.len()];
        Ok(Self { groups: ColumnGroup::each(setup, columns)?, settled, rows: Rows::new(columns.len()) })
    }

    /// What has been finished since this was asked last.
    pub fn take(&mut self) -> Finished {
        std::mem::take(&mut self.rows.finished)
    }
}

impl Monitors for StepColumns {
    fn start(&mut self, lane: usize, shrunk: bool) {
        self.rows.start(lane, Cell { shrunk, ..Cell::BLANK });
        for settled in &mut self.settled {
            *settled &= !Mask::lane(lane);
        }
        for group in &mut self.groups {
            group.start(lane);
        }
    }

    fn observe(&mut self, run: &Run<'_>, _: Mask) -> Mask {
        let state = run.state();
        // Nothing more can be seen of a trial that has ended.
        let ended = run.ended();
        let watched = run.occupied() & !ended;
        let mut touched = Mask::NONE;
        for group in &mut self.groups {
            let missing = group.read(run);
            for (k, observer) in group.observers.iter_mut().enumerate() {
                let place = group.places[k];
                let lost =
                    (missing | if group.follows[k] { state.queues.reused } else { Mask::NONE }) & watched;
                let open = watched & !lost & !self.settled[place];
                if !open.is_empty() {
                    observer.observe(open, &group.readings);
                }
                let decided = (observer.decided() & open) | (lost & !self.settled[place]);
                if decided.is_empty() {
                    continue;
                }
                touched |= decided;
                self.settled[place] |= decided;
                for lane in decided.iter() {
                    self.rows.open[lane] -= 1;
                    let reading = if lost.has(lane) { Reading::Unresolved } else { observer.reading(lane) };
                    let cell = &mut self.rows.row(lane)[place];
                    (cell.reading, cell.steps) = (reading, state.ticks[lane]);
                    cell.triggered = observer.triggered(lane);
                    cell.no_way = state.no_way.has(lane);
                }
            }
        }
        ended | self.rows.decided(touched)
    }

    fn finish(&mut self, place: usize, lane: usize, run: &Run<'_>) {
        let state = run.state();
        for group in &self.groups {
            for (observer, &column) in group.observers.iter().zip(&group.places) {
                if self.settled[column].has(lane) {
                    continue;
                }
                let cell = &mut self.rows.row(lane)[column];
                // What its monitors saw before the trial ended counts.
                (cell.steps, cell.triggered) = (state.ticks[lane], observer.triggered(lane));
                cell.no_way = state.no_way.has(lane);
                if state.faulty.has(lane) {
                    cell.reading = Reading::Faulty;
                }
            }
        }
        self.rows.finish(place, lane);
    }

    fn cut(&mut self, place: usize, lane: usize) {
        for (cell, settled) in self.rows.row(lane).iter_mut().zip(&self.settled) {
            if !settled.has(lane) {
                *cell = Cell::OPEN;
            }
        }
        self.rows.cut(place, lane);
    }

    fn refuse(&mut self, place: usize) {
        self.rows.refuse(place);
    }
}

/// From jump to jump.
///
/// A state is judged when the next one comes, because one that lasts no time is as if it had not been; so a
/// decision shows at the first jump after it, or at the horizon.
pub struct EventColumns {
    view: View,
    seen: ViewReadings,
    /// Lane by lane, one a column.
    monitors: Vec<SignalObserver>,
    rows: Rows,
    /// Most jumps of a trial.
    most: u64,
}

impl EventColumns {
    /// Monitors of some columns of a setup.
    pub fn new(setup: &Setup, columns: &[usize]) -> Result<Self, Invalid> {
        let one: Vec<SignalObserver> =
            columns.iter().map(|&column| SignalObserver::of(setup, column)).collect::<Result<_, _>>()?;
        Ok(Self {
            view: setup.view(columns),
            seen: ViewReadings::default(),
            monitors: (0..LANES).flat_map(|_| one.iter().cloned()).collect(),
            rows: Rows::new(columns.len()),
            most: setup.most_jumps,
        })
    }

    /// What has been finished since this was asked last.
    pub fn take(&mut self) -> Finished {
        std::mem::take(&mut self.rows.finished)
    }

    /// Shows the state of a lane to its monitors and fills the cells of those that are decided.
    #[inline]
    fn judge(&mut self, run: &Run<'_>, lane: usize, jumped: bool) {
        let state = run.state();
        let faulty = state.faulty.has(lane);
        let (now, jumps) = (state.clocks.instant(lane), state.clocks.jumps[lane]);
        let (atoms, signals) = self.view.of(state, &mut self.seen, lane);
        let width = self.rows.width;
        let monitors = &mut self.monitors[lane * width..][..width];
        let row = &mut self.rows.cells[lane * width..][..width];
        for (monitor, cell) in monitors.iter_mut().zip(row) {
            if !cell.is_open() {
                continue;
            }
            let reading = match (jumped || faulty, faulty) {
                (true, false) => match monitor.jump(now, atoms, signals) {
                    None if jumps < self.most => continue,
                    None => Reading::Unresolved,
                    Some(reading) => reading,
                },
                // What was decided before the error stays decided.
                (_, true) => monitor.jump(now, atoms, signals).unwrap_or(Reading::Faulty),
                (false, false) => monitor.finish(),
            };
            *cell = Cell { reading, steps: jumps, triggered: monitor.triggered(), ..Cell::BLANK };
            self.rows.open[lane] -= 1;
        }
    }
}

impl Monitors for EventColumns {
    fn start(&mut self, lane: usize, _: bool) {
        self.rows.start(lane, Cell::OPEN);
    }

    fn observe(&mut self, run: &Run<'_>, fresh: Mask) -> Mask {
        if fresh.is_empty() {
            return Mask::NONE;
        }
        self.view.look(run.state(), &mut self.seen);
        let width = self.rows.width;
        for lane in fresh.iter() {
            let (atoms, signals) = self.view.of(run.state(), &mut self.seen, lane);
            for monitor in &mut self.monitors[lane * width..][..width] {
                monitor.start();
                monitor.jump(0.0, atoms, signals);
            }
        }
        Mask::NONE
    }

    fn follow(&mut self, run: &Run<'_>, moved: Mask) -> Mask {
        self.view.look(run.state(), &mut self.seen);
        let occupied = run.occupied();
        for lane in occupied.iter() {
            self.judge(run, lane, moved.has(lane));
        }
        self.rows.decided(occupied)
    }

    fn finish(&mut self, place: usize, lane: usize, _: &Run<'_>) {
        self.rows.finish(place, lane);
    }

    fn cut(&mut self, place: usize, lane: usize) {
        self.rows.cut(place, lane);
    }

    fn refuse(&mut self, place: usize) {
        self.rows.refuse(place);
    }
}
