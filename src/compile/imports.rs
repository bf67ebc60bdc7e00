//! Imports: the walls, obstacles and doors of a file become barriers of the scene.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::files::{Files, missing};
use super::filter;
use super::laws::value_span;
use super::symbols::unknown;
use super::typed::Typed;
use crate::base::geometry::{Segment, Shape, Vec2};
use crate::data::geometry::{
    self, Door, Drawing, Fault, Form, Format, Geometry, GeometryError, Opened, Placement, PropertyValue,
    placement::middle, plan::TOUCHING,
};
use crate::model::{Barrier, Obstacle};
use crate::syntax::ast::{Expr, ExprKind, Field, Text, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Walls that miss each other by less than this distance are reported; walls of a DXF drawing are joined, m.
const NEAR_MISS: f64 = 0.05;
/// Within at most so many metres walls are joined.
const WIDEST_SNAP: f64 = 1.0;
/// Most names of properties that a warning lists.
const MOST_NAMES: usize = 8;
/// Most features that a message names.
const MOST_NAMED: usize = 5;
/// The fields of an import.
const FIELDS: [&str; 4] = ["snap", "unit", "origin", "projection"];

/// An import as written.
pub(super) struct Import<'a> {
    pub(super) path: &'a Text,
    pub(super) walkable: bool,
    pub(super) filter: Option<&'a Expr>,
    pub(super) fields: &'a [Field],
}

/// The fields of an import; lengths in m.
#[derive(Default)]
struct Fields {
    snap: Option<f64>,
    unit: Option<f64>,
    /// As written: metres, or degrees with a projection.
    origin: Option<Vec2>,
    is_local: bool,
}

impl Elaborator<'_> {
    /// Imports all files of a scene. Doors open the walls of all of them.
    pub(super) fn import_all(&mut self, imports: &[Import<'_>], files: &Files) {
        let (first, mut middle) = (self.scene.barriers.len(), None);
        let mut found: Vec<(Span, Vec<Door>)> = Vec::new();
        for import in imports {
            let start = self.scene.barriers.len();
            if let Ok(doors) = self.import(import, files, &mut middle) {
                found.push((import.path.span, doors));
            }
            self.origins.imports.push((start..self.scene.barriers.len(), import.path.span));
        }
        let doors: Vec<Door> = found.iter().flat_map(|(_, doors)| doors.iter().cloned()).collect();
        let mut walls = walls(&mut self.scene.barriers[first..]);
        let mut opened = geometry::open_doors(&mut walls, &doors).into_iter();
        for (span, doors) in found {
            let faults: Vec<String> =
                doors
                    .iter()
                    .zip(opened.by_ref())
                    .filter_map(|(door, opened)| match opened {
                        Opened::Whole => None,
                        Opened::Part(part) => Some(
                            door.place
                                .error(format!("its wall has {part:.2} m for a door of {:.2} m", door.width)),
                        ),
                        Opened::Nothing => Some(door.place.error(format!(
                            "no wall is within 0.5 m of ({:.2}, {:.2})",
                            door.at.x, door.at.y
                        ))),
                    })
                    .map(|fault| fault.to_string())
                    .collect();
            if !faults.is_empty() {
                let text = match faults.len() {
                    1 => "a door does not open its whole width".to_owned(),
                    count => format!("{count} doors do not open their whole width"),
                };
                let warning = Diagnostic::warning(Code::W0703, span, text).label(shown(&faults));
                self.note(warning.hint("a door opens the walls that pass within 0.5 m of it"));
            }
        }
    }

    /// Imports one file; its doors. `middle` is the middle of the first file in degrees, which several share.
    fn import(
        &mut self,
        import: &Import<'_>,
        files: &Files,
        middle_of_first: &mut Option<Vec2>,
    ) -> Lowered<Vec<Door>> {
        let span = import.path.span;
        let format = Format::of(&import.path.value);
        let fields = self.import_fields(import)?;
        let mut drawing = self.drawing(import, format, fields.unit, files)?;
        let placement = if fields.is_local {
            if fields.origin.is_none() && middle_of_first.is_none() {
                *middle_of_first = middle(&drawing.features);
            }
            Placement::Local(fields.origin.or(*middle_of_first).unwrap_or_default())
        } else {
            let is_stated = format == Format::Dxf || fields.unit.is_some() || fields.origin.is_some();
            let unit = match drawing.unit.or(fields.unit) {
                None if format == Format::Dxf => {
                    let error =
                        Diagnostic::error(Code::E0711, span, "the drawing does not state its unit of length");
                    let written = self.rewritten(import, "unit", "1 mm");
                    return self.report(error.hint(format!("write the unit, for example `{written}`")));
                }
                unit => unit.unwrap_or(1.0),
            };
            Placement::Plane { unit, origin: fields.origin.unwrap_or_default(), is_stated }
        };
        if let Err(fault) = placement.place(&mut drawing.features) {
            return self.misplaced(import, fault);
        }
        let plan = match geometry::plan(drawing.features, placement.unit(), import.walkable) {
            Ok(plan) => plan,
            Err(errors) => return self.report(unreadable(span, &errors)),
        };
        if let Err(fault) = placement.check_doors(plan.doors.iter().map(|door| door.width)) {
            return self.misplaced(import, fault);
        }
        if !drawing.skipped.is_empty() {
            let counts: Vec<String> =
                drawing.skipped.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
            let text = format!("the drawing has entities that are not imported: {}", counts.join(", "));
            let warning = Diagnostic::warning(Code::W0704, span, text);
            self.note(warning.hint("explode blocks and convert curves to polylines, or select other layers"));
        }
        let first = self.scene.barriers.len();
        self.scene.barriers.extend(plan.barriers.into_iter().map(|(name, form)| {
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
        self.join_walls(import, first, fields.snap, implied);
        Ok(plan.doors)
    }

    /// The fields of an import as numbers.
    fn import_fields(&mut self, import: &Import<'_>) -> Lowered<Fields> {
        let mut found = Ok(Fields::default());
        for (k, field) in import.fields.iter().enumerate() {
            let set = self.import_field(import.fields, k);
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
                found = self.report(Diagnostic::error(Code::E0712, field.name.span, text));
            }
        }
        found
    }

    fn import_field(&mut self, fields: &[Field], k: usize) -> Lowered<Fields> {
        let (name, at) = (&fields[k].name, value_span(&fields[k].value));
        if !FIELDS.contains(&name.name.as_str()) {
            return self.report(unknown("field", &name.name, name.span, Code::E0207, FIELDS.into_iter()));
        }
        if fields[..k].iter().any(|before| before.name.name == name.name) {
            let text = format!("`{}` is set twice", name.name);
            return self.report(Diagnostic::error(Code::E0202, name.span, text));
        }
        let expr = match (&fields[k].value, name.name.as_str()) {
            (Value::Plain(expr), _) => expr,
            (_, "snap" | "unit") => {
                return self.report(Diagnostic::error(Code::E0305, at, "expected a length such as `5 cm`"));
            }
            (_, "origin") => {
                return self.report(Diagnostic::error(Code::E0305, at, "expected a point such as `(1, 2)`"));
            }
            _ => return self.report(Diagnostic::error(Code::E0305, at, "expected `local`")),
        };
        match name.name.as_str() {
            "projection" => match &expr.kind {
                ExprKind::Name(name) if name == "local" => Ok(Fields { is_local: true, ..Fields::default() }),
                _ => {
                    let error = Diagnostic::error(Code::E0305, at, "the only `projection` is `local`");
                    self.report(error.hint("write `projection = local` for coordinates in degrees"))
                }
            },
            "origin" => match self.lower(expr, &Locals::default())? {
                Typed::Point(x, y) if x.dimension == Dimension::LENGTH => {
                    Ok(Fields { origin: Some(Vec2::new(x.value, y.value)), ..Fields::default() })
                }
                Typed::Point(x, _) => self.wrong_dimension(at, Dimension::LENGTH, x.dimension),
                other => self.mismatch(at, "a point such as `(1, 2)`", &other),
            },
            setting => {
                let value = self.number_of(expr, Dimension::LENGTH, &Locals::default())?.value;
                let (is_snap, most) = (setting == "snap", if setting == "snap" { WIDEST_SNAP } else { 1e4 });
                if !(0.0 < value && value <= most) {
                    let text = format!("`{setting}` must be positive and at most {most} m (got {value} m)");
                    return self.report(Diagnostic::error(Code::E0405, at, text));
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
    fn rewritten(&self, import: &Import<'_>, name: &str, value: &str) -> String {
        let mut text = format!("import {}", self.text(import.path.span));
        if import.walkable {
            text += " as walkable";
        }
        if let Some(filter) = import.filter {
            text += &format!(" where {}", self.text(filter.span));
        }
        let others = import.fields.iter().filter(|field| field.name.name != name);
        let others = others
            .map(|field| format!("{} = {}  ", field.name.name, self.text(value_span(&field.value))))
            .collect::<String>();
        text + &format!(" {{ {others}{name} = {value} }}")
    }

    /// A drawing that cannot lie where its coordinates say.
    fn misplaced<T>(&mut self, import: &Import<'_>, fault: Fault) -> Lowered<T> {
        let span = import.path.span;
        let is_local = import.fields.iter().any(|field| field.name.name == "projection");
        let unit_hint = |this: &Self, fits: Option<&str>| match fits {
            _ if is_local => {
                "leave out `projection` for coordinates in metres, or select fewer features".into()
            }
            Some(unit) => format!("the unit that fits is {unit}: `{}`", this.rewritten(import, "unit", unit)),
            None => "set `unit` to the unit of the drawing, or select fewer features".to_owned(),
        };
        let error = match fault {
            Fault::Degrees => {
                let error = Diagnostic::error(
                    Code::E0712,
                    span,
                    "the coordinates are degrees, or all of the file lies within 5 cm",
                );
                let local = self.rewritten(import, "projection", "local");
                error.hint(format!("write `{local}` for degrees, or set `unit`"))
            }
            Fault::NoDegrees(p) => {
                let text = format!("({}, {}) is not a longitude and a latitude in degrees", p.x, p.y);
                Diagnostic::error(Code::E0712, span, text)
                    .hint("leave out `projection` for coordinates in metres")
            }
            Fault::Extent { size, fits } => {
                let text = if size < 1.0 {
                    format!("the drawing is only {size:.3} m wide")
                } else {
                    format!("the drawing is {:.0} km wide", size / 1e3)
                };
                Diagnostic::error(Code::E0711, span, text).hint(unit_hint(self, fits))
            }
            Fault::Door { width, fits } => {
                let text = format!("the narrowest door is {width:.0} m wide");
                Diagnostic::error(Code::E0711, span, text).hint(unit_hint(self, fits))
            }
            Fault::Far(origin) => {
                let text = "the drawing is more than 100 km from the origin of its coordinates";
                let origin = self.rewritten(import, "origin", &format!("({}, {})", origin.x, origin.y));
                Diagnostic::error(Code::E0710, span, text)
                    .hint(format!("move it to the origin of the scene: `{origin}`"))
            }
        };
        self.report(error)
    }

    /// The drawing in a file. Filters come first: what is wrong with features that are not selected does not matter.
    fn drawing(
        &mut self,
        import: &Import<'_>,
        format: Format,
        unit: Option<f64>,
        files: &Files,
    ) -> Lowered<Drawing> {
        let (path, span) = (import.path, import.path.span);
        let (mut total, mut wrong) = (0, None);
        let mut known: BTreeSet<String> = BTreeSet::new();
        let mut strange: Vec<(&str, Span)> = import.filter.into_iter().flat_map(filter::names).collect();
        strange.retain(|(name, _)| *name != "name");
        let mut select = |name: &str, properties: &[(String, PropertyValue)]| {
            total += 1;
            strange.retain(|(name, _)| !properties.iter().any(|(known, _)| known == name));
            if known.len() < MOST_NAMES {
                known.extend(properties.iter().map(|(name, _)| name.clone()));
            }
            match import.filter.map(|f| filter::selects(f, (name, properties))) {
                Some(Err(error)) => {
                    wrong = Some(error);
                    false
                }
                Some(Ok(selected)) => selected,
                None => true,
            }
        };
        let text = match files.get(&path.value) {
            Ok(bytes) => text_of(bytes, format),
            Err(reason) => return self.report(missing(span, &reason)),
        };
        let text = match text {
            Ok(text) if text.trim().is_empty() => Err("the file is empty"),
            text => text,
        };
        let text = match text {
            Ok(text) => text,
            Err(fault) => return self.report(Diagnostic::error(Code::E0704, span, fault)),
        };
        let read = geometry::read(format, &text, unit, &mut select);
        if let Some(error) = wrong {
            return self.report(error);
        }
        let drawing = match read {
            Ok(drawing) => drawing,
            Err(errors) => return self.report(unreadable(span, &errors)),
        };
        for (layer, at) in import.filter.into_iter().flat_map(|f| filter::texts(f, "layer")) {
            if !drawing.layers.is_empty() && !drawing.layers.contains(layer) {
                let known = drawing.layers.iter().map(String::as_str);
                let error = unknown("layer", layer, at, Code::E0201, known);
                let names: Vec<String> = drawing.layers.iter().take(MOST_NAMES).cloned().collect();
                return self.report(error.label(format!("the drawing has {}", names.join(", "))));
            }
        }
        // A property that no feature has equals nothing, and differs from everything.
        let all_known = strange.is_empty() || known.is_empty();
        for (name, at) in strange.into_iter().filter(|_| !all_known) {
            let known = known.iter().map(String::as_str).chain(["name"]);
            self.note(unknown("property", name, at, Code::E0201, known));
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
            self.note(warning.hint(if !drawing.features.is_empty() {
                "polygons become obstacles and lines become walls; points are ignored".to_owned()
            } else if total == 0 {
                "polygons become obstacles and lines become walls".to_owned()
            } else if names.is_empty() {
                "the filter after `where` compares properties of features, but these features have none"
                    .to_owned()
            } else {
                format!(
                    "the filter after `where` matches no feature; their properties are {}",
                    names.join(", ")
                )
            }));
        }
        Ok(drawing)
    }

    /// Joins the walls of an import that nearly touch, or reports them. `implied` is the distance of an import without
    /// `snap`, if it has one; what is joined there by more than rounding is reported, too.
    fn join_walls(&mut self, import: &Import<'_>, first: usize, snap: Option<f64>, implied: Option<f64>) {
        let imported = &mut self.scene.barriers[first..];
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
        let is_reported = implied.is_some_and(|implied| implied > TOUCHING) && snap.is_none();
        let before = if is_reported { geometry::slips(&lines, &edges, NEAR_MISS) } else { None };
        if let Some(snap) = snap.or(implied) {
            lines = geometry::snap(&lines, &edges, snap);
            for (pieces, joined) in walls.iter_mut().zip(&lines) {
                **pieces = joined.clone();
            }
            let imported = self.scene.barriers.split_off(first);
            let whole = imported.into_iter().filter(|one| one.obstacle != Obstacle::Wall(Vec::new()));
            self.scene.barriers.extend(whole);
        }
        let slips = match (snap, before) {
            (Some(_), _) => None,
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
        let warning = Diagnostic::warning(
            Code::W0702,
            import.path.span,
            format!("the file has {}", what.join(" and ")),
        )
        .label(format!("for example at ({:.3}, {:.3})", slips.place.x, slips.place.y));
        let written = self.rewritten(import, "snap", "5 cm");
        self.note(warning.hint(if is_reported {
            format!("they were joined and merged; write `{written}` to accept this, or a smaller `snap`")
        } else {
            format!("write `{written}` to join and merge them")
        }));
    }

    /// The hint for a point inside an imported polygon that may be where agents move.
    pub(super) fn walkable_hint(&self, p: Vec2) -> Option<String> {
        let (_, span) = self.origins.imports.iter().find(|(range, _)| {
            self.scene.barriers[range.clone()].iter().any(|barrier| {
                matches!(&barrier.obstacle, Obstacle::Solid(Shape::Polygon(polygon)) if polygon.contains(p))
            })
        })?;
        let path = self.text(*span);
        Some(format!("polygons are obstacles; if agents move inside them, write `import {path} as walkable`"))
    }
}

/// The walls among barriers.
fn walls(barriers: &mut [Barrier]) -> Vec<&mut Vec<Segment>> {
    let wall = |barrier| match barrier {
        &mut Barrier { obstacle: Obstacle::Wall(ref mut pieces), .. } => Some(pieces),
        _ => None,
    };
    barriers.iter_mut().filter_map(wall).collect()
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

fn unreadable(span: Span, errors: &[GeometryError]) -> Diagnostic {
    let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
    Diagnostic::error(Code::E0704, span, "the geometry in the file cannot be read").label(shown(&errors))
}

/// The first of some sentences.
fn shown(sentences: &[String]) -> String {
    let mut text = sentences[..sentences.len().min(MOST_NAMED)].join("; ");
    if sentences.len() > MOST_NAMED {
        text += "; …";
    }
    text
}
