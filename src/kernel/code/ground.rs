//! Regions and barriers, made ready for lanes of points.
//!
//! Rectangles and discs have formulas of their own; everything else is a list of edges: the nearest
//! point of each, and the even-odd rule for what is inside.

use super::lanes::{Truth, Vector, lesser, narrow};
use crate::base::geometry::{Bounds, Polygon, Segment, Shape, Vec2};
use crate::base::lanes::Mask;
use crate::model::Obstacle;
use fearless_simd::{Simd, prelude::*};

/// An edge with what is the same for every point.
#[derive(Clone, Copy, Debug)]
struct Edge {
    a: Vec2,
    b: Vec2,
    along: Vec2,
    square: f64,
}

impl Edge {
    fn new(segment: Segment) -> Self {
        let along = segment.b - segment.a;
        Self { a: segment.a, b: segment.b, along, square: along.dot(&along) }
    }

    /// The way from a point to the nearest point of the edge, as in [`Segment::nearest`], with its sign
    /// turned.
    #[inline(always)]
    fn offset<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> (Vector<S>, Vector<S>) {
        let zero = Vector::splat(x.simd, 0.0);
        let one = Vector::splat(x.simd, 1.0);
        let share = if self.square == 0.0 {
            zero
        } else {
            let share = ((x - self.a.x) * self.along.x + (y - self.a.y) * self.along.y) / self.square;
            let share = share.simd_lt(zero).select(zero, share);
            share.simd_gt(one).select(one, share)
        };
        (x - (share * self.along.x + self.a.x), y - (share * self.along.y + self.a.y))
    }

    /// Squared distance of a point.
    #[inline(always)]
    fn distance_squared<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        let (dx, dy) = self.offset(x, y);
        dx * dx + dy * dy
    }

    /// Whether a ray from the point in the direction of x crosses the edge.
    #[inline(always)]
    fn crossed<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Truth<S> {
        let (ay, by) = (Vector::splat(x.simd, self.a.y), Vector::splat(x.simd, self.b.y));
        let at = (y - self.a.y) / (self.b.y - self.a.y) * (self.b.x - self.a.x) + self.a.x;
        (ay.simd_gt(y) ^ by.simd_gt(y)) & x.simd_lt(at)
    }
}

/// A form.
#[derive(Clone, Debug)]
enum Form {
    Rectangle(Bounds),
    Disc {
        centre: Vec2,
        radius: f64,
    },
    /// Edges of the outline, then of each hole; the ends of the rings in the list.
    Polygon {
        edges: Vec<Edge>,
        rings: Vec<usize>,
    },
    /// Edges without an inside.
    Wall(Vec<Edge>),
}

impl Form {
    /// The lanes whose point is inside or on the rim.
    #[inline(always)]
    fn contains<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Truth<S> {
        match self {
            Self::Rectangle(Bounds { low, high }) => {
                x.simd_ge(Vector::splat(x.simd, low.x))
                    & x.simd_le(Vector::splat(x.simd, high.x))
                    & y.simd_ge(Vector::splat(x.simd, low.y))
                    & y.simd_le(Vector::splat(x.simd, high.y))
            }
            Self::Disc { centre, radius } => {
                let (dx, dy) = (x - centre.x, y - centre.y);
                (dx * dx + dy * dy).simd_le(Vector::splat(x.simd, radius * radius))
            }
            Self::Polygon { edges, rings } => {
                nearest_squared(edges, x, y).simd_eq(Vector::splat(x.simd, 0.0)) | within(edges, rings, x, y)
            }
            Self::Wall(_) => Truth::<S>::splat(x.simd, false),
        }
    }

    /// The way from a point to the nearest point of the rim of a form with edges, and of another one from outside.
    #[inline(always)]
    fn way_to_rim<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> (Vector<S>, Vector<S>) {
        let zero = Vector::splat(x.simd, 0.0);
        let mut best = (Vector::splat(x.simd, f64::INFINITY), zero, zero);
        let edges = match self {
            Self::Polygon { edges, .. } | Self::Wall(edges) => edges,
            Self::Rectangle(Bounds { low, high }) => {
                let way = |v: Vector<S>, low: f64, high: f64| {
                    let (up, down) = (-v + low, -v + high);
                    let down = down.simd_lt(zero).select(down, zero);
                    up.simd_gt(zero).select(up, down)
                };
                return (way(x, low.x, high.x), way(y, low.y, high.y));
            }
            Self::Disc { centre, radius } => {
                let (dx, dy) = (-x + centre.x, -y + centre.y);
                let far = (dx * dx + dy * dy).sqrt();
                let share = (far - *radius) / far;
                return (dx * share, dy * share);
            }
        };
        for edge in edges {
            let (dx, dy) = edge.offset(x, y);
            let squared = dx * dx + dy * dy;
            let nearer = squared.simd_lt(best.0);
            best = (nearer.select(squared, best.0), nearer.select(-dx, best.1), nearer.select(-dy, best.2));
        }
        (best.1, best.2)
    }

    /// Distance from the region: 0 inside.
    #[inline(always)]
    fn distance<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        let outside = match self {
            Self::Rectangle(bounds) => return box_squared(bounds, x, y).sqrt(),
            Self::Disc { .. } => self.signed_distance(x, y),
            Self::Polygon { edges, .. } | Self::Wall(edges) => nearest_squared(edges, x, y).sqrt(),
        };
        self.contains(x, y).select(Vector::splat(x.simd, 0.0), outside)
    }

    /// Distance from the surface of a barrier or the rim of a region: negative inside.
    #[inline(always)]
    fn signed_distance<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        match self {
            Self::Disc { centre, radius } => {
                let (dx, dy) = (x - centre.x, y - centre.y);
                (dx * dx + dy * dy + nothing(x, y)).sqrt() - *radius
            }
            Self::Polygon { edges, .. } => {
                let distance = nearest_squared(edges, x, y).sqrt();
                self.contains(x, y).select(-distance, distance)
            }
            Self::Wall(edges) => nearest_squared(edges, x, y).sqrt(),
            Self::Rectangle(bounds) => {
                let across = lesser(x - bounds.low.x, -x + bounds.high.x);
                let depth = lesser(across, lesser(y - bounds.low.y, -y + bounds.high.y));
                let inside = depth.simd_ge(Vector::splat(x.simd, 0.0));
                inside.select(-depth, box_squared(bounds, x, y).sqrt())
            }
        }
    }
}

/// A region or barrier.
#[derive(Clone, Debug)]
pub struct Ground {
    form: Form,
    /// The other parts of a region of several.
    others: Vec<Form>,
    bounds: Option<Bounds>,
}

/// The upright rectangle that a polygon is, if it is one.
pub fn upright(polygon: &Polygon) -> Option<Bounds> {
    let [a, b, c, d] = *polygon.outline.as_slice() else { return None };
    let flat = |p: Vec2, q: Vec2| p.y == q.y;
    let steep = |p: Vec2, q: Vec2| p.x == q.x;
    let is = (flat(a, b) && steep(b, c) && flat(c, d) && steep(d, a))
        || (steep(a, b) && flat(b, c) && steep(c, d) && flat(d, a));
    if is && polygon.holes.is_empty() { Bounds::around([a, b, c, d]) } else { None }
}

impl Ground {
    /// The middle of its bounds; none of a wall without pieces, and of a region of several parts.
    pub fn middle(&self) -> Option<Vec2> {
        self.bounds.filter(|_| self.others.is_empty()).map(|bounds| 0.5 * (bounds.low + bounds.high))
    }

    fn polygon(polygon: &Polygon) -> Form {
        let mut rings = vec![polygon.outline.len()];
        for hole in &polygon.holes {
            rings.push(rings[rings.len() - 1] + hole.len());
        }
        Form::Polygon { edges: polygon.segments().map(Edge::new).collect(), rings }
    }

    /// A region.
    pub fn region(shape: &Shape) -> Self {
        let form = |part: &Shape| match part {
            Shape::Circle { centre, radius } => Form::Disc { centre: *centre, radius: *radius },
            Shape::Polygon(polygon) => match upright(polygon) {
                Some(bounds) => Form::Rectangle(bounds),
                None => Self::polygon(polygon),
            },
            // Parts have no parts.
            Shape::Parts(_) => Form::Wall(Vec::new()),
        };
        let mut forms = shape.parts().iter().map(form);
        let first = forms.next().unwrap_or(Form::Wall(Vec::new()));
        Self { form: first, others: forms.collect(), bounds: Some(shape.bounds()) }
    }

    /// A barrier.
    pub(super) fn barrier(obstacle: &Obstacle) -> Self {
        match obstacle {
            Obstacle::Wall(segments) => Self {
                form: Form::Wall(segments.iter().copied().map(Edge::new).collect()),
                others: Vec::new(),
                bounds: Bounds::around(segments.iter().flat_map(|s| [s.a, s.b])),
            },
            Obstacle::Solid(Shape::Polygon(polygon)) => Self {
                form: Self::polygon(polygon),
                others: Vec::new(),
                bounds: Bounds::around(polygon.outline.iter().copied()),
            },
            Obstacle::Solid(shape @ (Shape::Circle { .. } | Shape::Parts(_))) => Self::region(shape),
        }
    }

    /// The rectangle around it; `None` for a wall without pieces.
    pub(super) const fn bounds(&self) -> Option<&Bounds> {
        self.bounds.as_ref()
    }

    /// The lanes whose point is inside or on the rim.
    #[inline(always)]
    pub fn contains<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Truth<S> {
        self.others.iter().fold(self.form.contains(x, y), |inside, form| inside | form.contains(x, y))
    }

    /// The way from a point outside to the nearest point of a region; inside of edges that to the rim.
    #[inline(always)]
    pub fn way_to_rim<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> (Vector<S>, Vector<S>) {
        self.others.iter().fold(self.form.way_to_rim(x, y), |(ax, ay), form| {
            let (bx, by) = form.way_to_rim(x, y);
            let nearer = (bx * bx + by * by).simd_lt(ax * ax + ay * ay);
            (nearer.select(bx, ax), nearer.select(by, ay))
        })
    }

    /// Distance from the region: 0 inside.
    #[inline(always)]
    pub(super) fn distance<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        self.others.iter().fold(self.form.distance(x, y), |least, form| lesser(least, form.distance(x, y)))
    }

    /// Distance from the surface of a barrier or the rim of a region: negative inside.
    #[inline(always)]
    pub(super) fn signed_distance<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        let first = self.form.signed_distance(x, y);
        self.others.iter().fold(first, |least, form| lesser(least, form.signed_distance(x, y)))
    }

    /// The smaller of `best` and the distance from the barrier. Far barriers are passed over by their
    /// bounds, with a margin far above what rounding can do.
    #[inline(always)]
    pub(super) fn nearer<S: Simd>(&self, best: Vector<S>, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        if let Some(bounds) = &self.bounds {
            let zero = Vector::splat(x.simd, 0.0);
            // Below 0 the point is in a solid: of what is outside nothing is nearer.
            let reach = best.simd_lt(zero).select(zero, best);
            let far = box_squared(bounds, x, y).simd_gt(reach * reach * (1.0 + 1e-9));
            if narrow(far) == Mask::ALL {
                return best;
            }
        }
        lesser(best, self.signed_distance(x, y))
    }
}

/// Zero; NaN for a position that is no finite number, so that it is at no distance from anything.
#[inline(always)]
fn nothing<S: Simd>(x: Vector<S>, y: Vector<S>) -> Vector<S> {
    (x + y) * 0.0
}

/// How far a coordinate is beyond an interval; 0 inside.
#[inline(always)]
fn beyond<S: Simd>(v: Vector<S>, low: f64, high: f64) -> Vector<S> {
    let (low, high) = (Vector::splat(v.simd, low), Vector::splat(v.simd, high));
    let below = v.simd_lt(low).select(low - v, Vector::splat(v.simd, 0.0));
    v.simd_gt(high).select(v - high, below)
}

/// Squared distance from an upright rectangle; 0 inside.
#[inline(always)]
fn box_squared<S: Simd>(bounds: &Bounds, x: Vector<S>, y: Vector<S>) -> Vector<S> {
    let dx = beyond(x, bounds.low.x, bounds.high.x);
    let dy = beyond(y, bounds.low.y, bounds.high.y);
    dx * dx + dy * dy + nothing(x, y)
}

/// Squared distance from the nearest edge; infinite without any.
#[inline(always)]
fn nearest_squared<S: Simd>(edges: &[Edge], x: Vector<S>, y: Vector<S>) -> Vector<S> {
    let mut best = Vector::splat(x.simd, f64::INFINITY);
    for edge in edges {
        let squared = edge.distance_squared(x, y);
        best = squared.simd_lt(best).select(squared, best);
    }
    best + nothing(x, y)
}

/// The lanes whose point is within the outline and in no hole.
#[inline(always)]
fn within<S: Simd>(edges: &[Edge], rings: &[usize], x: Vector<S>, y: Vector<S>) -> Truth<S> {
    let mut inside = Truth::<S>::splat(x.simd, true);
    let mut start = 0;
    for (ring, &end) in rings.iter().enumerate() {
        let mut odd = Truth::<S>::splat(x.simd, ring > 0);
        for edge in &edges[start..end] {
            odd ^= edge.crossed(x, y);
        }
        inside &= odd;
        start = end;
    }
    inside
}
