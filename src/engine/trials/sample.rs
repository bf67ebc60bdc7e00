//! Trials of a world in which the ways of some agents are kept beside what each column comes to.

use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Mask};
use crate::engine::fault::Fault;
use crate::engine::trials::prepared::PreparedWorld;
use crate::kernel::Run;
use crate::model::AgentId;
use crate::trials::batch::{Batch, Monitors};
use crate::trials::budget::Budget;
use crate::trials::cell::{Item, Reading, Series};
use crate::trials::columns::StepColumns;

/// What trials yield.
#[derive(Clone, Debug, Default)]
pub struct Sample {
    /// Trial by trial what each column came to.
    pub readings: Vec<Vec<Reading>>,
    /// Trial by trial the positions at the ticks that were asked for, m, of all agents at the first, at the second, and so on;
    /// fewer where the trial ended before.
    pub paths: Vec<Vec<Vec2>>,
}

impl Sample {
    /// The share of the trials that say anything of a column in which it is true.
    pub fn share(&self, column: usize) -> Option<f64> {
        let known = || self.readings.iter().filter_map(|row| row.get(column)?.truth());
        let (held, count) = (known().filter(|truth| *truth).count(), known().count());
        (count > 0).then(|| held as f64 / count as f64)
    }
}

/// Whose ways are kept, and at which ticks, ascending.
#[derive(Clone, Copy, Debug)]
pub struct Followed<'t> {
    /// Who.
    pub agents: &'t [AgentId],
    /// When.
    pub ticks: &'t [u64],
}

/// The first trials of a series. A trial that cannot start is unresolved and has no way.
///
/// # Errors
/// For columns that no monitor can watch, and in continuous time.
pub fn sample(
    prepared: &PreparedWorld,
    columns: &[usize],
    series: Series,
    trials: u64,
    followed: Followed<'_>,
) -> Result<Sample, Fault> {
    let own = StepColumns::new(prepared, columns).map_err(|_| Fault::Unsuitable)?;
    let watching = Watching {
        columns: own,
        asks: !columns.is_empty(),
        followed,
        decided: Mask::NONE,
        ways: std::array::from_fn(|_| Vec::new()),
        paths: Vec::new(),
    };
    let mut batch = Batch::new(&prepared.program, watching);
    let mut items = Item::row(0, trials).enumerate();
    batch.run(
        &mut || items.next().map(|(place, item)| (place, item.address(series))),
        &Budget::new(trials, None),
    );
    let Watching { mut columns, mut paths, .. } = batch.monitors;
    let finished = columns.take();
    let width = finished.cells.len() / finished.places.len().max(1);
    let mut rows: Vec<(usize, Vec<Reading>)> = (finished.places.iter().copied())
        .zip(finished.cells.chunks(width.max(1)).map(|row| row.iter().map(|cell| cell.reading).collect()))
        .collect();
    // The results of trials stand in the order of their indices, whichever lane was done first.
    rows.sort_by_key(|(place, _)| *place);
    paths.sort_by_key(|(place, _)| *place);
    Ok(Sample {
        readings: rows.into_iter().map(|(_, row)| row).collect(),
        paths: paths.into_iter().map(|(_, path)| path).collect(),
    })
}

/// Monitors of columns that go on until the last tick that was asked for.
struct Watching<'t> {
    columns: StepColumns,
    /// Whether there is any column.
    asks: bool,
    followed: Followed<'t>,
    /// Lanes in which all columns are decided.
    decided: Mask,
    /// Lane by lane the ways so far.
    ways: [Vec<Vec2>; LANES],
    paths: Vec<(usize, Vec<Vec2>)>,
}

impl Monitors for Watching<'_> {
    fn start(&mut self, lane: usize, shrunk: bool) {
        self.columns.start(lane, shrunk);
        self.decided &= !Mask::lane(lane);
        self.ways[lane].clear();
    }

    fn observe(&mut self, run: &Run<'_>, fresh: Mask) -> Mask {
        let state = run.state();
        if !(run.occupied() & !self.decided).is_empty() {
            self.decided |= self.columns.observe(run, fresh) & run.occupied();
        }
        let mut over = run.ended();
        let Followed { agents, ticks } = self.followed;
        for lane in run.occupied().iter() {
            let way = &mut self.ways[lane];
            let seen = way.len() / agents.len().max(1);
            if ticks.get(seen) == Some(&state.ticks[lane]) {
                way.extend(agents.iter().map(|agent| state.position(state.slot(agent.0 as usize, lane))));
            }
            if way.len() >= agents.len() * ticks.len() && (self.decided.has(lane) || !self.asks) {
                over |= Mask::lane(lane);
            }
        }
        over
    }

    fn finish(&mut self, place: usize, lane: usize, run: &Run<'_>) {
        self.columns.finish(place, lane, run);
        self.paths.push((place, std::mem::take(&mut self.ways[lane])));
    }

    fn cut(&mut self, place: usize, lane: usize) {
        self.columns.cut(place, lane);
    }

    fn refuse(&mut self, place: usize) {
        self.columns.refuse(place);
        self.paths.push((place, Vec::new()));
    }
}
