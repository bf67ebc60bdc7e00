//! Straight lines among the barriers of a scene: whether a body can go along one.

use super::scene::{Obstacle, Scene};
use crate::base::geometry::{Bounds, Nearby, Segment, Shape, Vec2, amply_around, cross};

/// What rounding may take from a distance, m.
pub const ROUNDING: f64 = 1e-9;

/// A piece of a barrier's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// A straight edge.
    Edge(Segment),
    /// The rim of a disc.
    Disc {
        /// Its centre.
        centre: Vec2,
        /// Its radius, m.
        radius: f64,
    },
}

impl Piece {
    /// Distance from a point to it, m; within a disc as at its rim.
    pub fn distance(&self, p: Vec2) -> f64 {
        match self {
            Self::Edge(edge) => edge.distance(p),
            Self::Disc { centre, radius } => ((p - centre).norm() - radius).max(0.0),
        }
    }

    /// The point of it nearest to a point; of a disc, its centre where the point lies within.
    pub fn nearest(&self, p: Vec2) -> Vec2 {
        match self {
            Self::Edge(edge) => edge.nearest(p),
            Self::Disc { centre, radius } => {
                let away = p - centre;
                let distance = away.norm();
                if distance > *radius { centre + away * (radius / distance) } else { *centre }
            }
        }
    }

    /// Distance from a line to it, m.
    pub fn distance_to(&self, line: &Segment) -> f64 {
        match self {
            Self::Edge(edge) => edge.distance_to(line),
            Self::Disc { centre, radius } => (line.distance(*centre) - radius).max(0.0),
        }
    }

    /// Whether it surely lies on one side of a line, farther than `reach` from it, m. So do most pieces, and this is found fast.
    fn is_aside(&self, line: &Segment, reach: f64) -> bool {
        let Self::Edge(edge) = self else { return false };
        let along = line.b - line.a;
        let (a, b) = (cross(along, edge.a - line.a), cross(along, edge.b - line.a));
        let square = along.norm_squared() * reach * reach;
        a * b > 0.0 && a * a > square && b * b > square
    }

    fn bounds(&self) -> Bounds {
        match self {
            Self::Edge(edge) => Bounds { low: edge.a.inf(&edge.b), high: edge.a.sup(&edge.b) },
            Self::Disc { centre, radius } => {
                let reach = Vec2::repeat(*radius);
                Bounds { low: centre - reach, high: centre + reach }
            }
        }
    }
}

/// Walls and rims of obstacles of a scene.
#[derive(Clone, Debug, Default)]
pub struct Sight {
    pieces: Vec<Piece>,
    nearby: Nearby,
}

impl Sight {
    /// Of a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut pieces = Vec::new();
        for barrier in scene.unrolled().iter() {
            let shape = match &barrier.obstacle {
                Obstacle::Wall(segments) => {
                    pieces.extend(segments.iter().copied().map(Piece::Edge));
                    continue;
                }
                Obstacle::Solid(shape) => shape,
            };
            for part in shape.parts() {
                match part {
                    Shape::Polygon(polygon) => pieces.extend(polygon.segments().map(Piece::Edge)),
                    Shape::Circle { centre, radius } => {
                        pieces.push(Piece::Disc { centre: *centre, radius: *radius });
                    }
                    Shape::Parts(_) => {}
                }
            }
        }
        let bounds: Vec<Bounds> = pieces.iter().map(Piece::bounds).collect();
        Self { pieces, nearby: Nearby::new(&bounds) }
    }

    /// Its pieces.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The pieces that may be nearer than `reach` to a place, and perhaps others.
    pub fn near(&self, p: Vec2, reach: f64) -> Vec<Piece> {
        let mut room = Vec::new();
        let found = self.nearby.find(&amply_around(p, reach), &mut room);
        found.iter().map(|&k| self.pieces[k as usize]).collect()
    }

    /// Whether something is true of a piece that may be nearer than `reach` to a line.
    pub fn any_along(&self, line: &Segment, reach: f64, mut is_true: impl FnMut(&Piece) -> bool) -> bool {
        self.nearby.any_along(line, reach, |k| is_true(&self.pieces[k as usize]))
    }

    /// Whether the middle of a body of radius `reach`, m, can go straight from one place to another. Where an end is nearer to
    /// a barrier than that, the line need only keep the distance of this end.
    pub fn is_clear(&self, from: Vec2, to: Vec2, reach: f64) -> bool {
        self.blocker((from, to), reach, None).is_none()
    }

    /// A piece that is in the way of such a body, by its number. One that is `likely` is looked at first.
    pub fn blocker(&self, (from, to): (Vec2, Vec2), reach: f64, likely: Option<u32>) -> Option<u32> {
        if likely.is_some_and(|k| self.blocks(k, (from, to), reach)) {
            return likely;
        }
        let mut found = None;
        self.nearby.any_along(&Segment::new(from, to), reach, |k| {
            found = Some(k).filter(|k| self.blocks(*k, (from, to), reach));
            found.is_some()
        });
        found
    }

    /// How near the nearest piece is to a straight line, m, at most `most`.
    pub fn clearance(&self, (from, to): (Vec2, Vec2), most: f64) -> f64 {
        let line = Segment::new(from, to);
        let mut clearance = most;
        self.nearby.any_along(&line, most, |k| {
            let piece = &self.pieces[k as usize];
            if !piece.is_aside(&line, clearance) {
                clearance = clearance.min(piece.distance_to(&line));
            }
            false
        });
        clearance
    }

    /// Whether this piece is in the way of such a body.
    pub fn blocks(&self, k: u32, (from, to): (Vec2, Vec2), reach: f64) -> bool {
        let Some(piece) = self.pieces.get(k as usize) else { return false };
        let line = Segment::new(from, to);
        if piece.is_aside(&line, reach) {
            return false;
        }
        let distance = piece.distance_to(&line);
        distance < reach - ROUNDING && distance < piece.distance(from).min(piece.distance(to)) - ROUNDING
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Barrier;

    #[test]
    fn a_line_is_clear_if_a_body_fits_along_it() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let wall = |a, b| Obstacle::Wall(vec![Segment::new(a, b)]);
        // A door of 1 m, and a pillar behind it.
        let pillar = Obstacle::Solid(Shape::Circle { centre: p(3.0, 0.0), radius: 0.5 });
        let obstacles = [wall(p(0.0, 0.5), p(0.0, 9.0)), wall(p(0.0, -0.5), p(0.0, -9.0)), pillar];
        let barriers = obstacles.map(|obstacle| Barrier { name: String::new(), obstacle }).to_vec();
        let sight = Sight::new(&Scene { barriers, ..Scene::default() });
        assert!(sight.is_clear(p(-2.0, 0.0), p(2.0, 0.0), 0.5));
        assert!(!sight.is_clear(p(-2.0, 0.0), p(2.0, 0.0), 0.51));
        assert!(sight.is_clear(p(-2.0, 0.0), p(2.0, 0.2), 0.25));
        assert!(!sight.is_clear(p(-2.0, 0.0), p(6.0, 0.0), 0.1));
        assert!(sight.is_clear(p(1.0, 0.75), p(6.0, 0.75), 0.25));
        // Somebody at a wall may go along it and away from it, not through it.
        assert!(sight.is_clear(p(-0.1, 2.0), p(-0.1, 5.0), 0.25));
        assert!(sight.is_clear(p(-0.1, 2.0), p(-3.0, 5.0), 0.25));
        assert!(!sight.is_clear(p(-0.1, 2.0), p(0.1, 2.0), 0.25));
    }
}
