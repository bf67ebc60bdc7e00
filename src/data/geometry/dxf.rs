//! Reader of DXF in text (Autodesk's "DXF Reference"): lines, polylines, arcs and circles of the model space.
//!
//! A file is a list of pairs: a line with a group code, then a line with a value. Entities keep their layer and type as
//! the properties `layer` and `entity`. Text, dimensions and hatches are no part of a plan; blocks and curves of other
//! types are counted.

use super::drawing::Drawing;
use super::feature::{self, Feature, FilePlace, Geometry, GeometryError, PropertyValue, Select};
use crate::base::geometry::Vec2;
use crate::base::math::{atan2, sin_cos};
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Largest distance between an arc and its chords, m.
const CHORD: f64 = 5e-3;
/// Most chords of an arc.
const MOST_CHORDS: f64 = 1e4;
/// Metres per unit of the drawing, by the code of `$INSUNITS`.
const UNITS: [(i64, f64); 13] = [
    (1, 0.0254),
    (2, 0.3048),
    (3, 1609.344),
    (4, 1e-3),
    (5, 1e-2),
    (6, 1.0),
    (7, 1e3),
    (9, 2.54e-5),
    (10, 0.9144),
    (13, 1e-6),
    (14, 0.1),
    (15, 10.0),
    (21, 1200.0 / 3937.0),
];
/// The flag of a layer that is frozen.
const FROZEN: i64 = 1;
/// Largest angle, in degrees: writers go around a few times at most.
const LARGEST_ANGLE: f64 = 3600.0;
/// Entities that may belong to a plan and are not read.
const SKIPPED: [&str; 8] = ["INSERT", "ELLIPSE", "SPLINE", "MLINE", "3DFACE", "SOLID", "REGION", "TRACE"];

/// A group code with its value.
#[derive(Clone, Copy)]
struct Pair<'t> {
    code: i32,
    value: &'t str,
    line: usize,
}

/// A part of the file that begins with the code 0.
struct Record<'p, 't> {
    kind: &'t str,
    line: usize,
    pairs: &'p [Pair<'t>],
}

/// Reads a drawing. `unit` is the number of metres per unit if the scenario sets it; else the header says it, if at all.
///
/// # Errors
/// Text that is not DXF, and selected entities without numbers where they need them, with their lines.
pub fn read_dxf(
    text: &str,
    unit: Option<f64>,
    select: &mut Select<'_>,
) -> Result<Drawing, Vec<GeometryError>> {
    let pairs = pairs(text).map_err(|error| vec![error])?;
    let mut drawing = Drawing { unit, ..Drawing::default() };
    let (mut section, mut errors, mut hidden) = ("", Vec::new(), BTreeSet::new());
    let mut records = records(&pairs).into_iter().peekable();
    while let Some(record) = records.next() {
        match (section, record.kind) {
            (_, "SECTION") => {
                section = record.text(2).unwrap_or_default();
                if section == "HEADER" && unit.is_none() {
                    drawing.unit = header_unit(record.pairs);
                }
            }
            (_, "ENDSEC") => section = "",
            ("TABLES", "LAYER") => {
                let is_off = record.text(62).is_some_and(|color| color.starts_with('-'));
                hidden.extend(record.text(2).filter(|_| is_off || record.flag(FROZEN)));
                drawing.layers.extend(record.text(2).map(str::to_owned));
            }
            ("ENTITIES", kind) => {
                let mut vertices = Vec::new();
                while let Some(vertex) = records.next_if(|next| kind == "POLYLINE" && next.kind == "VERTEX") {
                    vertices.push(vertex);
                }
                let layer = record.text(8).unwrap_or("0");
                let property = |key: &str, value: &str| (key.to_owned(), PropertyValue::Text(value.into()));
                let properties = vec![property("layer", layer), property("entity", kind)];
                let is_paper = record.text(67) == Some("1");
                let is_read = ["LINE", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ARC"].contains(&kind);
                if kind != "SEQEND" && !drawing.layers.contains(layer) {
                    drawing.layers.insert(layer.to_owned());
                }
                if is_paper || !(is_read || SKIPPED.contains(&kind)) || !select(layer, &properties) {
                    continue;
                }
                let is_hidden = hidden.contains(layer) || record.text(60) == Some("1");
                if !is_read || is_hidden {
                    let of = if is_hidden { format!(" hidden on `{layer}`") } else { String::new() };
                    let skipped = format!("{kind}{of}");
                    *drawing.skipped.entry(skipped).or_default() += 1;
                    continue;
                }
                let place = FilePlace { line: Some(record.line), ..FilePlace::default() };
                match record.shape(&vertices, drawing.unit.unwrap_or(1.0)) {
                    Ok(None) => {}
                    Ok(Some(shape)) => {
                        drawing.features.push(Feature { place, name: layer.to_owned(), properties, shape });
                    }
                    Err(message) => errors.push(place.error(format!("{kind} {message}"))),
                }
            }
            _ => {}
        }
    }
    if errors.is_empty() { Ok(drawing) } else { Err(errors) }
}

/// All pairs of a file.
fn pairs(text: &str) -> Result<Vec<Pair<'_>>, GeometryError> {
    let mut lines = text.lines().enumerate();
    let mut found: Vec<Pair<'_>> = Vec::new();
    let fault = |line: usize, message: String| {
        FilePlace { line: Some(line), ..FilePlace::default() }
            .error(format!("the text is not DXF: {message}"))
    };
    while let Some((k, code)) = lines.next() {
        if code.trim().is_empty() && found.last().is_some_and(|last| last.value == "EOF") {
            break;
        }
        let Ok(code) = code.trim().parse::<i32>() else {
            let code: String = code.trim().chars().take(20).collect();
            return Err(fault(k + 1, format!("expected a group code, found `{code}`")));
        };
        let Some((_, value)) = lines.next() else {
            return Err(fault(k + 1, format!("the group code {code} has no value")));
        };
        // A comment.
        if code != 999 {
            found.push(Pair { code, value: value.trim(), line: k + 1 });
        }
    }
    if found.first().is_some_and(|first| first.code == 0 && first.value == "SECTION") {
        Ok(found)
    } else {
        Err(fault(1, "it does not begin with a section".into()))
    }
}

fn records<'p, 't>(pairs: &'p [Pair<'t>]) -> Vec<Record<'p, 't>> {
    let starts: Vec<usize> = (0..pairs.len()).filter(|k| pairs[*k].code == 0).collect();
    let end = |k: usize| starts.get(k + 1).copied().unwrap_or(pairs.len());
    let record = |(k, start): (usize, &usize)| Record {
        kind: pairs[*start].value,
        line: pairs[*start].line,
        pairs: &pairs[start + 1..end(k)],
    };
    starts.iter().enumerate().map(record).collect()
}

/// Metres per unit, as the header says.
fn header_unit(pairs: &[Pair<'_>]) -> Option<f64> {
    let at = pairs.iter().position(|pair| pair.code == 9 && pair.value == "$INSUNITS")?;
    let code: i64 = pairs.get(at + 1)?.value.parse().ok()?;
    UNITS.iter().find(|(known, _)| *known == code).map(|(_, unit)| *unit)
}

fn number(pair: &Pair<'_>) -> Result<f64, String> {
    match pair.value.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("has `{}` on line {} instead of a number", pair.value, pair.line + 1)),
    }
}

impl<'t> Record<'_, 't> {
    fn text(&self, code: i32) -> Option<&'t str> {
        self.pairs.iter().find(|pair| pair.code == code).map(|pair| pair.value)
    }

    fn maybe(&self, code: i32) -> Result<Option<f64>, String> {
        self.pairs.iter().find(|pair| pair.code == code).map(number).transpose()
    }

    fn number(&self, code: i32, what: &str) -> Result<f64, String> {
        self.maybe(code)?.ok_or_else(|| format!("has no {what} (group code {code})"))
    }

    fn point(&self, code: i32, what: &str) -> Result<Vec2, String> {
        Ok(Vec2::new(self.number(code, what)?, self.number(code + 10, what)?))
    }

    fn flag(&self, bits: i64) -> bool {
        self.text(70).and_then(|text| text.parse::<i64>().ok()).is_some_and(|flags| flags & bits != 0)
    }

    /// The corners of a polyline with the bulges of the edges that follow them.
    fn corners(&self, vertices: &[Record<'_, '_>]) -> Result<Vec<(Vec2, f64)>, String> {
        if self.kind == "POLYLINE" {
            let corner =
                |vertex: &Record<'_, '_>| Ok((vertex.point(10, "corner")?, vertex.maybe(42)?.unwrap_or(0.0)));
            return vertices.iter().map(corner).collect();
        }
        let mut found: Vec<(Vec2, f64)> = Vec::new();
        for pair in self.pairs {
            match (pair.code, found.last_mut()) {
                (10, _) => found.push((Vec2::new(number(pair)?, 0.0), 0.0)),
                (20, Some((corner, _))) => corner.y = number(pair)?,
                (42, Some((_, bulge))) => *bulge = number(pair)?,
                _ => {}
            }
        }
        Ok(found)
    }

    /// The shape of an entity in the units of the drawing; none where all of it is in one place.
    fn shape(&self, vertices: &[Record<'_, '_>], unit: f64) -> Result<Option<Geometry>, String> {
        // Entities may be seen from below: their first coordinate is then mirrored.
        let mirror =
            if self.maybe(230)?.is_some_and(|z| z < 0.0) && self.kind != "LINE" { -1.0 } else { 1.0 };
        let seen = |p: Vec2| Vec2::new(mirror * p.x, p.y);
        let mut points = match self.kind {
            "LINE" => vec![self.point(10, "start")?, self.point(11, "end")?],
            "CIRCLE" | "ARC" => {
                let (centre, radius) = (self.point(10, "center")?, self.number(40, "radius")?);
                if radius <= 0.0 {
                    return Err(format!("needs a positive radius (got {radius})"));
                }
                if self.kind == "CIRCLE" {
                    feature::point(centre)?;
                    return Ok(Some(Geometry::Circle { centre: seen(centre), radius }));
                }
                let turn = |code, what| match self.number(code, what)? {
                    angle if angle.abs() <= LARGEST_ANGLE => Ok(angle / 180.0 * PI),
                    angle => Err(format!("has {angle:e} degrees as its {what}, at most {LARGEST_ANGLE}")),
                };
                let (start, end) = (turn(50, "start angle")?, turn(51, "end angle")?);
                let sweep = (end - start).rem_euclid(TAU);
                arc(centre, radius, start, if sweep == 0.0 { TAU } else { sweep }, unit)
            }
            // Meshes are no polylines.
            _ if self.kind == "POLYLINE" && self.flag(16 | 64) => return Ok(None),
            _ => {
                let corners = self.corners(vertices)?;
                let Some((first, _)) = corners.first() else { return Ok(None) };
                let mut points = vec![*first];
                let edges = if self.flag(1) { corners.len() } else { corners.len() - 1 };
                for k in 0..edges {
                    let ((from, bulge), (to, _)) = (corners[k], corners[(k + 1) % corners.len()]);
                    if bulge != 0.0 && from != to {
                        points.extend(bulged(from, to, bulge, unit));
                    }
                    points.push(to);
                }
                points
            }
        };
        points = points.into_iter().map(seen).collect();
        points.dedup();
        if points.len() < 2 { Ok(None) } else { feature::line(points).map(Some) }
    }
}

/// Points of an arc, its ends included, so that chords miss it by less than [`CHORD`].
fn arc(centre: Vec2, radius: f64, start: f64, sweep: f64, unit: f64) -> Vec<Vec2> {
    // A chord of the angle a misses its arc by r (1 - cos(a / 2)) <= r a^2 / 8.
    let needed = (sweep * (radius * unit / (8.0 * CHORD)).sqrt()).max(sweep / FRAC_PI_4).ceil();
    let count = if needed < MOST_CHORDS { needed } else { MOST_CHORDS };
    let at = |k: u32| {
        let (sin, cos) = sin_cos(start + sweep * (f64::from(k) / count));
        centre + Vec2::new(cos, sin) * radius
    };
    (0..=count as u32).map(at).collect()
}

/// Points between the ends of an edge that is an arc: `bulge` is the tangent of a quarter of its angle, positive where
/// the arc turns left.
fn bulged(from: Vec2, to: Vec2, bulge: f64, unit: f64) -> Vec<Vec2> {
    let chord = to - from;
    let aside = Vec2::new(-chord.y, chord.x);
    let centre = from + 0.5 * chord + aside * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let first = from - centre;
    let radius = first.norm();
    let sweep = 4.0 * atan2(bulge.abs(), 1.0);
    let start = atan2(first.y, first.x);
    // Arcs turn left: one that turns right is walked backwards.
    let mut points = if bulge > 0.0 {
        arc(centre, radius, start, sweep, unit)
    } else {
        let mut points = arc(centre, radius, start - sweep, sweep, unit);
        points.reverse();
        points
    };
    points.pop();
    points.into_iter().skip(1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drawing in millimetres with some entities, a pair a word.
    fn drawing(entities: &str) -> String {
        let head = "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 ENTITIES";
        format!("{head} {entities} 0 ENDSEC 0 EOF").split(' ').collect::<Vec<_>>().join("\n")
    }

    fn read(entities: &str) -> Result<Drawing, Vec<GeometryError>> {
        read_dxf(&drawing(entities), None, &mut |_, _| true)
    }

    fn points(shape: &Geometry) -> &[Vec2] {
        let Geometry::Line(points) = shape else { panic!("{shape:?}") };
        points
    }

    #[test]
    fn entities_become_lines_and_discs() {
        let found = read(
            "0 LINE 8 A-WALL 10 0 20 0 11 5000 21 0 0 CIRCLE 8 A-COLS 10 1 20 2 40 300 \
             0 LWPOLYLINE 8 A-WALL 90 3 70 1 10 0 20 0 10 9 20 0 10 9 20 9 \
             0 POLYLINE 8 A-WALL 70 0 0 VERTEX 10 1 20 1 0 VERTEX 10 2 20 1 0 SEQEND \
             0 LINE 8 A-WALL 10 7 20 7 11 7 21 7 0 TEXT 8 A-TEXT 10 0 20 0 1 hall 0 INSERT 8 A-DOOR 2 door 10 0 20 0",
        )
        .unwrap();
        assert_eq!(found.unit, Some(1e-3));
        assert_eq!(found.features.len(), 4, "a line in one place is nothing");
        assert_eq!(found.features[1].shape, Geometry::Circle { centre: Vec2::new(1.0, 2.0), radius: 300.0 });
        let closed = points(&found.features[2].shape);
        assert_eq!((closed.len(), closed[0]), (4, closed[3]));
        assert_eq!(found.skipped.get("INSERT"), Some(&1));
        let layers: Vec<&str> = found.layers.iter().map(String::as_str).collect();
        assert_eq!(layers, ["A-COLS", "A-DOOR", "A-TEXT", "A-WALL"]);
    }

    #[test]
    fn chords_of_arcs_miss_them_by_less_than_a_centimetre() {
        // A half circle from (0, 0) to (2 m, 0), once each way, and a quarter circle around the origin.
        for (entity, centre, radius, low) in [
            ("0 LWPOLYLINE 8 W 70 0 10 0 20 0 42 1 10 2000 20 0", (1e3, 0.0), 1e3, true),
            ("0 LWPOLYLINE 8 W 70 0 10 0 20 0 42 -1 10 2000 20 0", (1e3, 0.0), 1e3, false),
            ("0 ARC 8 W 10 0 20 0 40 5000 50 270 51 0", (0.0, 0.0), 5e3, true),
        ] {
            let found = read(entity).unwrap();
            let points = points(&found.features[0].shape);
            assert!((3..50).contains(&points.len()), "{}", points.len());
            let centre = Vec2::new(centre.0, centre.1);
            for pair in points.windows(2) {
                let middle = 0.5 * (pair[0] + pair[1]) - centre;
                assert!((radius - 10.0..=radius).contains(&middle.norm()));
                assert!((pair[0] - centre).norm() <= radius * (1.0 + 1e-12));
                assert_eq!(middle.y < 0.0, low);
            }
        }
    }

    #[test]
    fn what_is_wrong_has_a_line() {
        let said = |entities: &str| read(entities).unwrap_err()[0].to_string();
        assert_eq!(said("0 LINE 8 W 10 0 20 0"), "line 15: LINE has no end (group code 11)");
        assert_eq!(
            said("0 LINE 8 W 10 zero 20 0 11 1 21 1"),
            "line 15: LINE has `zero` on line 20 instead of a number"
        );
        assert_eq!(said("0 CIRCLE 8 W 10 0 20 0 40 -1"), "line 15: CIRCLE needs a positive radius (got -1)");
        assert_eq!(said("x"), "line 15: the text is not DXF: expected a group code, found `x`");
        let other = read_dxf("{}", None, &mut |_, _| true).unwrap_err()[0].to_string();
        assert_eq!(other, "line 1: the text is not DXF: expected a group code, found `{}`");
    }
}
