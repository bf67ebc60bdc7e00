//! Shapes of regions and obstacles.

use super::{Polygon, Segment, Vec2};
use std::f64::consts::PI;

/// A region of the plane, closed.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A disc.
    Circle {
        /// Centre.
        centre: Vec2,
        /// Radius, positive.
        radius: f64,
    },
    /// A polygon, perhaps with holes. Rectangles are polygons of four corners.
    Polygon(Polygon),
    /// Several shapes that share no area, such as the exits of a building.
    Parts(Vec<Self>),
}

/// The smallest upright rectangle around something.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Lower left corner.
    pub low: Vec2,
    /// Upper right corner.
    pub high: Vec2,
}

impl Bounds {
    /// The bounds of points; `None` without any.
    pub fn around(points: impl IntoIterator<Item = Vec2>) -> Option<Self> {
        points.into_iter().fold(None, |bounds, p| {
            Some(bounds.map_or(Self { low: p, high: p }, |b: Self| Self {
                low: b.low.inf(&p),
                high: b.high.sup(&p),
            }))
        })
    }

    /// Whether `p` lies inside or on the rim.
    pub fn contains(&self, p: Vec2) -> bool {
        self.low.x <= p.x && p.x <= self.high.x && self.low.y <= p.y && p.y <= self.high.y
    }

    /// Distance from `p` to the rectangle, 0 inside.
    pub fn distance(&self, p: Vec2) -> f64 {
        (self.low - p).sup(&(p - self.high)).sup(&Vec2::zeros()).norm()
    }
}

impl Shape {
    /// The rectangle between two opposite corners.
    pub fn rectangle(a: Vec2, b: Vec2) -> Self {
        Self::Polygon(Polygon::rectangle(a, b))
    }

    /// Its parts in order of writing: the shape itself where it has only one.
    pub fn parts(&self) -> &[Self] {
        if let Self::Parts(parts) = self { parts } else { std::slice::from_ref(self) }
    }

    /// Whether `p` lies inside or on the rim.
    pub fn contains(&self, p: Vec2) -> bool {
        match self {
            Self::Circle { centre, radius } => (p - centre).norm_squared() <= radius * radius,
            Self::Polygon(polygon) => polygon.contains(p),
            Self::Parts(parts) => parts.iter().any(|part| part.contains(p)),
        }
    }

    /// How deep `p` lies inside, m: its distance from the rim; negative outside.
    pub fn depth(&self, p: Vec2) -> f64 {
        match self {
            Self::Circle { centre, radius } => radius - (p - centre).norm(),
            Self::Polygon(polygon) => {
                let distance = (p - polygon.nearest_on_outline(p)).norm();
                if polygon.contains(p) { distance } else { -distance }
            }
            Self::Parts(parts) => parts.iter().map(|part| part.depth(p)).fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Distance from `p` to the shape, 0 inside.
    pub fn distance(&self, p: Vec2) -> f64 {
        if self.contains(p) {
            return 0.0;
        }
        match self {
            Self::Circle { centre, radius } => (p - centre).norm() - radius,
            Self::Polygon(polygon) => (p - polygon.nearest_on_outline(p)).norm(),
            Self::Parts(parts) => parts.iter().map(|part| part.distance(p)).fold(f64::INFINITY, f64::min),
        }
    }

    /// The point of the shape nearest to `p`: `p` itself inside.
    pub fn nearest(&self, p: Vec2) -> Vec2 {
        if self.contains(p) {
            return p;
        }
        match self {
            Self::Circle { centre, radius } => centre + (p - centre) * (radius / (p - centre).norm()),
            Self::Polygon(polygon) => polygon.nearest_on_outline(p),
            // Of parts that are equally far the first one.
            Self::Parts(parts) => {
                let nearest = parts.iter().map(|part| part.nearest(p));
                nearest.reduce(|a, b| if (b - p).norm() < (a - p).norm() { b } else { a }).unwrap_or(p)
            }
        }
    }

    /// The same shape somewhere else.
    pub fn moved(&self, way: Vec2) -> Self {
        let ring = |corners: &Vec<Vec2>| corners.iter().map(|corner| corner + way).collect();
        match self {
            Self::Circle { centre, radius } => Self::Circle { centre: centre + way, radius: *radius },
            Self::Polygon(Polygon { outline, holes }) => {
                Self::Polygon(Polygon { outline: ring(outline), holes: holes.iter().map(ring).collect() })
            }
            Self::Parts(parts) => Self::Parts(parts.iter().map(|part| part.moved(way)).collect()),
        }
    }

    /// Its area.
    pub fn area(&self) -> f64 {
        match self {
            Self::Circle { radius, .. } => PI * radius * radius,
            Self::Polygon(polygon) => polygon.area(),
            Self::Parts(parts) => parts.iter().map(Self::area).sum(),
        }
    }

    /// The smallest upright rectangle around it.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Circle { centre, radius } => {
                let r = Vec2::new(*radius, *radius);
                Bounds { low: centre - r, high: centre + r }
            }
            Self::Polygon(polygon) => Bounds::around(polygon.outline.iter().copied())
                .unwrap_or(Bounds { low: Vec2::zeros(), high: Vec2::zeros() }),
            Self::Parts(parts) => {
                let corners = parts.iter().map(Self::bounds).flat_map(|bounds| [bounds.low, bounds.high]);
                Bounds::around(corners).unwrap_or(Bounds { low: Vec2::zeros(), high: Vec2::zeros() })
            }
        }
    }

    /// A point well inside: the centre of a disc, the centroid of the outline if it lies inside,
    /// else the middle of the widest inner stretch of a horizontal line. Of several parts that of the first one.
    pub fn inner_point(&self) -> Vec2 {
        let polygon = match self {
            Self::Circle { centre, .. } => return *centre,
            Self::Polygon(polygon) => polygon,
            Self::Parts(parts) => return parts.first().map_or_else(Vec2::zeros, Self::inner_point),
        };
        let ring = &polygon.outline;
        let (mut twice, mut sum) = (0.0, Vec2::zeros());
        for (k, &a) in ring.iter().enumerate() {
            let b = ring[(k + 1) % ring.len()];
            let c = super::cross(a, b);
            twice += c;
            sum += (a + b) * c;
        }
        if twice != 0.0 {
            let centroid = sum / (3.0 * twice);
            if polygon.contains(centroid) {
                return centroid;
            }
        }
        let bounds = self.bounds();
        let mut best = (0.0, ring.first().copied().unwrap_or_default());
        for row in 1..16 {
            let y = bounds.low.y + (bounds.high.y - bounds.low.y) * f64::from(row) / 16.0;
            let mut xs: Vec<f64> = polygon
                .segments()
                .filter(|s| (s.a.y > y) != (s.b.y > y))
                .map(|s| s.a.x + (y - s.a.y) / (s.b.y - s.a.y) * (s.b.x - s.a.x))
                .collect();
            xs.sort_by(f64::total_cmp);
            for pair in xs.chunks_exact(2) {
                if pair[1] - pair[0] > best.0 {
                    best = (pair[1] - pair[0], Vec2::new(0.5 * (pair[0] + pair[1]), y));
                }
            }
        }
        best.1
    }

    /// Whether two shapes share area. Shapes that only touch do not.
    pub fn overlaps(&self, other: &Self) -> bool {
        /// Rounding of places that are computed, m.
        const HAIR: f64 = 1e-6;
        match (self, other) {
            (Self::Parts(parts), one) | (one, Self::Parts(parts)) => parts.iter().any(|p| p.overlaps(one)),
            (Self::Circle { centre: a, radius: r }, Self::Circle { centre: b, radius: s }) => {
                (a - b).norm() < r + s - HAIR
            }
            (Self::Circle { centre, radius }, Self::Polygon(polygon))
            | (Self::Polygon(polygon), Self::Circle { centre, radius }) => {
                polygon.contains(*centre)
                    || polygon.segments().any(|side| side.distance(*centre) < radius - HAIR)
            }
            (Self::Polygon(a), Self::Polygon(b)) => {
                let crosses = |side: Segment| b.segments().any(|other| side.crosses(&other));
                // Where sides lie on each other nothing crosses: then a corner or the middle of a side lies inside.
                let is_deep = |of: &Polygon, into: &Self| {
                    let places = of.segments().flat_map(|side| [side.a, 0.5 * (side.a + side.b)]);
                    places.chain([Self::Polygon(of.clone()).inner_point()]).any(|p| into.depth(p) > HAIR)
                };
                a.segments().any(crosses) || is_deep(a, other) || is_deep(b, self)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_and_a_rectangle() {
        let circle = Shape::Circle { centre: Vec2::new(1.0, 2.0), radius: 1.0 };
        assert!(circle.contains(Vec2::new(1.0, 3.0)));
        assert_eq!(circle.distance(Vec2::new(4.0, 2.0)), 2.0);
        let rect = Shape::rectangle(Vec2::new(0.0, 0.0), Vec2::new(2.0, 1.0));
        assert_eq!(rect.area(), 2.0);
        assert_eq!(rect.nearest(Vec2::new(3.0, 0.5)), Vec2::new(2.0, 0.5));
        assert_eq!(rect.inner_point(), Vec2::new(1.0, 0.5));
    }

    #[test]
    fn parts_are_one_region() {
        let rect = |x: f64| Shape::rectangle(Vec2::new(x, 0.0), Vec2::new(x + 2.0, 1.0));
        let circle = Shape::Circle { centre: Vec2::new(9.0, 0.5), radius: 0.5 };
        let parts = Shape::Parts(vec![rect(0.0), rect(4.0), circle.clone()]);
        let p = |x: f64| Vec2::new(x, 0.5);
        assert!(parts.contains(p(5.0)) && parts.contains(p(9.2)) && !parts.contains(p(3.0)));
        assert_eq!(parts.distance(p(7.0)), 1.0);
        assert_eq!(parts.nearest(p(2.9)), p(2.0));
        // Of two that are equally far the first one.
        assert_eq!(parts.nearest(p(3.0)), p(2.0));
        assert_eq!(parts.depth(p(5.0)), 0.5);
        assert_eq!(parts.depth(p(3.0)), -1.0);
        assert!((parts.area() - 4.0 - 0.25 * PI).abs() < 1e-12);
        assert!(rect(0.0).overlaps(&rect(1.0)) && rect(1.0).overlaps(&rect(1.0)));
        assert!(!rect(0.0).overlaps(&rect(2.0)) && !rect(0.0).overlaps(&circle));
        assert!(circle.overlaps(&rect(7.0)) && rect(8.0).overlaps(&circle));
    }

    #[test]
    fn the_inner_point_of_a_horseshoe_is_inside() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let shape = Shape::Polygon(Polygon::new(vec![
            p(0., 0.),
            p(4., 0.),
            p(4., 4.),
            p(3., 4.),
            p(3., 1.),
            p(1., 1.),
            p(1., 4.),
            p(0., 4.),
        ]));
        assert!(shape.contains(shape.inner_point()));
    }
}
