//! Features: a shape with a name and properties.

use super::ring;
use crate::base::geometry::{Polygon, Vec2, coordinate_fault};

/// A shape and what is said of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
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
}

/// Whether a feature of a name and properties is taken.
pub type Select<'s> = dyn FnMut(&str, &[(String, PropertyValue)]) -> bool + 's;

/// The value of a property.
#[derive(Clone, Debug, PartialEq)]
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

/// A shape of one part, in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A point.
    Point(Vec2),
    /// At least two points, successive ones apart, joined by straight segments.
    Line(Vec<Vec2>),
    /// A polygon with simple rings and its holes inside.
    Polygon(Polygon),
}

/// An error of a geometry.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct GeometryError {
    /// Line of the file from 1, where known.
    pub line: Option<usize>,
    /// Column of that line from 1, where known.
    pub column: Option<usize>,
    /// Which feature, from 1, and its name if it has one.
    pub feature: Option<String>,
    /// The error: one sentence, lower case, no full stop.
    pub message: String,
}

impl GeometryError {
    fn sentence(&self) -> String {
        let mut text = match (self.line, self.column) {
            (Some(line), Some(column)) => format!("line {line}, column {column}: "),
            (Some(line), None) => format!("line {line}: "),
            (None, _) => String::new(),
        };
        if let Some(feature) = &self.feature {
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
        good.push(ring::checked(points).map_err(|fault| format!("{what} {fault}"))?);
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
    points.iter().find_map(|p| coordinate_fault(*p)).map_or(Ok(()), Err)
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
        assert_eq!(fault(vec![bad]), "a coordinate must lie between -1e6 m and 1e6 m (got NaN m)");
        assert!(line(vec![Vec2::zeros(), Vec2::zeros()]).is_err());
        assert!(point(Vec2::new(f64::INFINITY, 0.0)).is_err());
        assert!(point(Vec2::new(-1e6, 1e6)).is_ok());
        let far = point(Vec2::new(500_000.0, 5_400_000.0)).unwrap_err();
        assert_eq!(far, "a coordinate must lie between -1e6 m and 1e6 m (got 5.4e6 m)");
    }
}
