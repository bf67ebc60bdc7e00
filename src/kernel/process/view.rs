//! What monitors want to know of the states of a scenario in continuous time, trial by trial: a table where
//! it depends on few values of variables, else code over lanes.

use super::super::code::{Code, Readings};
use super::super::state::{Layout, State};
use super::keys::Keys;
use super::table::MOST_ROWS;
use crate::model::{Bool, Domain, Num, Scenario};
use std::collections::BTreeSet;

/// Truth values and numbers of a state.
#[derive(Clone, Debug)]
pub struct View {
    keys: Option<Keys>,
    code: Code,
    /// Row by row, where there are keys.
    atoms: Vec<bool>,
    signals: Vec<f64>,
    /// Number of atoms and of signals.
    width: (usize, usize),
}

/// What was seen of the states of a batch.
#[derive(Clone, Debug, Default)]
pub struct Sight {
    readings: Readings,
    atoms: Vec<bool>,
    signals: Vec<f64>,
}

impl View {
    /// Prepares to look at the states of a scenario of processes.
    pub fn new(scenario: &Scenario, atoms: &[Bool], signals: &[Num]) -> Self {
        let domains: Vec<Domain> = scenario.processes.variables.iter().map(|v| v.domain).collect();
        let mut read = BTreeSet::new();
        let closed = atoms.iter().fold(true, |so_far, atom| so_far & atom.reads(&mut read))
            & signals.iter().fold(true, |so_far, signal| so_far & signal.reads(&mut read));
        let mut view = Self {
            keys: if closed { Keys::of(&read, &domains, MOST_ROWS) } else { None },
            code: Code::compile(scenario, atoms, signals),
            atoms: Vec::new(),
            signals: Vec::new(),
            width: (atoms.len(), signals.len()),
        };
        if let Some(keys) = &view.keys {
            let (atoms, signals) = (&mut view.atoms, &mut view.signals);
            keys.each_row(&view.code, domains.len(), |readings, lane| {
                atoms.extend(readings.atoms.iter().map(|mask| mask.has(lane)));
                signals.extend(readings.signals.iter().map(|lanes| lanes.0[lane]));
                Some(())
            });
        }
        view
    }

    /// Looks at the states of a batch.
    #[inline]
    pub fn look(&self, state: &State, sight: &mut Sight) {
        if self.keys.is_none() {
            self.code.read(Layout::Trials, state, &mut sight.readings);
        }
    }

    /// The atoms and signals of one lane, of a batch that was looked at.
    #[inline]
    pub fn of<'s>(&'s self, state: &State, sight: &'s mut Sight, lane: usize) -> (&'s [bool], &'s [f64]) {
        let (atoms, signals) = self.width;
        if let Some(keys) = &self.keys {
            let row = keys.row(&state.variables, lane);
            return (&self.atoms[row * atoms..][..atoms], &self.signals[row * signals..][..signals]);
        }
        sight.atoms.clear();
        sight.atoms.extend(sight.readings.atoms.iter().map(|mask| mask.has(lane)));
        sight.signals.clear();
        sight.signals.extend(sight.readings.signals.iter().map(|lanes| lanes.0[lane]));
        (&sight.atoms, &sight.signals)
    }
}
