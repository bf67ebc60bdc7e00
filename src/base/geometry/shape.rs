//! Shapes of regions and obstacles.

use super::{Polygon, Vec2};
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
}

/// The smallest upright rectangle around something.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

impl Shape {
    /// The rectangle between two opposite corners.
    pub fn rectangle(a: Vec2, b: Vec2) -> Self {
        Self::Polygon(Polygon::rectangle(a, b))
    }

    /// Whether `p` lies inside or on the rim.
    pub fn contains(&self, p: Vec2) -> bool {
        match self {
            Self::Circle { centre, radius } => (p - centre).norm_squared() <= radius * radius,
            Self::Polygon(polygon) => polygon.contains(p),
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
        }
    }

    /// Its area.
    pub fn area(&self) -> f64 {
        match self {
            Self::Circle { radius, .. } => PI * radius * radius,
            Self::Polygon(polygon) => polygon.area(),
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
        }
    }

    /// A point well inside: the centre of a disc, the centroid of the outline if it lies inside,
    /// else the middle of the widest inner stretch of a horizontal line.
    pub fn inner_point(&self) -> Vec2 {
        let polygon = match self {
            Self::Circle { centre, .. } => return *centre,
            Self::Polygon(polygon) => polygon,
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
