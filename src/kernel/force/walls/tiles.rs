//! The faces near each square of the plane.
//!
//! Which faces are in reach of a square is worked out once. Most squares along a wall have the same list, and in the middle of
//! a room there is none, which costs nothing.
//!
//! ```text
//!     +----+----+----+----+
//!     | 1  | 1  | 1  | 2  |          how many faces are in reach of the squares at the end of a wall with another one
//!     +====+====+====+====+====
//!     | 1  | 1  | 1  | 2  |
//!     +----+----+----+----+
//!     | 0  | 0  | 0  | 1  |
//! ```

use super::face::Form;
use super::{Face, Surfaces};
use crate::base::geometry::{Bounds, Vec2, amply_around};
use std::collections::HashMap;
use std::sync::Arc;

/// Side of a square in reaches.
const SIDE: f64 = 0.35;

/// At most about so many squares.
const MOST: f64 = 262_144.0;

/// Squares of the plane and the faces in reach of each.
#[derive(Clone, Debug, Default)]
pub(in crate::kernel) struct Tiles {
    /// Of which faces, and how far the reach is, m.
    of: Option<(Arc<()>, f64)>,
    low: Vec2,
    per_side: f64,
    columns: usize,
    rows: usize,
    /// The list of each square; the first list is empty.
    list_of: Vec<u32>,
    /// The faces of each list, ascending.
    pub(in crate::kernel) lists: Vec<Vec<u32>>,
}

impl Tiles {
    /// Makes the lists for the faces of a scene, all that are nearer than `reach`; false if they are there already.
    pub(in crate::kernel) fn prepare(&mut self, surfaces: &Surfaces, reach: f64) -> bool {
        let serves = |(mark, made): &(Arc<()>, f64)| {
            Arc::ptr_eq(mark, &surfaces.mark) && reach <= *made && *made <= 2.0 * reach
        };
        if self.of.as_ref().is_some_and(serves) {
            return false;
        }
        // A little more, as the next trial may have a larger body.
        let reach = 1.05 * reach;
        *self = Self { of: Some((surfaces.mark.clone(), reach)), lists: vec![Vec::new()], ..Self::default() };
        let corners = surfaces.faces.iter().flat_map(|face| [face.bounds.low, face.bounds.high]);
        let Some(all) = Bounds::around(corners).filter(|_| reach.is_finite()) else { return true };
        self.low = all.low - Vec2::repeat(reach);
        let size = all.high - all.low + Vec2::repeat(2.0 * reach);
        let least = (size.x * size.y / MOST).sqrt();
        let side = if SIDE * reach > least { SIDE * reach } else { least };
        self.per_side = 1.0 / side;
        (self.columns, self.rows) = ((size.x / side) as usize + 1, (size.y / side) as usize + 1);
        let mut known = HashMap::from([(Vec::new(), 0)]);
        let mut room = Vec::new();
        for row in 0..self.rows {
            for column in 0..self.columns {
                let centre = self.low + Vec2::new(column as f64 + 0.5, row as f64 + 0.5) * side;
                let beyond = reach + 0.71 * side;
                let near = surfaces.nearby.find(&amply_around(centre, beyond), &mut room);
                let is_near = |face: &u32| surfaces.apart(*face, centre) <= beyond;
                let faces: Vec<u32> = near.iter().copied().filter(is_near).collect();
                let list = *known.entry(faces).or_insert_with_key(|faces| {
                    self.lists.push(faces.clone());
                    self.lists.len() as u32 - 1
                });
                self.list_of.push(list);
            }
        }
        true
    }

    /// The list of the faces in reach of a place; 0 where there are none.
    #[inline(always)]
    pub(in crate::kernel) fn at(&self, p: Vec2) -> u32 {
        let (x, y) = ((p.x - self.low.x) * self.per_side, (p.y - self.low.y) * self.per_side);
        let is_inside = x >= 0.0 && y >= 0.0 && x < self.columns as f64 && y < self.rows as f64;
        if is_inside { self.list_of[y as usize * self.columns + x as usize] } else { 0 }
    }
}

impl Surfaces {
    /// At least how far a face is from a place, m.
    fn apart(&self, face: u32, p: Vec2) -> f64 {
        let Face { form, bounds, .. } = &self.faces[face as usize];
        match form {
            Form::Side(side) => side.piece().distance(p),
            Form::Disc | Form::Inside => bounds.distance(p),
        }
    }
}
