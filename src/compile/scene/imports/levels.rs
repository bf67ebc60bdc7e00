//! Imports by level: one file becomes several levels, and its stairs join them.
//!
//! Steps of OSM are lines on two levels. A stairwell of IMDF is a unit on two levels that follow each other, with one
//! opening on each of them.

use crate::base::geometry::{Polygon, Segment, Shape, Vec2};
use crate::compile::context::{Context, Locals, Lowered, Reported, levels::level};
use crate::compile::dimension::Dimension;
use crate::compile::files::Files;
use crate::compile::scene::{
    declare_stairs,
    imports::{
        drawing::read,
        fields::{FIELDS, Import, import_fields},
        filter, place,
    },
};
use crate::data::geometry::{Drawing, Feature, Geometry, PropertyValue, indoor::width};
use crate::syntax::ast::{Expr, Ident, Text};
use crate::syntax::source::Span;
use std::collections::BTreeSet;

/// The width of steps that have none of their own, m.
const WIDTH: f64 = 1.2;
/// An opening this near to the outline of a stairwell leads into it, as a door opens walls, m.
const REACH: f64 = 0.5;
/// Rounding of lengths, m.
const HAIR: f64 = 1e-6;
/// Between those who go up and those who go down through one opening, m.
const BETWEEN: f64 = 0.06;
/// The run of usual steps for each metre of rise: 29 cm and 17 cm (DIN 18065).
const USUAL_RUN: f64 = 29.0 / 17.0;

/// Most levels that a message names.
const MOST_NAMED: usize = 20;

/// A file that becomes several levels.
pub(crate) struct Building<'a> {
    import: Import<'a>,
    /// From the lowest one on, each with its name in the file.
    levels: &'a [(Ident, Text)],
    /// How far floors lie apart, m.
    storey: f64,
    /// What may be stairs, and openings.
    drawing: Drawing,
}

/// A flight of stairs in a file.
pub(crate) struct Flight {
    pub(crate) name: Ident,
    /// The lower and the upper level among all of the scene.
    pub(crate) levels: [usize; 2],
    /// Foot and head in the coordinates of their levels, from the left to the right of who goes up.
    pub(crate) lines: [Segment; 2],
    /// The openings around them, which may be wider.
    openings: [Segment; 2],
    /// In which direction one goes up there, unit vectors.
    pub(crate) upward: [Vec2; 2],
    /// Length in the plan, m.
    pub(crate) run: f64,
}

impl Flight {
    /// What is closed of each opening beside foot and head.
    pub(crate) fn wings(&self) -> [Vec<Segment>; 2] {
        [0, 1].map(|end| {
            let (line, opening) = (self.lines[end], self.openings[end]);
            let pieces = [Segment::new(opening.a, line.a), Segment::new(line.b, opening.b)];
            pieces.into_iter().filter(|piece| piece.length() > HAIR).collect()
        })
    }
}

/// A flight before it has a name: what may name it, the lower level of the building, its openings, directions, run.
type Found<'f> = (&'f Feature, usize, [Segment; 2], [Vec2; 2], f64);

/// What a file has of stairs, if it has all levels that the import names.
pub(crate) fn survey<'a>(
    context: &mut Context<'a>,
    import: Import<'a>,
    levels: &'a [(Ident, Text)],
    storey: Option<&Expr>,
    files: &Files,
) -> Lowered<Building<'a>> {
    for (k, (name, text)) in levels.iter().enumerate() {
        if let Some((first, own)) = levels[..k].iter().find(|(_, other)| other.value == text.value) {
            let said = format!("`{}` and `{}` are one level of the file", first.name, name.name);
            let error = error!(E0412, text.span, "{said}"; hint: "give each level a text of its own");
            return context.report(error.related(own.span, "first named here"));
        }
    }
    if let Some(field) = import.fields.iter().find(|field| !FIELDS.contains(&field.name.name.as_str())) {
        let (name, span) = (&field.name.name, field.value.span());
        let said = format!("`{name}` is neither a level nor a field of imports");
        return context.report(error!(E0412, span, "{said}";
            hint: "the levels of a file are texts: `{name} = \"0\"`"));
    }
    let Some(storey) = storey else {
        return context
            .report(error!(E0412, import.path.span, "the import does not say how high its storeys are";
            hint: "write how far the floors lie apart: `storey = 4 m`"));
    };
    let height = context.number_of(storey, Dimension::LENGTH, &Locals::default())?.value;
    if !(height > 0.0 && height.is_finite()) {
        return context.report(error!(E0412, storey.span, "`storey` must be positive"));
    }
    let mut known = BTreeSet::new();
    let mut select = |name: &str, properties: &[(String, PropertyValue)]| {
        known.extend(["level", "repeat_on"].iter().flat_map(|key| filter::levels(properties, key)));
        let is = |key: &str, value: &str| {
            properties.iter().any(|(name, of)| name == key && *of == PropertyValue::Text(value.into()))
        };
        let is_stairs = is("highway", "steps")
            || is("feature_type", "opening")
            || is("feature_type", "unit") && is("category", "stairs");
        // What is wrong with the filter is told where the levels are imported.
        let is_selected = |filter| filter::selects(filter, (name, properties)).unwrap_or(false);
        is_stairs && import.filter.is_none_or(is_selected)
    };
    let fields = import_fields(context, &import)?;
    let drawing = read(context, import.path, fields.unit, files, &mut select)?;
    if let Some((_, absent)) = levels.iter().find(|(_, text)| !known.contains(&text.value)) {
        let error = error!(E0412, absent.span, "the file has no level `{}`", absent.value);
        let all: Vec<String> = known.iter().take(MOST_NAMED).map(|level| format!("\"{level}\"")).collect();
        return context.report(match all.len() {
            0 => error.hint("no feature of the file has a property `level`"),
            _ => error.hint(format!("the levels of the file are {}", all.join(", "))),
        });
    }
    Ok(Building { import, levels, storey: height, drawing })
}

/// The flights of a building, whose names it declares.
pub(crate) fn flights(
    context: &mut Context<'_>,
    building: &mut Building<'_>,
    middle: &mut Option<Vec2>,
) -> Lowered<Vec<Flight>> {
    let span = building.import.path.span;
    let fields = import_fields(context, &building.import)?;
    let placement = place(context, &building.import, &fields, &mut building.drawing, middle)?;
    let mut found = Vec::new();
    for feature in &building.drawing.features {
        if feature.text("highway") == Some("steps") {
            found.extend(steps(context, building, feature, placement.unit())?);
        }
    }
    found.extend(stairwells(context, building)?);
    let mut flights = Vec::new();
    for (number, (feature, lower, openings, upward, run)) in found.into_iter().enumerate() {
        let on = |level_of: usize| level(context, &building.levels[level_of].0.name).ok_or(Reported);
        let levels = [on(lower)?, on(lower + 1)?];
        let is_free = |name: &&str| is_name(name) && context.names.scopes[0].get(name).is_none();
        let own = ["name", "ref"].iter().filter_map(|key| feature.text(key)).find(is_free);
        let name = own.map_or_else(|| format!("stairs{}", number + 1), str::to_owned);
        let name = Ident { name, span };
        declare_stairs(context, &name);
        let [low, high] = openings.map(|opening| opening.length());
        let width = if low < high { low } else { high };
        let line = |end: usize| across(0.5 * (openings[end].a + openings[end].b), upward[end], width);
        flights.push(Flight { name, levels, lines: [line(0), line(1)], openings, upward, run });
    }
    Ok(flights)
}

/// Whether a text may be a name.
fn is_name(text: &str) -> bool {
    let goes_on = |c: char| c.is_alphanumeric() || c == '_';
    !text.starts_with(|c: char| c.is_numeric()) && !text.is_empty() && text.chars().all(goes_on)
}

/// The levels of a building that a feature lies on.
fn levels_of(building: &Building<'_>, feature: &Feature) -> (Vec<usize>, usize) {
    let all: BTreeSet<String> = filter::levels(&feature.properties, "level").into_iter().collect();
    let is_named = |k: &usize| all.contains(&building.levels[*k].1.value);
    ((0..building.levels.len()).filter(is_named).collect(), all.len())
}

/// A line of some width across a direction, from the left to the right.
fn across(at: Vec2, ahead: Vec2, width: f64) -> Segment {
    let left = Vec2::new(-ahead.y, ahead.x) * (0.5 * width);
    Segment::new(at + left, at - left)
}

/// The flight that steps of OSM are; none between levels that the import does not name.
fn steps<'f>(
    context: &mut Context<'_>,
    building: &Building<'_>,
    feature: &'f Feature,
    unit: f64,
) -> Lowered<Option<Found<'f>>> {
    let span = building.import.path.span;
    let Geometry::Line(points) = &feature.shape else { return Ok(None) };
    let (levels, count) = levels_of(building, feature);
    if count < 2 || levels.len() < count {
        return Ok(None);
    }
    if levels.len() > 2 || levels[1] != levels[0] + 1 {
        let names: Vec<String> = levels.iter().map(|k| format!("`{}`", building.levels[*k].0.name)).collect();
        let said = feature.place.error(format!("the steps join {}", names.join(", "))).to_string();
        return context.report(error!(E0412, span, "{said}";
            hint: "draw one flight for each storey, with two levels that follow each other: \"0;1\""));
    }
    let width = match width(feature, unit, ("steps", WIDTH)) {
        Ok(width) => width,
        Err(fault) => {
            return context.report(error!(E0412, span, "{}", feature.place.error(fault).to_string()));
        }
    };
    let mut points = points.clone();
    if feature.text("incline").is_some_and(|incline| incline == "down" || incline.starts_with('-')) {
        points.reverse();
    }
    let ahead = |k: usize| (points[k + 1] - points[k]).normalize();
    let last = points.len() - 1;
    let upward = [ahead(0), ahead(last - 1)];
    let lines = [across(points[0], upward[0], width), across(points[last], upward[1], width)];
    let run = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    Ok(Some((feature, levels[0], lines, upward, run)))
}

/// The flights of stairwells of IMDF.
fn stairwells<'f>(context: &mut Context<'_>, building: &'f Building<'_>) -> Lowered<Vec<Found<'f>>> {
    let features = &building.drawing.features;
    let wells: Vec<(usize, &Feature, &Polygon)> = features
        .iter()
        .filter(|feature| feature.text("feature_type") == Some("unit"))
        .filter_map(|feature| match (&feature.shape, levels_of(building, feature).0.first()) {
            (Geometry::Polygon(polygon), Some(level)) => Some((*level, feature, polygon)),
            _ => None,
        })
        .collect();
    // Each with the first one above it.
    let pairs: Vec<[usize; 2]> = (0..wells.len())
        .filter_map(|k| {
            let shape = |k: usize| Shape::Polygon(wells[k].2.clone());
            let is_above =
                |above: &usize| wells[*above].0 == wells[k].0 + 1 && shape(k).overlaps(&shape(*above));
            Some([k, (0..wells.len()).find(is_above)?])
        })
        .collect();
    let mut found = Vec::new();
    for pair in &pairs {
        let mut ends = Vec::new();
        for (end, k) in pair.iter().enumerate() {
            let opening = opening(context, building, wells[*k])?;
            let (polygon, middle) = (wells[*k].2, 0.5 * (opening.a + opening.b));
            let along = (opening.b - opening.a).normalize();
            let aside = Vec2::new(-along.y, along.x);
            let inward = if polygon.contains(middle + aside * (REACH + 0.1)) { aside } else { -aside };
            // Where another flight begins at this opening, each has the half on the right of who enters it.
            let is_shared = pairs.iter().any(|other| other[1 - end] == *k);
            let width = if is_shared { 0.5 * (opening.length() - BETWEEN) } else { opening.length() };
            let upward = if end == 0 { inward } else { -inward };
            let right = Vec2::new(upward.y, -upward.x);
            let shift = if is_shared { 0.5 * (width + BETWEEN) } else { 0.0 };
            ends.push((across(middle + right * shift, upward, width), upward, middle));
        }
        let way = (ends[1].2 - ends[0].2).norm();
        let usual = USUAL_RUN * building.storey;
        let run = if way > usual { way } else { usual };
        let (lines, upward) = ([ends[0].0, ends[1].0], [ends[0].1, ends[1].1]);
        found.push((wells[pair[0]].1, wells[pair[0]].0, lines, upward, run));
    }
    Ok(found)
}

/// The one opening of a stairwell.
fn opening(
    context: &mut Context<'_>,
    building: &Building<'_>,
    (own, unit, polygon): (usize, &Feature, &Polygon),
) -> Lowered<Segment> {
    let openings = building.drawing.features.iter().filter_map(|feature| {
        let Geometry::Line(points) = &feature.shape else { return None };
        let is_here =
            feature.text("feature_type") == Some("opening") && levels_of(building, feature).0.contains(&own);
        let line = Segment::new(points[0], points[points.len() - 1]);
        let middle = 0.5 * (line.a + line.b);
        let is_near = (polygon.nearest_on_outline(middle) - middle).norm() <= REACH;
        (is_here && is_near && line.length() > 0.0).then_some(line)
    });
    let openings: Vec<Segment> = openings.collect();
    if let [one] = openings[..] {
        return Ok(one);
    }
    let (level, span): (&Ident, Span) = (&building.levels[own].0, building.import.path.span);
    let said = format!("the stairs have {} openings on the level `{}`", openings.len(), level.name);
    context.report(error!(E0412, span, "{}", unit.place.error(said).to_string();
        hint: "draw one opening on their outline on each level, or leave the stairs out: `where category != \"stairs\"`"))
}
