//! Drawings of imports: files are read, filtered and moved to their places.

use crate::compile::context::{Context, Lowered, symbols::unknown};
use crate::compile::files::{Files, missing};
use crate::compile::scene::imports::{
    fields::{self, Import},
    filter::{self, Compared},
};
use crate::data::geometry::{self, Drawing, Fault, Format, Geometry, GeometryError, PropertyValue, Select};
use crate::syntax::ast::Text;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Most names of properties that a warning lists.
const MOST_NAMES: usize = 8;
/// The formats that are read.
const FORMATS: &str = "imports are GeoJSON (`.geojson`), OSM (`.osm`), WKT (`.wkt`) or DXF (`.dxf`); export other drawings as DXF";
/// Most features that a message names.
const MOST_NAMED: usize = 5;

/// A drawing that cannot lie where its coordinates say.
pub(crate) fn misplaced<T>(context: &mut Context<'_>, import: &Import<'_>, fault: Fault) -> Lowered<T> {
    let span = import.path.span;
    let is_local = Format::of(&import.path.value) == Format::Osm
        || import.fields.iter().any(|field| field.name.name == "projection");
    let unit_hint = |this: &Context<'_>, fits: Option<&str>| match fits {
        _ if is_local => "leave out `projection` for coordinates in metres, or select fewer features".into(),
        Some(unit) => {
            format!("the unit that fits is {unit}: `{}`", fields::rewritten(this, import, "unit", unit))
        }
        None => "set `unit` to the unit of the drawing, or select fewer features".to_owned(),
    };
    let error = match fault {
        Fault::Degrees => {
            let error =
                error!(E0712, span, "the coordinates are degrees, or all of the file lies within 5 cm");
            let local = fields::rewritten(context, import, "projection", "local");
            error.hint(format!("write `{local}` for degrees, or set `unit`"))
        }
        Fault::NoDegrees(p) => {
            let text = format!("({}, {}) is not a longitude and a latitude in degrees", p.x, p.y);
            error!(E0712, span, "{text}"; hint: "leave out `projection` for coordinates in metres")
        }
        Fault::Swapped => {
            let has_origin = import.fields.iter().any(|field| field.name.name == "origin");
            let or_origin = if has_origin { " or in `origin`" } else { "" };
            let text = format!("latitude and longitude are swapped in the file{or_origin}");
            error!(E0712, span, "{text}";
                    hint: "write the longitude first, as GeoJSON, WKT and `origin` have it: `(11.57, 48.15)`")
        }
        Fault::Extent { size, fits } => {
            let text = if size < 1.0 {
                format!("the drawing is only {size:.3} m wide")
            } else {
                format!("the drawing is {:.0} km wide", size / 1e3)
            };
            error!(E0711, span, "{text}").hint(unit_hint(context, fits))
        }
        Fault::Door { width, fits } => {
            let text = format!("the narrowest door is {width:.0} m wide");
            error!(E0711, span, "{text}").hint(unit_hint(context, fits))
        }
        Fault::Far(origin) => {
            let text = "the drawing is more than 100 km from the origin of its coordinates";
            let origin =
                fields::rewritten(context, import, "origin", &format!("({}, {})", origin.x, origin.y));
            error!(E0710, span, "{text}"; hint: "move it to the origin of the scene: `{origin}`")
        }
    };
    context.report(error)
}

/// A filter that compares a property with a value of a type that it never has.
fn of_another_type(context: &Context<'_>, compared: &Compared<'_>) -> Diagnostic {
    let kind = |value: &PropertyValue| match value {
        PropertyValue::Text(_) => "a text",
        PropertyValue::Number(_) => "a number",
        PropertyValue::Bool(_) => "a truth value",
        PropertyValue::Null | PropertyValue::Other(_) => "a list",
    };
    let bare = |value: &PropertyValue| value.to_string().trim_matches('"').to_owned();
    let Compared { name, value, spans: [at, whole], seen, .. } = compared;
    let alike = match &seen[0] {
        PropertyValue::Text(_) => PropertyValue::Text(bare(value)),
        first => seen.iter().find(|known| bare(known) == bare(value)).unwrap_or(first).clone(),
    };
    let written = context.text(*whole).replacen(context.text(*at).as_str(), &alike.to_string(), 1);
    let text = format!("`{name}` is {} in this file, not {}", kind(&alike), kind(value));
    error!(E0305, *at, "{text}"; hint: "write `{written}`; the values of `{name}` are {}", listed(seen))
}

/// The drawing in a file. Filters come first: what is wrong with features that are not selected does not matter.
pub(crate) fn drawing(
    context: &mut Context<'_>,
    import: &Import<'_>,
    unit: Option<f64>,
    files: &Files,
) -> Lowered<Drawing> {
    let (path, span) = (import.path, import.path.span);
    let (mut total, mut wrong) = (0, None);
    let mut known: BTreeSet<String> = BTreeSet::new();
    let mut strange: Vec<(&str, Span)> = import.filter.into_iter().flat_map(filter::names).collect();
    strange.retain(|(name, _)| *name != "name");
    let mut compared = import.filter.map(filter::compared).unwrap_or_default();
    let mut select = |name: &str, properties: &[(String, PropertyValue)]| {
        total += 1;
        for compared in &mut compared {
            compared.see(properties);
        }
        strange.retain(|(name, _)| !properties.iter().any(|(known, _)| known == name));
        if known.len() < MOST_NAMES {
            known.extend(properties.iter().map(|(name, _)| name.clone()));
        }
        let Some(filter) = import.filter else { return true };
        match filter::selects(filter, (name, properties)) {
            Ok(selected) => selected || filter::selects_door(filter, (name, properties)),
            Err(error) => {
                wrong = Some(error);
                false
            }
        }
    };
    let read = read(context, path, unit, files, &mut select);
    if let Some(error) = wrong {
        return context.report(error);
    }
    let drawing = read?;
    for compared in compared.iter().filter(|compared| compared.name == "layer") {
        let PropertyValue::Text(layer) = &compared.value else { continue };
        if !drawing.layers.is_empty() && !drawing.layers.contains(layer) {
            let known = drawing.layers.iter().map(String::as_str);
            let error = unknown("layer", layer, compared.spans[0], Code::E0201, known);
            let names: Vec<String> = drawing.layers.iter().take(MOST_NAMES).cloned().collect();
            return context.report(error.label(format!("the drawing has {}", names.join(", "))));
        }
    }
    let is_unlike = |one: &&Compared<'_>| !one.fits && !one.seen.is_empty() && !filter::is_by_level(one);
    if let Some(unlike) = compared.iter().find(is_unlike) {
        return context.report(of_another_type(context, unlike));
    }
    // A property that no feature has equals nothing, and differs from everything.
    let all_known = strange.is_empty() || known.is_empty();
    for (name, at) in strange.into_iter().filter(|_| !all_known) {
        let known = known.iter().map(String::as_str).chain(["name"]);
        context.note(unknown("property", name, at, Code::E0201, known));
    }
    let used = |shape: &Geometry| !matches!(shape, Geometry::Point(_));
    let is_used = |feature: &geometry::Feature| {
        used(&feature.shape) || geometry::indoor::role(feature, false) == geometry::indoor::Role::Door
    };
    if all_known && !drawing.features.iter().any(is_used) && drawing.skipped.is_empty() {
        let have = if total == 1 { "1 feature".to_owned() } else { format!("{total} features") };
        let text = format!("the import adds nothing: the file has {have}");
        let warning = Diagnostic::warning(Code::W0401, span, text);
        let names: Vec<String> = known.iter().take(MOST_NAMES).map(|name| format!("`{name}`")).collect();
        context.note(warning.hint(if !drawing.features.is_empty() {
            "polygons become obstacles and lines become walls; points are ignored".to_owned()
        } else if total == 0 {
            "polygons become obstacles and lines become walls".to_owned()
        } else if names.is_empty() {
            "the filter after `where` compares properties of features, but these features have none"
                .to_owned()
        } else {
            let known = compared.iter().filter(|compared| !compared.seen.is_empty());
            let values = known.map(|of| format!("; the values of `{}` are {}", of.name, listed(&of.seen)));
            let names = names.join(", ") + &values.collect::<String>();
            format!("the filter after `where` matches no feature; their properties are {names}")
        }));
    }
    Ok(drawing)
}

/// The features of a file that are selected, or what is wrong with it.
pub(crate) fn read(
    context: &mut Context<'_>,
    path: &Text,
    unit: Option<f64>,
    files: &Files,
    select: &mut Select<'_>,
) -> Lowered<Drawing> {
    let (format, span) = (Format::of(&path.value), path.span);
    let text = match files.get(&path.value) {
        Ok(bytes) => text_of(bytes, format),
        Err(reason) => return context.report(missing(span, &reason)),
    };
    let text = match text {
        Ok(text) if text.trim().is_empty() => Err("the file is empty"),
        text => text,
    };
    let end = path.value.rsplit_once('.').map_or("", |(_, end)| end);
    let is_other = format == Format::GeoJson && !end.to_ascii_lowercase().ends_with("json");
    let formats = |error: Diagnostic| if is_other { error.hint(FORMATS) } else { error };
    let read = match text {
        Ok(text) => {
            let read = |select: &mut Select<'_>| geometry::read(format, &text, unit, select);
            match &files.drawings {
                Some(drawings) => drawings.read((&path.value, unit), select, read),
                None => read(select),
            }
        }
        Err(fault) => return context.report(formats(error!(E0704, span, "{fault}"))),
    };
    read.or_else(|errors| context.report(formats(unreadable(span, &errors))))
}

fn listed(values: &[PropertyValue]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// The text in the bytes of a file. Older DXF is written in the code page of its author, most often Latin-1.
fn text_of(bytes: &[u8], format: Format) -> Result<Cow<'_, str>, &'static str> {
    match std::str::from_utf8(bytes) {
        _ if bytes.starts_with(b"AutoCAD Binary DXF") => {
            Err("the drawing is a binary DXF; save it as a DXF in text (ASCII)")
        }
        Ok(text) => Ok(text.into()),
        Err(_) if format == Format::Dxf => Ok(bytes.iter().map(|byte| char::from(*byte)).collect()),
        Err(_) => Err("the file is not UTF-8 text"),
    }
}

/// Errors of a geometry.
pub(crate) fn unreadable(span: Span, errors: &[GeometryError]) -> Diagnostic {
    let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
    error!(E0704, span, "the geometry in the file cannot be read").label(shown(&errors))
}

/// The first of some sentences.
pub(crate) fn shown(sentences: &[String]) -> String {
    let mut text = sentences[..sentences.len().min(MOST_NAMED)].join("; ");
    if sentences.len() > MOST_NAMED {
        text += "; …";
    }
    text
}
