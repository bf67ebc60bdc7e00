//! Arithmetic of one lane.

use crate::model::{Arithmetic, Function};

/// A function of one number.
#[inline(always)]
pub(super) fn apply(function: Function, x: f64) -> f64 {
    function.of(x)
}

/// Arithmetic of two numbers.
#[inline(always)]
pub(super) fn combine(operator: Arithmetic, a: f64, b: f64) -> f64 {
    operator.of(a, b)
}
