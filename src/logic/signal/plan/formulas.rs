//! Cells of formulas, and of comparisons with a constant.

use super::super::average::Average;
use super::super::moment::Moment;
use super::super::truth::{Machine, Ref, Seen};
use super::{Builder, Range};
use crate::base::tick::Tick;
use crate::logic::formula::{Aggregation, Node, NodeId, Relation, Term, TermId, Window};
use crate::logic::invalid::Invalid;

impl Builder<'_> {
    /// A formula at some moments.
    pub(super) fn truth(&mut self, id: NodeId, range: Range) -> Result<Ref, Invalid> {
        if let Some(&known) = self.known_truths.get(&(id.0, range)) {
            return Ok(known);
        }
        let k = id.0 as usize;
        let tree = self.tree;
        let made = if let Some(truth) = self.parts.node_constants[k] {
            self.add_truth(Machine::Fixed(truth), range)?
        } else if let Some(slot) = self.parts.node_slots[k] {
            self.add_truth(Machine::Present(slot), range)?
        } else {
            match &tree.nodes[k] {
                Node::Constant(truth) => self.add_truth(Machine::Fixed(*truth), range)?,
                Node::Atom(_) => return Err(Invalid::Malformed),
                Node::Compare(relation, x, y) => self.compare(*relation, *x, *y, range)?,
                Node::Not(x) => !self.truth(*x, range)?,
                Node::Or(parts) => self.any(parts, false, range)?,
                Node::And(parts) => !self.any(parts, true, range)?,
                Node::Finally(w, x) => self.somewhere(*w, *x, false, range)?,
                Node::Globally(w, x) => !self.somewhere(*w, *x, true, range)?,
                Node::Until(w, p, q) => self.until(*w, (*p, *q), false, range)?,
                Node::Release(w, p, q) => !self.until(*w, (*p, *q), true, range)?,
                Node::WeakUntil(w, p, q) => {
                    let until = self.until(*w, (*p, *q), false, range)?;
                    let window = Window { from: Tick(0), to: w.to };
                    let all = !self.somewhere(window, *p, true, range)?;
                    self.add_truth(Machine::Any([until, all].into()), range)?
                }
            }
        };
        self.known_truths.insert((id.0, range), made);
        Ok(made)
    }

    fn any(&mut self, parts: &[NodeId], negated: bool, range: Range) -> Result<Ref, Invalid> {
        let mut operands = Vec::new();
        for part in parts {
            if self.parts.node_constants[part.0 as usize].is_none() {
                let operand = self.truth(*part, range)?;
                operands.push(if negated { !operand } else { operand });
            }
        }
        self.add_truth(Machine::Any(operands.into()), range)
    }

    fn somewhere(&mut self, w: Window, x: NodeId, negated: bool, range: Range) -> Result<Ref, Invalid> {
        let shifts = self.shifts(w);
        let operand = self.truth(x, self.through(shifts, range))?;
        self.reach(shifts, if negated { !operand } else { operand }, range)
    }

    fn reach(&mut self, (from, to): (Moment, Moment), operand: Ref, range: Range) -> Result<Ref, Invalid> {
        self.add_truth(Machine::Reach(Seen::Within { from, to }, operand), range)
    }

    fn until(
        &mut self,
        w: Window,
        (p, q): (NodeId, NodeId),
        negated: bool,
        range: Range,
    ) -> Result<Ref, Invalid> {
        let (from, to) = self.shifts(w);
        let asked = self.through((from, to), range);
        let second = self.truth(q, asked)?;
        let second = if negated { !second } else { second };
        if to == 0 {
            return Ok(second);
        }
        // Up to just before the last instant.
        let first = self.truth(p, (range.0, (asked.1 - 1) | 1))?;
        let first = if negated { !first } else { first };
        self.add_truth(Machine::Until { from, to, first, second }, range)
    }

    fn compare(&mut self, relation: Relation, x: TermId, y: TermId, range: Range) -> Result<Ref, Invalid> {
        match (self.parts.term_constants[x.0 as usize], self.parts.term_constants[y.0 as usize]) {
            (None, Some(c)) => self.against(relation, x, c, range),
            (Some(c), None) => self.against(relation.flipped(), y, c, range),
            (Some(x), Some(y)) => self.add_truth(Machine::Alike(relation, x, y), range),
            (None, None) => {
                let (x, y) = (self.number(x, range)?, self.number(y, range)?);
                self.add_truth(Machine::Compare(relation, x, y), range)
            }
        }
    }

    /// A comparison with a constant looks at the moments of extremes and times one by one.
    fn against(&mut self, relation: Relation, x: TermId, c: f64, range: Range) -> Result<Ref, Invalid> {
        use Relation::{AtLeast, AtMost, Equal, Greater, Less, Unequal};
        if let Some(value) = self.parts.term_constants[x.0 as usize] {
            return self.add_truth(Machine::Alike(relation, value, c), range);
        }
        if let Some(slot) = self.compare_now(relation, x, c) {
            return self.add_truth(Machine::Present(slot), range);
        }
        let tree = self.tree;
        if let Some((w, x, any)) = tree.within(relation, x) {
            return self.through_window(w, (relation, x, c), any, range);
        }
        match (&tree.terms[x.0 as usize], relation) {
            (Term::AtEnd(x), _) => {
                let end = self.last();
                let operand = self.against(relation, *x, c, (end, end))?;
                self.add_truth(Machine::Spread(operand), range)
            }
            (Term::Window(Aggregation::Mean, w, x), _) if w.to == Some(w.from) => {
                self.through_window(*w, (relation, *x, c), true, range)
            }
            (Term::Window(Aggregation::Mean, w, x), _) => {
                let (from, to) = self.shifts(*w);
                let of = self.excess(*x, c, self.through((from, to), range))?;
                if range.0 < range.1 {
                    return self.add_truth(Machine::Average(Average { of, from, to, relation }), range);
                }
                let mean = self.average(of, self.through((from, to), range), range)?;
                let zero = self.fixed(0.0, range)?;
                self.add_truth(Machine::Compare(relation, mean, zero), range)
            }
            (Term::TimeUntil(goal), _) if !c.is_nan() => match relation {
                AtMost => self.soon(*goal, c, false, range),
                Less => self.soon(*goal, c, true, range),
                Greater => self.soon(*goal, c, false, range).map(|soon| !soon),
                AtLeast => self.soon(*goal, c, true, range).map(|soon| !soon),
                Equal | Unequal => {
                    let later = !self.soon(*goal, c, false, range)?;
                    let sooner = self.soon(*goal, c, true, range)?;
                    let unequal = self.add_truth(Machine::Any([later, sooner].into()), range)?;
                    Ok(if relation == Equal { !unequal } else { unequal })
                }
            },
            _ => {
                let of = self.number(x, range)?;
                let constant = self.fixed(c, range)?;
                self.add_truth(Machine::Compare(relation, of, constant), range)
            }
        }
    }

    /// The comparison somewhere, or everywhere, in a window.
    fn through_window(
        &mut self,
        window: Window,
        (relation, x, c): (Relation, TermId, f64),
        somewhere: bool,
        range: Range,
    ) -> Result<Ref, Invalid> {
        let shifts = self.shifts(window);
        let operand = self.against(relation, x, c, self.through(shifts, range))?;
        let reach = self.reach(shifts, if somewhere { operand } else { !operand }, range)?;
        Ok(if somewhere { reach } else { !reach })
    }

    /// The time until a goal is at most `c` seconds, or less.
    fn soon(&mut self, goal: NodeId, c: f64, strictly: bool, range: Range) -> Result<Ref, Invalid> {
        let last = self.last();
        if c == f64::INFINITY {
            // It is at most infinite in any case, and less if it comes at all.
            if !strictly {
                return self.add_truth(Machine::Fixed(true), range);
            }
            return self.somewhere(Window { from: Tick(0), to: None }, goal, false, range);
        }
        let within = self.scale.span(c);
        if within < Moment::from(strictly) {
            return self.add_truth(Machine::Fixed(false), range);
        }
        // What begins right after an instant comes at that instant's time, unless to see that the goal had to look beyond the
        // horizon.
        let last = last - self.scale.shift(self.last_asked(goal)?);
        let operand = self.truth(goal, (range.0, (range.1 + within + 1).min(last)))?;
        self.add_truth(Machine::Reach(Seen::Soon { within, strictly }, operand), range)
    }
}
