//! Expressions over one state, compiled once and run for all lanes.
//!
//! The trees of `model::expression` become a graph without duplicates, the graph becomes linear code over
//! registers of eight lanes, and folds become loops in it whose bodies stand there once. The shapes
//! that nearly every property has (the gap to everybody else against a bound) are single instructions.
//!
//! Meaning: only agents in the scene count in sets, contacts, clearance and times to collision; a fixed
//! agent that has left keeps its last position and numbers. Sums are ascending over agents. `min` and
//! `max` of something that is no number are no number; comparisons with it are false.

mod barriers;
mod crowd;
pub mod ground;
pub(crate) mod lanes;
mod lists;
mod lower;
mod machine;
mod node;
mod proximity;
mod schedule;
mod span;
mod voronoi;

use super::near::Close;
use super::state::{Layout, State};
use crate::base::lanes::{Lanes, Mask};
use crate::model::{Bool, Num, Periods, Scenario};
use barriers::Barriers;
use fearless_simd::{Level, dispatch};
use ground::Ground;
use machine::Frame;
use node::{Id, Node};
use proximity::Proximity;
use schedule::Schedule;
use std::sync::Arc;
pub use voronoi::Voronoi;

/// Compiled expressions.
#[derive(Clone, Debug)]
pub struct Code {
    schedule: Schedule,
    /// Registers with the constants in place.
    registers: Arc<Vec<Lanes>>,
    lists: Vec<Vec<u32>>,
    regions: Vec<Ground>,
    barriers: Barriers,
    periods: Periods,
    /// Where a Voronoi density is read.
    voronoi: Option<Arc<Voronoi>>,
    atoms: Vec<Id>,
    signals: Vec<Id>,
    unresolved: Option<Id>,
    /// Where each atom and each signal has no value, if they can lack one.
    open: (Vec<Option<Id>>, Vec<Option<Id>>),
    /// Whether it asks who is near somebody.
    asks_who_is_near: bool,
    /// Numerator and denominator of the step in seconds.
    step: (f64, f64),
    level: Level,
}

/// What code read from a state. Reused from run to run; starts empty with `default()`.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    /// The lanes in which each atom holds.
    pub atoms: Vec<Mask>,
    /// The value of each signal, SI units.
    pub signals: Vec<Lanes>,
    /// Occupied lanes in which some atom or signal has no value: a mean or centroid of nobody.
    pub unresolved: Mask,
    /// The lanes in which each atom, and each signal, has none. Empty where there is no such lane.
    pub missing: (Vec<Mask>, Vec<Mask>),
    /// The code whose constants are in the registers.
    loaded: Option<Arc<Vec<Lanes>>>,
    numbers: Vec<Lanes>,
    truths: Vec<Mask>,
    frames: Vec<Frame>,
    /// Who is near, for each list of members, in one large crowd.
    proximities: Vec<Proximity>,
    /// Number of the state.
    number: u64,
}

impl Code {
    /// Compiles the truth values and numbers that monitors and metrics want to know of each state.
    pub fn compile<'a>(scenario: &'a Scenario, atoms: &[Bool], signals: &[Num]) -> Self {
        let lower = |mut lowering: lower::Lowering<'a>| {
            let atoms: Vec<lower::Value> = atoms.iter().map(|atom| lowering.truth(atom)).collect();
            let signals: Vec<lower::Value> = signals.iter().map(|signal| lowering.number(signal)).collect();
            (lowering, atoms, signals)
        };
        let (first, ..) = lower(lower::Lowering::new(scenario));
        let (mut lowering, atoms, signals) = lower(lower::Lowering::again(first));
        let mut open: Vec<Id> = atoms.iter().chain(&signals).filter_map(|value| value.open).collect();
        open.sort_unstable();
        open.dedup();
        let unresolved = (!open.is_empty()).then(|| lowering.graph.enter(Node::Or(open.clone())));
        let mut roots: Vec<Id> = atoms.iter().chain(&signals).map(|value| value.id).collect();
        roots.extend(unresolved.into_iter().chain(open));
        let schedule = schedule::schedule(&lowering.graph, &roots);
        let mut registers = vec![Lanes::ZERO; schedule.numbers as usize];
        for &(register, value) in &schedule.constants {
            registers[register as usize] = Lanes::splat(value);
        }
        let register = |value: &lower::Value| schedule.registers[value.id as usize];
        let missing = |value: &lower::Value| value.open.map(|id| schedule.registers[id as usize]);
        Self {
            atoms: atoms.iter().map(register).collect(),
            signals: signals.iter().map(register).collect(),
            unresolved: unresolved.map(|id| schedule.registers[id as usize]),
            open: (atoms.iter().map(missing).collect(), signals.iter().map(missing).collect()),
            asks_who_is_near: lowering
                .graph
                .nodes
                .iter()
                .any(|node| matches!(node, Node::Nearest(..) | Node::AllFar { .. })),
            voronoi: lowering
                .graph
                .nodes
                .iter()
                .any(|node| matches!(node, Node::Voronoi(_)))
                .then(|| Arc::new(Voronoi::new(&scenario.scene))),
            registers: Arc::new(registers),
            lists: lowering.lists.all,
            regions: scenario.scene.regions.iter().map(|region| Ground::region(&region.shape)).collect(),
            barriers: Barriers::new(&scenario.scene),
            periods: scenario.scene.periods,
            schedule,
            step: scenario.clock.step_ratio(),
            level: Level::new(),
        }
    }

    /// Reads all lanes of a state in this layout.
    pub(super) fn read(&self, layout: Layout, state: &State, readings: &mut Readings) {
        self.read_close(layout, (state, None), readings);
    }

    pub(super) fn read_close(
        &self,
        layout: Layout,
        (state, close): (&State, Option<Close<'_>>),
        readings: &mut Readings,
    ) {
        let known = readings.loaded.as_ref().is_some_and(|loaded| Arc::ptr_eq(loaded, &self.registers));
        if !known {
            readings.numbers.clone_from(&self.registers);
            readings.truths = vec![Mask::NONE; self.schedule.truths as usize];
            readings.frames = vec![Frame::default(); self.schedule.running as usize];
            readings.proximities.clear();
            readings.loaded = Some(Arc::clone(&self.registers));
        }
        match layout {
            Layout::Trials => {
                dispatch!(self.level, simd => machine::execute::<_, false>(simd, self, (state, None), readings));
            }
            Layout::Agents => {
                readings.number += 1;
                readings.proximities.resize_with(self.lists.len(), Proximity::default);
                dispatch!(self.level, simd => machine::execute::<_, true>(simd, self, (state, close), readings));
            }
        }
        machine::collect(self, state, readings);
    }

    /// Whether it has use for what the kernel found out about who is close to whom.
    pub const fn asks_who_is_near(&self) -> bool {
        self.asks_who_is_near
    }

    /// Whether some atom or signal can lack a value: a mean or centroid of a set that may be empty.
    pub const fn may_be_unresolved(&self) -> bool {
        self.unresolved.is_some()
    }

    /// The same code for the plainest vectors of the machine: the same bits, slower.
    pub fn at_baseline(mut self) -> Self {
        self.level = Level::baseline();
        self
    }
}
