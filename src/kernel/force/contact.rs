//! Contact: compression and sliding friction where bodies, or a body and a wall, overlap by g > 0.
//!
//! Compression k1 g pushes them apart, friction k2 g slows their relative tangential velocity (Helbing, Farkas, Vicsek
//! 2000; Given-Wilson et al. 2017, equations (4) to (6), each term once). Both are stiff: `kernel::contact` advances them in
//! sub-steps, friction pair by pair by its exact solution.

use crate::kernel::vector::{Doubles, Part, exp};
use fearless_simd::Simd;

/// The constants k1, kg/s^2, and k2, kg/(m s), of two bodies: the means of both. Two bodies of several persons do not
/// compress each other and have a friction constant of their own.
#[inline(always)]
pub(in crate::kernel) fn of_pair(
    friction: &[f64],
    (i, j): (usize, usize),
    one: (f64, f64),
    other: (f64, f64),
) -> (f64, f64) {
    if let (Some(a), Some(b)) = (friction.get(i), friction.get(j))
        && !(a + b).is_nan()
    {
        return (0.0, 0.5 * (a + b));
    }
    (0.5 * (one.0 + other.0), 0.5 * (one.1 + other.1))
}

/// Impulse of compression over `t` seconds, kg m/s.
#[inline(always)]
pub(in crate::kernel) fn compression<S: Simd>(
    part: Part<S>,
    k1: Doubles<S>,
    gap: Doubles<S>,
    t: f64,
) -> Doubles<S> {
    k1 * gap * part.c(t)
}

/// Share of the slip that friction takes away in `t` seconds: the relative tangential speed decays by `exp(-k2 g (1/m_i +
/// 1/m_j) t)`, at a wall by exp(-k2 g t/m). `inverse` is the sum of the inverse masses, 1/kg.
#[inline(always)]
pub(in crate::kernel) fn friction<S: Simd>(
    part: Part<S>,
    k2: Doubles<S>,
    gap: Doubles<S>,
    inverse: Doubles<S>,
    t: f64,
) -> Doubles<S> {
    part.c(1.0) - exp(part, -k2 * gap * inverse * part.c(t))
}
