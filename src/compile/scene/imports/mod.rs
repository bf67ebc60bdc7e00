//! Imports: the walls, obstacles and doors of files become barriers of the scene.

pub(crate) mod drawing;
pub(crate) mod fields;
pub(crate) mod filter;
pub(crate) mod levels;

use crate::compile::context::{
    Context, Lowered,
    plans::{FloorPlan, NamedParts, PlanPart},
};
use crate::compile::files::Files;
use crate::compile::scene::imports::{
    drawing::{shown, unreadable},
    fields::{Fields, Import},
};

use crate::base::geometry::{Segment, Shape, Vec2};
use crate::data::geometry::{
    self, Door, Drawing, Feature, Form, Format, Geometry, Opened, Placement, placement::middle,
    plan::TOUCHING,
};
use crate::model::{Barrier, Obstacle};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Walls that miss each other by less than this distance are reported; walls of a DXF drawing are joined, m.
const NEAR_MISS: f64 = 0.05;
/// A wider gap lets a person through, m.
const PASSABLE: f64 = 0.5;

/// Imports all files of a scene. Doors open the walls of all of them.
pub(crate) fn import_all(
    context: &mut Context<'_>,
    imports: &[Import<'_>],
    files: &Files,
    middle: &mut Option<Vec2>,
) {
    let first = context.scene.barriers.len();
    let mut found: Vec<(&Import<'_>, Vec<Door>)> = Vec::new();
    for import in imports {
        let start = context.scene.barriers.len();
        let read = read_import(context, import, files, middle);
        if let Some(plan) = plan_of(context, import) {
            let rooms = read.as_ref().ok().map(|(_, rooms)| rooms.clone());
            plan.parts = rooms;
        }
        if let Ok((doors, _)) = read {
            found.push((import, doors));
        }
        context.origins.imports.push((start..context.scene.barriers.len(), import.path.span));
    }
    let doors: Vec<Door> = found.iter().flat_map(|(_, doors)| doors.iter().cloned()).collect();
    let mut walls = walls(&mut context.scene.barriers[first..]);
    let mut opened = geometry::open_doors(&mut walls, &doors).into_iter();
    for (import, doors) in found {
        let names_level =
            import.filter.is_some_and(|filter| filter::names(filter).any(|(name, _)| name == "level"));
        let opened: Vec<(Door, Opened)> = doors.into_iter().zip(opened.by_ref()).collect();
        if let Some(parts) = plan_of(context, import).and_then(|plan| plan.parts.as_mut()) {
            let named = opened.iter().filter(|(door, _)| !door.name.is_empty());
            parts.extend(named.filter_map(|(door, opened)| match opened {
                Opened::Whole(segment) => Some((door.name.clone(), PlanPart::Door(*segment))),
                Opened::Part(_) | Opened::Nothing => None,
            }));
        }
        let faults: Vec<String> = opened
            .iter()
            .filter_map(|(door, opened)| match opened {
                Opened::Whole(_) => None,
                // The door is on another level.
                Opened::Nothing if names_level && !door.has_level => None,
                Opened::Part(part) => Some(
                    door.place.error(format!("its wall has {part:.2} m for a door of {:.2} m", door.width)),
                ),
                Opened::Nothing => Some(
                    door.place
                        .error(format!("no wall is within 0.5 m of ({:.2}, {:.2})", door.at.x, door.at.y)),
                ),
            })
            .map(|fault| fault.to_string())
            .collect();
        if !faults.is_empty() {
            let text = match faults.len() {
                1 => "a door does not open its whole width".to_owned(),
                count => format!("{count} doors do not open their whole width"),
            };
            let warning = Diagnostic::warning(Code::W0703, import.path.span, text).label(shown(&faults));
            context.note(warning.hint("a door opens the walls that pass within 0.5 m of it"));
        }
    }
}

/// The floor plan that an import gives its name to.
fn plan_of<'c>(context: &'c mut Context<'_>, import: &Import<'_>) -> Option<&'c mut FloorPlan> {
    let name = &import.called?.name;
    context.plans.iter_mut().find(|plan| plan.name == *name)
}

/// The parts of a floor plan that have an area and a name.
fn rooms(features: &[Feature]) -> NamedParts {
    let named = features.iter().flat_map(|feature| {
        let shape = match &feature.shape {
            Geometry::Polygon(polygon) => Some(Shape::Polygon(polygon.clone())),
            Geometry::Circle { centre, radius } => Some(Shape::Circle { centre: *centre, radius: *radius }),
            Geometry::Point(_) | Geometry::Line(_) => None,
        };
        // Maps number rooms by their `ref`.
        let number = feature.text("ref").filter(|number| *number != feature.name);
        let names = [Some(feature.name.as_str()), number].into_iter().flatten();
        names.filter(|name| !name.is_empty()).filter_map(move |name| Some((name.to_owned(), shape.clone()?)))
    });
    named.map(|(name, shape)| (name, PlanPart::Room(shape))).collect()
}

/// Imports one file; its doors, and its rooms by name. `middle` is the middle of the first file in degrees, which several share.
fn read_import(
    context: &mut Context<'_>,
    import: &Import<'_>,
    files: &Files,
    middle_of_first: &mut Option<Vec2>,
) -> Lowered<(Vec<Door>, NamedParts)> {
    let span = import.path.span;
    let format = Format::of(&import.path.value);
    let fields = fields::import_fields(context, import)?;
    let mut drawing = drawing::drawing(context, import, fields.unit, files)?;
    let placement = place(context, import, &fields, &mut drawing, middle_of_first)?;
    let touching = fields.snap.unwrap_or(TOUCHING);
    let plan = match geometry::plan(&drawing.features, (placement.unit(), touching), import.walkable) {
        Ok(plan) => plan,
        Err(errors) => return context.report(unreadable(span, &errors)),
    };
    if let Err(fault) = placement.check_doors(plan.doors.iter().map(|door| door.width)) {
        return drawing::misplaced(context, import, fault);
    }
    if !drawing.skipped.is_empty() {
        let counts: Vec<String> =
            drawing.skipped.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        let text = format!("the drawing has entities that are not imported: {}", counts.join(", "));
        let warning = Diagnostic::warning(Code::W0704, span, text);
        context.note(warning.hint(
            "explode blocks, convert curves to polylines, show what is hidden, or select other layers",
        ));
    }
    let first = context.scene.barriers.len();
    context.scene.barriers.extend(plan.barriers.into_iter().map(|(name, form)| {
        let obstacle = match form {
            Form::Wall(pieces) => Obstacle::Wall(pieces),
            Form::Solid(shape) => Obstacle::Solid(shape),
        };
        Barrier { name, obstacle }
    }));
    let implied = match format {
        Format::Dxf => Some(NEAR_MISS),
        _ => plan.has_spaces.then_some(TOUCHING),
    };
    join_walls(context, import, first, fields.snap, implied);
    Ok((plan.doors, rooms(&drawing.features)))
}

/// Moves a drawing to its place in the scene.
fn place(
    context: &mut Context<'_>,
    import: &Import<'_>,
    fields: &Fields,
    drawing: &mut Drawing,
    middle_of_first: &mut Option<Vec2>,
) -> Lowered<Placement> {
    let placement = if fields.is_local {
        if fields.origin.is_none() && middle_of_first.is_none() {
            *middle_of_first = middle(&drawing.features);
        }
        Placement::Local(fields.origin.or(*middle_of_first).unwrap_or_default())
    } else {
        let format = Format::of(&import.path.value);
        let is_stated = format == Format::Dxf || fields.unit.is_some() || fields.origin.is_some();
        let unit = match drawing.unit.or(fields.unit) {
            None if format == Format::Dxf => {
                let error = error!(E0711, import.path.span, "the drawing does not state its unit of length");
                let written = fields::rewritten(context, import, "unit", "1 mm");
                return context.report(error.hint(format!("write the unit, for example `{written}`")));
            }
            unit => unit.unwrap_or(1.0),
        };
        Placement::Plane { unit, origin: fields.origin.unwrap_or_default(), is_stated }
    };
    match placement.place(&mut drawing.features) {
        Ok(()) => Ok(placement),
        Err(fault) => drawing::misplaced(context, import, fault),
    }
}

/// Joins the walls of an import that nearly touch, or reports them. `implied` is the distance of an import without
/// `snap`, if it has one; what is joined there by more than rounding is reported, too.
fn join_walls(
    context: &mut Context<'_>,
    import: &Import<'_>,
    first: usize,
    snap: Option<f64>,
    implied: Option<f64>,
) {
    let imported = &mut context.scene.barriers[first..];
    let edges: Vec<Segment> = imported
        .iter()
        .filter_map(|barrier| match &barrier.obstacle {
            Obstacle::Solid(Shape::Polygon(polygon)) => Some(polygon.segments()),
            _ => None,
        })
        .flatten()
        .collect();
    let mut walls = walls(imported);
    let mut lines: Vec<Vec<Segment>> = walls.iter().map(|pieces| (**pieces).clone()).collect();
    if geometry::is_crowded(&lines, &edges, snap.unwrap_or(0.0).max(NEAR_MISS)) {
        context.scene.barriers.truncate(first);
        return crowded(context, import.path.span);
    }
    let is_reported = implied.is_some_and(|implied| implied > TOUCHING) && snap.is_none();
    let before = match snap {
        Some(snap) if snap > PASSABLE => geometry::slips(&lines, &edges, snap),
        None if is_reported => geometry::slips(&lines, &edges, NEAR_MISS),
        _ => None,
    };
    if let Some(snap) = snap.or(implied) {
        lines = geometry::snap(&lines, &edges, snap);
        for (pieces, joined) in walls.iter_mut().zip(&lines) {
            (*pieces).clone_from(joined);
        }
        let imported = context.scene.barriers.split_off(first);
        let whole = imported.into_iter().filter(|one| one.obstacle != Obstacle::Wall(Vec::new()));
        context.scene.barriers.extend(whole);
    }
    let slips = match (snap, before) {
        (Some(_), before) => before.filter(|slips| slips.widest.0 > PASSABLE),
        (None, before) if is_reported => before,
        _ => geometry::slips(&lines, &edges, NEAR_MISS),
    };
    let Some(slips) = slips else { return };
    let counted = |count: usize, one: &str, many: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        count => Some(format!("{count} {many}")),
    };
    let ends = counted(
        slips.ends,
        "end of a wall that misses another wall by less than 5 cm",
        "ends of walls that miss another wall by less than 5 cm",
    );
    let twice = counted(slips.doubled, "wall drawn twice", "walls drawn twice");
    let what: Vec<String> = ends.into_iter().chain(twice).collect();
    let written = fields::rewritten(context, import, "snap", "5 cm");
    let (text, at, hint) = if snap.is_some() {
        let (gap, at) = slips.widest;
        let text = format!("`snap` closes gaps of up to {gap:.2} m, which may be doors");
        (text, at, format!("write a smaller `snap`, such as `{written}`"))
    } else {
        let hint = if is_reported {
            format!("they were joined and merged; write `{written}` to accept this, or a smaller `snap`")
        } else {
            format!("write `{written}` to join and merge them")
        };
        (format!("the file has {}", what.join(" and ")), slips.place, hint)
    };
    let warning = Diagnostic::warning(Code::W0702, import.path.span, text);
    context.note(warning.label(format!("for example at ({:.3}, {:.3})", at.x, at.y)).hint(hint));
}

/// Walls that meet in more pairs than forces can look at.
pub(crate) fn crowded(context: &mut Context<'_>, span: Span) {
    let text = "too many walls meet or nearly meet each other: more than 2 million pairs";
    let hint = "leave out hatches and other fills, and lines that meet in one point by the thousand";
    context.note(error!(E0923, span, "{text}"; hint: "{hint}"));
}

/// The hint for a point inside an imported polygon that may be where agents move.
pub(crate) fn walkable_hint(context: &Context<'_>, p: Vec2) -> Option<String> {
    let (_, span) = context.origins.imports.iter().find(|(range, _)| {
        context.scene.barriers[range.clone()].iter().any(|barrier| {
                matches!(&barrier.obstacle, Obstacle::Solid(Shape::Polygon(polygon)) if polygon.contains(p))
            })
    })?;
    let path = context.text(*span);
    Some(format!("polygons are obstacles; if agents move inside them, write `import {path} as walkable`"))
}

/// The walls among barriers.
pub(crate) fn walls(barriers: &mut [Barrier]) -> Vec<&mut Vec<Segment>> {
    let wall = |barrier| match barrier {
        &mut Barrier { obstacle: Obstacle::Wall(ref mut pieces), .. } => Some(pieces),
        _ => None,
    };
    barriers.iter_mut().filter_map(wall).collect()
}
