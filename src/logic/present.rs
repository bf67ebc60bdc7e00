//! Truths and numbers of the present state alone, as straight-line code, and which parts of a tree they are.

use super::formula::{Node, NodeId, Operation, Relation, Term, TermId, Tree};
use super::reach::Part;

/// One result: a truth or a number of the state that begins.
#[derive(Clone, Debug)]
pub(super) enum Code {
    Atom(usize),
    Compare(Relation, usize, usize),
    Not(usize),
    All(Box<[usize]>),
    Any(Box<[usize]>),
    Signal(usize),
    Number(f64),
    Combine(Operation, usize, usize),
    Abs(usize),
}

/// The code and its latest results.
#[derive(Clone, Debug, Default)]
pub(super) struct Present {
    code: Vec<Code>,
    truths: Vec<bool>,
    numbers: Vec<f64>,
}

impl Present {
    /// Adds a result. Operands stand before it.
    pub(super) fn add(&mut self, code: Code) -> usize {
        self.code.push(code);
        self.truths.push(false);
        self.numbers.push(0.0);
        self.code.len() - 1
    }

    /// Computes everything for a new state. What is missing counts as false and as no number.
    #[inline]
    pub(super) fn read(&mut self, atoms: &[bool], signals: &[f64]) {
        for (k, code) in self.code.iter().enumerate() {
            match code {
                Code::Atom(a) => self.truths[k] = atoms.get(*a).copied().unwrap_or(false),
                Code::Compare(relation, x, y) => {
                    self.truths[k] = relation.holds(self.numbers[*x], self.numbers[*y]);
                }
                Code::Not(x) => self.truths[k] = !self.truths[*x],
                Code::All(all) => self.truths[k] = all.iter().all(|x| self.truths[*x]),
                Code::Any(all) => self.truths[k] = all.iter().any(|x| self.truths[*x]),
                Code::Signal(s) => self.numbers[k] = signals.get(*s).copied().unwrap_or(f64::NAN),
                Code::Number(value) => self.numbers[k] = *value,
                Code::Combine(operation, x, y) => {
                    self.numbers[k] = operation.apply(self.numbers[*x], self.numbers[*y]);
                }
                Code::Abs(x) => self.numbers[k] = self.numbers[*x].abs(),
            }
        }
    }

    /// Computes the margins of everything for a new state: a truth has its margin as its number. One that is no number
    /// counts as false.
    pub(super) fn measure(&mut self, atoms: &[bool], signals: &[f64]) {
        for k in 0..self.code.len() {
            let of = |x: &usize| self.numbers[*x];
            self.numbers[k] = match &self.code[k] {
                Code::Atom(a) if atoms.get(*a).copied().unwrap_or(false) => f64::INFINITY,
                Code::Atom(_) => f64::NEG_INFINITY,
                Code::Compare(relation, x, y) => {
                    let margin = relation.margin(of(x), of(y));
                    if margin.is_nan() { f64::NEG_INFINITY } else { margin }
                }
                Code::Not(x) => -of(x),
                Code::All(all) => all.iter().map(of).fold(f64::INFINITY, |x, y| if y < x { y } else { x }),
                Code::Any(all) => {
                    all.iter().map(of).fold(f64::NEG_INFINITY, |x, y| if y > x { y } else { x })
                }
                Code::Signal(s) => signals.get(*s).copied().unwrap_or(f64::NAN),
                Code::Number(value) => *value,
                Code::Combine(operation, x, y) => operation.apply(of(x), of(y)),
                Code::Abs(x) => of(x).abs(),
            };
        }
    }

    #[inline]
    pub(super) fn truth(&self, k: usize) -> bool {
        self.truths[k]
    }

    #[inline]
    pub(super) fn number(&self, k: usize) -> f64 {
        self.numbers[k]
    }
}

/// Which parts of a tree are the same everywhere, and where the code of those of the present state alone is.
pub(super) struct Parts<'t> {
    tree: &'t Tree,
    /// Whether margins are asked for: then a comparison of constants has one, too, and is no constant.
    margins: bool,
    pub(super) present: Present,
    /// Results of the present state alone.
    pub(super) node_slots: Vec<Option<usize>>,
    pub(super) term_slots: Vec<Option<usize>>,
    /// The constant parts.
    pub(super) node_constants: Vec<Option<bool>>,
    pub(super) term_constants: Vec<Option<f64>>,
}

impl<'t> Parts<'t> {
    pub(super) fn new(tree: &'t Tree, margins: bool) -> Self {
        Self {
            tree,
            margins,
            present: Present::default(),
            node_slots: vec![None; tree.nodes.len()],
            term_slots: vec![None; tree.terms.len()],
            node_constants: vec![None; tree.nodes.len()],
            term_constants: vec![None; tree.terms.len()],
        }
    }

    /// Notes whether a part is the same everywhere, or is one of the present state alone. Children come
    /// first.
    pub(super) fn note(&mut self, part: Part) {
        match part {
            Part::Node(id) => {
                let k = id.0 as usize;
                self.node_constants[k] = self.constant(id);
                if self.node_constants[k].is_none() {
                    self.node_slots[k] = self.node_code(id).map(|code| self.present.add(code));
                }
            }
            Part::Term(id) => {
                let k = id.0 as usize;
                self.term_constants[k] = self.tree.constant(id, |x| self.term_constants[x.0 as usize]);
                let code = match self.term_constants[k] {
                    Some(value) => Some(Code::Number(value)),
                    None => self.term_code(id),
                };
                self.term_slots[k] = code.map(|code| self.present.add(code));
            }
        }
    }

    fn constant(&self, id: NodeId) -> Option<bool> {
        let of = |id: &NodeId| self.node_constants[id.0 as usize];
        match &self.tree.nodes[id.0 as usize] {
            Node::Constant(truth) => Some(*truth),
            Node::Compare(relation, x, y) if !self.margins => {
                Some(relation.holds(self.term_constants[x.0 as usize]?, self.term_constants[y.0 as usize]?))
            }
            Node::Not(x) => of(x).map(|truth| !truth),
            Node::And(all) if all.iter().any(|x| of(x) == Some(false)) => Some(false),
            Node::And(all) => all.iter().all(|x| of(x) == Some(true)).then_some(true),
            Node::Or(all) if all.iter().any(|x| of(x) == Some(true)) => Some(true),
            Node::Or(all) => all.iter().all(|x| of(x) == Some(false)).then_some(false),
            _ => None,
        }
    }

    fn node_code(&self, id: NodeId) -> Option<Code> {
        let slot = |id: &NodeId| self.node_slots[id.0 as usize];
        let all = |parts: &[NodeId]| {
            let open = parts.iter().filter(|x| self.node_constants[x.0 as usize].is_none());
            open.map(slot).collect::<Option<Box<[usize]>>>()
        };
        match &self.tree.nodes[id.0 as usize] {
            Node::Atom(atom) => Some(Code::Atom(atom.0 as usize)),
            // Its margin is known in states to come.
            Node::Compare(_, x, y)
                if self.margins
                    && [x, y].map(|x| self.term_constants[x.0 as usize]).iter().all(Option::is_some) =>
            {
                None
            }
            Node::Compare(relation, x, y) => {
                Some(Code::Compare(*relation, self.term_slots[x.0 as usize]?, self.term_slots[y.0 as usize]?))
            }
            Node::Not(x) => slot(x).map(Code::Not),
            Node::And(parts) => all(parts).map(Code::All),
            Node::Or(parts) => all(parts).map(Code::Any),
            _ => None,
        }
    }

    fn term_code(&self, id: TermId) -> Option<Code> {
        let slot = |id: &TermId| self.term_slots[id.0 as usize];
        match &self.tree.terms[id.0 as usize] {
            Term::Signal(signal) => Some(Code::Signal(signal.0 as usize)),
            Term::Combine(operation, x, y) => Some(Code::Combine(*operation, slot(x)?, slot(y)?)),
            Term::Abs(x) => slot(x).map(Code::Abs),
            _ => None,
        }
    }
}
