//! A world made ready to run: a program of the kernel and what is observed in it.

use crate::compile::study::{Origins, Study, Texts, World};
use crate::kernel::Program;
use crate::kernel::driver::{Drivers, MakeDrivers};
use crate::logic::{Invalid, Node, NodeId, Root};
use crate::trials::setup::Setup;
use std::ops::Deref;

/// Most jumps of a trial, and most that are made again to see why one is unresolved.
const MOST_JUMPS: u64 = 1 << 26;
const JUMPS_AGAIN: u64 = 1 << 24;

/// A world made ready to run.
pub struct PreparedWorld {
    /// Number of the world in its study, by which other processes find it; `None` where it is of no study.
    pub number: Option<usize>,
    pub(in crate::engine) setup: Setup,
    /// How atoms, signals and comparisons were written.
    pub texts: Texts,
    /// Where what can go wrong is written.
    pub origins: Origins,
    /// Most jumps that are made again to see why a trial is unresolved.
    pub(in crate::engine) jumps_again: u64,
}

impl Deref for PreparedWorld {
    type Target = Setup;

    fn deref(&self) -> &Setup {
        &self.setup
    }
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
        let setup = Setup {
            horizon: scenario.horizon,
            program: Program::driven(scenario, drivers),
            tree: world.tree.clone(),
            columns: world.columns.iter().map(|c| c.root).collect(),
            most_jumps: MOST_JUMPS,
            atoms: world.atoms.clone(),
            signals: world.signals.clone(),
        };
        Self {
            number: None,
            setup,
            texts: world.texts.clone(),
            origins: world.origins.clone(),
            jumps_again: JUMPS_AGAIN,
        }
    }

    /// The implications of a column that are watched; of each, whether it is one of a quantifier that asks about
    /// those who are there, so that nobody wrote it.
    pub(in crate::engine) fn implications(&self, column: usize) -> Result<Vec<bool>, Invalid> {
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
}
