//! Barriers between two bodies: through a wall or an obstacle nobody feels the social force of another one.
//!
//! A face hides two bodies from each other where it crosses the line between their centres (a disc where the line passes
//! through it). So a force ends where the line of sight comes to an end of a wall. Whoever got into an obstacle and whoever is
//! outside do not feel each other. Contact is not affected: bodies that reach around an end touch.
//!
//! Most faces have all people on one side, as the walls of a room that nobody leaves: they are sorted out beforehand, for
//! everybody at once.

use super::Surfaces;
use super::face::Screen;
use crate::base::geometry::{Bounds, Vec2, cross};
use crate::base::lanes::Mask;
use crate::kernel::vector::{Doubles, Part, Truths, larger, smaller};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

impl Surfaces {
    fn screen(&self, face: u32) -> Option<Screen> {
        self.faces[face as usize].screen
    }

    /// Lists the faces that can stand between two places of a rectangle, ascending.
    pub(in crate::kernel) fn list_screens(&self, around: &Bounds, out: &mut Vec<u32>) {
        out.clear();
        let Bounds { low, high } = *around;
        let corners = [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)];
        let divides = |face: &u32| match self.screen(*face) {
            Some(Screen::Piece(piece)) => {
                let along = piece.b - piece.a;
                let sides = corners.map(|corner| cross(along, corner - piece.a));
                sides.iter().any(|&side| side > 0.0) && sides.iter().any(|&side| side < 0.0)
            }
            Some(Screen::Disc { .. }) => true,
            None => false,
        };
        let meets = |face: &u32| {
            let bounds = &self.faces[*face as usize].bounds;
            bounds.low.x <= high.x
                && bounds.low.y <= high.y
                && low.x <= bounds.high.x
                && low.y <= bounds.high.y
        };
        out.extend((0..self.faces.len() as u32).filter(|face| meets(face) && divides(face)));
    }

    /// Where a face may come between two bodies while neither goes farther than `slack`.
    #[inline(always)]
    pub(in crate::kernel) fn may_hide<S: Simd>(
        &self,
        face: u32,
        part: Part<S>,
        (x, y): (Doubles<S>, Doubles<S>),
        (other_x, other_y): (Doubles<S>, Doubles<S>),
        slack: f64,
    ) -> Truths<S> {
        let bounds = &self.faces[face as usize].bounds;
        let slack_of_all = part.c(slack);
        let beside = |v: Doubles<S>, other: Doubles<S>, low: f64, high: f64| {
            (larger::<S>(v, other) + slack_of_all).simd_lt(part.c(low))
                | (smaller::<S>(v, other) - slack_of_all).simd_gt(part.c(high))
        };
        let apart =
            beside(x, other_x, bounds.low.x, bounds.high.x) | beside(y, other_y, bounds.low.y, bounds.high.y);
        let Some(Screen::Piece(piece)) = self.screen(face) else { return !apart };
        let along = piece.b - piece.a;
        let side = |x: Doubles<S>, y: Doubles<S>| {
            part.c(along.x) * (y - part.c(piece.a.y)) - part.c(along.y) * (x - part.c(piece.a.x))
        };
        let (one, other) = (side(x, y), side(other_x, other_y));
        let limit = part.c(slack * along.norm());
        let same = smaller::<S>(one, other).simd_gt(limit) | larger::<S>(one, other).simd_lt(-limit);
        !(apart | same)
    }

    /// Where a face is between two bodies.
    #[inline(always)]
    pub(in crate::kernel) fn hides<S: Simd>(
        &self,
        face: u32,
        part: Part<S>,
        (x, y): (Doubles<S>, Doubles<S>),
        (other_x, other_y): (Doubles<S>, Doubles<S>),
    ) -> Truths<S> {
        let zero = part.c(0.0);
        let (dx, dy) = (other_x - x, other_y - y);
        match self.screen(face) {
            Some(Screen::Piece(piece)) => {
                let (ax, ay) = (part.c(piece.a.x) - x, part.c(piece.a.y) - y);
                let along = piece.b - piece.a;
                let (lx, ly) = (part.c(along.x), part.c(along.y));
                // On which side of the piece both are, and of the line between them its ends.
                let one = ax * ly - ay * lx;
                let other = one + (lx * dy - ly * dx);
                let start = dx * ay - dy * ax;
                let end = start + (dx * ly - dy * lx);
                (one * other).simd_lt(zero) & (start * end).simd_le(zero)
            }
            Some(Screen::Disc { centre, radius }) => {
                let (cx, cy) = (part.c(centre.x) - x, part.c(centre.y) - y);
                let share = (cx * dx + cy * dy) / (dx * dx + dy * dy + part.c(1e-300));
                let share = smaller::<S>(larger::<S>(share, zero), part.c(1.0));
                let (mx, my) = (cx - dx * share, cy - dy * share);
                (mx * mx + my * my).simd_lt(part.c(radius * radius))
            }
            None => part.mask(Mask::NONE),
        }
    }

    /// Where any of some faces is between two bodies.
    #[inline(always)]
    pub(in crate::kernel) fn hide<S: Simd>(
        &self,
        faces: &[u32],
        part: Part<S>,
        place: (Doubles<S>, Doubles<S>),
        other: (Doubles<S>, Doubles<S>),
    ) -> Truths<S> {
        let mut hidden = part.mask(Mask::NONE);
        for &face in faces {
            hidden |= self.hides(face, part, place, other);
        }
        hidden
    }
}

/// Where faces hide two bodies from each other in lanes with different doors closed.
#[cold]
#[inline(never)]
pub(in crate::kernel) fn hidden_by_doors<S: Simd>(
    simd: S,
    surfaces: &[(&Surfaces, Mask)],
    screens: &[u32],
    part: Part<S>,
    place: (Doubles<S>, Doubles<S>),
    other: (Doubles<S>, Doubles<S>),
) -> Truths<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let each = surfaces.iter();
            let hide = |(surfaces, lanes): &(&Surfaces, Mask)| {
                surfaces.hide(screens, part, place, other) & part.mask(*lanes)
            };
            each.map(hide).fold(part.mask(Mask::NONE), |all, one| all | one)
        },
    )
}
