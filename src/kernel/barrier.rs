//! Walls and obstacles as wholes: the nearest point of the surface, inside or outside.
//!
//! Inside a solid the normal points out. `force::walls` says which of the faces of a barrier push.

use super::edges::Edges;
use super::vector::{Doubles, Part};
use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use crate::model::{Barrier, Obstacle};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

#[derive(Clone, Debug)]
enum Form {
    Wall(Edges),
    Polygon(Edges),
    Disc { centre: Vec2, radius: f64 },
}

/// A barrier.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    form: Form,
    /// The smallest upright rectangle around it.
    pub(super) bounds: Bounds,
}

impl Surface {
    /// The surface of a barrier; `None` if it has no piece.
    pub(super) fn new(barrier: &Barrier) -> Option<Self> {
        let (form, bounds) = match &barrier.obstacle {
            Obstacle::Wall(segments) => (
                Form::Wall(Edges::new(segments.iter().copied())),
                Bounds::around(segments.iter().flat_map(|s| [s.a, s.b]))?,
            ),
            Obstacle::Solid(shape @ Shape::Circle { centre, radius }) => {
                (Form::Disc { centre: *centre, radius: *radius }, shape.bounds())
            }
            Obstacle::Solid(Shape::Polygon(polygon)) => (
                Form::Polygon(Edges::new(polygon.segments())),
                Bounds::around(polygon.segments().map(|s| s.a))?,
            ),
            // Obstacles have one part.
            Obstacle::Solid(Shape::Parts(_)) => return None,
        };
        Some(Self { form, bounds })
    }

    /// Its straight edges; a disc has none.
    pub(super) fn edges(&self) -> impl Iterator<Item = Segment> + '_ {
        let edges = match &self.form {
            Form::Wall(edges) | Form::Polygon(edges) => Some(edges),
            Form::Disc { .. } => None,
        };
        edges.into_iter().flat_map(Edges::segments)
    }

    /// Whether it is made of straight edges: not a disc.
    pub(super) fn has_edges(&self) -> bool {
        !matches!(self.form, Form::Disc { .. })
    }

    /// The middle of its bounds: of a disc, its centre.
    pub(super) fn centre(&self) -> Vec2 {
        match &self.form {
            Form::Disc { centre, .. } => *centre,
            Form::Wall(_) | Form::Polygon(_) => 0.5 * (self.bounds.low + self.bounds.high),
        }
    }

    /// Whether a place lies in a polygon.
    pub(super) fn surrounds(&self, p: Vec2) -> bool {
        matches!(&self.form, Form::Polygon(edges) if edges.surround(p))
    }

    /// The nearest points to eight places: unit vectors away from the surface, zero exactly on it, and distances,
    /// negative inside a solid.
    #[inline(always)]
    pub(super) fn nearest<S: Simd>(
        &self,
        part: Part<S>,
        x: Doubles<S>,
        y: Doubles<S>,
    ) -> (Doubles<S>, Doubles<S>, Doubles<S>) {
        // Far below any square of a distance that matters: keeps 1/0 out where the centre is on the line.
        let tiny = part.c(1e-300);
        match &self.form {
            Form::Disc { centre, radius } => {
                let (dx, dy) = (x - part.c(centre.x), y - part.c(centre.y));
                let d = (dx * dx + dy * dy + tiny).sqrt();
                let q = part.c(1.0) / d;
                (dx * q, dy * q, d - part.c(*radius))
            }
            Form::Wall(edges) => {
                let (dx, dy) = edges.nearest(part, x, y);
                let d = (dx * dx + dy * dy + tiny).sqrt();
                let q = part.c(1.0) / d;
                (dx * q, dy * q, d)
            }
            Form::Polygon(edges) => {
                let (dx, dy) = edges.nearest(part, x, y);
                let d = (dx * dx + dy * dy + tiny).sqrt();
                let inside = edges.inside(part, x, y);
                let sign = inside.select(part.c(-1.0), part.c(1.0));
                let q = sign / d;
                (dx * q, dy * q, sign * d)
            }
        }
    }

    /// The nearest point to one place: unit vector away from the surface and signed distance.
    pub(super) fn nearest_to(&self, p: Vec2) -> (Vec2, f64) {
        let normal = |d: Vec2| {
            let distance = (d.x * d.x + d.y * d.y + 1e-300).sqrt();
            (d * (1.0 / distance), distance)
        };
        match &self.form {
            Form::Disc { centre, radius } => {
                let (n, distance) = normal(p - centre);
                (n, distance - radius)
            }
            Form::Wall(edges) => normal(edges.nearest_to(p)),
            Form::Polygon(edges) => {
                let (n, distance) = normal(edges.nearest_to(p));
                if edges.surround(p) { (-n, -distance) } else { (n, distance) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::vector::parts;
    use super::*;
    use crate::base::geometry::Polygon;
    use crate::base::lanes::Lanes;
    use fearless_simd::{Level, dispatch};

    #[inline(always)]
    fn eight<S: Simd>(simd: S, surface: &Surface, x: [f64; 8], y: [f64; 8]) -> [[f64; 8]; 3] {
        let mut out = [Lanes::ZERO; 3];
        for part in parts(simd) {
            let (nx, ny, distance) = surface.nearest(part, part.slice(&x), part.slice(&y));
            part.store(nx, &mut out[0]);
            part.store(ny, &mut out[1]);
            part.store(distance, &mut out[2]);
        }
        out.map(|lanes| lanes.0)
    }

    #[test]
    fn eight_at_once_are_as_one_by_one_and_as_the_scene_says() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let mut ring = Polygon::rectangle(p(0.0, 0.0), p(4.0, 4.0));
        ring.holes.push(Polygon::rectangle(p(1.0, 1.0), p(3.0, 2.5)).outline);
        let obstacles = [
            Obstacle::Wall(vec![
                Segment::new(p(0.0, 0.0), p(4.0, 0.0)),
                Segment::new(p(4.0, 0.0), p(4.0, 3.0)),
                Segment::new(p(1.0, 2.0), p(1.0, 2.0)),
            ]),
            Obstacle::Solid(Shape::Circle { centre: p(2.0, 2.0), radius: 1.5 }),
            Obstacle::Solid(Shape::Polygon(ring)),
        ];
        for obstacle in obstacles {
            let barrier = Barrier { name: String::new(), obstacle };
            let surface = Surface::new(&barrier).unwrap();
            for k in 0..500 {
                let x: [f64; 8] =
                    std::array::from_fn(|lane| f64::from(k % 25) * 0.3 - 1.7 + lane as f64 * 0.03);
                let y: [f64; 8] =
                    std::array::from_fn(|lane| f64::from(k / 25) * 0.33 - 1.3 - lane as f64 * 0.02);
                let [nx, ny, distance] = dispatch!(Level::new(), simd => eight(simd, &surface, x, y));
                for lane in 0..8 {
                    let place = p(x[lane], y[lane]);
                    let (n, d) = surface.nearest_to(place);
                    assert_eq!((n.x, n.y, d), (nx[lane], ny[lane], distance[lane]));
                    assert!((d - barrier.obstacle.distance(place)).abs() < 1e-14);
                    // A step towards the nearest point is a step nearer (on the surface there is none).
                    if d.abs() > 1e-5 {
                        let (_, nearer) = surface.nearest_to(place - n * (d.signum() * 1e-6));
                        assert!((d.abs() - nearer.abs() - 1e-6).abs() < 1e-12, "{place} {d} {nearer}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_barrier_without_pieces_is_none() {
        let barrier = Barrier { name: String::new(), obstacle: Obstacle::Wall(Vec::new()) };
        assert!(Surface::new(&barrier).is_none());
    }
}
