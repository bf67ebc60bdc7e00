//! Shapes and points of a scene, as expressions give them.

use crate::base::geometry::{Polygon, Shape, Vec2, coordinate_fault};
use crate::compile::context::levels;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    dependence::Meant,
    number::Number,
    symbols::{Meaning, unknown},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::model::{Period, RegionId};
use crate::syntax::ast::{Expr, Ident, ShapeExpr};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;

/// What lies outside of the range must not: a hair is rounding, m.
const HAIR: f64 = 1e-9;

/// The shape of a region, settled when it is first needed.
pub(crate) fn region_shape(context: &mut Context<'_>, id: RegionId, span: Span) -> Lowered<Shape> {
    if let Some(Some(known)) = context.shapes.get(id.0 as usize) {
        return known.clone();
    }
    let name = context.scene.regions[id.0 as usize].name.clone();
    let Some(Meaning::Region(_, written)) = context.names.scopes[0].get(&name).map(|e| e.meaning.clone())
    else {
        return context.report(error!(E0205, span, "the region `{name}` is not declared yet"));
    };
    if context.names.expanding.iter().any(|(_, n)| *n == name) {
        return context.report(error!(E0205, span, "`{name}` depends on itself").about(About::Circle));
    }
    context.expand_further(span)?;
    context.names.expanding.push((0, name));
    let shape = lower_shape(context, written, &Locals::default());
    context.names.expanding.pop();
    context.shapes[id.0 as usize] = Some(shape.clone());
    shape
}

/// A shape as written.
pub(crate) fn lower_shape(context: &mut Context<'_>, shape: &ShapeExpr, locals: &Locals) -> Lowered<Shape> {
    match shape {
        ShapeExpr::Named(name) => named_shape(context, name),
        ShapeExpr::Of(room) => match context.lower(room, locals)? {
            Typed::Region(id) => region_shape(context, id, room.span),
            found => context.mismatch(room.span, "a region", &found),
        },
        ShapeExpr::Circle { centre, radius, span } => {
            let middle = point_of(context, centre, locals);
            let size = context.number_of(radius, Dimension::LENGTH, locals)?;
            if size.value <= 0.0 {
                return context.report(error!(E0401, radius.span, "the radius of a circle must be positive"));
            }
            let circle = Shape::Circle { centre: middle?, radius: size.value };
            in_scene(context, *span, circle.bounds().low)?;
            in_scene(context, *span, circle.bounds().high)?;
            Ok(circle)
        }
        ShapeExpr::Rectangle { a, b, span } => {
            let corners = (point_of(context, a, locals), point_of(context, b, locals));
            let (a, b) = (corners.0?, corners.1?);
            if a.x == b.x || a.y == b.y {
                return context.report(error!(E0401, *span, "the rectangle has no area"));
            }
            Ok(Shape::rectangle(a.inf(&b), a.sup(&b)))
        }
        ShapeExpr::Parts(parts) => {
            let shapes: Vec<_> = parts.iter().map(|part| lower_shape(context, part, locals)).collect();
            joined(context, parts.iter().map(ShapeExpr::span).zip(shapes).collect())
        }
        ShapeExpr::Polygon { outline, holes, span } => {
            let ring = |this: &mut Context<'_>, points: &[Expr]| -> Lowered<Vec<Vec2>> {
                let corners: Vec<_> = points.iter().map(|p| point_of(this, p, locals)).collect();
                corners.into_iter().collect()
            };
            let outline = ring(context, outline);
            let holes: Vec<_> = holes.iter().map(|hole| ring(context, hole)).collect();
            let polygon = Polygon { outline: outline?, holes: holes.into_iter().collect::<Lowered<_>>()? };
            if polygon.outline.len() < 3 || polygon.holes.iter().any(|hole| hole.len() < 3) {
                return context.report(error!(E0401, *span, "a polygon needs at least three corners"));
            }
            let twice = std::iter::once(&polygon.outline).chain(&polygon.holes).find_map(|ring| {
                (0..ring.len()).map(|k| (ring[k], ring[(k + 1) % ring.len()])).find(|(a, b)| a == b)
            });
            if let Some((corner, _)) = twice {
                return context.report(error!(E0401, *span, "the corner ({}, {}) is repeated", corner.x, corner.y;
                        hint: "polygons are closed automatically: do not repeat the first corner at the end"));
            }
            if !polygon.is_simple() {
                return context.report(error!(E0401, *span, "the edges of the polygon cross"));
            }
            if let Some(fault) = polygon.hole_fault() {
                return context.report(error!(E0401, *span, "{}", fault.to_string();
                        hint: "holes must be inside the outline and must not meet each other"));
            }
            if polygon.area() <= 0.0 {
                return context.report(error!(E0401, *span, "the polygon has no area"));
            }
            Ok(Shape::Polygon(polygon))
        }
    }
}

/// One shape of several that share no area.
pub(crate) fn joined(context: &mut Context<'_>, written: Vec<(Span, Lowered<Shape>)>) -> Lowered<Shape> {
    let mut parts: Vec<(Span, Shape)> = Vec::new();
    for (span, shape) in written {
        // Parts have no parts.
        for part in shape?.parts() {
            if let Some((first, _)) = parts.iter().find(|(_, other)| other.overlaps(part)) {
                let error = error!(E0401, span, "two parts of the region overlap";
                    hint: "give each part an area of its own");
                return context.report(error.related(*first, "the other part"));
            }
            parts.push((span, part.clone()));
        }
    }
    Ok(Shape::Parts(parts.into_iter().map(|(_, part)| part).collect()))
}

/// A place known at compile time, m.
pub(crate) fn point_of(context: &mut Context<'_>, expr: &Expr, locals: &Locals) -> Lowered<Vec2> {
    match context.lower(expr, locals)? {
        Typed::Point(x, y) => place(context, expr.span, (x, y)),
        found => context.mismatch(expr.span, "a point such as `(1, 2)`", &found),
    }
}

/// A point as a place of the plane, m.
pub(crate) fn place(context: &mut Context<'_>, span: Span, (x, y): (Number, Number)) -> Lowered<Vec2> {
    if x.dimension != Dimension::LENGTH {
        return context.wrong_dimension(span, Dimension::LENGTH, x.dimension);
    }
    in_scene(context, span, Vec2::new(x.value, y.value))
}

/// A point that a scene can have: rounding swallows the steps of people far from the origin.
pub(crate) fn in_reach(context: &mut Context<'_>, span: Span, p: Vec2) -> Lowered<Vec2> {
    match coordinate_fault(p) {
        None => Ok(p),
        Some(fault) => context.report(error!(E0710, span, "{fault}";
                    hint: "subtract a common origin from all coordinates")),
    }
}

fn named_shape(context: &mut Context<'_>, name: &Ident) -> Lowered<Shape> {
    let full = levels::on_level(context, &name.name);
    match context.look_up(full.as_ref().unwrap_or(&name.name), 0) {
        Some((_, Meaning::Stairs(id))) => region_shape(context, id, name.span),
        Some((_, Meaning::Region(id, shape))) => {
            context.names.uses.insert(name.span, Meant::Written(shape.span()));
            region_shape(context, id, name.span)
        }
        Some((_, Meaning::Doubtful)) => Err(Reported),
        Some((_, meaning)) => context.report(error!(
            E0206,
            name.span,
            "expected a region, but `{}` is {}",
            name.name,
            meaning.noun()
        )),
        None => {
            let regions: Vec<String> = context.scene.regions.iter().map(|r| r.name.clone()).collect();
            let known = regions.iter().map(String::as_str);
            let error = unknown("region", &name.name, name.span, Code::E0201, known);
            context.report(error)
        }
    }
}

/// A place that the scene holds.
pub(crate) fn in_scene(context: &mut Context<'_>, span: Span, p: Vec2) -> Lowered<Vec2> {
    let p = in_reach(context, span, p)?;
    if context.scene.periods.hold(p, HAIR) {
        return Ok(p);
    }
    let periods = context.scene.periods;
    let beyond = |axis: &str, period: Option<Period>, v: f64| {
        let period = period.filter(|period| v < period.low || v > period.high())?;
        let (low, high) = (metres(period.low), metres(period.high()));
        Some(format!("{axis} = {} lies outside of the period {low} .. {high}", metres(v)))
    };
    let text = beyond("x", periods.x, p.x).or_else(|| beyond("y", periods.y, p.y));
    context.report(error!(E0410, span, "{}", text.unwrap_or_default();
            hint: "end at the ends of the period: what is there continues at the other end"))
}

/// A length without noise of rounding.
pub(crate) fn metres(length: f64) -> String {
    format!("{} m", (length * 1e6).round() / 1e6)
}

/// The area of a region, m^2.
pub(crate) fn area(context: &mut Context<'_>, typed: &Typed, span: Span) -> Lowered<Number> {
    match typed {
        Typed::Region(region) => {
            let shape = region_shape(context, *region, span)?;
            Ok(Number::rounded(shape.area(), Dimension::AREA))
        }
        found => context.mismatch(span, "a region", found),
    }
}
