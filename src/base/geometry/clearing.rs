//! The part of a convex polygon that can be reached from the origin without crossing a segment.

use super::convex::{Convex, UNNAMED};
use super::{Segment, Vec2, cross};

/// Shorter ways and distances are none, m.
const NOTHING: f64 = 1e-9;

/// Divides a polygon along segments and returns the parts around the origin that are joined, convex each.
pub fn clearing(whole: &Convex, segments: &[Segment]) -> Vec<Convex> {
    let mut parts = vec![whole.clone()];
    for (name, segment) in segments.iter().enumerate() {
        let along = segment.b - segment.a;
        let normal = Vec2::new(along.y, -along.x);
        let limit = normal.dot(&segment.a);
        let mut beyond = Vec::new();
        for part in parts.iter_mut().filter(|part| runs_through(segment, part)) {
            let mut other = part.clone();
            part.cut(normal, limit, name as u32);
            other.cut(-normal, -limit, name as u32);
            beyond.push(other);
        }
        parts.extend(beyond);
    }
    // Those reached so far come first; of these `done` have been looked at.
    let first = (0..parts.len())
        .max_by(|&a, &b| parts[a].depth(Vec2::zeros()).total_cmp(&parts[b].depth(Vec2::zeros())));
    parts.swap(0, first.unwrap_or(0));
    let (mut reached, mut done) = (1, 0);
    while done < reached {
        let unknown = reached..parts.len();
        for k in unknown {
            if are_joined(&parts[done], &parts[k], segments) {
                parts.swap(reached, k);
                reached += 1;
            }
        }
        done += 1;
    }
    parts.truncate(reached);
    parts
}

/// Whether a segment has a piece inside a polygon.
fn runs_through(segment: &Segment, part: &Convex) -> bool {
    let along = segment.b - segment.a;
    let (mut from, mut to) = (0.0, 1.0);
    for (edge, _) in part.edges() {
        let way = edge.b - edge.a;
        // Inside is on the left of each edge.
        let (start, slope) = (cross(way, segment.a - edge.a), cross(way, along));
        if slope > 0.0 {
            from = f64::max(from, -start / slope);
        } else if slope < 0.0 {
            to = f64::min(to, -start / slope);
        } else if start <= 0.0 {
            return false;
        }
    }
    (to - from) * along.norm() > NOTHING && part.depth(segment.a + along * (0.5 * (from + to))) > NOTHING
}

/// Whether two parts share a piece of an edge on which no segment lies.
fn are_joined(a: &Convex, b: &Convex, segments: &[Segment]) -> bool {
    a.edges().filter(|(_, name)| *name != UNNAMED).any(|(edge, name)| {
        let line = &segments[name as usize];
        let along = (line.b - line.a) / line.length();
        let stretch = |edge: &Segment| {
            let (p, q) = ((edge.a - line.a).dot(&along), (edge.b - line.a).dot(&along));
            (p.min(q), p.max(q))
        };
        let own = stretch(&edge);
        b.edges().filter(|(_, other)| *other == name).any(|(edge, _)| {
            let other = stretch(&edge);
            let on_line = |p: Vec2| cross(along, p - line.a).abs() <= NOTHING;
            let walls = segments.iter().filter(|one| on_line(one.a) && on_line(one.b)).map(stretch);
            is_open((own.0.max(other.0), own.1.min(other.1)), &walls.collect::<Vec<_>>())
        })
    })
}

/// Whether stretches leave a gap in another one.
fn is_open((mut from, to): (f64, f64), walls: &[(f64, f64)]) -> bool {
    while to - from > NOTHING {
        let covers = walls.iter().filter(|wall| wall.0 <= from + NOTHING).map(|wall| wall.1);
        let next = covers.fold(from, f64::max);
        if next - from <= NOTHING {
            return true;
        }
        from = next;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    type Wall = ((f64, f64), (f64, f64));

    /// The area of what is reached from the middle of a square of side 2.
    fn reached(walls: &[Wall]) -> f64 {
        let mut square = Convex::regular(4, 9.0);
        for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            square.cut(Vec2::new(x, y), 1.0, UNNAMED);
        }
        let segment = |&((ax, ay), (bx, by)): &Wall| Segment::new(Vec2::new(ax, ay), Vec2::new(bx, by));
        let walls: Vec<Segment> = walls.iter().map(segment).collect();
        clearing(&square, &walls).iter().map(Convex::area).sum()
    }

    #[test]
    fn walls_from_rim_to_rim_cut_and_others_do_not() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(reached(&[]), 4.0));
        assert!(near(reached(&[((0.5, -3.0), (0.5, 3.0))]), 3.0));
        assert!(near(reached(&[((0.5, -3.0), (0.5, 0.9))]), 4.0), "a way around its end");
        // Two pieces of a wall, that touch or leave a door.
        assert!(near(reached(&[((0.5, -3.0), (0.5, 0.0)), ((0.5, 3.0), (0.5, 0.0))]), 3.0));
        assert!(near(reached(&[((0.5, -3.0), (0.5, 0.0)), ((0.5, 3.0), (0.5, 0.1))]), 4.0));
        // The corner of a building, a pillar, and a room around the middle.
        assert!(near(reached(&[((0.5, 0.5), (0.5, 3.0)), ((0.5, 0.5), (3.0, 0.5))]), 3.75));
        let pillar = [(0.2, 0.2), (0.7, 0.2), (0.7, 0.7), (0.2, 0.7)];
        let sides: Vec<_> = (0..4).map(|k| (pillar[k], pillar[(k + 1) % 4])).collect();
        assert!(near(reached(&sides), 3.75));
        let room = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let sides: Vec<_> = (0..4).map(|k| (room[k], room[(k + 1) % 4])).collect();
        assert!(near(reached(&sides), 1.0));
        assert!(near(reached(&sides[1..]), 4.0), "a room with an open side");
    }
}
