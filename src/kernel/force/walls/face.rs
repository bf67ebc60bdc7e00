//! A face: what one straight piece of a barrier, or a barrier as a whole, does.
//!
//! A piece of a wall has two faces in one, an edge of a polygon is felt from outside alone. The nearest point of a
//! piece is the foot of the perpendicular, or an end. Where that end lies on another one, as on the hollow side of a
//! corner, a piece fades out over the first centimetres behind it, so that nothing jumps as the foot leaves it.

use super::ON;
use crate::base::geometry::{Bounds, Polygon, Segment, Vec2, cross};
use crate::base::lanes::Mask;
use crate::kernel::barrier::Surface;
use crate::kernel::vector::{Doubles, Part, Truths, larger, smaller};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Sine of an angle that is none: such pieces are in line.
const ALIGNED: f64 = 1e-7;

/// Longest way behind an end over which a face fades out, m; a shorter piece does so over its length. Where bodies are
/// farther from a straight wall than this, times sqrt(1/2), what fades out gives nothing beside its neighbour.
const FADE: f64 = 0.1;

/// What pushes.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// A piece of a wall or an edge of a polygon.
    Side(Side),
    /// A whole barrier: a disc.
    Disc,
    /// A whole barrier: a polygon, which pushes those who got into it.
    Inside,
}

/// What a face hides others behind.
#[derive(Clone, Copy, Debug)]
pub(super) enum Screen {
    Piece(Segment),
    Disc { centre: Vec2, radius: f64 },
}

impl Screen {
    /// Of a face of a barrier.
    pub(super) fn new(form: &Form, barrier: &Surface) -> Option<Self> {
        match form {
            Form::Side(side) => Some(Self::Piece(side.piece())),
            Form::Disc => {
                let half = 0.5 * (barrier.bounds.high - barrier.bounds.low);
                Some(Self::Disc { centre: barrier.centre(), radius: half.x })
            }
            // Its edges hide who is inside.
            Form::Inside => None,
        }
    }
}

/// A straight piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    a: Vec2,
    along: Vec2,
    /// One over the squared length; 0 for a point.
    inverse_square: f64,
    /// Of an edge of a polygon: which way is out, of any length. Zero in a wall.
    outward: Vec2,
    /// Whether the polygon is hollow at the ends.
    closed: [bool; 2],
    /// Its length, in ways behind an end over which it fades out.
    per_fade: f64,
}

/// The nearest point of a face to each of eight places.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Nearest<S: Simd> {
    /// Unit vector away from the surface; zero exactly on it.
    pub(in crate::kernel) nx: Doubles<S>,
    pub(in crate::kernel) ny: Doubles<S>,
    /// Distance, seen or not, negative inside a solid, m.
    pub(in crate::kernel) near: Doubles<S>,
    /// The same; infinite where the face is not seen, as from behind.
    pub(in crate::kernel) distance: Doubles<S>,
    /// Share of its force that is left behind an end that lies on another one: 1 at the foot of a perpendicular.
    pub(in crate::kernel) fading: Doubles<S>,
    /// Whether it fades out anyway: behind an end where a polygon is hollow.
    pub(in crate::kernel) fades: Truths<S>,
}

/// The nearest point of a face to one place: the fields of `Nearest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kernel) struct NearestTo {
    pub(in crate::kernel) normal: Vec2,
    pub(in crate::kernel) near: f64,
    pub(in crate::kernel) distance: f64,
    pub(in crate::kernel) fading: f64,
    pub(in crate::kernel) fades: bool,
}

impl Form {
    /// A piece beyond the reach of everybody: a door that is open.
    pub(super) const FAR: Self = Self::Side(Side {
        a: Vec2::new(1e100, 1e100),
        along: Vec2::new(0.0, 0.0),
        inverse_square: 0.0,
        outward: Vec2::new(0.0, 0.0),
        closed: [false; 2],
        per_fade: 1.0,
    });
}

impl Side {
    pub(super) fn of_wall(piece: Segment) -> Self {
        let along = piece.b - piece.a;
        let square = along.dot(&along);
        Self {
            a: piece.a,
            along,
            inverse_square: if square > 0.0 { 1.0 / square } else { 0.0 },
            outward: Vec2::zeros(),
            closed: [false; 2],
            per_fade: if along.norm() < FADE { 1.0 } else { along.norm() / FADE },
        }
    }

    pub(super) fn bounds(&self) -> Bounds {
        let b = self.a + self.along;
        Bounds { low: self.a.inf(&b), high: self.a.sup(&b) }
    }

    pub(super) fn piece(&self) -> Segment {
        Segment::new(self.a, self.a + self.along)
    }

    fn is_one_sided(&self) -> bool {
        self.outward != Vec2::zeros()
    }

    /// Where a straight way first meets the piece, which reaches `ON` beyond its ends: the share of the way, the height of
    /// its beginning over the piece, m, and the unit vector to that side. From inside an edge is not met.
    pub(super) fn meets(&self, from: Vec2, to: Vec2) -> Option<(f64, f64, Vec2)> {
        let height = |p: Vec2| cross(self.along, p - self.a);
        let (before, after) = (height(from), height(to));
        if before * after > 0.0 || before == 0.0 {
            return None;
        }
        let share = before / (before - after);
        let foot = (from + (to - from) * share - self.a).dot(&self.along) * self.inverse_square;
        let length = self.along.norm();
        let normal = Vec2::new(-self.along.y, self.along.x) * (before.signum() / length);
        let is_on = (foot - 0.5).abs() * length <= 0.5 * length + ON;
        (is_on && normal.dot(&self.outward) >= 0.0).then(|| (share, before.abs() / length, normal))
    }

    #[inline(always)]
    pub(super) fn nearest<S: Simd>(&self, part: Part<S>, x: Doubles<S>, y: Doubles<S>) -> Nearest<S> {
        let (px, py) = (x - part.c(self.a.x), y - part.c(self.a.y));
        let foot = (px * part.c(self.along.x) + py * part.c(self.along.y)) * part.c(self.inverse_square);
        let share = smaller::<S>(larger::<S>(foot, part.c(0.0)), part.c(1.0));
        let (dx, dy) = (px - share * part.c(self.along.x), py - share * part.c(self.along.y));
        // Far below any square of a distance that matters: keeps 1/0 out where the centre is on the line.
        let near = (dx * dx + dy * dy + part.c(1e-300)).sqrt();
        let q = part.c(1.0) / near;
        let mut distance = near;
        let mut fades = part.mask(Mask::NONE);
        if self.is_one_sided() {
            let height = px * part.c(self.outward.x) + py * part.c(self.outward.y);
            let seen = height.simd_ge(part.c(0.0));
            distance = seen.select(near, part.c(f64::INFINITY));
            if self.closed[0] {
                fades |= foot.simd_lt(part.c(0.0));
            }
            if self.closed[1] {
                fades |= foot.simd_gt(part.c(1.0));
            }
        }
        let behind = (foot - share).abs() * part.c(self.per_fade);
        let fading = larger::<S>(part.c(1.0) - behind, part.c(0.0));
        Nearest { nx: dx * q, ny: dy * q, near, distance, fading, fades }
    }

    /// With the operations of `nearest`.
    pub(super) fn nearest_to(&self, p: Vec2) -> NearestTo {
        let from = p - self.a;
        let foot = from.dot(&self.along) * self.inverse_square;
        let share = if foot > 0.0 { foot } else { 0.0 };
        let share = if share < 1.0 { share } else { 1.0 };
        let d = from - self.along * share;
        let near = (d.dot(&d) + 1e-300).sqrt();
        let is_seen = !self.is_one_sided() || from.dot(&self.outward) >= 0.0;
        let left = 1.0 - (foot - share).abs() * self.per_fade;
        NearestTo {
            normal: d * (1.0 / near),
            near,
            distance: if is_seen { near } else { f64::INFINITY },
            fading: if left > 0.0 { left } else { 0.0 },
            fades: self.closed[0] && foot < 0.0 || self.closed[1] && foot > 1.0,
        }
    }
}

/// As `Side::meets`, of a disc.
pub(super) fn meets_disc(disc: &Surface, from: Vec2, to: Vec2) -> Option<(f64, f64, Vec2)> {
    let radius = 0.5 * (disc.bounds.high.x - disc.bounds.low.x);
    let (start, way) = (from - disc.centre(), to - from);
    // The first root of |start + share way| = radius.
    let (square, towards) = (way.dot(&way), -start.dot(&way));
    let outside = start.dot(&start) - radius * radius;
    let root = towards * towards - square * outside;
    if outside <= 0.0 || towards <= 0.0 || root < 0.0 {
        return None;
    }
    let share = outside / (towards + root.sqrt());
    (share <= 1.0).then(|| (share, start.norm() - radius, (start + way * share) / radius))
}

/// The nearest point of a disc or, for those inside, of a polygon.
#[inline(always)]
pub(super) fn nearest_of_whole<S: Simd>(
    surface: &Surface,
    part: Part<S>,
    x: Doubles<S>,
    y: Doubles<S>,
) -> Nearest<S> {
    let (nx, ny, near) = surface.nearest(part, x, y);
    let mut distance = near;
    if surface.has_edges() {
        distance = near.simd_lt(part.c(0.0)).select(near, part.c(f64::INFINITY));
    }
    Nearest { nx, ny, near, distance, fading: part.c(0.0), fades: part.mask(Mask::NONE) }
}

/// With the operations of `nearest_of_whole`.
pub(super) fn nearest_of_whole_to(surface: &Surface, p: Vec2) -> NearestTo {
    let (normal, near) = surface.nearest_to(p);
    let is_seen = near < 0.0 || !surface.has_edges();
    let distance = if is_seen { near } else { f64::INFINITY };
    NearestTo { normal, near, distance, fading: 0.0, fades: false }
}

/// The edges of a polygon as they are felt from outside, in their order.
pub(super) fn sides_of(polygon: &Polygon) -> Vec<Side> {
    let mut sides = Vec::new();
    let holes = polygon.holes.iter().map(|hole| (hole, -1.0));
    for (ring, solid) in [(&polygon.outline, 1.0)].into_iter().chain(holes) {
        let n = ring.len();
        let along = |k: usize| ring[(k + 1) % n] - ring[k % n];
        // From its first corner, so that a ring far from the origin keeps its sense.
        let twice: f64 = (0..n).map(|k| cross(ring[k] - ring[0], along(k))).sum();
        let sense = if twice < 0.0 { -solid } else { solid };
        // Whether the polygon is hollow at the corner where edge k begins.
        let is_hollow = |k: usize| {
            let (before, after) = (along(k + n - 1), along(k));
            sense * cross(before, after) < -ALIGNED * before.norm() * after.norm()
        };
        for k in 0..n {
            let way = along(k);
            sides.push(Side {
                outward: Vec2::new(way.y, -way.x) * sense,
                closed: [is_hollow(k), is_hollow(k + 1)],
                ..Side::of_wall(Segment::new(ring[k], ring[(k + 1) % n]))
            });
        }
    }
    sides
}
