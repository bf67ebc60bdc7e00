//! Reader of `GeoJSON` (RFC 7946): a feature collection, one feature, or one geometry.

use super::feature::{self, Feature, FilePlace, Geometry, GeometryError, PropertyValue, Select};
use crate::base::geometry::Vec2;
use geojson::feature::Id;
use geojson::{GeoJson, GeometryValue, JsonValue, Position};
use std::collections::BTreeMap;

/// Reads all features. A feature without a geometry is passed over, as the format allows it.
///
/// # Errors
/// Text that is no `GeoJSON` (one error, with its place where the parser knows it); else every feature with
/// too large coordinates, a line in one place, or a ring that is degenerate or meets itself.
pub fn read_geojson(text: &str) -> Result<Vec<Feature>, Vec<GeometryError>> {
    select_geojson(text, &mut |_, _| true)
}

/// As [`read_geojson`], of the features only whose name and properties are selected; what is wrong with the shapes of
/// others does not matter.
///
/// # Errors
/// As [`read_geojson`].
pub fn select_geojson(text: &str, select: &mut Select<'_>) -> Result<Vec<Feature>, Vec<GeometryError>> {
    let features = match text.parse::<GeoJson>() {
        Ok(GeoJson::FeatureCollection(collection)) => collection.features,
        Ok(GeoJson::Feature(one)) => vec![one],
        Ok(GeoJson::Geometry(shape)) => vec![geojson::Feature::from(shape)],
        Err(error) => return Err(vec![malformed(&error)]),
    };
    let levels = levels(&features);
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for (k, one) in features.into_iter().enumerate() {
        // IMDF (OGC 20-094) writes the type of a feature beside its properties.
        let kind = one.foreign_members.into_iter().flatten().filter(|(key, _)| key == "feature_type");
        let mut properties: Vec<_> = one
            .properties
            .into_iter()
            .flatten()
            .chain(kind)
            .map(|(key, value)| (key, property(value)))
            .collect();
        let of_level = properties.iter().find_map(|(key, value)| match (key.as_str(), value) {
            ("level_id", PropertyValue::Text(id)) => levels.get(id),
            _ => None,
        });
        let of_level = of_level.or_else(|| levels.get(&id_of(one.id.as_ref()?)));
        if let Some(level) = of_level.filter(|_| !properties.iter().any(|(key, _)| key == "level")) {
            properties.push(("level".to_owned(), PropertyValue::Text(level.clone())));
        }
        let name = properties
            .iter()
            .find_map(|(key, value)| match value {
                PropertyValue::Text(name) if key == "name" => Some(name.clone()),
                _ => None,
            })
            .or_else(|| one.id.as_ref().map(id_of))
            .unwrap_or_default();
        let Some(geometry) = one.geometry else { continue };
        if !select(&name, &properties) {
            continue;
        }
        let number = k + 1;
        let feature =
            if name.is_empty() { format!("feature {number}") } else { format!("feature {number} `{name}`") };
        let place = FilePlace { feature: Some(feature), ..FilePlace::default() };
        flatten(geometry.value, &mut |shape| match shape {
            Ok(shape) => found.push(Feature {
                place: place.clone(),
                name: name.clone(),
                properties: properties.clone(),
                shape,
            }),
            Err(message) => errors.push(place.error(message)),
        });
    }
    if errors.is_empty() { Ok(found) } else { Err(errors) }
}

fn id_of(id: &Id) -> String {
    match id {
        Id::String(text) => text.clone(),
        Id::Number(number) => number.to_string(),
    }
}

/// The levels of IMDF by their ids, as OSM has levels: the ordinal, and the short names that are no numbers. A short name
/// may be the number of another level, as where the ground floor is called `1`.
fn levels(features: &[geojson::Feature]) -> BTreeMap<String, String> {
    let level = |one: &geojson::Feature| {
        let of = |key: &str| one.property(key).or_else(|| one.foreign_members.as_ref()?.get(key));
        of("feature_type").filter(|kind| kind.as_str() == Some("level"))?;
        let short = match of("short_name") {
            Some(JsonValue::Object(labels)) => labels.values().collect(),
            short => short.into_iter().collect::<Vec<_>>(),
        };
        let short = short.into_iter().filter_map(JsonValue::as_str).map(str::trim);
        let short = short.filter(|name| name.parse::<f64>().is_err()).map(str::to_owned);
        let names: Vec<_> = std::iter::once(of("ordinal")?.as_i64()?.to_string()).chain(short).collect();
        Some((id_of(one.id.as_ref()?), names.join(";")))
    };
    features.iter().filter_map(level).collect()
}

fn malformed(error: &geojson::Error) -> GeometryError {
    let (mut at, mut message) = (FilePlace::default(), error.to_string());
    if let geojson::Error::MalformedGeoJson(json) = error {
        message = json.to_string();
        if json.line() > 0 {
            (at.line, at.column) = (Some(json.line()), Some(json.column().max(1)));
            let place = format!(" at line {} column {}", json.line(), json.column());
            message = message.replace(&place, "");
        }
    }
    at.error(format!("the text is not GeoJSON: {message}"))
}

fn property(value: JsonValue) -> PropertyValue {
    match value {
        JsonValue::Null => PropertyValue::Null,
        JsonValue::Bool(truth) => PropertyValue::Bool(truth),
        JsonValue::String(text) => PropertyValue::Text(text),
        JsonValue::Number(ref number) => match number.as_f64() {
            Some(number) if number.is_finite() => PropertyValue::Number(number),
            _ => PropertyValue::Other(value.to_string()),
        },
        JsonValue::Array(_) | JsonValue::Object(_) => PropertyValue::Other(value.to_string()),
    }
}

fn vector(position: &Position) -> Result<Vec2, String> {
    match *position.as_slice() {
        [x, y, ..] => Ok(Vec2::new(x, y)),
        [x] => Err(format!("a position needs two numbers (got one: [{x}])")),
        [] => Err("a position needs two numbers (got none)".into()),
    }
}

fn vectors(positions: &[Position]) -> Result<Vec<Vec2>, String> {
    positions.iter().map(vector).collect()
}

/// Hands on every part of a geometry. Nesting is bounded by the JSON parser.
fn flatten(value: GeometryValue, each: &mut impl FnMut(Result<Geometry, String>)) {
    let rings =
        |polygon: &[Vec<Position>]| polygon.iter().map(|ring| vectors(ring)).collect::<Result<_, _>>();
    match value {
        GeometryValue::Point { coordinates } => each(vector(&coordinates).and_then(feature::point)),
        GeometryValue::MultiPoint { coordinates } => {
            for p in &coordinates {
                each(vector(p).and_then(feature::point));
            }
        }
        GeometryValue::LineString { coordinates } => each(vectors(&coordinates).and_then(feature::line)),
        GeometryValue::MultiLineString { coordinates } => {
            for points in &coordinates {
                each(vectors(points).and_then(feature::line));
            }
        }
        GeometryValue::Polygon { coordinates } => each(rings(&coordinates).and_then(feature::polygon)),
        GeometryValue::MultiPolygon { coordinates } => {
            for polygon in &coordinates {
                each(rings(polygon).and_then(feature::polygon));
            }
        }
        GeometryValue::GeometryCollection { geometries } => {
            for part in geometries {
                flatten(part.value, each);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_collection_of_all_types_is_flattened() {
        let text = r#"{"type": "FeatureCollection", "features": [
            {"type": "Feature", "id": 7, "properties": null, "geometry": {"type": "Point", "coordinates": [1, 2, 3]}},
            {"type": "Feature", "properties": {"name": "rail", "n": 2, "ok": true, "no": null, "list": [1]},
             "geometry": {"type": "MultiLineString", "coordinates": [[[0,0],[1,0]], [[2,0],[3,0]]]}},
            {"type": "Feature", "properties": {}, "geometry": null},
            {"type": "Feature", "properties": {}, "geometry": {"type": "GeometryCollection", "geometries": [
                {"type": "MultiPolygon", "coordinates": [[[[0,0],[1,0],[0,1],[0,0]]]]},
                {"type": "MultiPoint", "coordinates": [[5, 5]]}]}}]}"#;
        let found = read_geojson(text).unwrap();
        let names: Vec<&str> = found.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["7", "rail", "rail", "", ""]);
        assert_eq!(found[0].shape, Geometry::Point(Vec2::new(1.0, 2.0)));
        assert_eq!(found[1].property("n"), Some(&PropertyValue::Number(2.0)));
        assert_eq!(found[1].property("ok"), Some(&PropertyValue::Bool(true)));
        assert_eq!(found[1].property("no"), Some(&PropertyValue::Null));
        assert_eq!(found[1].property("list"), Some(&PropertyValue::Other("[1]".into())));
        assert!(matches!(&found[3].shape, Geometry::Polygon(p) if p.area() == 0.5));
    }

    #[test]
    fn every_bad_feature_is_named() {
        let text = r#"{"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"name": "bow"},
             "geometry": {"type": "Polygon", "coordinates": [[[0,0],[2,2],[2,0],[0,2],[0,0]]]}},
            {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[1,1],[1,1]]}}]}"#;
        let said: Vec<String> = read_geojson(text).unwrap_err().iter().map(ToString::to_string).collect();
        assert_eq!(said[0], "feature 1 `bow`: the outline meets itself near (1, 1)");
        assert_eq!(said[1], "feature 2: a line needs two different points");
    }

    #[test]
    fn broken_text_has_a_place() {
        let errors = read_geojson("{\n  \"type\": \"Point\",\n  \"coordinates\": [1, oops]\n}").unwrap_err();
        assert_eq!((errors[0].place.line, errors[0].place.feature.as_ref()), (Some(3), None));
        assert!(errors[0].place.column.is_some());
        assert!(read_geojson("{\"type\": \"Point\"}").is_err());
        assert!(read_geojson("{\"type\": \"Point\", \"coordinates\": [1]}").is_err());
        let fault = |text| read_geojson(text).unwrap_err()[0].message.clone();
        let one = fault("{\"type\": \"LineString\", \"coordinates\": [[1], [1, 1]]}");
        assert_eq!(one, "a position needs two numbers (got one: [1])");
        let none = fault("{\"type\": \"Polygon\", \"coordinates\": [[[1, 1], [], [0, 1]]]}");
        assert_eq!(none, "a position needs two numbers (got none)");
        assert!(read_geojson(&"[".repeat(100_000)).is_err());
    }
}
