//! The meanings of names, members and calls in words: kind, unit, and the value as far as it is known. An editor shows them.

use crate::compile::context::typed::Typed;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// The meanings of expressions, by their places.
pub type Notes = BTreeMap<Span, String>;

/// A type in words, with its value if that is known.
pub(crate) fn described(typed: &Typed) -> String {
    match typed {
        Typed::Number(number) if number.dimension.is_none() => format!("a number, {}", number.value),
        Typed::Number(number) => format!("{}, {} {}", typed.noun(), number.value, number.dimension),
        Typed::Point(x, y) => format!("a point, ({}, {}) {}", x.value, y.value, x.dimension),
        Typed::Vector(_, _, dimension) => format!("a vector ({dimension})"),
        Typed::Agents { set, .. } if set.except.is_none() => format!("a set of {} agents", set.members.len()),
        other => other.noun(),
    }
}
