//! The scene: walls, obstacles, regions.

pub(crate) mod doors;
pub(crate) mod imports;
pub(crate) mod periodic;
pub(crate) mod storeys;

use crate::base::geometry::{Segment, Shape, Vec2};
use crate::compile::context::{
    Context, Locals, Lowered, Reported, entry, levels::Level, plans::FloorPlan, symbols::Meaning,
};
use crate::compile::files::Files;
use crate::compile::lower::{builtin::DISTRIBUTIONS, shapes};
use crate::compile::nearest::nearest;
use crate::compile::scene::imports::{fields::Import, walls};
use crate::data::geometry::{self, plan::TOUCHING};
use crate::model::{Barrier, BarrierId, BuiltIn, Line, LineId, Obstacle, Region, RegionId};
use crate::syntax::ast::{Expr, ExprKind, Ident, SceneItem, ShapeExpr};
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;

/// The word behind `as` that is no name of a floor plan.
const WALKABLE: &str = "walkable";

/// Declares the names of a scene. Regions and barriers get their numbers in order of writing; barriers of
/// imports come last.
pub(crate) fn declare_scene<'a>(context: &mut Context<'a>, items: &'a [SceneItem]) {
    for item in items {
        match item {
            SceneItem::Region { name, shape } => {
                context.shapes.push(None);
                let id = RegionId(context.shapes.len() as u32 - 1);
                let nothing = Shape::rectangle(Vec2::zeros(), Vec2::zeros());
                context.scene.regions.push(Region::new(&name.name, nothing));
                entry::enter(context, name, Meaning::Region(id, shape));
            }
            SceneItem::Wall { name, .. } | SceneItem::Obstacle { name, .. } => {
                let id = BarrierId(context.scene.barriers.len() as u32);
                let text = name.as_ref().map_or(String::new(), |n| n.name.clone());
                context.scene.barriers.push(Barrier { name: text, obstacle: Obstacle::Wall(Vec::new()) });
                if let Some(name) = name {
                    entry::enter(context, name, Meaning::Barrier(id));
                }
            }
            SceneItem::Point { name, at } => entry::enter(context, name, Meaning::Point(at)),
            SceneItem::Line { name, .. } => {
                let id = LineId(context.scene.lines.len() as u32);
                let nowhere = Segment::new(Vec2::zeros(), Vec2::zeros());
                context.scene.lines.push(Line { name: name.name.clone(), segment: nowhere });
                entry::enter(context, name, Meaning::Line(id));
            }
            SceneItem::Door { name, .. } => {
                let id = LineId(context.scene.lines.len() as u32);
                let nowhere = Segment::new(Vec2::zeros(), Vec2::zeros());
                context.scene.lines.push(Line { name: name.name.clone(), segment: nowhere });
                entry::enter(context, name, Meaning::Line(id));
            }
            SceneItem::Import { called: Some(name), .. } => {
                if is_misspelt(name) {
                    let error = error!(E0101, name.span, "expected `{WALKABLE}`, found `{}`", name.name;
                        hint: "did you mean `{WALKABLE}`?");
                    context.note(error);
                }
                context.plans.push(FloorPlan { name: name.name.clone(), parts: None });
                entry::enter(context, name, Meaning::Plan(context.plans.len() - 1));
            }
            SceneItem::Level { name, items, .. } => {
                let [barriers, lines] = [context.scene.barriers.len(), context.scene.lines.len()];
                entry::enter(context, name, Meaning::Level(context.levels.all.len()));
                let level = Level { name: name.name.clone(), barriers: 0..0, lines: 0..0 };
                let number = context.levels.all.len();
                context.levels.all.push(level);
                declare_scene(context, items);
                let level = &mut context.levels.all[number];
                level.barriers = barriers..context.scene.barriers.len();
                level.lines = lines..context.scene.lines.len();
            }
            SceneItem::Stairs { name, .. } => declare_stairs(context, name),
            SceneItem::Storeys { import, levels, .. } if levels.is_empty() => {
                let span = storeys::place_of(import);
                let error = error!(E0412, span, "the import names no levels");
                let hint =
                    "write which level of the file is which: `ground = \"0\"; first = \"1\"; storey = 4 m`";
                context.note(error.hint(hint));
            }
            SceneItem::Import { called: None, .. }
            | SceneItem::Periodic { .. }
            | SceneItem::Storeys { .. } => {}
        }
    }
}

/// Declares a flight of stairs, a region of its own.
fn declare_stairs(context: &mut Context<'_>, name: &Ident) {
    context.shapes.push(None);
    let id = RegionId(context.shapes.len() as u32 - 1);
    let nothing = Shape::rectangle(Vec2::zeros(), Vec2::zeros());
    context.scene.regions.push(Region::new(&name.name, nothing));
    entry::enter(context, name, Meaning::Stairs(id));
}

/// Settles the shapes of all scenes. The doors are set when all walls are known.
pub(crate) fn settle<'a>(
    context: &mut Context<'a>,
    scenes: &[&'a [SceneItem]],
    files: &Files,
) -> Vec<doors::Door> {
    if !context.levels.all.is_empty() {
        return storeys::settle(context, scenes, files);
    }
    let (mut barrier, mut line) = (0, 0);
    let (mut doors, mut middle) = (Vec::new(), None);
    for items in scenes {
        doors.extend(settle_scene(context, items, files, (&mut barrier, &mut line, &mut middle)));
    }
    doors
}

fn settle_region(context: &mut Context<'_>, name: &Ident, shape: &ShapeExpr) {
    let entry = context.names.scopes[0].get(&name.name).filter(|entry| entry.span == name.span);
    if let Some(Meaning::Region(id, _)) = entry.map(|entry| entry.meaning.clone()) {
        if let Ok(shape) = shapes::region_shape(context, id, name.span) {
            context.scene.regions[id.0 as usize].shape = shape;
        }
    } else {
        // The name is taken; what is wrong with the shape is said beside that.
        let _ = shapes::lower_shape(context, shape, &Locals::default());
    }
}

/// Settles the shapes of a scene or level; `next` and `line` are the numbers of its first barrier and its first line, `middle` is that of
/// the first file in degrees, which all share. The doors are set when all walls are known.
pub(crate) fn settle_scene<'a>(
    context: &mut Context<'a>,
    items: &'a [SceneItem],
    files: &Files,
    (next, line, middle): (&mut usize, &mut usize, &mut Option<Vec2>),
) -> Vec<doors::Door> {
    let first = context.scene.barriers.len();
    let imports: Vec<Import<'_>> = items.iter().filter_map(import_of).collect();
    imports::import_all(context, &imports, files, middle);
    periodic::check_imported(context, items, first);
    let mut doors = Vec::new();
    for item in items {
        match item {
            SceneItem::Region { name, shape } => settle_region(context, name, shape),
            SceneItem::Wall { points, span, .. } => {
                if let Ok(segments) = wall(context, points, *span) {
                    context.scene.barriers[*next].obstacle = Obstacle::Wall(segments);
                }
                *next += 1;
            }
            SceneItem::Obstacle { shape, .. } => {
                match shapes::lower_shape(context, shape, &Locals::default()) {
                    Ok(Shape::Parts(_)) => {
                        let error = error!(E0401, shape.span(), "an obstacle has one part";
                            hint: "write an obstacle for each part of the region");
                        context.note(error);
                    }
                    Ok(shape) => context.scene.barriers[*next].obstacle = Obstacle::Solid(shape),
                    Err(Reported) => {}
                }
                *next += 1;
            }
            SceneItem::Point { name, at } => match shapes::point_of(context, at, &Locals::default()) {
                Ok(at) => context.scene.points.push((name.name.clone(), at)),
                Err(Reported) => entry::doubt(context, 0, &name.name),
            },
            SceneItem::Line { ends, span, .. } => {
                if let Ok(segment) = lower_line(context, ends, *span) {
                    context.scene.lines[*line].segment = segment;
                }
                *line += 1;
            }
            SceneItem::Door { name, ends, fields, span } => {
                let state = doors::state(context, fields);
                if let Ok(segment) = lower_line(context, ends, *span) {
                    context.scene.lines[*line].segment = segment;
                    let state = state.unwrap_or(doors::State::Fixed(false));
                    doors.push(doors::Door { name: name.clone(), segment, state });
                }
                *line += 1;
            }
            SceneItem::Import { .. }
            | SceneItem::Periodic { .. }
            | SceneItem::Level { .. }
            | SceneItem::Storeys { .. }
            | SceneItem::Stairs { .. } => {}
        }
    }
    let walls =
        walls(&mut context.scene.barriers).into_iter().map(|pieces| pieces.clone()).collect::<Vec<_>>();
    let wall = items.iter().find_map(|item| match item {
        SceneItem::Wall { span, .. } | SceneItem::Import { span, .. } => Some(*span),
        _ => None,
    });
    if let Some(span) = wall.filter(|_| geometry::is_crowded(&walls, &[], TOUCHING)) {
        imports::crowded(context, span);
    }
    doors
}

/// An import as written.
pub(crate) fn import_of(item: &SceneItem) -> Option<Import<'_>> {
    let SceneItem::Import { path, walkable, filter, called, fields, .. } = item else { return None };
    let walkable = *walkable || called.as_ref().is_some_and(is_misspelt);
    Some(Import { path, walkable, filter: filter.as_ref(), called: called.as_ref(), fields })
}

/// Whether the name of a floor plan was meant to be `walkable`.
fn is_misspelt(name: &Ident) -> bool {
    nearest(&name.name, std::iter::once(WALKABLE)).is_some()
}

fn wall(context: &mut Context<'_>, points: &[Expr], span: Span) -> Lowered<Vec<Segment>> {
    let corner = |(k, point)| if k == 0 { first_corner(context, point) } else { corner(context, point) };
    let corners: Vec<_> = points.iter().enumerate().map(corner).collect();
    let corners: Vec<Vec2> = corners.into_iter().collect::<Lowered<_>>()?;
    if corners.windows(2).all(|pair| pair[0] == pair[1]) {
        return context.report(error!(E0401, span, "the wall has no length"));
    }
    Ok(corners
        .windows(2)
        .filter(|pair| pair[0] != pair[1])
        .map(|pair| Segment::new(pair[0], pair[1]))
        .collect())
}

fn lower_line(context: &mut Context<'_>, ends: &[Expr; 2], span: Span) -> Lowered<Segment> {
    let [a, b] = ends.each_ref().map(|end| corner(context, end));
    let segment = Segment::new(a?, b?);
    if segment.a == segment.b {
        return context.report(error!(E0401, span, "the line has no length";
                hint: "write two different points: `line door: (3, 0) -- (3, 2)`"));
    }
    Ok(segment)
}

fn corner(context: &mut Context<'_>, point: &Expr) -> Lowered<Vec2> {
    shapes::point_of(context, point, &Locals::default())
}

/// Where a wall begins. `wall south (0, 0) -- …` lacks a colon: it reads as a call.
fn first_corner(context: &mut Context<'_>, point: &Expr) -> Lowered<Vec2> {
    if let ExprKind::Call { function, arguments } = &point.kind
        && arguments.len() == 2
        && context.look_up(&function.name, 0).is_none()
        && !BuiltIn::names().chain(DISTRIBUTIONS).any(|known| known == function.name)
    {
        let name = &function.name;
        return context.report(error!(E0203, function.span, "unknown function `{name}`";
                hint: "write `:` after a name: `wall {name}: {}`", context.text(Span { start: function.span.end, ..point.span })).about(About::Name(name.clone())));
    }
    corner(context, point)
}
