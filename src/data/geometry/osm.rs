//! Reader of OSM XML (wiki: "OSM XML"), as editors write it: nodes, ways, and multipolygons of ways.
//!
//! Tags are properties. A closed way is an area if its tags say so, otherwise a line, as on maps. Elements without tags
//! are parts of others. Coordinates are longitude and latitude, degrees.

use super::feature::{self, Feature, FilePlace, Geometry, GeometryError, PropertyValue, Select};
use crate::base::geometry::{Polygon, Vec2};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::BTreeMap;

/// Values of `indoor` that have an area.
const AREAS: [&str; 5] = ["room", "area", "corridor", "level", "column"];
/// Most elements and texts of a file.
const MOST_NODES: u32 = 50_000_000;

type Properties = Vec<(String, PropertyValue)>;

/// The elements that ways and multipolygons refer to.
#[derive(Default)]
struct Elements<'t> {
    /// Nodes: where they are, if the file says so.
    nodes: BTreeMap<&'t str, Option<Vec2>>,
    /// Ways: their nodes.
    ways: BTreeMap<&'t str, Vec<&'t str>>,
}

/// Reads the features whose name and properties are selected.
///
/// # Errors
/// Text that is no OSM XML (one error, with its place); else every selected element that refers to nodes or ways that are
/// missing, and every shape that is none.
pub fn read_osm(text: &str, select: &mut Select<'_>) -> Result<Vec<Feature>, Vec<GeometryError>> {
    // Entities, which may stand for texts without end, are declared in a document type.
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        let place =
            FilePlace { line: Some(at.row as usize), column: Some(at.col as usize), ..FilePlace::default() };
        let said = error.to_string();
        let said = said.rsplit_once(" at ").map_or(said.as_str(), |(said, _)| said);
        vec![place.error(format!("the text is not XML: {said}"))]
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "osm" {
        let place = FilePlace { line: Some(1), ..FilePlace::default() };
        let name = root.tag_name().name();
        return Err(vec![place.error(format!("the text is not OSM XML: it begins with `<{name}>`"))]);
    }
    let is_there = |one: &Node<'_, '_>| {
        let is = |key: &str, value: &str| one.attribute(key) == Some(value);
        one.is_element() && !is("action", "delete") && !is("visible", "false")
    };
    let elements = || root.children().filter(is_there);
    let mut known = Elements::default();
    for one in elements() {
        let Some(id) = one.attribute("id") else { continue };
        match one.tag_name().name() {
            "node" => drop(known.nodes.insert(id, position(one))),
            "way" => {
                let nodes = one.children().filter(|part| part.has_tag_name("nd"));
                known.ways.insert(id, nodes.filter_map(|part| part.attribute("ref")).collect());
            }
            _ => {}
        }
    }
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for one in elements() {
        let properties = tags(one);
        let kind = one.tag_name().name();
        let text = |key: &str| match properties.iter().find(|(name, _)| name == key) {
            Some((_, PropertyValue::Text(text))) => Some(text.as_str()),
            _ => None,
        };
        let is_shape = match kind {
            "node" | "way" => !properties.is_empty(),
            "relation" => text("type") == Some("multipolygon"),
            _ => false,
        };
        let name = text("name").unwrap_or_default().to_owned();
        if !is_shape || !select(&name, &properties) {
            continue;
        }
        let id = one.attribute("id").unwrap_or_default();
        let title = if name.is_empty() { format!("{kind} {id}") } else { format!("{kind} {id} `{name}`") };
        let place = FilePlace { feature: Some(title), ..FilePlace::default() };
        let shapes = match kind {
            "node" => known.point(id).and_then(feature::point).map(|shape| vec![shape]),
            "way" => known.way(id, is_area(&properties)).map(|shape| vec![shape]),
            _ => known.multipolygon(one),
        };
        match shapes {
            Ok(shapes) => found.extend(shapes.into_iter().map(|shape| Feature {
                place: place.clone(),
                name: name.clone(),
                properties: properties.clone(),
                shape,
            })),
            Err(message) => {
                let at = document.text_pos_at(one.range().start);
                let line = Some(at.row as usize);
                errors.push(FilePlace { line, ..place }.error(message));
            }
        }
    }
    if errors.is_empty() { Ok(found) } else { Err(errors) }
}

fn position(node: Node<'_, '_>) -> Option<Vec2> {
    let number = |name| node.attribute(name)?.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    Some(Vec2::new(number("lon")?, number("lat")?))
}

/// The tags of an element, without what editors note of their work.
fn tags(one: Node<'_, '_>) -> Properties {
    let tags = one.children().filter(|part| part.has_tag_name("tag"));
    let pair = |tag: Node<'_, '_>| Some((tag.attribute("k")?.to_owned(), tag.attribute("v")?.to_owned()));
    let own = tags.filter_map(pair).filter(|(key, _)| key != "created_by");
    own.map(|(key, value)| (key, PropertyValue::Text(value))).collect()
}

/// Whether tags say that a closed way is an area.
fn is_area(properties: &Properties) -> bool {
    properties.iter().any(|(key, value)| match (key.as_str(), value) {
        ("indoor", PropertyValue::Text(kind)) => AREAS.contains(&kind.as_str()),
        ("area", PropertyValue::Text(is)) => is == "yes",
        ("room", _) => true,
        _ => false,
    })
}

impl Elements<'_> {
    fn point(&self, id: &str) -> Result<Vec2, String> {
        match self.nodes.get(id) {
            Some(Some(at)) => Ok(*at),
            Some(None) => Err(format!("the node {id} needs `lat` and `lon`, two numbers")),
            None => Err(format!("the node {id} is not in the file")),
        }
    }

    fn points(&self, nodes: &[&str]) -> Result<Vec<Vec2>, String> {
        nodes.iter().map(|id| self.point(id)).collect()
    }

    fn way(&self, id: &str, is_area: bool) -> Result<Geometry, String> {
        let nodes = self.ways.get(id).map(Vec::as_slice).unwrap_or_default();
        let is_closed = nodes.len() > 3 && nodes.first() == nodes.last();
        let points = self.points(nodes)?;
        if is_closed && is_area { feature::polygon(vec![points]) } else { feature::line(points) }
    }

    /// One polygon for each outer ring, with the inner rings that lie in it.
    fn multipolygon(&self, one: Node<'_, '_>) -> Result<Vec<Geometry>, String> {
        let (mut outer, mut inner) = (Vec::new(), Vec::new());
        let is_way =
            |part: &Node<'_, '_>| part.has_tag_name("member") && part.attribute("type") == Some("way");
        for member in one.children().filter(is_way) {
            let id = member.attribute("ref").unwrap_or_default();
            let Some(nodes) = self.ways.get(id) else {
                return Err(format!("the way {id} is not in the file"));
            };
            let side = if member.attribute("role") == Some("inner") { &mut inner } else { &mut outer };
            side.push(nodes.clone());
        }
        let rings = |ways| joined(ways)?.iter().map(|ring| self.points(ring)).collect::<Result<Vec<_>, _>>();
        let (outer, inner) = (rings(outer)?, rings(inner)?);
        let lies_in = |hole: &[Vec2], ring: &[Vec2]| {
            let ring = Polygon::new(ring.to_vec());
            hole.first().is_some_and(|corner| ring.contains(*corner))
        };
        let polygon = |ring: Vec<Vec2>| {
            let holes: Vec<_> = inner.iter().filter(|hole| lies_in(hole, &ring)).cloned().collect();
            feature::polygon(std::iter::once(ring).chain(holes).collect())
        };
        outer.into_iter().map(polygon).collect()
    }
}

/// Closed rings of ways that meet at their ends.
fn joined(mut ways: Vec<Vec<&str>>) -> Result<Vec<Vec<&str>>, String> {
    let mut rings = Vec::new();
    while let Some(mut ring) = ways.pop() {
        while ring.first() != ring.last() || ring.len() < 2 {
            let end = ring.last().copied();
            let next = ways.iter().position(|way| way.first().copied() == end || way.last().copied() == end);
            let Some(next) = next.filter(|_| end.is_some()) else {
                return Err("the ways of the multipolygon do not close a ring".into());
            };
            let mut way = ways.swap_remove(next);
            if way.first().copied() != end {
                way.reverse();
            }
            ring.extend(way.into_iter().skip(1));
        }
        rings.push(ring);
    }
    rings.reverse();
    Ok(rings)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: &str = "<node id='-1' lat='0' lon='0'/><node id='-2' lat='0' lon='4'/>
        <node id='-3' lat='4' lon='4'/><node id='-4' lat='4' lon='0'/>
        <node id='-5' lat='1' lon='1'/><node id='-6' lat='1' lon='2'/><node id='-7' lat='2' lon='2'/>";

    fn read(elements: &str) -> Result<Vec<Feature>, Vec<GeometryError>> {
        read_osm(&format!("<osm version='0.6' generator='JOSM'>{NODES}{elements}</osm>"), &mut |_, _| true)
    }

    fn way(id: i32, nodes: &[i32], tags: &str) -> String {
        let nodes: String = nodes.iter().map(|node| format!("<nd ref='{node}'/>")).collect();
        format!("<way id='{id}'>{nodes}{tags}</way>")
    }

    #[test]
    fn tags_decide_whether_a_closed_way_is_an_area() {
        let ring = [-1, -2, -3, -4, -1];
        for (tag, is_area) in [
            ("<tag k='indoor' v='room'/>", true),
            ("<tag k='indoor' v='wall'/>", false),
            ("<tag k='area' v='yes'/>", true),
            ("<tag k='building' v='yes'/>", false),
        ] {
            let found = read(&way(-9, &ring, tag)).unwrap();
            assert_eq!(matches!(&found[0].shape, Geometry::Polygon(_)), is_area, "{tag}");
        }
        assert_eq!(read(&way(-9, &ring, "")).unwrap(), [], "without tags it is a part of another element");
    }

    #[test]
    fn ways_that_meet_are_the_rings_of_a_multipolygon() {
        let parts =
            [way(-10, &[-1, -2, -3], ""), way(-11, &[-1, -4, -3], ""), way(-12, &[-5, -6, -7, -5], "")];
        let relation = "<relation id='-20'><member type='way' ref='-10' role='outer'/>
            <member type='way' ref='-11' role='outer'/><member type='way' ref='-12' role='inner'/>
            <tag k='type' v='multipolygon'/><tag k='indoor' v='room'/><tag k='name' v='Shop'/></relation>";
        let found = read(&(parts.concat() + relation)).unwrap();
        let Geometry::Polygon(polygon) = &found[0].shape else { panic!() };
        assert_eq!((found[0].name.as_str(), polygon.area()), ("Shop", 15.5));
        let open = read(&(parts[0].clone() + &parts[2] + &relation.replace("'-11'", "'-12'"))).unwrap_err();
        assert!(open[0].message.contains("do not close a ring"), "{open:?}");
    }

    #[test]
    fn what_is_missing_is_named_with_its_line() {
        let tag = "<tag k='indoor' v='wall'/>";
        let said = |elements: &str| read(elements).unwrap_err()[0].to_string();
        assert_eq!(said(&way(-9, &[-1, -99], tag)), "line 3: way -9: the node -99 is not in the file");
        assert_eq!(
            said(&("<node id='-8' lat='x' lon='0'/>".to_owned() + &way(-9, &[-1, -8], tag))),
            "line 3: way -9: the node -8 needs `lat` and `lon`, two numbers"
        );
        let gone = way(-9, &[-1, -99], tag).replace("id='-9'", "id='-9' action='delete'");
        assert_eq!(read(&gone).unwrap(), []);
        let bad = |text| read_osm(text, &mut |_, _| true).unwrap_err()[0].to_string();
        assert!(bad("<osm>").starts_with("line 1, column"), "{}", bad("<osm>"));
        assert!(bad("<gpx/>").contains("not OSM XML"));
        let entities = "<!DOCTYPE osm [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]><osm>&b;</osm>";
        assert!(bad(entities).contains("not XML"), "{}", bad(entities));
    }
}
