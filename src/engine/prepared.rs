//! A world made ready to run: a program of the kernel and what is observed in it.

use super::observer::Observer;
use crate::base::lanes::{LANES, Mask};
use crate::base::tick::{Clock, Tick};
use crate::compile::dimension::Dimension;
use crate::compile::study::{Origins, Root, Study, Texts, World};
use crate::kernel::driver::{Drivers, MakeDrivers};
use crate::kernel::process::View;
use crate::kernel::{Code, Program, Readings, Run};
use crate::logic::{
    AtomId, Invalid, Monitor, Needs, Node, NodeId, Operation, Part, Robustness, SignalId, SignalMonitor,
    SignalRobustness, Term, TermId, Tree, leaves,
};
use crate::model::{Bool, Num};
use std::collections::BTreeSet;

/// Most jumps of a trial, and most that are made again to see why one is unresolved.
const MOST_JUMPS: u64 = 1 << 26;
const JUMPS_AGAIN: u64 = 1 << 24;

/// A world made ready to run.
pub struct PreparedWorld {
    /// Number of the world in its study, by which other processes find it; `None` where it is of no study.
    pub number: Option<usize>,
    /// The program of the kernel.
    pub program: Program,
    /// Formulas and metrics.
    pub tree: Tree,
    /// What is asked of each trace.
    pub columns: Vec<Root>,
    /// Last tick.
    pub horizon: Tick,
    /// How atoms, signals and comparisons were written.
    pub texts: Texts,
    /// Where what can go wrong is written.
    pub origins: Origins,
    /// Most jumps of a trial in continuous time; one that needs more is unresolved.
    pub most_jumps: u64,
    /// Most jumps that are made again to see why a trial is unresolved.
    pub(super) jumps_again: u64,
    atoms: Vec<Bool>,
    signals: Vec<Num>,
}

/// Code and monitors for some columns of a prepared world. Columns whose atoms can lack a value stand alone, so
/// that the outcome of one never depends on which others are observed.
pub(super) struct ColumnGroup {
    /// Code that reads the atoms and signals of these columns, and what it read last.
    code: Code,
    pub(super) readings: Readings,
    /// Places of the columns in the request.
    pub(super) places: Vec<usize>,
    /// One a column.
    pub(super) observers: Vec<Observer>,
    /// Whether each column follows single people of a source.
    pub(super) follows: Vec<bool>,
    /// When they look at what.
    needs: Needs,
}

impl ColumnGroup {
    /// A trial begins in a lane.
    pub(super) fn start(&mut self, lane: usize) {
        for observer in &mut self.observers {
            observer.start(lane);
        }
    }

    /// Reads the present states. The lanes in which something that is looked at has no value: there nothing more can be said.
    pub(super) fn read(&mut self, run: &Run<'_>) -> Mask {
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

impl PreparedWorld {
    /// Makes a world of a study ready, with the drivers of a run; `None` beyond the last one.
    pub fn of(study: &Study, number: usize, seed: u64, drivers: &MakeDrivers) -> Option<Self> {
        let world = study.worlds.get(number)?;
        Some(Self { number: Some(number), ..Self::driven(world, drivers(&world.scenario, seed)) })
    }

    /// Makes a world ready in which all agents head straight for their goals.
    pub fn new(world: &World) -> Self {
        Self::driven(world, Drivers::default())
    }

    fn driven(world: &World, drivers: Drivers) -> Self {
        let scenario = world.scenario.clone();
        Self {
            number: None,
            horizon: scenario.horizon,
            program: Program::driven(scenario, drivers),
            tree: world.tree.clone(),
            columns: world.columns.iter().map(|c| c.root).collect(),
            texts: world.texts.clone(),
            origins: world.origins.clone(),
            most_jumps: MOST_JUMPS,
            jumps_again: JUMPS_AGAIN,
            atoms: world.atoms.clone(),
            signals: world.signals.clone(),
        }
    }

    /// Steps to the horizon; `None` in continuous time, where nobody knows how many jumps come.
    pub(super) fn most_steps(&self) -> Option<u64> {
        (!self.program.scenario.clock.is_jumps()).then_some(self.horizon.0)
    }

    /// Truth values observed in each state.
    pub fn atoms(&self) -> &[Bool] {
        &self.atoms
    }

    /// Numbers observed in each state.
    pub(super) fn signals(&self) -> &[Num] {
        &self.signals
    }

    /// Whether a number is made of times that count from 0, so that it is never below 0.
    pub(super) fn is_never_early(&self, term: TermId) -> bool {
        let of = |term: &TermId| self.is_never_early(*term);
        match &self.tree.terms[term.0 as usize] {
            Term::TimeUntil(_) | Term::Abs(_) => true,
            Term::Constant(value) => *value >= 0.0,
            Term::Signal(signal) => match &self.signals[signal.0 as usize] {
                Num::Time => true,
                Num::Of(field, _) => field.dimension() == Some(Dimension::TIME),
                Num::OfTwo(pair, ..) => pair.dimension() == Some(Dimension::TIME),
                _ => false,
            },
            Term::Combine(operation, a, b) => *operation != Operation::Subtract && of(a) && of(b),
            Term::Window(_, _, a) | Term::Later(_, a) | Term::AtEnd(a) => of(a),
        }
    }

    /// What watches a column.
    pub(super) fn observer(&self, column: usize) -> Result<Observer, Invalid> {
        match self.columns[column] {
            Root::Robustness(_, sought) => Ok(Observer::Robustness(self.robustness(column)?, sought)),
            Root::Formula(_) => Ok(Observer::Formula(self.monitor(column)?)),
            Root::Metric(_) => Ok(Observer::Metric(self.monitor(column)?)),
        }
    }

    /// The robustness of a column that is one.
    pub(super) fn robustness(&self, column: usize) -> Result<Robustness, Invalid> {
        match self.columns[column] {
            Root::Robustness(node, _) => {
                Robustness::new(&self.tree, node, self.horizon, self.program.scenario.clock)
            }
            Root::Formula(_) | Root::Metric(_) => Err(Invalid::NoMargin),
        }
    }

    /// A monitor of a column: of the formula itself, where its robustness is asked for.
    pub fn monitor(&self, column: usize) -> Result<Monitor, Invalid> {
        match self.columns[column] {
            Root::Formula(node) | Root::Robustness(node, _) => {
                Monitor::formula(&self.tree, node, self.horizon, self.program.scenario.clock)
            }
            Root::Metric(term) => {
                Monitor::metric(&self.tree, term, self.horizon, self.program.scenario.clock)
            }
        }
    }

    /// The implications of a column that are watched; of each, whether it is one of a quantifier that asks about
    /// those who are there, so that nobody wrote it.
    pub(super) fn implications(&self, column: usize) -> Result<Vec<bool>, Invalid> {
        if self.program.scenario.clock.is_jumps() {
            return Ok(match self.columns[column] {
                Root::Robustness(..) => Vec::new(),
                Root::Formula(_) | Root::Metric(_) => {
                    vec![false; self.signal_monitor(column)?.implications()]
                }
            });
        }
        let of_presence = |implication: NodeId| {
            let Node::Or(parts) = &self.tree.nodes[implication.0 as usize] else { return false };
            let Some(Node::Not(left)) = parts.first().map(|part| &self.tree.nodes[part.0 as usize]) else {
                return false;
            };
            let Node::Atom(atom) = self.tree.nodes[left.0 as usize] else { return false };
            self.texts.implied.contains(&atom.0)
        };
        Ok(self.monitor(column)?.antecedents().map(|one| of_presence(one.implication)).collect())
    }

    /// A monitor of a column in continuous time.
    pub fn signal_monitor(&self, column: usize) -> Result<SignalMonitor, Invalid> {
        let Clock::Jumps(tick) = self.program.scenario.clock else { return Err(Invalid::NoSteps) };
        match self.columns[column] {
            Root::Formula(node) => SignalMonitor::formula(&self.tree, node, self.horizon, tick),
            Root::Metric(term) => SignalMonitor::metric(&self.tree, term, self.horizon, tick),
            Root::Robustness(..) => Err(Invalid::NoMargin),
        }
    }

    /// The robustness of a column in continuous time, if it is one.
    pub fn signal_robustness(&self, column: usize) -> Result<SignalRobustness, Invalid> {
        let Clock::Jumps(tick) = self.program.scenario.clock else { return Err(Invalid::NoSteps) };
        match self.columns[column] {
            Root::Robustness(node, _) => SignalRobustness::new(&self.tree, node, self.horizon, tick),
            Root::Formula(_) | Root::Metric(_) => Err(Invalid::NoMargin),
        }
    }

    /// A look at what some columns use in continuous time; what they do not use reads as a constant.
    pub fn view(&self, columns: &[usize]) -> View {
        let (atoms, signals) = self.observed(columns);
        View::new(&self.program.scenario, &atoms, &signals)
    }

    /// The same of one column and some more conditions, whose truths come after those of the atoms.
    pub(super) fn view_beside(&self, column: usize, more: &[Bool]) -> View {
        let (mut atoms, signals) = self.observed(&[column]);
        atoms.extend_from_slice(more);
        View::new(&self.program.scenario, &atoms, &signals)
    }

    /// Code that reads what some columns use; what they do not use reads as a constant.
    pub fn code(&self, columns: &[usize]) -> Code {
        let (atoms, signals) = self.observed(columns);
        Code::compile(&self.program.scenario, &atoms, &signals)
    }

    /// Whether what some columns use is made of variables of processes and nothing else.
    pub(super) fn reads_variables_only(&self, columns: &[usize]) -> bool {
        let (atoms, signals) = self.observed(columns);
        let mut read = BTreeSet::new();
        atoms.iter().all(|atom| atom.reads(&mut read)) && signals.iter().all(|s| s.reads(&mut read))
    }

    /// Whether a column follows single people of a source: it knows no more once a place is given to a second person.
    pub(super) fn follows(&self, column: usize) -> bool {
        let (atoms, signals) = self.observed(&[column]);
        self.program.arrivals.are_named(&atoms, &signals)
    }

    /// The numbers of the atoms that a column uses.
    pub(super) fn atoms_of(&self, column: usize) -> Vec<usize> {
        self.leaves(&[column]).0.into_iter().map(|atom| atom.0 as usize).collect()
    }

    /// The numbers of the signals that a column uses.
    pub(super) fn signals_of(&self, column: usize) -> Vec<usize> {
        self.leaves(&[column]).1.into_iter().map(|signal| signal.0 as usize).collect()
    }

    /// The atoms and signals that some columns use, others as constants.
    pub(super) fn observed(&self, columns: &[usize]) -> (Vec<Bool>, Vec<Num>) {
        let (used_atoms, used_signals) = self.leaves(columns);
        let mut atoms = vec![Bool::Constant(false); self.atoms.len()];
        for atom in used_atoms {
            atoms[atom.0 as usize] = self.atoms[atom.0 as usize].clone();
        }
        let mut signals = vec![Num::Constant(0.0); self.signals.len()];
        for signal in used_signals {
            signals[signal.0 as usize] = self.signals[signal.0 as usize].clone();
        }
        (atoms, signals)
    }

    /// The atoms and signals that some columns use. A tree that no monitor accepts uses none.
    fn leaves(&self, columns: &[usize]) -> (BTreeSet<AtomId>, BTreeSet<SignalId>) {
        let roots: Vec<Part> = columns.iter().map(|&column| part(self.columns[column])).collect();
        leaves(&self.tree, &roots).unwrap_or_default()
    }

    /// When some columns look at what.
    pub(super) fn needs(&self, columns: &[usize]) -> Result<Needs, Invalid> {
        let mut needs = Needs::default();
        for &column in columns {
            match self.columns[column] {
                Root::Formula(node) | Root::Robustness(node, _) => {
                    needs.add_formula(&self.tree, node, self.horizon)?;
                }
                Root::Metric(term) => needs.add_metric(&self.tree, term, self.horizon)?,
            }
        }
        Ok(needs)
    }

    /// Groups for some columns.
    pub(super) fn groups(&self, columns: &[usize]) -> Result<Vec<ColumnGroup>, Invalid> {
        let together = self.code(columns);
        let groups: Vec<Vec<usize>> = if together.may_be_unresolved() && columns.len() > 1 {
            (0..columns.len()).map(|place| vec![place]).collect()
        } else {
            vec![(0..columns.len()).collect()]
        };
        let of = |places: Vec<usize>| {
            let chosen: Vec<usize> = places.iter().map(|&p| columns[p]).collect();
            Ok(ColumnGroup { places, ..self.group(&chosen)? })
        };
        groups.into_iter().map(of).collect()
    }

    /// One group for all of some columns.
    pub(super) fn group(&self, columns: &[usize]) -> Result<ColumnGroup, Invalid> {
        Ok(ColumnGroup {
            code: self.code(columns),
            readings: Readings::default(),
            places: (0..columns.len()).collect(),
            observers: columns.iter().map(|&column| self.observer(column)).collect::<Result<_, _>>()?,
            follows: columns.iter().map(|&column| self.follows(column)).collect(),
            needs: self.needs(columns)?,
        })
    }
}

/// The part of the tree that a column is.
fn part(root: Root) -> Part {
    match root {
        Root::Formula(node) | Root::Robustness(node, _) => Part::Node(node),
        Root::Metric(term) => Part::Term(term),
    }
}
