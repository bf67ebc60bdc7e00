//! What is observed of states: nodes of formulas and terms, atoms and signals, and how each was written.

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::study::Part;
use super::wording::Frame;
use crate::logic::{Node, NodeId, Relation, SignalId, Term, TermId};
use crate::model::{AgentId, Bool, Num, Who};
use crate::syntax::source::Span;
use std::sync::Arc;

/// How many conditions on states it may have.
const MOST_ATOMS: usize = 5_000;

impl Elaborator<'_> {
    /// A formula node, shared with equal ones.
    pub(super) fn node(&mut self, node: Node) -> NodeId {
        NodeId(self.known[0].place(&mut self.tree.nodes, node).0 as u32)
    }

    /// A numeric node, shared with equal ones.
    pub(super) fn term(&mut self, term: Term) -> TermId {
        TermId(self.known[1].place(&mut self.tree.terms, term).0 as u32)
    }

    /// The formula that reads a truth value of the present state. Each spelling is separate, so a
    /// witness shows it as written.
    pub(super) fn atom(&mut self, truth: Bool, span: Span, phrase: Option<&Arc<Part>>) -> NodeId {
        let text = self.words(span);
        self.atom_worded(truth, span, text, phrase)
    }

    /// The same in words that are not those of its place.
    pub(super) fn atom_worded(
        &mut self,
        truth: Bool,
        span: Span,
        text: String,
        phrase: Option<&Arc<Part>>,
    ) -> NodeId {
        let node = self.atom_said(truth, span, text, false);
        if let (Node::Atom(atom), Some(part)) = (&self.tree.nodes[node.0 as usize], phrase)
            && !part.is_plain()
        {
            self.texts.parts.entry(atom.0).or_insert_with(|| part.clone());
        }
        node
    }

    /// The text of a place; arguments of a function are what it was called with.
    pub(super) fn words(&self, span: Span) -> String {
        self.told((span, self.frame.as_ref()))
    }

    /// The words of a part.
    pub(super) fn said_of(&self, part: &Part) -> String {
        match &part.said {
            Some(said) => said.to_string(),
            None => self.told((part.place, part.frame.as_ref())),
        }
    }

    fn told(&self, (place, frame): (Span, Option<&Arc<Frame>>)) -> String {
        let people = |who: Who| match who {
            // Whoever comes and goes has another name each time.
            Who::Agent(id) if !self.passing.contains(&id) => self.agent_names.get(id.0 as usize).cloned(),
            _ => None,
        };
        let told = self.uses.worded(self.sources, (place, frame), &people);
        told.unwrap_or_else(|| bare(&self.text(place)).to_owned())
    }

    /// A generated condition differs from a written one with the same text.
    fn atom_said(&mut self, truth: Bool, span: Span, text: String, implied: bool) -> NodeId {
        if let Bool::Constant(value) = truth {
            return self.node(Node::Constant(value));
        }
        if self.atoms.len() - self.atoms_before >= MOST_ATOMS {
            if !self.failed() {
                self.note(error!(E0211, span, "the formula expands into more than {MOST_ATOMS} conditions";
                    hint: "a quantifier over formulas is expanded for every agent; quantify over states instead: `F<=1 s (forall a in crowd: …)`"));
            }
            self.overflown = true;
            return self.node(Node::Constant(false));
        }
        let (said, unsaid) = (&self.texts.atoms, &self.texts.implied);
        let same = |at: usize| said.get(at) == Some(&text) && unsaid.contains(&(at as u32)) == implied;
        let (at, new) = self.known[2].place_said(&mut self.atoms, truth, &text, same);
        if new {
            self.texts.atoms.push(text);
            if implied {
                self.texts.implied.insert(at as u32);
            }
        }
        self.node(Node::Atom(crate::logic::AtomId(at as u32)))
    }

    /// A generated condition that an agent is present, with a text of its own.
    pub(super) fn presence(&mut self, id: AgentId, span: Span) -> NodeId {
        let name = self.agent_names.get(id.0 as usize).map_or("", String::as_str);
        let text = format!("present({name})");
        self.atom_said(Bool::Present(Who::Agent(id)), span, text, true)
    }

    /// A comparison of numbers over time.
    pub(super) fn comparison(
        &mut self,
        (relation, a, b): (Relation, TermId, TermId),
        text: String,
        dimension: Dimension,
    ) -> NodeId {
        let said = &self.texts.comparisons;
        let same = |at: usize| said.get(&(at as u32)).is_some_and(|(known, _)| *known == text);
        let nodes = &mut self.tree.nodes;
        let (at, new) = self.known[0].place_said(nodes, Node::Compare(relation, a, b), &text, same);
        let node = NodeId(at as u32);
        if new {
            self.texts.comparisons.insert(node.0, (text, dimension));
        }
        node
    }

    /// The term that reads a number of the present state.
    pub(super) fn signal(&mut self, num: Num, dimension: Dimension, span: Span) -> TermId {
        if let Num::Constant(value) = num {
            return self.term(Term::Constant(value));
        }
        let text = self.words(span);
        let said = &self.texts.signals;
        let same = |at: usize| said.get(at).is_some_and(|(known, _)| *known == text);
        let (at, new) = self.known[3].place_said(&mut self.signals, num, &text, same);
        if new {
            self.texts.signals.push((text, dimension));
        }
        self.term(Term::Signal(SignalId(at as u32)))
    }
}

/// A text without parentheses around the whole of it.
pub(super) fn bare(text: &str) -> &str {
    let Some(inner) = text.strip_prefix('(').and_then(|t| t.strip_suffix(')')) else { return text };
    let mut depth = 0i32;
    for c in inner.chars() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        if depth < 0 {
            // The first parenthesis closes before the end: `(a) & (b)`.
            return text;
        }
    }
    bare(inner.trim())
}

#[cfg(test)]
mod tests {
    use super::bare;

    #[test]
    fn only_parentheses_around_the_whole_go() {
        assert_eq!(bare("((a > 1 m))"), "a > 1 m");
        assert_eq!(bare("(a) & (b)"), "(a) & (b)");
        assert_eq!(bare("f(a)"), "f(a)");
    }
}
