//! A floor plan: barriers and doors of features that lie in the scene.
//!
//! The outline of a space is a wall, except where another hall lies just outside of a hall: what lies between two halls
//! is open. Polygons that are walkable are halls, so those that touch or overlap are one.

use super::door::Door;
use super::feature::{Feature, Geometry, GeometryError};
use super::indoor::{DOOR, Role, role, width};
use crate::base::geometry::{Bounds, Polygon, Segment, Shape, Vec2, cross};

/// Outlines nearer than this are one, m.
pub const TOUCHING: f64 = 1e-3;

/// The form of a barrier.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// Pieces of a wall.
    Wall(Vec<Segment>),
    /// A solid disc or polygon.
    Solid(Shape),
}

/// What a drawing gives to a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Walls and obstacles with the names of their features, in the order of the file.
    pub barriers: Vec<(String, Form)>,
    /// Doors, which open walls.
    pub doors: Vec<Door>,
    /// Whether some walls are outlines of spaces, of which two may be drawn at one place.
    pub has_spaces: bool,
}

/// The barriers and doors of features. `unit`: metres per unit of their widths; `walkable`: polygons are where agents
/// move; halls nearer than `touching` are one.
///
/// # Errors
/// Doors that are no points or lines, or whose width is no length.
pub fn plan(
    features: &[Feature],
    (unit, touching): (f64, f64),
    walkable: bool,
) -> Result<Plan, Vec<GeometryError>> {
    let roles: Vec<Role> = features.iter().map(|feature| role(feature, walkable)).collect();
    let halls: Vec<(usize, Bounds, &Polygon)> = features
        .iter()
        .enumerate()
        .filter_map(|(k, feature)| match &feature.shape {
            Geometry::Polygon(polygon) if roles[k] == Role::Hall => {
                Some((k, Bounds::around(polygon.outline.iter().copied())?, polygon))
            }
            _ => None,
        })
        .collect();
    let (mut found, mut errors) = (Plan::default(), Vec::new());
    for (k, feature) in features.iter().enumerate() {
        let form = match (&feature.shape, roles[k]) {
            (_, Role::Nothing) => continue,
            (_, Role::Door) => {
                match door(feature, unit) {
                    Ok(door) => found.doors.push(door),
                    Err(message) => errors.push(feature.place.error(message)),
                }
                continue;
            }
            (Geometry::Point(_), _) => continue,
            (Geometry::Line(points), _) => {
                Form::Wall(points.windows(2).map(|pair| Segment::new(pair[0], pair[1])).collect())
            }
            (Geometry::Circle { centre, radius }, _) => {
                Form::Solid(Shape::Circle { centre: *centre, radius: *radius })
            }
            (Geometry::Polygon(polygon), Role::Room) => Form::Wall(polygon.segments().collect()),
            (Geometry::Polygon(polygon), Role::Hall) => Form::Wall(rim(k, polygon, &halls, touching)),
            (Geometry::Polygon(polygon), _) => Form::Solid(Shape::Polygon(polygon.clone())),
        };
        found.has_spaces |= matches!(roles[k], Role::Room | Role::Hall);
        if form != Form::Wall(Vec::new()) {
            found.barriers.push((feature.name.clone(), form));
        }
    }
    if errors.is_empty() { Ok(found) } else { Err(errors) }
}

fn door(feature: &Feature, unit: f64) -> Result<Door, String> {
    let (place, name) = (feature.place.clone(), feature.name.clone());
    let has_level = feature.property("level").is_some();
    match &feature.shape {
        Geometry::Point(at) => Ok(Door {
            place,
            name,
            at: *at,
            along: None,
            width: width(feature, unit, ("a door", DOOR))?,
            has_level,
        }),
        Geometry::Line(points) => {
            let (first, last) = (points[0], points[points.len() - 1]);
            let (along, width) = (last - first, (last - first).norm());
            if width == 0.0 {
                return Err("the line of a door must not end where it begins".into());
            }
            let at = 0.5 * (first + last);
            Ok(Door { place, name, at, along: Some(along / width), width, has_level })
        }
        Geometry::Polygon(_) | Geometry::Circle { .. } => Err("a door must be a point or a line".into()),
    }
}

/// The parts of the rim of a hall that no other hall lies beyond.
fn rim(own: usize, polygon: &Polygon, halls: &[(usize, Bounds, &Polygon)], touching: f64) -> Vec<Segment> {
    let mut found = Vec::new();
    for edge in polygon.segments() {
        // Just outside, and as far as another hall may lie.
        let outside = [2.0 * TOUCHING, touching];
        let reach = Vec2::repeat(outside[0].max(outside[1]));
        let (low, high) = (edge.a.inf(&edge.b) - reach, edge.a.sup(&edge.b) + reach);
        let near: Vec<&Polygon> = halls
            .iter()
            .filter(|(k, around, _)| {
                *k != own
                    && around.low.x <= high.x
                    && around.low.y <= high.y
                    && around.high.x >= low.x
                    && around.high.y >= low.y
            })
            .map(|(_, _, other)| *other)
            .collect();
        if near.is_empty() {
            found.push(edge);
            continue;
        }
        let along = edge.b - edge.a;
        let aside = Vec2::new(-along.y, along.x) / edge.length();
        let mut cuts = vec![0.0, 1.0];
        for other in near.iter().flat_map(|other| other.segments()) {
            cuts.extend(meetings(&edge, &other, touching));
        }
        cuts.sort_by(f64::total_cmp);
        // Parts that follow one another stay one piece.
        let mut start = None;
        for pair in cuts.windows(2) {
            let middle = edge.a + along * (0.5 * (pair[0] + pair[1]));
            let is_left = polygon.contains(middle + aside * outside[0]);
            let away = if is_left { -aside } else { aside };
            let is_open = (pair[1] - pair[0]) * edge.length() > TOUCHING
                && near.iter().any(|other| outside.iter().any(|far| other.contains(middle + away * *far)));
            if !is_open {
                start.get_or_insert(pair[0]);
            }
            if let Some(from) = start.filter(|_| is_open || pair[1] == 1.0) {
                let to = if is_open { pair[0] } else { pair[1] };
                let piece = Segment::new(edge.a + along * from, edge.a + along * to);
                if piece.length() > TOUCHING {
                    found.push(piece);
                }
                start = None;
            }
        }
    }
    found
}

/// Where another edge crosses an edge or ends on it, as shares of its length.
fn meetings(edge: &Segment, other: &Segment, touching: f64) -> impl Iterator<Item = f64> {
    let (along, across) = (edge.b - edge.a, other.b - other.a);
    let turn = cross(along, across);
    let crossing = (turn != 0.0 && edge.meets(other)).then(|| cross(other.a - edge.a, across) / turn);
    let ends = [other.a, other.b].map(|end| {
        (edge.distance(end) <= touching).then(|| (end - edge.a).dot(&along) / along.norm_squared())
    });
    ends.into_iter().chain([crossing]).flatten().filter(|share| *share > 0.0 && *share < 1.0)
}
