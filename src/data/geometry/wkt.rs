//! Reader of well-known text (OGC 06-103r4, section 7): any number of geometries, one after another,
//! parted by blanks, line ends, commas or semicolons. Coordinates after the second are dropped.

use super::feature::{self, Feature, FilePlace, Geometry, GeometryError};
use crate::base::geometry::Vec2;
use wkt::Wkt;
use wkt::types::{Coord, LineString, Polygon};

/// Deepest nesting of parentheses; beyond it the text is refused before it is parsed.
const DEEPEST: usize = 64;
/// The content of parentheses other than numbers.
const WORDS: &str =
    "point linestring polygon multipoint multilinestring multipolygon geometrycollection empty z m zm";

/// Reads all geometries, as features without name and properties. Empty ones are passed over.
///
/// # Errors
/// Every geometry that does not parse, has too large coordinates, or is a line in one place or a degenerate ring, with
/// the place where it begins.
pub fn read_wkt(text: &str) -> Result<Vec<Feature>, Vec<GeometryError>> {
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for piece in pieces(text) {
        let place = FilePlace { line: Some(piece.line), column: Some(piece.column), feature: None };
        let mut fail = |message: String| errors.push(place.error(message));
        if piece.depth > DEEPEST {
            fail(format!("parentheses are nested deeper than {DEEPEST}"));
            continue;
        }
        match piece.text.parse::<Wkt<f64>>() {
            Err(message) => match no_number(piece.text) {
                Some(at) => {
                    let word = words(&piece.text[at..]).next().map_or("", |(_, word)| word);
                    let (line, column) = after((piece.line, piece.column), &piece.text[..at]);
                    let message = format!("the text is not WKT: `{word}` is not a number");
                    let place = FilePlace { line: Some(line), column: Some(column), feature: None };
                    errors.push(place.error(message));
                }
                None => fail(format!("the text is not WKT: {}", lower_case_start(message))),
            },
            Ok(shape) => flatten(&shape, &mut |part| match part {
                Ok(shape) => found.push(Feature {
                    place: place.clone(),
                    name: String::new(),
                    properties: Vec::new(),
                    shape,
                }),
                Err(message) => fail(message),
            }),
        }
    }
    if errors.is_empty() { Ok(found) } else { Err(errors) }
}

/// The text of one geometry.
struct Piece<'a> {
    text: &'a str,
    /// Line on which it begins, from 1.
    line: usize,
    /// Character of that line, from 1.
    column: usize,
    /// Deepest nesting of its parentheses.
    depth: usize,
}

/// The separators between geometries.
fn parting(c: char) -> bool {
    c.is_whitespace() || c == ',' || c == ';'
}

/// Line and column after some text.
fn after((line, column): (usize, usize), passed: &str) -> (usize, usize) {
    let fresh = passed.rfind('\n').map(|k| &passed[k + 1..]);
    let column = fresh.map_or(column, |_| 1) + fresh.unwrap_or(passed).chars().count();
    (line + passed.matches('\n').count(), column)
}

/// Words between blanks, commas and parentheses, and where they begin.
fn words(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let ends = |c: char| parting(c) || c == '(' || c == ')';
    text.split(ends)
        .filter(|word| !word.is_empty())
        .map(|word| (word.as_ptr() as usize - text.as_ptr() as usize, word))
}

/// Where within its parentheses a geometry has something that is neither a number nor a word of this language.
fn no_number(text: &str) -> Option<usize> {
    let open = text.find('(')?;
    let known = |word: &str| WORDS.split(' ').any(|known| known.eq_ignore_ascii_case(word));
    let (at, _) = words(&text[open..]).find(|(_, word)| word.parse::<f64>().is_err() && !known(word))?;
    Some(open + at)
}

/// Cuts the text after every closing parenthesis of the outermost level and after `EMPTY` there.
fn pieces(text: &str) -> Vec<Piece<'_>> {
    let mut found = Vec::new();
    let (mut rest, mut line, mut column) = (text, 1, 1);
    let mut pass = |passed: &str| {
        (line, column) = after((line, column), passed);
        (line, column)
    };
    loop {
        let trimmed = rest.trim_start_matches(parting);
        let (line, column) = pass(&rest[..rest.len() - trimmed.len()]);
        if trimmed.is_empty() {
            return found;
        }
        let (length, depth) = extent(trimmed);
        found.push(Piece { text: &trimmed[..length], line, column, depth });
        pass(&trimmed[..length]);
        rest = &trimmed[length..];
    }
}

/// Bytes and depth of the geometry at the start of a text.
fn extent(text: &str) -> (usize, usize) {
    let (mut depth, mut deepest, mut word) = (0_usize, 0, 0);
    for (byte, c) in text.char_indices() {
        match c {
            '(' => {
                depth += 1;
                deepest = deepest.max(depth);
            }
            ')' => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    return (byte + 1, deepest);
                }
            }
            _ if depth == 0 && parting(c) => {
                if text[word..byte].trim_matches(parting).eq_ignore_ascii_case("empty") {
                    return (byte, deepest);
                }
                word = byte;
            }
            _ => {}
        }
    }
    (text.len(), deepest)
}

fn lower_case_start(message: &str) -> String {
    let mut characters = message.chars();
    characters.next().map_or_else(String::new, |c| c.to_lowercase().chain(characters).collect())
}

fn vector(coord: &Coord<f64>) -> Vec2 {
    Vec2::new(coord.x, coord.y)
}

fn vectors(line: &LineString<f64>) -> Vec<Vec2> {
    line.coords().iter().map(vector).collect()
}

/// Hands on every part of a geometry that is not empty.
fn flatten(shape: &Wkt<f64>, each: &mut impl FnMut(Result<Geometry, String>)) {
    let line = |line: &LineString<f64>, each: &mut dyn FnMut(Result<Geometry, String>)| {
        if !line.coords().is_empty() {
            each(feature::line(vectors(line)));
        }
    };
    let polygon = |polygon: &Polygon<f64>, each: &mut dyn FnMut(Result<Geometry, String>)| {
        if !polygon.rings().is_empty() {
            each(feature::polygon(polygon.rings().iter().map(vectors).collect()));
        }
    };
    match shape {
        Wkt::Point(point) => point.coord().into_iter().for_each(|c| each(feature::point(vector(c)))),
        Wkt::MultiPoint(points) => {
            for c in points.points().iter().filter_map(|point| point.coord()) {
                each(feature::point(vector(c)));
            }
        }
        Wkt::LineString(one) => line(one, each),
        Wkt::MultiLineString(many) => many.line_strings().iter().for_each(|one| line(one, each)),
        Wkt::Polygon(one) => polygon(one, each),
        Wkt::MultiPolygon(many) => many.polygons().iter().for_each(|one| polygon(one, each)),
        Wkt::GeometryCollection(many) => many.geometries().iter().for_each(|one| flatten(one, &mut *each)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_geometries_follow_one_another() {
        let text = "POINT (1 2)\nLINESTRING Z (0 0 5, 1 0 5); POLYGON EMPTY\n\
                    GEOMETRYCOLLECTION(MULTIPOINT(3 3, 4 4), MULTIPOLYGON(((0 0, 4 0, 0 4, 0 0), (1 1, 2 1, 1 2, 1 1))))";
        let found = read_wkt(text).unwrap();
        assert_eq!(found.len(), 5);
        assert_eq!(found[0].shape, Geometry::Point(Vec2::new(1.0, 2.0)));
        assert_eq!(found[1].shape, Geometry::Line(vec![Vec2::zeros(), Vec2::new(1.0, 0.0)]));
        assert!(matches!(&found[4].shape, Geometry::Polygon(p) if p.area() == 7.5 && p.holes.len() == 1));
        assert_eq!(read_wkt("  \n").unwrap(), []);
    }

    #[test]
    fn every_fault_has_its_place() {
        let text = "POINT (1 2)\n  POINT (1 oops)\nPOLYGON ((0 0, 1 1, 0 0)) POINT (1e999 0)\nLINESTRING (0 0,\n 3 x) SRID";
        let errors = read_wkt(text).unwrap_err();
        let places: Vec<_> =
            errors.iter().map(|e| (e.place.line.unwrap(), e.place.column.unwrap())).collect();
        assert_eq!(places, [(2, 12), (3, 1), (3, 27), (5, 4), (5, 7)]);
        assert_eq!(errors[0].message, "the text is not WKT: `oops` is not a number");
        assert_eq!(errors[3].message, "the text is not WKT: `x` is not a number");
        assert_eq!(errors[1].message, "the outline has fewer than three corners");
        assert_eq!(errors[2].message, "a coordinate must lie between -1e12 and 1e12 (got inf)");
    }

    #[test]
    fn deep_nesting_is_refused_before_parsing() {
        let deep = "GEOMETRYCOLLECTION(".repeat(200_000) + &")".repeat(200_000);
        assert_eq!(read_wkt(&deep).unwrap_err()[0].message, "parentheses are nested deeper than 64");
    }
}
