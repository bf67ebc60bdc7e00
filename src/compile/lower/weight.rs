//! How large and how deep expressions of one state grow where names and operators repeat what they stand for.
//!
//! `let f(v) = v + v` doubles what it is given: called 27 times in itself it is larger than any memory, though each
//! call is a few words. So whatever is copied counts as if it had been written out.

use crate::compile::context::{Context, Lowered, MOST_NODES, typed::Typed};
use crate::model::visit::Part;
use crate::model::{Bool, Num, Process, Timing};
use crate::syntax::source::Span;

/// How deep an expression may be that is copied: what walks it does so on the stack.
const DEEPEST: u32 = 4000;

/// Size and depth of an expression.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Weight {
    /// Number of its parts.
    nodes: u64,
    /// How deep they are in one another.
    depth: u32,
}

impl Weight {
    /// That of some parts. It goes no further than expressions may grow.
    fn of_parts(parts: Vec<Part<'_>>) -> Self {
        let mut weight = Self::default();
        let mut open: Vec<(Part<'_>, u32)> = parts.into_iter().map(|part| (part, 1)).collect();
        while let Some((part, depth)) = open.pop() {
            weight.nodes += 1;
            weight.depth = weight.depth.max(depth);
            if weight.nodes > MOST_NODES || depth > DEEPEST {
                break;
            }
            part.parts(&mut |inner| {
                // Agents and sets are no larger than a number.
                if !matches!(inner, Part::Set(_) | Part::Who(_)) {
                    open.push((inner, depth + 1));
                }
            });
        }
        weight
    }

    /// That of what an expression turned out to be.
    pub(crate) fn of(typed: &Typed) -> Self {
        match typed {
            Typed::Num(num, _) => Self::of_num(num),
            Typed::Vector(x, y, _) => Self::of_parts(vec![Part::Num(x), Part::Num(y)]),
            Typed::Truth(truth, _) => Self::of_truth(truth),
            Typed::Tally(formulas) => Self { nodes: formulas.len() as u64, depth: 1 },
            _ => Self { nodes: 1, depth: 1 },
        }
    }

    /// That of a number.
    pub(crate) fn of_num(num: &Num) -> Self {
        Self::of_parts(vec![Part::Num(num)])
    }

    /// That of a condition.
    pub(crate) fn of_truth(truth: &Bool) -> Self {
        Self::of_parts(vec![Part::Bool(truth)])
    }

    /// That of all that a process computes in a state.
    pub(crate) fn of_process(process: &Process) -> Self {
        let mut parts = Vec::new();
        for command in &process.commands {
            parts.push(Part::Bool(&command.guard));
            if let Timing::Rate(rate) = &command.timing {
                parts.push(Part::Num(rate));
            }
            for branch in &command.branches {
                parts.push(Part::Num(&branch.weight));
                parts.extend(branch.updates.iter().map(|(_, value)| Part::Num(value)));
            }
        }
        Self::of_parts(parts)
    }

    /// Number of parts.
    pub(crate) fn nodes(self) -> u64 {
        self.nodes
    }
}

/// Counts a copy of something; an error where that grows beyond reason.
pub(crate) fn count_copy(context: &mut Context<'_>, weight: Weight, span: Span) -> Lowered<()> {
    context.extent.nodes = context.extent.nodes.saturating_add(weight.nodes);
    if weight.depth > DEEPEST || context.extent.nodes > MOST_NODES {
        return context.too_large(span);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Arithmetic, Comparison, Place};

    fn sum(a: Num, b: Num) -> Num {
        Num::Combine(Arithmetic::Add, Box::new(a), Box::new(b))
    }

    #[test]
    fn parts_are_counted_wherever_they_stand() {
        assert_eq!(Weight::of_num(&Num::Time), Weight { nodes: 1, depth: 1 });
        let two = sum(Num::Time, Num::Constant(1.0));
        assert_eq!(Weight::of_num(&two), Weight { nodes: 3, depth: 2 });
        let place = Place::Point(Box::new(two.clone()), Box::new(Num::Time));
        let far = Num::Distance(place.clone(), place);
        assert_eq!(Weight::of_num(&far), Weight { nodes: 11, depth: 4 });
        let near = Bool::Compare(Comparison::Less, Box::new(far), Box::new(two));
        let both = Bool::And(vec![near, Bool::Constant(true)]);
        assert_eq!(Weight::of_truth(&both), Weight { nodes: 17, depth: 6 });
    }

    #[test]
    fn what_is_too_deep_is_looked_at_no_further() {
        let deep = (0..2 * DEEPEST).fold(Num::Time, |sum_so_far, _| sum(sum_so_far, Num::Time));
        let weight = Weight::of_num(&deep);
        assert_eq!(weight.depth, DEEPEST + 1);
        assert!(weight.nodes <= 2 * u64::from(DEEPEST) + 2, "{weight:?}");
    }
}
