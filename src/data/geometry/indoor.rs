//! What the features of a floor plan are: the tags of OSM's simple indoor tagging (wiki: "Simple Indoor Tagging") and
//! the feature types of IMDF (OGC 20-094).

use super::feature::{Feature, Geometry, PropertyValue};

/// The width of a door that has none of its own, m.
pub(super) const DOOR: f64 = 0.9;

/// What becomes of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Its lines are walls.
    Wall,
    /// It is solid.
    Obstacle,
    /// A space that walls surround.
    Room,
    /// A space that walls surround, except towards another such space.
    Hall,
    /// It opens walls.
    Door,
    /// It is not part of the scene.
    Nothing,
}

/// The role of a feature. `walkable`: polygons without a role of their own are where agents move.
pub fn role(feature: &Feature, walkable: bool) -> Role {
    let (is_polygon, plain) = match feature.shape {
        Geometry::Polygon(_) if walkable => (true, Role::Hall),
        Geometry::Polygon(_) => (true, Role::Obstacle),
        Geometry::Circle { .. } => (false, Role::Obstacle),
        Geometry::Line(_) => (false, Role::Wall),
        Geometry::Point(_) => (false, Role::Nothing),
    };
    let area = |role: Role| if is_polygon { role } else { plain };
    if let Some(kind) = feature.text("feature_type") {
        return match (kind, feature.text("category").unwrap_or_default()) {
            ("unit", "walkway") => area(Role::Hall),
            ("unit", "brick" | "column" | "opentobelow" | "structure") | ("fixture" | "kiosk", _) => {
                area(Role::Obstacle)
            }
            ("unit" | "level", _) => area(Role::Room),
            ("opening", _) => Role::Door,
            ("detail", _) => plain,
            _ => Role::Nothing,
        };
    }
    match feature.text("indoor") {
        Some("door") => Role::Door,
        _ if !is_polygon && may_be_door(&feature.properties) => Role::Door,
        Some("room" | "level") => area(Role::Room),
        Some("corridor" | "area") => area(Role::Hall),
        Some("wall" | "column") => area(Role::Obstacle),
        // Steps and other ways are where one walks.
        _ if feature.property("highway").is_some() => Role::Nothing,
        None if feature.property("room").is_some() => area(Role::Room),
        _ => plain,
    }
}

/// Whether a point or a line with these tags of OSM is a door.
pub fn may_be_door(properties: &[(String, PropertyValue)]) -> bool {
    properties.iter().any(|(name, value)| match name.as_str() {
        "door" | "entrance" => *value != PropertyValue::Null,
        "indoor" => *value == PropertyValue::Text("door".into()),
        _ => false,
    })
}

/// The property `width` of a door or of stairs, in metres, or else the usual one; a number in the file is in its unit.
///
/// # Errors
/// A width that is no length.
pub fn width(feature: &Feature, unit: f64, (of, usual): (&str, f64)) -> Result<f64, String> {
    let found = match feature.property("width") {
        None | Some(PropertyValue::Null) => return Ok(usual),
        Some(PropertyValue::Number(width)) => Some(width * unit),
        Some(PropertyValue::Text(text)) => length(text, unit),
        Some(_) => None,
    };
    let is_width = |width: &f64| *width > 0.0 && width.is_finite();
    found
        .filter(is_width)
        .ok_or_else(|| format!("the `width` of {of} must be a positive length, such as {usual}"))
}

/// A length as maps have it: a number, perhaps with a unit.
fn length(text: &str, unit: f64) -> Option<f64> {
    let text = text.trim();
    let end = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let size = match text[end..].trim() {
        "" => unit,
        "m" => 1.0,
        "cm" => 0.01,
        "mm" => 0.001,
        _ => return None,
    };
    Some(text[..end].trim().parse::<f64>().ok()? * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_width_may_have_a_unit() {
        assert_eq!(length("0.9", 1.0), Some(0.9));
        assert_eq!(length("0.9 m", 0.001), Some(0.9));
        assert_eq!(length(" 90cm", 1.0), Some(0.9));
        assert_eq!(length("900", 0.001), Some(0.9));
        assert_eq!(length("3'", 1.0), None);
        assert_eq!(length("wide", 1.0), None);
    }
}
