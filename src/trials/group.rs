//! Columns that are read together: their code, and their monitors for all lanes.

use super::observer::Observer;
use super::setup::Setup;
use crate::base::lanes::{LANES, Mask};
use crate::kernel::{Code, Readings, Run};
use crate::logic::{Invalid, Needs};

/// Code and monitors for some columns of a prepared world. Columns whose atoms can lack a value stand alone, so
/// that the outcome of one never depends on which others are observed.
pub struct ColumnGroup {
    /// Code that reads the atoms and signals of these columns.
    code: Code,
    /// The atoms and signals that it read last.
    pub readings: Readings,
    /// Places of the columns in the request.
    pub places: Vec<usize>,
    /// One a column.
    pub observers: Vec<Observer>,
    /// Whether each column follows single people of a source.
    pub follows: Vec<bool>,
    /// When they look at what.
    needs: Needs,
}

impl ColumnGroup {
    /// One group for all of some columns.
    pub fn of(setup: &Setup, columns: &[usize]) -> Result<Self, Invalid> {
        Ok(Self {
            code: setup.code(columns),
            readings: Readings::default(),
            places: (0..columns.len()).collect(),
            observers: columns.iter().map(|&column| Observer::of(setup, column)).collect::<Result<_, _>>()?,
            follows: columns.iter().map(|&column| setup.follows(column)).collect(),
            needs: setup.needs(columns)?,
        })
    }

    /// Groups for some columns.
    pub fn each(setup: &Setup, columns: &[usize]) -> Result<Vec<Self>, Invalid> {
        let together = setup.code(columns);
        let groups: Vec<Vec<usize>> = if together.may_be_unresolved() && columns.len() > 1 {
            (0..columns.len()).map(|place| vec![place]).collect()
        } else {
            vec![(0..columns.len()).collect()]
        };
        let of = |places: Vec<usize>| {
            let chosen: Vec<usize> = places.iter().map(|&p| columns[p]).collect();
            Ok(Self { places, ..Self::of(setup, &chosen)? })
        };
        groups.into_iter().map(of).collect()
    }

    /// A trial begins in a lane.
    pub fn start(&mut self, lane: usize) {
        for observer in &mut self.observers {
            observer.start(lane);
        }
    }

    /// Reads the present states. The lanes in which something that is looked at has no value: there nothing more can be said.
    pub fn read(&mut self, run: &Run<'_>) -> Mask {
        let close = if self.code.asks_who_is_near() { run.close() } else { None };
        run.read(&self.code, close, &mut self.readings);
        lost(&self.needs, &self.readings, &run.state().ticks)
    }
}

/// The lanes in which something is needed at their ticks that has no value.
fn lost(needs: &Needs, readings: &Readings, ticks: &[u64; LANES]) -> Mask {
    let mut lost = Mask::NONE;
    let (atoms, signals) = &readings.missing;
    for (place, lanes) in atoms.iter().enumerate() {
        lost |= lanes.iter().filter(|&lane| needs.atom(place, ticks[lane])).map(Mask::lane).fold(lost, join);
    }
    for (place, lanes) in signals.iter().enumerate() {
        lost |=
            lanes.iter().filter(|&lane| needs.signal(place, ticks[lane])).map(Mask::lane).fold(lost, join);
    }
    lost & readings.unresolved
}

fn join(a: Mask, b: Mask) -> Mask {
    a | b
}
