//! What faces that hang together give at once: the smallest that is enough along each normal.
//!
//! Faces that push with f along unit vectors n give g >= 0 such that the sum over all j of `max(0, n_i . n_j) g_j` is at
//! least `f_i`, and just that where `g_i > 0`: a linear complementarity problem. So those that push against each other,
//! or at right angles, do not know of each other. Of two at an angle, c its cosine, the first gives
//! `(f_1 - c f_2)/(1 - c^2)`, at least 0 and at most `f_1`. With more, the least of these, and so much less as they are
//! too much together, is where Jacobi's iteration begins
//! (projected, each row damped by its sum; Cottle, Pang, Stone 1992, chapter 5): all at once, so that their order does not
//! matter, and a fixed number of times, so that what comes out changes as smoothly as what goes in.

use crate::base::geometry::Vec2;
use crate::base::lanes::Lanes;
use crate::kernel::vector::{Doubles, Part, larger, smaller};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Iterations over three or more.
const ITERATIONS: usize = 16;

/// A face that pushes eight bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Push {
    /// What it hangs together with.
    pub(super) structure: u32,
    pub(super) barrier: u32,
    pub(super) nx: Lanes,
    pub(super) ny: Lanes,
    /// What it gives alone, N.
    pub(super) alone: Lanes,
    /// What it gives beside the others, N.
    pub(super) shared: Lanes,
    /// The same after the next iteration.
    pub(super) next: Lanes,
}

/// A face that pushes one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kernel) struct Touch {
    pub(super) structure: u32,
    pub(super) barrier: u32,
    /// Unit vector away from the face.
    pub(in crate::kernel) normal: Vec2,
    /// How deep the body overlaps it, m.
    pub(super) alone: f64,
    /// How deep beside the others.
    pub(in crate::kernel) depth: f64,
    /// The same after the next iteration.
    pub(super) next: f64,
}

/// What of two the first one gives.
#[inline(always)]
fn of_two<S: Simd>(part: Part<S>, c: Doubles<S>, own: Doubles<S>, other: Doubles<S>) -> Doubles<S> {
    let one = part.c(1.0);
    // (own - c other)/(1 - c^2), such that in line, c = 1, two that are equal give half each.
    own / (one + c) + c * (own - other) / (one - c * c + part.c(1e-300))
}

/// Cosine between the normals of two, 0 where they push against each other.
#[inline(always)]
fn cosine<S: Simd>(part: Part<S>, one: &Push, other: &Push) -> Doubles<S> {
    let c = part.load(&one.nx) * part.load(&other.nx) + part.load(&one.ny) * part.load(&other.ny);
    smaller::<S>(larger::<S>(c, part.c(0.0)), part.c(1.0))
}

/// Works out what each gives beside the others. Nothing of one lane is felt in another.
#[inline(always)]
pub(super) fn share<S: Simd>(part: Part<S>, pushes: &mut [Push]) {
    let (zero, one) = (part.c(0.0), part.c(1.0));
    let mut most = zero;
    for i in 0..pushes.len() {
        let own = part.load(&pushes[i].alone);
        let (mut least, mut others) = (own, zero);
        for j in 0..pushes.len() {
            if i == j || pushes[i].structure != pushes[j].structure {
                continue;
            }
            let c = cosine(part, &pushes[i], &pushes[j]);
            let other = part.load(&pushes[j].alone);
            let shares = c.simd_gt(zero) & other.simd_gt(zero) & own.simd_gt(zero);
            if shares.any_true() {
                let given = larger::<S>(of_two(part, c, own, other), zero);
                least = shares.select(smaller::<S>(given, least), least);
                others += shares.select(one, zero);
            }
        }
        most = larger::<S>(others, most);
        part.store(least, &mut pushes[i].shared);
    }
    let several = most.simd_gt(one);
    if !several.any_true() {
        return;
    }
    // Where many halve with each other they give too much together: so much less.
    for i in 0..pushes.len() {
        let mut given = part.load(&pushes[i].shared);
        for j in 0..pushes.len() {
            if i != j && pushes[i].structure == pushes[j].structure {
                given += cosine(part, &pushes[i], &pushes[j]) * part.load(&pushes[j].shared);
            }
        }
        let own = part.load(&pushes[i].alone);
        let less = given.simd_gt(own * part.c(1.0 + 1e-12));
        let shared = part.load(&pushes[i].shared);
        part.store(less.select(shared * own / given, shared), &mut pushes[i].next);
    }
    for push in &mut *pushes {
        part.store_in(several, part.load(&push.next), &mut push.shared);
    }
    for _ in 0..ITERATIONS {
        for i in 0..pushes.len() {
            let (mut given, mut row) = (zero, one);
            for j in 0..pushes.len() {
                if i != j && pushes[i].structure == pushes[j].structure {
                    let c = cosine(part, &pushes[i], &pushes[j]);
                    let c = part.load(&pushes[j].alone).simd_gt(zero).select(c, zero);
                    given += c * part.load(&pushes[j].shared);
                    row += c;
                }
            }
            let own = part.load(&pushes[i].shared);
            let wanted = larger::<S>(part.load(&pushes[i].alone) - given, zero);
            part.store(own + (wanted - own) / row, &mut pushes[i].next);
        }
        for push in &mut *pushes {
            part.store_in(several, part.load(&push.next), &mut push.shared);
        }
    }
}

/// The same for depths in contact with one body.
pub(super) fn share_depths(touches: &mut [Touch]) {
    let cosine = |one: &Touch, other: &Touch| {
        let c = one.normal.dot(&other.normal);
        let c = if c > 0.0 { c } else { 0.0 };
        if c < 1.0 { c } else { 1.0 }
    };
    let touching = |touch: &Touch| touch.alone > 0.0;
    let mut iterations = 0;
    for i in 0..touches.len() {
        let own = touches[i];
        let mut others = 0;
        if touching(&own) {
            for j in 0..touches.len() {
                let other = touches[j];
                let c = cosine(&own, &other);
                if i != j && own.structure == other.structure && touching(&other) && c > 0.0 {
                    others += 1;
                    let given =
                        own.alone / (1.0 + c) + c * (own.alone - other.alone) / (1.0 - c * c + 1e-300);
                    let given = if given > 0.0 { given } else { 0.0 };
                    let least = touches[i].depth;
                    touches[i].depth = if given < least { given } else { least };
                }
            }
        }
        if others > 1 {
            iterations = ITERATIONS;
        }
    }
    if iterations > 0 {
        for i in 0..touches.len() {
            let own = touches[i];
            let fellow =
                |(j, other): &(usize, &Touch)| *j != i && own.structure == other.structure && touching(other);
            let others = touches.iter().enumerate().filter(fellow);
            let given = others.fold(own.depth, |sum, (_, other)| sum + cosine(&own, other) * other.depth);
            let is_less = touching(&own) && given > own.alone * (1.0 + 1e-12);
            touches[i].next = if is_less { own.depth * own.alone / given } else { own.depth };
        }
        for touch in &mut *touches {
            touch.depth = touch.next;
        }
    }
    for _ in 0..iterations {
        for i in 0..touches.len() {
            let own = touches[i];
            if touching(&own) {
                let (mut given, mut row) = (0.0, 1.0);
                for (j, other) in touches.iter().enumerate() {
                    if j != i && own.structure == other.structure && touching(other) {
                        given += cosine(&own, other) * other.depth;
                        row += cosine(&own, other);
                    }
                }
                let wanted = if own.alone > given { own.alone - given } else { 0.0 };
                touches[i].next = own.depth + (wanted - own.depth) / row;
            }
        }
        for touch in touches.iter_mut().filter(|touch| touching(touch)) {
            touch.depth = touch.next;
        }
    }
}
