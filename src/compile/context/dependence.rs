//! Which errors depend on the values of parameters. Each use of a name notes what the name stands for, so an expression
//! depends on a parameter if one is used in it or in what its names stand for.

use crate::compile::context::names::Names;
use crate::syntax::ast::Ident;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic};
use crate::syntax::source::Span;
use std::collections::BTreeSet;

/// Codes of unknown names.
pub(crate) const UNKNOWN: [Code; 4] = [Code::E0201, Code::E0203, Code::E0208, Code::E0210];
/// Codes of errors of queries that depend on no value, besides those of names, kinds and units.
const VALUELESS: [Code; 6] = [Code::E0204, Code::E0507, Code::E0508, Code::E0603, Code::E0606, Code::E0607];
/// Codes of errors about numbers that depend on no other value if they are written as literals.
const WRITTEN: [Code; 9] = [
    Code::E0402,
    Code::E0404,
    Code::E0405,
    Code::E0503,
    Code::E0601,
    Code::E0602,
    Code::E0604,
    Code::E0605,
    Code::E0710,
];

/// The meaning of a name where it is used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Meant {
    /// A parameter.
    Parameter,
    /// Whatever is written at this place.
    Written(Span),
    /// A name that is bound around: an argument or an agent of a quantifier.
    Bound(String),
    /// Anything else: agents, regions, processes.
    Other,
}

impl Names<'_> {
    /// The uses of names within a place.
    fn uses_within(&self, place: Span) -> impl Iterator<Item = &Meant> {
        let from = self.uses.range(Span { end: 0, ..place }..);
        let within = from.take_while(move |(used, _)| used.source == place.source && used.start < place.end);
        within.filter(move |(used, _)| used.end <= place.end).map(|(_, meant)| meant)
    }

    /// Whether the expression at a place depends on a parameter, directly or by names.
    pub(crate) fn hangs_on_parameters(&self, place: Span) -> bool {
        let (mut left, mut seen) = (vec![place], BTreeSet::new());
        while let Some(place) = left.pop() {
            if !seen.insert(place) {
                continue;
            }
            for meant in self.uses_within(place) {
                match meant {
                    Meant::Parameter => return true,
                    Meant::Written(body) => left.push(*body),
                    Meant::Bound(_) | Meant::Other => {}
                }
            }
        }
        false
    }

    /// Whether the expression at a place uses one of some names that are bound around it.
    pub(crate) fn hangs_on_bound(&self, place: Span, names: &[Ident]) -> bool {
        let is_one = |bound: &String| names.iter().any(|name| name.name == *bound);
        self.uses_within(place).any(|meant| matches!(meant, Meant::Bound(bound) if is_one(bound)))
    }

    /// Whether an error is found whatever the values of parameters are: one about names, kinds and units, or about numbers as
    /// they are written.
    pub(crate) fn is_sure(&self, one: &Diagnostic) -> bool {
        if one.hangs_on.iter().any(|value| self.hangs_on_parameters(*value)) {
            return false;
        }
        if one.is_formal {
            return true;
        }
        let is_circle = one.code == Code::E0205 && one.about == About::Circle;
        if is_circle || UNKNOWN.contains(&one.code) || one.code.is_of("E03") || VALUELESS.contains(&one.code)
        {
            return true;
        }
        let is_literal = |place: Span| self.uses_within(place).next().is_none();
        WRITTEN.contains(&one.code) && one.place.as_ref().is_some_and(|place| is_literal(place.span))
    }
}
