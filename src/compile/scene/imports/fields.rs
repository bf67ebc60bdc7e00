//! Imports as written, and their fields: unit, origin, projection, snapping.

use crate::base::geometry::Vec2;
use crate::compile::context::{Context, Locals, Lowered, symbols::unknown, typed::Typed};
use crate::compile::dimension::Dimension;
use crate::compile::scene::imports::filter;
use crate::data::geometry::Format;
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Text, Value};
use crate::syntax::codes::Code;

/// Within at most so many metres walls are joined.
const WIDEST_SNAP: f64 = 1.0;
/// The fields of an import.
pub(crate) const FIELDS: [&str; 4] = ["snap", "unit", "origin", "projection"];

/// An import as written.
pub(crate) struct Import<'a> {
    pub(crate) path: &'a Text,
    pub(crate) walkable: bool,
    pub(crate) filter: Option<&'a Expr>,
    /// Its name, by which its rooms and doors are named.
    pub(crate) called: Option<&'a Ident>,
    pub(crate) fields: &'a [Field],
}

/// The fields of an import; lengths in m.
#[derive(Default)]
pub(crate) struct Fields {
    pub(crate) snap: Option<f64>,
    pub(crate) unit: Option<f64>,
    /// As written: metres, or degrees with a projection.
    pub(crate) origin: Option<Vec2>,
    pub(crate) is_local: bool,
}

/// The fields of an import as numbers.
pub(crate) fn import_fields(context: &mut Context<'_>, import: &Import<'_>) -> Lowered<Fields> {
    let is_local = Format::of(&import.path.value) == Format::Osm;
    let mut found = Ok(Fields { is_local, ..Fields::default() });
    for (k, field) in import.fields.iter().enumerate() {
        let set = import_field(context, import.fields, k);
        found = match (found, set) {
            (Ok(found), Ok(set)) => Ok(Fields {
                snap: set.snap.or(found.snap),
                unit: set.unit.or(found.unit),
                origin: set.origin.or(found.origin),
                is_local: set.is_local || found.is_local,
            }),
            (found, set) => found.and(set),
        };
        if let Ok(Fields { is_local: true, unit, .. }) = &found {
            let text = if unit.is_some() {
                "coordinates with a `projection` are in degrees: they have no `unit`"
            } else if Format::of(&import.path.value) == Format::Dxf {
                "coordinates of a DXF drawing are lengths: they have no `projection`"
            } else {
                continue;
            };
            found = context.report(error!(E0712, field.name.span, "{text}"));
        }
    }
    found
}

fn import_field(context: &mut Context<'_>, fields: &[Field], k: usize) -> Lowered<Fields> {
    let (name, at) = (&fields[k].name, fields[k].value.span());
    if !FIELDS.contains(&name.name.as_str()) {
        return context.report(unknown("field", &name.name, name.span, Code::E0207, FIELDS.into_iter()));
    }
    if fields[..k].iter().any(|before| before.name.name == name.name) {
        let text = format!("`{}` is set twice", name.name);
        return context.report(error!(E0202, name.span, "{text}"));
    }
    let expr = match (&fields[k].value, name.name.as_str()) {
        (Value::Plain(expr), _) => expr,
        (_, "snap" | "unit") => {
            return context.report(error!(E0305, at, "expected a length such as `5 cm`"));
        }
        (_, "origin") => {
            return context.report(error!(E0305, at, "expected a point such as `(1, 2)`"));
        }
        _ => return context.report(error!(E0305, at, "expected `local`")),
    };
    match name.name.as_str() {
        "projection" => match &expr.kind {
            ExprKind::Name(name) if name == "local" => Ok(Fields { is_local: true, ..Fields::default() }),
            _ => context.report(error!(E0305, at, "the only `projection` is `local`";
                        hint: "write `projection = local` for coordinates in degrees")),
        },
        "origin" => match context.lower(expr, &Locals::default())? {
            Typed::Point(x, y) if x.dimension == Dimension::LENGTH => {
                Ok(Fields { origin: Some(Vec2::new(x.value, y.value)), ..Fields::default() })
            }
            Typed::Point(x, _) => context.wrong_dimension(at, Dimension::LENGTH, x.dimension),
            other => context.mismatch(at, "a point such as `(1, 2)`", &other),
        },
        setting => {
            let value = context.number_of(expr, Dimension::LENGTH, &Locals::default())?.value;
            let (is_snap, most) = (setting == "snap", if setting == "snap" { WIDEST_SNAP } else { 1e4 });
            if !(0.0 < value && value <= most) {
                let text = format!("`{setting}` must be positive and at most {most} m (got {value} m)");
                return context.report(error!(E0405, at, "{text}"));
            }
            Ok(Fields {
                snap: is_snap.then_some(value),
                unit: (!is_snap).then_some(value),
                ..Fields::default()
            })
        }
    }
}

/// The import with one field set, as it would be written.
pub(crate) fn rewritten(context: &Context<'_>, import: &Import<'_>, name: &str, value: &str) -> String {
    let mut text = format!("import {}", context.text(import.path.span));
    if import.walkable {
        text += " as walkable";
    }
    if let Some(filter) = import.filter {
        if filter::compared(filter).iter().any(filter::is_by_level) {
            return format!("{name} = {value}");
        }
        text += &format!(" where {}", context.text(filter.span));
    }
    let others = import.fields.iter().filter(|field| field.name.name != name);
    let others = others
        .map(|field| format!("{} = {}  ", field.name.name, context.text(field.value.span())))
        .collect::<String>();
    text + &format!(" {{ {others}{name} = {value} }}")
}
