//! Points uniform in a shape from two uniform numbers: no rejection, so that every attempt takes one draw.
//!
//! A polygon is cut into trapezoids at the heights of its corners (the even-odd rule pairs the edges, so
//! holes need no care); one is chosen by area and the height in it by the inverse of its quadratic
//! distribution function.

use crate::base::geometry::{Polygon, Shape, Vec2};
use crate::base::math;

/// Between two heights, between two edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trapezoid {
    low: f64,
    high: f64,
    /// Left and right end at the lower height.
    below: (f64, f64),
    /// Left and right end at the upper height.
    above: (f64, f64),
    /// Area up to and with this one, m^2.
    sum: f64,
}

/// Points in a shape.
#[derive(Clone, Debug)]
pub(super) enum Sampler {
    Disc {
        centre: Vec2,
        radius: f64,
    },
    Trapezoids(Vec<Trapezoid>),
    /// Each part, and the area up to and with it, m^2.
    Parts(Vec<(Self, f64)>),
}

fn trapezoids(polygon: &Polygon) -> Vec<Trapezoid> {
    let edges: Vec<_> = polygon.segments().filter(|s| s.a.y != s.b.y).collect();
    let mut heights: Vec<f64> = polygon.segments().map(|s| s.a.y).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let mut out = Vec::new();
    let mut sum = 0.0;
    for pair in heights.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        let mut crossing: Vec<(f64, f64)> = edges
            .iter()
            .filter(|s| s.a.y.min(s.b.y) <= low && s.a.y.max(s.b.y) >= high)
            .map(|s| {
                let at = |y: f64| {
                    if y == s.a.y {
                        s.a.x
                    } else if y == s.b.y {
                        s.b.x
                    } else {
                        s.a.x + (y - s.a.y) / (s.b.y - s.a.y) * (s.b.x - s.a.x)
                    }
                };
                (at(low), at(high))
            })
            .collect();
        crossing.sort_by(|p, q| (p.0 + p.1).total_cmp(&(q.0 + q.1)));
        for sides in crossing.chunks_exact(2) {
            let (below, above) = ((sides[0].0, sides[1].0), (sides[0].1, sides[1].1));
            sum += 0.5 * ((below.1 - below.0) + (above.1 - above.0)) * (high - low);
            out.push(Trapezoid { low, high, below, above, sum });
        }
    }
    out
}

impl Sampler {
    pub(super) fn new(shape: &Shape) -> Self {
        match shape {
            Shape::Circle { centre, radius } => Self::Disc { centre: *centre, radius: *radius },
            Shape::Polygon(polygon) => Self::Trapezoids(trapezoids(polygon)),
            Shape::Parts(parts) => {
                let mut sum = 0.0;
                let part = |part: &Shape| {
                    sum += part.area();
                    (Self::new(part), sum)
                };
                Self::Parts(parts.iter().map(part).collect())
            }
        }
    }

    /// The point that belongs to two numbers in (0, 1); none in an empty shape.
    pub(super) fn point(&self, [u, v]: [f64; 2]) -> Option<Vec2> {
        let list = match self {
            Self::Disc { centre, radius } => {
                let (sin, cos) = math::sin_cos_turn(v);
                return Some(centre + Vec2::new(cos, sin) * (radius * u.sqrt()));
            }
            Self::Trapezoids(list) => list,
            Self::Parts(parts) => {
                let wanted = u * parts.last()?.1;
                let index = parts.partition_point(|part| part.1 <= wanted).min(parts.len() - 1);
                let before = if index == 0 { 0.0 } else { parts[index - 1].1 };
                let share = math::at_most((wanted - before) / (parts[index].1 - before), 1.0);
                return parts[index].0.point([share, v]);
            }
        };
        let wanted = u * list.last()?.sum;
        let index = list.partition_point(|t| t.sum <= wanted).min(list.len() - 1);
        let t = list[index];
        let before = if index == 0 { 0.0 } else { list[index - 1].sum };
        let share = math::at_most((wanted - before) / (t.sum - before), 1.0);
        let (w0, w1) = (t.below.1 - t.below.0, t.above.1 - t.above.0);
        // Solves w0 s + (w1 - w0) s^2 / 2 = share (w0 + w1) / 2, without cancellation.
        let root = (w0 * w0 + share * (w1 * w1 - w0 * w0)).sqrt();
        let s = if w0 + root > 0.0 { math::at_most(share * (w0 + w1) / (w0 + root), 1.0) } else { 0.0 };
        let (left, right) =
            (t.below.0 + s * (t.above.0 - t.below.0), t.below.1 + s * (t.above.1 - t.below.1));
        Some(Vec2::new(left + v * (right - left), t.low + s * (t.high - t.low)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    fn mean_and_share(shape: &Shape, part: &Shape) -> (Vec2, f64) {
        let sampler = Sampler::new(shape);
        let stream = Stream::of(TrialKey { seed: 3, index: 1, branch: 0 }, 1, Purpose::Test);
        let n = 20_000;
        let (mut sum, mut inside) = (Vec2::zeros(), 0);
        for draw in 0..n {
            let p = sampler.point(stream.uniform_pair(draw)).unwrap();
            assert!(shape.distance(p) < 1e-9);
            sum += p;
            inside += u32::from(part.contains(p));
        }
        (sum / f64::from(n), f64::from(inside) / f64::from(n))
    }

    #[test]
    fn points_are_spread_by_area() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let triangle = Shape::Polygon(Polygon::new(vec![p(0., 0.), p(6., 0.), p(0., 3.)]));
        let (mean, share) = mean_and_share(&triangle, &Shape::rectangle(p(0., 0.), p(2., 1.)));
        assert!((mean - p(2.0, 1.0)).norm() < 0.04, "{mean}");
        assert!((share - 2.0 / 9.0).abs() < 0.012, "{share}");

        let mut ring = Polygon::rectangle(p(0., 0.), p(4., 4.));
        ring.holes.push(Polygon::rectangle(p(1., 1.), p(3., 3.)).outline);
        let (_, share) = mean_and_share(&Shape::Polygon(ring), &Shape::rectangle(p(0., 0.), p(1., 4.)));
        assert!((share - 1.0 / 3.0).abs() < 0.012, "{share}");

        let rooms = vec![Shape::rectangle(p(0., 0.), p(1., 1.)), Shape::rectangle(p(5., 0.), p(8., 1.))];
        let (_, share) = mean_and_share(&Shape::Parts(rooms.clone()), &rooms[1]);
        assert!((share - 0.75).abs() < 0.012, "{share}");

        let disc = Shape::Circle { centre: p(1., 1.), radius: 2.0 };
        let (_, share) = mean_and_share(&disc, &Shape::Circle { centre: p(1., 1.), radius: 1.0 });
        assert!((share - 0.25).abs() < 0.012, "{share}");
    }

    #[test]
    fn an_empty_shape_has_no_points() {
        let line = Shape::rectangle(Vec2::new(0.0, 1.0), Vec2::new(5.0, 1.0));
        assert_eq!(Sampler::new(&line).point([0.5, 0.5]), None);
    }
}
