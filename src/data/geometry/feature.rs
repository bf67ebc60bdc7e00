//! Features: a shape with a name and properties, as every format gives them.

use crate::base::geometry::{Polygon, Segment, Vec2, cross, meeting_edges};
use std::fmt;

/// Largest coordinate that a file may hold, in its own unit: millimetres of a country, and more.
const LARGEST: f64 = 1e12;

/// A shape and what is said of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Where it is in the file.
    pub place: FilePlace,
    /// Its property `name`, else its id, else empty.
    pub name: String,
    /// Its properties in the order of the file.
    pub properties: Vec<(String, PropertyValue)>,
    /// Its shape.
    pub shape: Geometry,
}

impl Feature {
    /// A property by its name.
    pub fn property(&self, name: &str) -> Option<&PropertyValue> {
        self.properties.iter().find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// A property that is a text.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.property(name) {
            Some(PropertyValue::Text(text)) => Some(text),
            _ => None,
        }
    }
}

/// Where a feature is in its file, as far as the format has places.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FilePlace {
    /// Line of the file from 1, where known.
    pub line: Option<usize>,
    /// Column of that line from 1, where known.
    pub column: Option<usize>,
    /// Which feature, from 1, and its name if it has one.
    pub feature: Option<String>,
}

impl FilePlace {
    /// An error at this place.
    pub fn error(&self, message: impl Into<String>) -> GeometryError {
        GeometryError { place: self.clone(), message: message.into() }
    }
}

/// Whether a feature of a name and properties is taken.
pub type Select<'s> = dyn FnMut(&str, &[(String, PropertyValue)]) -> bool + 's;

/// The value of a property.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub enum PropertyValue {
    /// A text.
    Text(String),
    /// A number, finite.
    Number(f64),
    /// True or false.
    Bool(bool),
    /// Said to be nothing.
    Null,
    /// A list or an object, as JSON text.
    Other(String),
}

impl fmt::Display for PropertyValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => write!(f, "\"{text}\""),
            Self::Number(number) => write!(f, "{number}"),
            Self::Bool(truth) => write!(f, "{truth}"),
            Self::Null => f.write_str("null"),
            Self::Other(text) => f.write_str(text),
        }
    }
}

/// A shape of one part.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A point.
    Point(Vec2),
    /// At least two points, successive ones apart, joined by straight segments.
    Line(Vec<Vec2>),
    /// A polygon with simple rings and its holes inside.
    Polygon(Polygon),
    /// A disc.
    Circle {
        /// Its centre.
        centre: Vec2,
        /// Its radius, positive.
        radius: f64,
    },
}

impl Geometry {
    /// Its corners; of a disc those of the square around it.
    pub fn corners(&self) -> Vec<Vec2> {
        match self {
            Self::Point(p) => vec![*p],
            Self::Line(points) => points.clone(),
            Self::Polygon(polygon) => polygon.outline.clone(),
            Self::Circle { centre, radius } => {
                vec![centre - Vec2::repeat(*radius), centre + Vec2::repeat(*radius)]
            }
        }
    }

    /// Moves its points and stretches the radius of a disc.
    pub fn map(&mut self, point: impl Fn(Vec2) -> Vec2, stretch: f64) {
        let move_all = |points: &mut Vec<Vec2>| points.iter_mut().for_each(|p| *p = point(*p));
        match self {
            Self::Point(p) => *p = point(*p),
            Self::Line(points) => move_all(points),
            Self::Polygon(polygon) => {
                std::iter::once(&mut polygon.outline).chain(&mut polygon.holes).for_each(move_all);
            }
            Self::Circle { centre, radius } => {
                *centre = point(*centre);
                *radius *= stretch;
            }
        }
    }
}

/// An error of a geometry.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct GeometryError {
    /// Where it is.
    pub place: FilePlace,
    /// The error: one sentence, lower case, no full stop.
    pub message: String,
}

impl GeometryError {
    fn sentence(&self) -> String {
        let mut text = match (self.place.line, self.place.column) {
            (Some(line), Some(column)) => format!("line {line}, column {column}: "),
            (Some(line), None) => format!("line {line}: "),
            (None, _) => String::new(),
        };
        if let Some(feature) = &self.place.feature {
            text = text + feature + ": ";
        }
        text + &self.message
    }
}

/// A point, refused where its coordinates are too large.
pub(super) fn point(p: Vec2) -> Result<Geometry, String> {
    in_reach(&[p])?;
    Ok(Geometry::Point(p))
}

/// A line, refused where its coordinates are too large or it is all in one place.
pub(super) fn line(mut points: Vec<Vec2>) -> Result<Geometry, String> {
    in_reach(&points)?;
    points.dedup();
    if points.len() < 2 {
        return Err("a line needs two different points".into());
    }
    Ok(Geometry::Line(points))
}

/// A polygon of an outline and holes as the formats write them: closed rings, the outline first.
pub(super) fn polygon(rings: Vec<Vec<Vec2>>) -> Result<Geometry, String> {
    let mut good = Vec::with_capacity(rings.len());
    for (k, points) in rings.into_iter().enumerate() {
        let what = if k == 0 { "the outline".to_owned() } else { format!("hole {k}") };
        in_reach(&points)?;
        good.push(checked_ring(points).map_err(|fault| format!("{what} {fault}"))?);
    }
    let mut good = good.into_iter();
    let Some(outline) = good.next() else { return Err("a polygon needs an outline".into()) };
    let polygon = Polygon { outline, holes: good.collect() };
    match polygon.hole_fault() {
        Some(fault) => Err(fault.to_string()),
        None => Ok(Geometry::Polygon(polygon)),
    }
}

fn in_reach(points: &[Vec2]) -> Result<(), String> {
    let is_far = |x: &f64| x.is_nan() || x.abs() > LARGEST;
    match points.iter().flat_map(|p| [p.x, p.y]).find(is_far) {
        Some(far) => Err(format!("a coordinate must lie between -1e12 and 1e12 (got {far:e})")),
        None => Ok(()),
    }
}

// Rings of polygons: what makes one usable.

/// The corners of a ring, the closing one not repeated, or what is wrong with it.
fn checked_ring(mut points: Vec<Vec2>) -> Result<Vec<Vec2>, String> {
    points.dedup();
    while points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 3 {
        return Err("has fewer than three corners".into());
    }
    if let Some(at) = crossing(&points) {
        return Err(format!("meets itself near ({}, {})", at.x, at.y));
    }
    let ring = Polygon::new(points);
    if ring.area() > 0.0 { Ok(ring.outline) } else { Err("has no area".into()) }
}

/// A point where two edges meet that are not neighbours, about.
fn crossing(ring: &[Vec2]) -> Option<Vec2> {
    let edge = |k: usize| Segment::new(ring[k], ring[(k + 1) % ring.len()]);
    meeting_edges(ring).map(|(i, j)| meeting(&edge(i), &edge(j)))
}

/// Where two segments that meet do so: at an end that lies on the other, or where they cross. Rounded to millionths, as
/// far as that can be seen, for people to read.
fn meeting(first: &Segment, second: &Segment) -> Vec2 {
    let ends = [(second, first.a), (second, first.b), (first, second.a), (first, second.b)];
    if let Some((_, end)) = ends.iter().find(|(other, end)| other.distance(*end) == 0.0) {
        return *end;
    }
    let (along, beside) = (first.b - first.a, second.b - second.a);
    let share = cross(second.a - first.a, beside) / cross(along, beside);
    let at = first.a + along * share;
    if !(at.x.is_finite() && at.y.is_finite()) {
        return second.a;
    }
    at.map(|v| if v.abs() < 1e9 { (v * 1e6).round() / 1e6 } else { v })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f64, high: f64) -> Vec<Vec2> {
        [(low, low), (high, low), (high, high), (low, high), (low, low)]
            .map(|(x, y)| Vec2::new(x, y))
            .to_vec()
    }

    #[test]
    fn a_polygon_keeps_its_holes() {
        let Ok(Geometry::Polygon(p)) = polygon(vec![square(0.0, 4.0), square(1.0, 2.0)]) else { panic!() };
        assert_eq!(p.area(), 15.0);
        assert_eq!(p.outline.len(), 4, "the closing corner is not repeated");
    }

    #[test]
    fn what_is_no_shape_is_refused() {
        let fault = |rings| polygon(rings).unwrap_err();
        assert_eq!(fault(vec![]), "a polygon needs an outline");
        assert_eq!(fault(vec![square(0.0, 1.0), square(3.0, 4.0)]), "hole 1 is outside the outline");
        assert_eq!(fault(vec![square(0.0, 1.0), square(0.5, 0.5)]), "hole 1 has fewer than three corners");
        let mut bad = square(0.0, 1.0);
        bad[2].x = f64::NAN;
        assert_eq!(fault(vec![bad]), "a coordinate must lie between -1e12 and 1e12 (got NaN)");
        assert!(line(vec![Vec2::zeros(), Vec2::zeros()]).is_err());
        assert!(point(Vec2::new(f64::INFINITY, 0.0)).is_err());
        assert!(point(Vec2::new(-1e12, 1e12)).is_ok());
    }

    fn ring(corners: &[(f64, f64)]) -> Vec<Vec2> {
        corners.iter().map(|&(x, y)| Vec2::new(x, y)).collect()
    }

    #[test]
    fn degenerate_rings_are_refused() {
        assert_eq!(
            checked_ring(ring(&[(0., 0.), (1., 0.), (1., 0.), (0., 0.)])).unwrap_err(),
            "has fewer than three corners"
        );
        assert_eq!(checked_ring(ring(&[(0., 0.), (1., 0.), (2., 0.)])).unwrap_err(), "has no area");
        let bow_tie = checked_ring(ring(&[(0., 0.), (2., 2.), (2., 0.), (0., 2.)])).unwrap_err();
        assert_eq!(bow_tie, "meets itself near (1, 1)");
        let third = checked_ring(ring(&[(0., 0.), (1., 1.), (1., 0.), (0., 0.5)])).unwrap_err();
        assert_eq!(third, "meets itself near (0.333333, 0.333333)");
        let touching = checked_ring(ring(&[(0., 0.), (4., 0.), (4., 4.), (3., 0.), (0., 4.)])).unwrap_err();
        assert_eq!(touching, "meets itself near (3, 0)");
        assert_eq!(checked_ring(ring(&[(0., 0.), (1., 0.), (0., 1.), (0., 0.)])).unwrap().len(), 3);
    }
}
