//! A program of the kernel, and what is read from each of its traces.

use crate::base::dimension::Dimension;
use crate::base::tick::{Clock, Tick};
use crate::kernel::process::View;
use crate::kernel::{Code, Program};
use crate::logic::{
    AtomId, Invalid, Monitor, Needs, Operation, Part, Robustness, Root, SignalId, SignalMonitor,
    SignalRobustness, Term, TermId, Tree, leaves,
};
use crate::model::{Bool, Num, VariableId};
use std::collections::BTreeSet;

/// What is run, and what is read from each trace.
pub struct Setup {
    /// The program of the kernel.
    pub program: Program,
    /// Formulas and metrics.
    pub tree: Tree,
    /// What is asked of each trace.
    pub columns: Vec<Root>,
    /// Last tick.
    pub horizon: Tick,
    /// Most jumps of a trial in continuous time; one that needs more is unresolved.
    pub most_jumps: u64,
    /// Truth values observed in each state.
    pub atoms: Vec<Bool>,
    /// Numbers observed in each state.
    pub signals: Vec<Num>,
}

impl Setup {
    /// Steps to the horizon; `None` in continuous time, where nobody knows how many jumps come.
    pub fn most_steps(&self) -> Option<u64> {
        (!self.program.scenario.clock.is_jumps()).then_some(self.horizon.0)
    }

    /// Whether a number is made of times that count from 0, so that it is never below 0.
    pub fn is_never_early(&self, term: TermId) -> bool {
        is_never_early((&self.tree, &self.signals), term)
    }

    /// The robustness of a column that is one.
    pub fn robustness(&self, column: usize) -> Result<Robustness, Invalid> {
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
    pub fn view_beside(&self, column: usize, more: &[Bool]) -> View {
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
    pub fn reads_variables_only(&self, columns: &[usize]) -> bool {
        let (atoms, signals) = self.observed(columns);
        let mut read = BTreeSet::new();
        atoms.iter().all(|atom| atom.reads(&mut read)) && signals.iter().all(|s| s.reads(&mut read))
    }

    /// Whether a column follows single people of a source: it knows no more once a place is given to a second person.
    pub fn follows(&self, column: usize) -> bool {
        let (atoms, signals) = self.observed(&[column]);
        self.program.arrivals.are_named(&atoms, &signals)
    }

    /// The numbers of the atoms that a column uses.
    pub fn atoms_of(&self, column: usize) -> Vec<usize> {
        self.leaves(&[column]).0.into_iter().map(|atom| atom.0 as usize).collect()
    }

    /// The numbers of the signals that a column uses.
    pub fn signals_of(&self, column: usize) -> Vec<usize> {
        self.leaves(&[column]).1.into_iter().map(|signal| signal.0 as usize).collect()
    }

    /// The atoms and signals that some columns use, others as constants.
    pub fn observed(&self, columns: &[usize]) -> (Vec<Bool>, Vec<Num>) {
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

    /// The variables of processes that a column reads.
    pub fn variables(&self, column: usize) -> BTreeSet<VariableId> {
        let (atoms, signals) = self.leaves(&[column]);
        let mut found = BTreeSet::new();
        for atom in atoms {
            self.atoms[atom.0 as usize].reads(&mut found);
        }
        for signal in signals {
            self.signals[signal.0 as usize].reads(&mut found);
        }
        found
    }

    /// The atoms and signals that some columns use. A tree that no monitor accepts uses none.
    fn leaves(&self, columns: &[usize]) -> (BTreeSet<AtomId>, BTreeSet<SignalId>) {
        let roots: Vec<Part> = columns.iter().map(|&column| self.columns[column].part()).collect();
        leaves(&self.tree, &roots).unwrap_or_default()
    }

    /// When some columns look at what.
    pub fn needs(&self, columns: &[usize]) -> Result<Needs, Invalid> {
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
}

/// Whether a number over some signals is made of times that count from 0.
pub fn is_never_early((tree, signals): (&Tree, &[Num]), term: TermId) -> bool {
    let of = |term: &TermId| is_never_early((tree, signals), *term);
    match &tree.terms[term.0 as usize] {
        Term::TimeUntil(_) | Term::Abs(_) => true,
        Term::Constant(value) => *value >= 0.0,
        Term::Signal(signal) => match &signals[signal.0 as usize] {
            Num::Time => true,
            Num::Of(field, _) => field.dimension() == Some(Dimension::TIME),
            Num::OfTwo(pair, ..) => pair.dimension() == Some(Dimension::TIME),
            _ => false,
        },
        Term::Combine(operation, a, b) => *operation != Operation::Subtract && of(a) && of(b),
        Term::Window(_, _, a) | Term::Later(_, a) | Term::AtEnd(a) => of(a),
    }
}
