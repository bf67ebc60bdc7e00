//! Counts of formulas over time, compared with a number: `count(a in crowd: F<=5 s (a in exit)) >= 3`.
//!
//! At least k of n formulas hold exactly if the first holds and at least k - 1 of the others do, or at least k
//! of the others do. Written out with shared parts these are n·k nodes, and a monitor decides as soon as the
//! members that are decided force the count.

use super::super::elaborator::{Elaborator, Lowered};
use crate::logic::{Node, NodeId, Relation};
use crate::syntax::source::Span;

/// Most nodes of one count.
const LARGEST: usize = 20_000;

impl Elaborator<'_> {
    /// How many of the formulas hold, compared with a number.
    pub(super) fn tally(
        &mut self,
        formulas: &[NodeId],
        relation: Relation,
        bound: f64,
        span: Span,
    ) -> Lowered<NodeId> {
        let whole = bound.fract() == 0.0;
        let (least, above) = (bound.ceil(), bound.floor() + 1.0);
        Ok(match relation {
            Relation::AtLeast => self.at_least(formulas, least, span)?,
            Relation::Greater => self.at_least(formulas, above, span)?,
            Relation::Less => {
                let reached = self.at_least(formulas, least, span)?;
                self.node(Node::Not(reached))
            }
            Relation::AtMost => {
                let reached = self.at_least(formulas, above, span)?;
                self.node(Node::Not(reached))
            }
            Relation::Equal | Relation::Unequal => {
                let equal = if whole {
                    let reached = self.at_least(formulas, least, span)?;
                    let passed = self.at_least(formulas, above, span)?;
                    let not_passed = self.node(Node::Not(passed));
                    self.node(Node::And(vec![reached, not_passed]))
                } else {
                    self.node(Node::Constant(false))
                };
                if relation == Relation::Equal { equal } else { self.node(Node::Not(equal)) }
            }
        })
    }

    fn at_least(&mut self, formulas: &[NodeId], bound: f64, span: Span) -> Lowered<NodeId> {
        let n = formulas.len();
        if bound <= 0.0 {
            return Ok(self.node(Node::Constant(true)));
        }
        if bound > n as f64 {
            return Ok(self.node(Node::Constant(false)));
        }
        let k = bound as usize;
        if k == 1 {
            return Ok(self.node(Node::Or(formulas.to_vec())));
        }
        if n.saturating_mul(k.min(n - k + 1)) > LARGEST {
            return self.report(error!(E0504, span, "a count of {n} temporal formulas is too large";
                hint: "count in each state: `F<=10 s (count(a in crowd: a in exit) >= 3)`"));
        }
        if n - k + 1 < k {
            // At least k hold exactly if fewer than n - k + 1 fail.
            let failures: Vec<NodeId> = formulas.iter().map(|f| self.node(Node::Not(*f))).collect();
            let many = self.table(&failures, n - k + 1);
            return Ok(self.node(Node::Not(many)));
        }
        Ok(self.table(formulas, k))
    }

    /// `row[j]`: at least `j` of the formulas looked at so far, from the last to the first, hold.
    fn table(&mut self, formulas: &[NodeId], k: usize) -> NodeId {
        let mut row: Vec<Option<NodeId>> = vec![None; k + 1];
        row[0] = Some(self.node(Node::Constant(true)));
        for &formula in formulas.iter().rev() {
            for j in (1..=k).rev() {
                let with = match row[j - 1] {
                    Some(_) if j == 1 => Some(formula),
                    Some(rest) => Some(self.node(Node::And(vec![formula, rest]))),
                    None => None,
                };
                row[j] = match (with, row[j]) {
                    (Some(with), Some(without)) => Some(self.node(Node::Or(vec![with, without]))),
                    (with, without) => with.or(without),
                };
            }
        }
        // There are at least k formulas.
        row[k].unwrap_or_else(|| self.node(Node::Constant(false)))
    }
}
