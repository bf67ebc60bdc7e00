//! What faces that touch give together.
//!
//! A face that would give `f_i` alone gives `f_i^4 / sum_j f_j^3 max(0, n_i . n_j)` beside the others that it touches, with
//! n the unit vectors along which they push, and j over all of them, itself included. So faces that push against each
//! other or at right angles do not share. Two equal ones at any angle give together, along each normal, what one gives
//! alone; several equal ones in the same direction give what one does, and of two unequal ones in the same direction
//! the sum is at most 8 % below the stronger one. The order of faces does not matter, and nothing jumps.

use crate::base::lanes::Lanes;
use crate::kernel::vector::{Part, larger};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Cosine that rounding may make of a right angle, amply: there a weak face must not share with a strong one.
const ROUNDING: f64 = 1e-12;

/// A face that pushes eight bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::kernel) struct Push {
    /// The first of the faces that it touches, directly or by others.
    pub(super) structure: u32,
    pub(super) barrier: u32,
    /// Unit vector away from the face.
    pub(in crate::kernel) nx: Lanes,
    pub(in crate::kernel) ny: Lanes,
    /// What it gives alone: a force, or the depth to which a body overlaps it.
    pub(super) alone: Lanes,
    /// The third power of that, relative to the largest of all.
    pub(super) cube: Lanes,
    /// What it gives beside the others.
    pub(in crate::kernel) shared: Lanes,
}

/// Works out what each face gives beside the others.
#[inline(always)]
pub(super) fn share<S: Simd>(part: Part<S>, pushes: &mut [Push]) {
    let zero = part.c(0.0);
    let mut most = part.c(1e-300);
    for push in &*pushes {
        most = larger::<S>(part.load(&push.alone), most);
    }
    for push in &mut *pushes {
        let relative = part.load(&push.alone) / most;
        part.store(relative * relative * relative, &mut push.cube);
    }
    for i in 0..pushes.len() {
        let own = &pushes[i];
        let (nx, ny, cube) = (part.load(&own.nx), part.load(&own.ny), part.load(&own.cube));
        let mut sum = cube;
        for (j, other) in pushes.iter().enumerate() {
            if j != i && other.structure == own.structure {
                let cosine = nx * part.load(&other.nx) + ny * part.load(&other.ny) - part.c(ROUNDING);
                sum += larger::<S>(cosine, zero) * part.load(&other.cube);
            }
        }
        let weight = cube.simd_gt(zero).select(cube / sum, zero);
        part.store(part.load(&own.alone) * weight, &mut pushes[i].shared);
    }
}
