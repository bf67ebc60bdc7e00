//! Counts of formulas over time, compared with a number: `count(a in crowd: F<=5 s (a in exit)) >= 3`.
//!
//! At least k of n formulas hold exactly if the first holds and at least k - 1 of the others do, or at least k
//! of the others do. Written out with shared parts these are n·k nodes, and a monitor decides as soon as the
//! members that are decided force the count.

use crate::compile::context::{Context, Lowered};
use crate::logic::{Node, NodeId, Relation};
use crate::syntax::source::Span;

/// Most nodes of one count.
const LARGEST: usize = 20_000;

/// How many of the formulas hold, compared with a number.
pub(crate) fn tally(
    context: &mut Context<'_>,
    formulas: &[NodeId],
    relation: Relation,
    bound: f64,
    span: Span,
) -> Lowered<NodeId> {
    let whole = bound.fract() == 0.0;
    let (least, above) = (bound.ceil(), bound.floor() + 1.0);
    Ok(match relation {
        Relation::AtLeast => at_least(context, formulas, least, span)?,
        Relation::Greater => at_least(context, formulas, above, span)?,
        Relation::Less => {
            let reached = at_least(context, formulas, least, span)?;
            context.node(Node::Not(reached))
        }
        Relation::AtMost => {
            let reached = at_least(context, formulas, above, span)?;
            context.node(Node::Not(reached))
        }
        Relation::Equal | Relation::Unequal => {
            let equal = if whole {
                let reached = at_least(context, formulas, least, span)?;
                let passed = at_least(context, formulas, above, span)?;
                let not_passed = context.node(Node::Not(passed));
                context.node(Node::And(vec![reached, not_passed]))
            } else {
                context.node(Node::Constant(false))
            };
            if relation == Relation::Equal { equal } else { context.node(Node::Not(equal)) }
        }
    })
}

fn at_least(context: &mut Context<'_>, formulas: &[NodeId], bound: f64, span: Span) -> Lowered<NodeId> {
    let n = formulas.len();
    if bound <= 0.0 {
        return Ok(context.node(Node::Constant(true)));
    }
    if bound > n as f64 {
        return Ok(context.node(Node::Constant(false)));
    }
    let k = bound as usize;
    if k == 1 {
        return Ok(context.node(Node::Or(formulas.to_vec())));
    }
    if n.saturating_mul(k.min(n - k + 1)) > LARGEST {
        return context.report(error!(E0504, span, "a count of {n} temporal formulas is too large";
                hint: "count in each state: `F<=10 s (count(a in crowd: a in exit) >= 3)`"));
    }
    if n - k + 1 < k {
        // At least k hold exactly if fewer than n - k + 1 fail.
        let failures: Vec<NodeId> = formulas.iter().map(|f| context.node(Node::Not(*f))).collect();
        let many = table(context, &failures, n - k + 1);
        return Ok(context.node(Node::Not(many)));
    }
    Ok(table(context, formulas, k))
}

/// `row[j]`: at least `j` of the formulas looked at so far, from the last to the first, hold.
fn table(context: &mut Context<'_>, formulas: &[NodeId], k: usize) -> NodeId {
    let mut row: Vec<Option<NodeId>> = vec![None; k + 1];
    row[0] = Some(context.node(Node::Constant(true)));
    for &formula in formulas.iter().rev() {
        for j in (1..=k).rev() {
            let with = match row[j - 1] {
                Some(_) if j == 1 => Some(formula),
                Some(rest) => Some(context.node(Node::And(vec![formula, rest]))),
                None => None,
            };
            row[j] = match (with, row[j]) {
                (Some(with), Some(without)) => Some(context.node(Node::Or(vec![with, without]))),
                (with, without) => with.or(without),
            };
        }
    }
    // There are at least k formulas.
    row[k].unwrap_or_else(|| context.node(Node::Constant(false)))
}
