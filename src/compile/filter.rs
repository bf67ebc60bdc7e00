//! Filters of imports: comparisons of a feature's properties, joined by `&`, `|`, `!`.

use crate::data::geometry::PropertyValue;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, UnaryOp};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// A side of a comparison.
#[derive(Clone, Debug, PartialEq)]
enum Side {
    Text(String),
    Number(f64),
    Bool(bool),
    /// The feature has no such property.
    Absent,
}

/// A name and properties.
pub(super) type Described<'f> = (&'f str, &'f [(String, PropertyValue)]);

/// Whether the filter selects the feature. A property that a feature lacks equals nothing.
pub(super) fn selects(filter: &Expr, feature: Described<'_>) -> Result<bool, Diagnostic> {
    match &filter.kind {
        ExprKind::Bool(value) => Ok(*value),
        ExprKind::Unary(UnaryOp::Not, inner) => Ok(!selects(inner, feature)?),
        ExprKind::Binary(BinaryOp::And, a, b) => Ok(selects(a, feature)? & selects(b, feature)?),
        ExprKind::Binary(BinaryOp::Or, a, b) => Ok(selects(a, feature)? | selects(b, feature)?),
        // What compares no property says nothing of a feature.
        ExprKind::Binary(_, a, b) if !names(a).chain(names(b)).any(|_| true) => Err(wrong(filter)),
        ExprKind::Binary(op, a, b) => {
            let (a, b) = (side(a, feature)?, side(b, feature)?);
            let order = match (&a, &b) {
                (Side::Text(a), Side::Text(b)) => Some(a.cmp(b)),
                (Side::Number(a), Side::Number(b)) => a.partial_cmp(b),
                (Side::Bool(a), Side::Bool(b)) => Some(a.cmp(b)),
                _ => None,
            };
            match op {
                BinaryOp::Equal => Ok(order.is_some_and(std::cmp::Ordering::is_eq)),
                BinaryOp::Unequal => Ok(!order.is_some_and(std::cmp::Ordering::is_eq)),
                BinaryOp::Less => Ok(order.is_some_and(std::cmp::Ordering::is_lt)),
                BinaryOp::AtMost => Ok(order.is_some_and(std::cmp::Ordering::is_le)),
                BinaryOp::Greater => Ok(order.is_some_and(std::cmp::Ordering::is_gt)),
                BinaryOp::AtLeast => Ok(order.is_some_and(std::cmp::Ordering::is_ge)),
                _ => Err(wrong(filter)),
            }
        }
        _ => Err(wrong(filter)),
    }
}

/// The properties that a filter names, and where.
pub(super) fn names(filter: &Expr) -> Box<dyn Iterator<Item = (&str, Span)> + '_> {
    match &filter.kind {
        ExprKind::Name(name) => Box::new(std::iter::once((name.as_str(), filter.span))),
        ExprKind::Unary(_, inner) => names(inner),
        ExprKind::Binary(_, a, b) => Box::new(names(a).chain(names(b))),
        _ => Box::new(std::iter::empty()),
    }
}

/// The texts that a filter compares a property with, and where.
pub(super) fn texts<'f>(
    filter: &'f Expr,
    property: &'f str,
) -> Box<dyn Iterator<Item = (&'f str, Span)> + 'f> {
    match &filter.kind {
        ExprKind::Unary(_, inner) => texts(inner, property),
        ExprKind::Binary(_, a, b) => match (&a.kind, &b.kind) {
            (ExprKind::Name(name), ExprKind::Text(text)) if name == property => {
                Box::new(std::iter::once((text.as_str(), b.span)))
            }
            _ => Box::new(texts(a, property).chain(texts(b, property))),
        },
        _ => Box::new(std::iter::empty()),
    }
}

fn side(expr: &Expr, feature: Described<'_>) -> Result<Side, Diagnostic> {
    match &expr.kind {
        ExprKind::Text(text) => Ok(Side::Text(text.clone())),
        ExprKind::Bool(value) => Ok(Side::Bool(*value)),
        ExprKind::Quantity(q) if q.unit.is_none() => Ok(Side::Number(q.value.to_f64())),
        ExprKind::Unary(UnaryOp::Minus, inner) => match side(inner, feature)? {
            Side::Number(value) => Ok(Side::Number(-value)),
            _ => Err(wrong(expr)),
        },
        ExprKind::Name(name) if name == "name" => Ok(Side::Text(feature.0.to_owned())),
        ExprKind::Name(name) => Ok(match feature.1.iter().find(|(n, _)| n == name).map(|(_, v)| v) {
            Some(PropertyValue::Text(text)) => Side::Text(text.clone()),
            Some(PropertyValue::Number(value)) => Side::Number(*value),
            Some(PropertyValue::Bool(value)) => Side::Bool(*value),
            Some(PropertyValue::Null | PropertyValue::Other(_)) | None => Side::Absent,
        }),
        _ => Err(wrong(expr)),
    }
}

fn wrong(expr: &Expr) -> Diagnostic {
    Diagnostic::error(
        Code::E0305,
        expr.span,
        "a filter can compare properties of features only with texts, numbers and truth values",
    )
    .hint("write for example `where source == \"map.png\" & height > 1`")
}
