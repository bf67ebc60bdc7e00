//! Nodes of formulas and terms, atoms and signals: each is kept once.

use crate::compile::context::{
    Context,
    parts::{Frame, Part},
    wording::bare,
};
use crate::compile::dimension::Dimension;
use crate::logic::{Node, NodeId, Relation, SignalId, Term, TermId};
use crate::model::{AgentId, Bool, Num, Who};
use crate::syntax::source::Span;
use std::sync::Arc;

/// How many conditions on states it may have.
const MOST_ATOMS: usize = 5_000;

impl Context<'_> {
    /// A formula node, shared with equal ones.
    pub(crate) fn node(&mut self, node: Node) -> NodeId {
        NodeId(self.observed.known[0].place(&mut self.observed.tree.nodes, node).0 as u32)
    }

    /// A numeric node, shared with equal ones.
    pub(crate) fn term(&mut self, term: Term) -> TermId {
        TermId(self.observed.known[1].place(&mut self.observed.tree.terms, term).0 as u32)
    }

    /// The formula that reads a truth value of the present state. Each spelling is separate, so a
    /// witness shows it as written.
    pub(crate) fn atom(&mut self, truth: Bool, span: Span, phrase: Option<&Arc<Part>>) -> NodeId {
        let text = self.words(span);
        self.atom_worded(truth, span, text, phrase)
    }

    /// The same in words that are not those of its place.
    pub(crate) fn atom_worded(
        &mut self,
        truth: Bool,
        span: Span,
        text: String,
        phrase: Option<&Arc<Part>>,
    ) -> NodeId {
        let node = self.atom_said(truth, span, text, false);
        if let (Node::Atom(atom), Some(part)) = (&self.observed.tree.nodes[node.0 as usize], phrase)
            && !part.is_plain()
        {
            self.observed.texts.parts.entry(atom.0).or_insert_with(|| part.clone());
        }
        node
    }

    /// The text of a place; arguments of a function are what it was called with.
    pub(crate) fn words(&self, span: Span) -> String {
        self.told((span, self.words.frame.as_ref()))
    }

    /// The words of a part.
    pub(crate) fn said_of(&self, part: &Part) -> String {
        match &part.said {
            Some(said) => said.to_string(),
            None => self.told((part.place, part.frame.as_ref())),
        }
    }

    fn told(&self, (place, frame): (Span, Option<&Arc<Frame>>)) -> String {
        let people = |who: Who| match who {
            // Whoever comes and goes has another name each time.
            Who::Agent(id) if !self.roster.passing.contains(&id) => {
                self.roster.agent_names.get(id.0 as usize).cloned()
            }
            _ => None,
        };
        let told = self.words.uses.worded(self.sources, (place, frame), &people);
        told.unwrap_or_else(|| bare(&self.text(place)).to_owned())
    }

    /// A generated condition differs from a written one with the same text.
    fn atom_said(&mut self, truth: Bool, span: Span, text: String, implied: bool) -> NodeId {
        if let Bool::Constant(value) = truth {
            return self.node(Node::Constant(value));
        }
        if self.observed.atoms.len() - self.observed.atoms_before >= MOST_ATOMS {
            if !self.sink.failed() {
                self.note(error!(E0211, span, "the formula expands into more than {MOST_ATOMS} conditions";
                    hint: "a quantifier over formulas is expanded for every agent; quantify over states instead: `F<=1 s (forall a in crowd: …)`"));
            }
            self.observed.overflown = true;
            return self.node(Node::Constant(false));
        }
        let (said, unsaid) = (&self.observed.texts.atoms, &self.observed.texts.implied);
        let same = |at: usize| said.get(at) == Some(&text) && unsaid.contains(&(at as u32)) == implied;
        let (at, new) = self.observed.known[2].place_said(&mut self.observed.atoms, truth, &text, same);
        if new {
            self.observed.texts.atoms.push(text);
            if implied {
                self.observed.texts.implied.insert(at as u32);
            }
        }
        self.node(Node::Atom(crate::logic::AtomId(at as u32)))
    }

    /// A generated condition that an agent is present, with a text of its own.
    pub(crate) fn presence_of(&mut self, id: AgentId, span: Span) -> NodeId {
        let name = self.roster.agent_names.get(id.0 as usize).map_or("", String::as_str);
        let text = format!("present({name})");
        self.atom_said(Bool::Present(Who::Agent(id)), span, text, true)
    }

    /// A comparison of numbers over time.
    pub(crate) fn comparison(
        &mut self,
        (relation, a, b): (Relation, TermId, TermId),
        text: String,
        dimension: Dimension,
    ) -> NodeId {
        let said = &self.observed.texts.comparisons;
        let same = |at: usize| said.get(&(at as u32)).is_some_and(|(known, _)| *known == text);
        let nodes = &mut self.observed.tree.nodes;
        let (at, new) = self.observed.known[0].place_said(nodes, Node::Compare(relation, a, b), &text, same);
        let node = NodeId(at as u32);
        if new {
            self.observed.texts.comparisons.insert(node.0, (text, dimension));
        }
        node
    }

    /// The term that reads a number of the present state.
    pub(crate) fn signal(&mut self, num: Num, dimension: Dimension, span: Span) -> TermId {
        if let Num::Constant(value) = num {
            return self.term(Term::Constant(value));
        }
        let text = self.words(span);
        let said = &self.observed.texts.signals;
        let same = |at: usize| said.get(at).is_some_and(|(known, _)| *known == text);
        let (at, new) = self.observed.known[3].place_said(&mut self.observed.signals, num, &text, same);
        if new {
            self.observed.texts.signals.push((text, dimension));
        }
        self.term(Term::Signal(SignalId(at as u32)))
    }
}
