//! Filters of imports: comparisons of a feature's properties, joined by `&`, `|`, `!`.

use crate::data::geometry::{PropertyValue, indoor::may_be_door};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, UnaryOp};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::cmp::Ordering;
use std::mem::discriminant;

/// Most values of a property that a message lists.
const MOST_SEEN: usize = 8;
/// Most levels that one range of them has.
const MOST_LEVELS: usize = 1000;

/// A name and properties.
pub(crate) type Described<'f> = (&'f str, &'f [(String, PropertyValue)]);

/// Whether the filter selects the feature. A property that a feature lacks equals nothing.
pub(crate) fn selects(filter: &Expr, feature: Described<'_>) -> Result<bool, Diagnostic> {
    match &filter.kind {
        ExprKind::Bool(value) => Ok(*value),
        ExprKind::Unary(UnaryOp::Not, inner) => Ok(!selects(inner, feature)?),
        ExprKind::Binary(BinaryOp::And, a, b) => Ok(selects(a, feature)? & selects(b, feature)?),
        ExprKind::Binary(BinaryOp::Or, a, b) => Ok(selects(a, feature)? | selects(b, feature)?),
        // What compares no property says nothing of a feature.
        ExprKind::Binary(_, a, b) if !names(a).chain(names(b)).any(|_| true) => Err(wrong(filter)),
        ExprKind::Binary(op, a, b) => {
            let (a, b) = (values(a, feature)?, values(b, feature)?);
            let any =
                |is: fn(Ordering) -> bool| a.iter().any(|a| b.iter().any(|b| order(a, b).is_some_and(is)));
            match op {
                BinaryOp::Equal => Ok(any(Ordering::is_eq)),
                BinaryOp::Unequal => Ok(!any(Ordering::is_eq)),
                BinaryOp::Less => Ok(any(Ordering::is_lt)),
                BinaryOp::AtMost => Ok(any(Ordering::is_le)),
                BinaryOp::Greater => Ok(any(Ordering::is_gt)),
                BinaryOp::AtLeast => Ok(any(Ordering::is_ge)),
                _ => Err(wrong(filter)),
            }
        }
        _ => Err(wrong(filter)),
    }
}

/// Whether the filter selects a door without a level once it is on a level that the filter names.
pub(crate) fn selects_door(filter: &Expr, (name, properties): Described<'_>) -> bool {
    let is_set = |(name, value): &(String, _)| name == "level" && *value != PropertyValue::Null;
    let on = |level| [&[("level".to_owned(), level)], properties].concat();
    may_be_door(properties)
        && !properties.iter().any(is_set)
        && compared(filter).into_iter().any(|compared| {
            compared.name == "level" && selects(filter, (name, &on(compared.value))).unwrap_or(false)
        })
}

/// The properties that a filter names, and where.
pub(crate) fn names(filter: &Expr) -> Box<dyn Iterator<Item = (&str, Span)> + '_> {
    match &filter.kind {
        ExprKind::Name(name) => Box::new(std::iter::once((name.as_str(), filter.span))),
        ExprKind::Unary(_, inner) => names(inner),
        ExprKind::Binary(_, a, b) => Box::new(names(a).chain(names(b))),
        _ => Box::new(std::iter::empty()),
    }
}

/// A comparison of a property with a value, and what features have.
pub(crate) struct Compared<'f> {
    pub(crate) name: &'f str,
    pub(crate) value: PropertyValue,
    /// The places of the value and of the comparison.
    pub(crate) spans: [Span; 2],
    /// Some values of features.
    pub(crate) seen: Vec<PropertyValue>,
    /// Whether a feature has a value of this type.
    pub(crate) fits: bool,
}

impl<'f> Compared<'f> {
    fn new(name: &'f str, value: PropertyValue, spans: [Span; 2]) -> Self {
        Self { name, value, spans, seen: Vec::new(), fits: false }
    }

    /// Notes the value that a feature has.
    pub(crate) fn see(&mut self, properties: &[(String, PropertyValue)]) {
        for (_, value) in properties.iter().filter(|(name, _)| name == self.name) {
            self.fits |= discriminant(value) == discriminant(&self.value);
            if *value != PropertyValue::Null && self.seen.len() < MOST_SEEN && !self.seen.contains(value) {
                self.seen.push(value.clone());
            }
        }
    }
}

/// The comparisons of a filter.
pub(crate) fn compared(filter: &Expr) -> Vec<Compared<'_>> {
    match &filter.kind {
        ExprKind::Unary(_, inner) => compared(inner),
        ExprKind::Binary(_, a, b) => match (&a.kind, literal(b), literal(a), &b.kind) {
            (ExprKind::Name(name), Some(value), ..) => {
                vec![Compared::new(name, value, [b.span, filter.span])]
            }
            (.., Some(value), ExprKind::Name(name)) => {
                vec![Compared::new(name, value, [a.span, filter.span])]
            }
            _ => compared(a).into_iter().chain(compared(b)).collect(),
        },
        _ => Vec::new(),
    }
}

fn literal(expr: &Expr) -> Option<PropertyValue> {
    match &expr.kind {
        ExprKind::Text(text) => Some(PropertyValue::Text(text.clone())),
        ExprKind::Bool(value) => Some(PropertyValue::Bool(*value)),
        ExprKind::Quantity(q) if q.unit.is_none() => Some(PropertyValue::Number(q.value.to_f64())),
        ExprKind::Unary(UnaryOp::Minus, inner) => match literal(inner)? {
            PropertyValue::Number(value) => Some(PropertyValue::Number(-value)),
            _ => None,
        },
        _ => None,
    }
}

/// The order of two values of one type.
fn order(a: &PropertyValue, b: &PropertyValue) -> Option<Ordering> {
    let is_value = !matches!(a, PropertyValue::Null | PropertyValue::Other(_));
    if is_value && discriminant(a) == discriminant(b) { a.partial_cmp(b) } else { None }
}

/// A value as written, or the values of a property: a feature may be on several levels.
fn values(expr: &Expr, (name, properties): Described<'_>) -> Result<Vec<PropertyValue>, Diagnostic> {
    let ExprKind::Name(property) = &expr.kind else {
        return literal(expr).map(|value| vec![value]).ok_or_else(|| wrong(expr));
    };
    let of = |property: &str| properties.iter().find(|(n, _)| n == property).map(|(_, value)| value.clone());
    let mut found: Vec<PropertyValue> = match property.as_str() {
        "name" => vec![PropertyValue::Text(name.to_owned())],
        property => of(property).into_iter().collect(),
    };
    if property == "level" {
        let found_on: Vec<String> =
            ["level", "repeat_on"].iter().flat_map(|key| levels(properties, key)).collect();
        found.extend(found_on.iter().cloned().map(PropertyValue::Text));
        found.extend(found_on.iter().filter_map(|level| level.parse().ok()).map(PropertyValue::Number));
    }
    Ok(found)
}

/// The levels in a property of OSM: `0;2` is two levels, and `0-2` is three.
pub(crate) fn levels(properties: &[(String, PropertyValue)], key: &str) -> Vec<String> {
    let text = match properties.iter().find(|(name, _)| name == key).map(|(_, value)| value) {
        Some(PropertyValue::Text(text)) => text.clone(),
        Some(PropertyValue::Number(level)) => level.to_string(),
        _ => return Vec::new(),
    };
    let mut found: Vec<String> = Vec::new();
    for part in text.split(';').map(str::trim) {
        // A hyphen at the start is a sign.
        let hyphen = part.char_indices().skip(1).find(|(_, c)| *c == '-');
        let end = |text: &str| text.trim().parse::<i32>().ok();
        match hyphen.and_then(|(k, _)| Some((end(&part[..k])?, end(&part[k + 1..])?))) {
            Some((low, high)) => found.extend((low..=high).take(MOST_LEVELS).map(|n| n.to_string())),
            None => found.push(part.to_owned()),
        }
    }
    found
}

/// Whether an import by level made a comparison: it has no place of its own.
pub(crate) fn is_by_level(compared: &Compared<'_>) -> bool {
    compared.spans[0] == compared.spans[1]
}

fn wrong(expr: &Expr) -> Diagnostic {
    error!(E0305, expr.span, "a filter can compare properties of features only with texts, numbers and truth values";
        hint: "write for example `where source == \"map.png\" & height > 1`")
}
