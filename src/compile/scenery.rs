//! The scene: walls, obstacles, regions.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::files::Files;
use super::imports::{Import, walls};
use super::lower::DISTRIBUTIONS;
use super::number::Number;
use super::symbols::Meaning;
use super::typed::Typed;
use crate::base::geometry::{Polygon, Segment, Shape, Vec2, coordinate_fault};
use crate::data::geometry::{self, plan::TOUCHING};
use crate::model::{Barrier, BarrierId, BuiltIn, Line, LineId, Obstacle, Region, RegionId};
use crate::syntax::ast::{Expr, ExprKind, Ident, SceneItem, ShapeExpr};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;

impl<'a> Elaborator<'a> {
    /// Declares the names of a scene. Regions and barriers get their numbers in order of writing; barriers of
    /// imports come last.
    pub(super) fn declare_scene(&mut self, items: &'a [SceneItem]) {
        for item in items {
            match item {
                SceneItem::Region { name, shape } => {
                    self.shapes.push(None);
                    let id = RegionId(self.shapes.len() as u32 - 1);
                    self.scene.regions.push(Region {
                        name: name.name.clone(),
                        shape: Shape::rectangle(Vec2::zeros(), Vec2::zeros()),
                    });
                    self.enter(name, Meaning::Region(id, shape));
                }
                SceneItem::Wall { name, .. } | SceneItem::Obstacle { name, .. } => {
                    let id = BarrierId(self.scene.barriers.len() as u32);
                    let text = name.as_ref().map_or(String::new(), |n| n.name.clone());
                    self.scene.barriers.push(Barrier { name: text, obstacle: Obstacle::Wall(Vec::new()) });
                    if let Some(name) = name {
                        self.enter(name, Meaning::Barrier(id));
                    }
                }
                SceneItem::Point { name, at } => self.enter(name, Meaning::Point(at)),
                SceneItem::Line { name, .. } => {
                    let id = LineId(self.scene.lines.len() as u32);
                    let nowhere = Segment::new(Vec2::zeros(), Vec2::zeros());
                    self.scene.lines.push(Line { name: name.name.clone(), segment: nowhere });
                    self.enter(name, Meaning::Line(id));
                }
                SceneItem::Import { .. } | SceneItem::Periodic { .. } => {}
            }
        }
    }

    /// Settles the shapes of a scene; `next` and `line` are the numbers of its first barrier and its first line.
    pub(super) fn settle_scene(
        &mut self,
        items: &'a [SceneItem],
        files: &Files,
        (next, line): (&mut usize, &mut usize),
    ) {
        let mut imports = Vec::new();
        for item in items {
            match item {
                SceneItem::Region { name, shape } => {
                    let entry = self.scopes[0].get(&name.name).filter(|entry| entry.span == name.span);
                    if let Some(Meaning::Region(id, _)) = entry.map(|entry| entry.meaning.clone()) {
                        if let Ok(shape) = self.region_shape(id, name.span) {
                            self.scene.regions[id.0 as usize].shape = shape;
                        }
                    } else {
                        // The name is taken; what is wrong with the shape is said beside that.
                        let _ = self.shape(shape, &Locals::default());
                    }
                }
                SceneItem::Wall { points, span, .. } => {
                    if let Ok(segments) = self.wall(points, *span) {
                        self.scene.barriers[*next].obstacle = Obstacle::Wall(segments);
                    }
                    *next += 1;
                }
                SceneItem::Obstacle { shape, .. } => {
                    if let Ok(shape) = self.shape(shape, &Locals::default()) {
                        self.scene.barriers[*next].obstacle = Obstacle::Solid(shape);
                    }
                    *next += 1;
                }
                SceneItem::Point { name, at } => match self.point_of(at, &Locals::default()) {
                    Ok(at) => self.scene.points.push((name.name.clone(), at)),
                    Err(Reported) => self.doubt(0, &name.name),
                },
                SceneItem::Line { ends, span, .. } => {
                    if let Ok(segment) = self.line(ends, *span) {
                        self.scene.lines[*line].segment = segment;
                    }
                    *line += 1;
                }
                SceneItem::Import { path, walkable, filter, fields, .. } => {
                    imports.push(Import { path, walkable: *walkable, filter: filter.as_ref(), fields });
                }
                SceneItem::Periodic { .. } => {}
            }
        }
        let first = self.scene.barriers.len();
        self.import_all(&imports, files);
        self.check_imported(items, first);
        let walls =
            walls(&mut self.scene.barriers).into_iter().map(|pieces| pieces.clone()).collect::<Vec<_>>();
        let wall = items.iter().find_map(|item| match item {
            SceneItem::Wall { span, .. } | SceneItem::Import { span, .. } => Some(*span),
            _ => None,
        });
        if let Some(span) = wall.filter(|_| geometry::is_crowded(&walls, &[], TOUCHING)) {
            self.crowded(span);
        }
    }

    /// The shape of a region, settled when it is first needed.
    pub(super) fn region_shape(&mut self, id: RegionId, span: Span) -> Lowered<Shape> {
        if let Some(Some(known)) = self.shapes.get(id.0 as usize) {
            return known.clone();
        }
        let name = self.scene.regions[id.0 as usize].name.clone();
        let Some(Meaning::Region(_, written)) = self.scopes[0].get(&name).map(|e| e.meaning.clone()) else {
            return self.report(error!(E0205, span, "the region `{name}` is not declared yet"));
        };
        if self.expanding.iter().any(|(_, n)| *n == name) {
            return self.report(error!(E0205, span, "`{name}` depends on itself").about(About::Circle));
        }
        self.expand_further(span)?;
        self.expanding.push((0, name));
        let shape = self.shape(written, &Locals::default());
        self.expanding.pop();
        self.shapes[id.0 as usize] = Some(shape.clone());
        shape
    }

    fn wall(&mut self, points: &[Expr], span: Span) -> Lowered<Vec<Segment>> {
        let corner = |(k, point)| if k == 0 { self.first_corner(point) } else { self.corner(point) };
        let corners: Vec<_> = points.iter().enumerate().map(corner).collect();
        let corners: Vec<Vec2> = corners.into_iter().collect::<Lowered<_>>()?;
        if corners.windows(2).all(|pair| pair[0] == pair[1]) {
            return self.report(error!(E0401, span, "the wall has no length"));
        }
        Ok(corners
            .windows(2)
            .filter(|pair| pair[0] != pair[1])
            .map(|pair| Segment::new(pair[0], pair[1]))
            .collect())
    }

    fn line(&mut self, ends: &[Expr; 2], span: Span) -> Lowered<Segment> {
        let [a, b] = ends.each_ref().map(|end| self.corner(end));
        let segment = Segment::new(a?, b?);
        if segment.a == segment.b {
            return self.report(error!(E0401, span, "the line has no length";
                hint: "write two different points: `line door: (3, 0) -- (3, 2)`"));
        }
        Ok(segment)
    }

    fn corner(&mut self, point: &Expr) -> Lowered<Vec2> {
        self.point_of(point, &Locals::default())
    }

    /// Where a wall begins. `wall south (0, 0) -- …` lacks a colon: it reads as a call.
    fn first_corner(&mut self, point: &Expr) -> Lowered<Vec2> {
        if let ExprKind::Call { function, arguments } = &point.kind
            && arguments.len() == 2
            && self.find(&function.name, 0).is_none()
            && !BuiltIn::names().chain(DISTRIBUTIONS).any(|known| known == function.name)
        {
            let name = &function.name;
            return self.report(error!(E0203, function.span, "unknown function `{name}`";
                hint: "write `:` after a name: `wall {name}: {}`", self.text(Span { start: function.span.end, ..point.span })).about(About::Name(name.clone())));
        }
        self.corner(point)
    }

    /// A shape as written.
    pub(super) fn shape(&mut self, shape: &ShapeExpr, locals: &Locals) -> Lowered<Shape> {
        match shape {
            ShapeExpr::Named(name) => self.named_shape(name),
            ShapeExpr::Circle { centre, radius, span } => {
                let middle = self.point_of(centre, locals);
                let size = self.number_of(radius, Dimension::LENGTH, locals)?;
                if size.value <= 0.0 {
                    return self
                        .report(error!(E0401, radius.span, "the radius of a circle must be positive"));
                }
                let circle = Shape::Circle { centre: middle?, radius: size.value };
                self.in_scene(*span, circle.bounds().low)?;
                self.in_scene(*span, circle.bounds().high)?;
                Ok(circle)
            }
            ShapeExpr::Rectangle { a, b, span } => {
                let corners = (self.point_of(a, locals), self.point_of(b, locals));
                let (a, b) = (corners.0?, corners.1?);
                if a.x == b.x || a.y == b.y {
                    return self.report(error!(E0401, *span, "the rectangle has no area"));
                }
                Ok(Shape::rectangle(a.inf(&b), a.sup(&b)))
            }
            ShapeExpr::Polygon { outline, holes, span } => {
                let ring = |this: &mut Self, points: &[Expr]| -> Lowered<Vec<Vec2>> {
                    let corners: Vec<_> = points.iter().map(|p| this.point_of(p, locals)).collect();
                    corners.into_iter().collect()
                };
                let outline = ring(self, outline);
                let holes: Vec<_> = holes.iter().map(|hole| ring(self, hole)).collect();
                let polygon =
                    Polygon { outline: outline?, holes: holes.into_iter().collect::<Lowered<_>>()? };
                if polygon.outline.len() < 3 || polygon.holes.iter().any(|hole| hole.len() < 3) {
                    return self.report(error!(E0401, *span, "a polygon needs at least three corners"));
                }
                let twice = std::iter::once(&polygon.outline).chain(&polygon.holes).find_map(|ring| {
                    (0..ring.len()).map(|k| (ring[k], ring[(k + 1) % ring.len()])).find(|(a, b)| a == b)
                });
                if let Some((corner, _)) = twice {
                    return self.report(error!(E0401, *span, "the corner ({}, {}) is repeated", corner.x, corner.y;
                        hint: "polygons are closed automatically: do not repeat the first corner at the end"));
                }
                if !polygon.is_simple() {
                    return self.report(error!(E0401, *span, "the edges of the polygon cross"));
                }
                if let Some(fault) = polygon.hole_fault() {
                    return self.report(error!(E0401, *span, "{}", fault.to_string();
                        hint: "holes must be inside the outline and must not meet each other"));
                }
                if polygon.area() <= 0.0 {
                    return self.report(error!(E0401, *span, "the polygon has no area"));
                }
                Ok(Shape::Polygon(polygon))
            }
        }
    }

    /// A place known at compile time, m.
    pub(super) fn point_of(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Vec2> {
        match self.lower(expr, locals)? {
            Typed::Point(x, y) => self.place(expr.span, (x, y)),
            found => self.mismatch(expr.span, "a point such as `(1, 2)`", &found),
        }
    }

    /// A point as a place of the plane, m.
    pub(super) fn place(&mut self, span: Span, (x, y): (Number, Number)) -> Lowered<Vec2> {
        if x.dimension != Dimension::LENGTH {
            return self.wrong_dimension(span, Dimension::LENGTH, x.dimension);
        }
        self.in_scene(span, Vec2::new(x.value, y.value))
    }

    /// A point that a scene can have: rounding swallows the steps of people far from the origin.
    pub(super) fn in_reach(&mut self, span: Span, p: Vec2) -> Lowered<Vec2> {
        match coordinate_fault(p) {
            None => Ok(p),
            Some(fault) => self.report(error!(E0710, span, "{fault}";
                    hint: "subtract a common origin from all coordinates")),
        }
    }

    fn named_shape(&mut self, name: &Ident) -> Lowered<Shape> {
        match self.find(&name.name, 0) {
            Some((_, Meaning::Region(id, _))) => self.region_shape(id, name.span),
            Some((_, Meaning::Doubtful)) => Err(Reported),
            Some((_, meaning)) => self.report(error!(
                E0206,
                name.span,
                "expected a region, but `{}` is {}",
                name.name,
                meaning.noun()
            )),
            None => {
                let regions: Vec<String> = self.scene.regions.iter().map(|r| r.name.clone()).collect();
                let known = regions.iter().map(String::as_str);
                let error = super::symbols::unknown("region", &name.name, name.span, Code::E0201, known);
                self.report(error)
            }
        }
    }
}
