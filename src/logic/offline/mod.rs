//! A formula over the first states of one recorded trial, for replayed trials and explanations.
//!
//! What is not known is open and connectives are Kleene's, as the definition has it. Every part is evaluated at all
//! states at which it is asked about in one pass from the last to the first, so the cost is that of the states,
//! however wide the windows are and however often parts are shared. The monitors do the same for eight running
//! trials at once, as the states come.

mod graph;
mod tracks;

use super::formula::{AtomId, NodeId, SignalId, TermId, Tree};
use super::invalid::Invalid;
use super::reach::Part;
use crate::base::tick::{Clock, Tick};
pub(super) use graph::Slot;
use graph::{Graph, graph};
pub(super) use tracks::{FALSE, Next, OPEN, Slide, TRUE, backward, turned};
use tracks::{Track, tracks};

/// A recorded trial. States are counted from 0.
pub struct Recording<'a> {
    /// Truth of an atom in a state.
    pub atoms: &'a dyn Fn(AtomId, u64) -> bool,
    /// A signal in a state.
    pub signals: &'a dyn Fn(SignalId, u64) -> f64,
    /// Number of states to look at.
    pub seen: u64,
    /// The last state that a trial has.
    pub horizon: Tick,
    /// The clock of the states.
    pub clock: Clock,
    /// Whether there is no time left: then everything stays open.
    pub stop: &'a dyn Fn() -> bool,
}

/// A part of a tree over a recording, asked about at one state, with all that is below it. The tree must be one that a
/// monitor accepts.
pub(super) struct Offline<'a> {
    pub(super) tree: &'a Tree,
    pub(super) recording: &'a Recording<'a>,
    graph: Graph,
    tracks: Vec<Track>,
}

impl<'a> Offline<'a> {
    /// Evaluates a part at the state `at`.
    pub(super) fn new(
        tree: &'a Tree,
        root: Part,
        at: u64,
        recording: &'a Recording<'a>,
    ) -> Result<Self, Invalid> {
        Ok(Self::of(graph(tree, root, at, recording, false)?, tree, recording))
    }

    /// The same of a formula at the first state, where a comparison of constants is one of each state, so that it has a margin.
    pub(super) fn measured(
        tree: &'a Tree,
        root: NodeId,
        recording: &'a Recording<'a>,
    ) -> Result<Self, Invalid> {
        Ok(Self::of(graph(tree, Part::Node(root), 0, recording, true)?, tree, recording))
    }

    fn of(graph: Graph, tree: &'a Tree, recording: &'a Recording<'a>) -> Self {
        let tracks = tracks(&graph, recording);
        Self { tree, recording, graph, tracks }
    }

    /// The slots of all parts, children first.
    pub(super) fn slots(&self) -> &[Slot] {
        &self.graph.slots
    }

    /// The atom or comparison whose truth a slot is.
    pub(super) fn leaf(&self, slot: usize) -> Option<NodeId> {
        self.graph.leaves[slot]
    }

    /// The slot of a formula.
    pub(super) fn slot(&self, id: NodeId) -> Option<usize> {
        self.graph.nodes[id.0 as usize]
    }

    /// The states seen at which a slot is asked about: the first, and how many.
    pub(super) fn range(&self, slot: usize) -> (u64, usize) {
        let Some((lo, hi)) = self.graph.ranges[slot] else { return (0, 0) };
        (lo, hi.saturating_add(1).min(self.recording.seen).saturating_sub(lo) as usize)
    }

    /// The states at which a truth is next false, open or true, from behind the last one.
    pub(super) fn next(&self, slot: usize) -> Next {
        Next::new(self.recording.seen, self.tracks[slot].truth(self.recording.seen))
    }

    /// The last state of a window that begins at `at`.
    pub(super) fn end(&self, at: u64, to: Option<u64>) -> u64 {
        self.graph.end(at, to)
    }

    /// Whether a formula's slot is true, false or open at a state.
    pub(super) fn look(&self, slot: usize, at: u64) -> u8 {
        self.tracks[slot].truth(at)
    }

    /// A formula at a state, `None` while it is open.
    pub(super) fn truth(&self, id: NodeId, at: u64) -> Option<bool> {
        self.slot(id).and_then(|slot| tracks::known(self.look(slot, at)))
    }

    /// A number at a state, `None` while it is open.
    pub(super) fn number(&self, id: TermId, at: u64) -> Option<f64> {
        self.graph.terms[id.0 as usize].and_then(|slot| self.tracks[slot].number(at))
    }

    /// A number's slot at a state, `None` while it is open.
    pub(super) fn value(&self, slot: usize, at: u64) -> Option<f64> {
        self.tracks[slot].number(at)
    }

    /// Number of states seen.
    pub(super) fn seen(&self) -> u64 {
        self.recording.seen
    }

    /// A number that does not depend on any state.
    pub(super) fn constant(&self, id: TermId) -> Option<f64> {
        self.graph.constants[id.0 as usize]
    }
}
