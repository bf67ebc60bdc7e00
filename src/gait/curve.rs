//! The curve of a step: the cubic spline through its landmarks, equally spaced in time, with not-a-knot ends (de Boor 1978), as
//! cubic pieces between velocities.

use super::step::{SPANS, Shape};
use crate::base::geometry::Vec2;

/// A curve over the share of the duration of its step, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Where the spans begin and end, m.
    places: [Vec2; SPANS + 1],
    /// Change of the place there, m a span.
    rises: [Vec2; SPANS + 1],
}

impl Curve {
    /// The curve of a step.
    pub fn through(shape: &Shape) -> Self {
        let mut p = [Vec2::zeros(); SPANS + 1];
        p[1..].copy_from_slice(&shape.landmarks);
        // Inner spans: d[k-1] + 4 d[k] + d[k+1] = 3 (p[k+1] - p[k-1]). At the ends the third derivatives of the first two spans
        // are equal: d[0] - d[2] = 2 (p[1] - p[0]) - 2 (p[2] - p[1]), by which d[0] leaves the first equation.
        let mut d = [Vec2::zeros(); SPANS + 1];
        let mut diagonal = [4.0; SPANS + 1];
        for k in 1..SPANS {
            d[k] = (p[k + 1] - p[k - 1]) * 3.0;
        }
        let start = (p[1] - p[0]) * 2.0 - (p[2] - p[1]) * 2.0;
        let end = (p[SPANS] - p[SPANS - 1]) * 2.0 - (p[SPANS - 1] - p[SPANS - 2]) * 2.0;
        d[1] -= start;
        d[SPANS - 1] -= end;
        // Elimination from below: the equation of k has `below` before d[k-1] and `above` before d[k+1].
        let above = |k: usize| if k == 1 { 2.0 } else { 1.0 };
        let below = |k: usize| if k == SPANS - 1 { 2.0 } else { 1.0 };
        for k in 2..SPANS {
            let factor = below(k) / diagonal[k - 1];
            diagonal[k] -= factor * above(k - 1);
            d[k] -= d[k - 1] * factor;
        }
        d[SPANS - 1] /= diagonal[SPANS - 1];
        for k in (1..SPANS - 1).rev() {
            d[k] = (d[k] - d[k + 1] * above(k)) / diagonal[k];
        }
        d[0] = d[2] + start;
        d[SPANS] = d[SPANS - 2] + end;
        Self { places: p, rises: d }
    }

    /// The span of a share and the place in it, from 0 to 1.
    fn span(share: f64) -> (usize, f64) {
        let at = share.clamp(0.0, 1.0) * SPANS as f64;
        let k = (at as usize).min(SPANS - 1);
        (k, at - k as f64)
    }

    /// The place at a share of the duration, m.
    pub fn place(&self, share: f64) -> Vec2 {
        let (k, t) = Self::span(share);
        let (p, q, v, w) = (self.places[k], self.places[k + 1], self.rises[k], self.rises[k + 1]);
        let rise = q - p;
        p + (v + (rise * 3.0 - v * 2.0 - w + (v + w - rise * 2.0) * t) * t) * t
    }

    /// The change of the place there over the whole duration, m.
    pub fn rise(&self, share: f64) -> Vec2 {
        let (k, t) = Self::span(share);
        let (p, q, v, w) = (self.places[k], self.places[k + 1], self.rises[k], self.rises[k + 1]);
        let rise = q - p;
        (v + ((rise * 3.0 - v * 2.0 - w) * 2.0 + (v + w - rise * 2.0) * (3.0 * t)) * t) * SPANS as f64
    }

    /// The direction there, of length 1; +x where the root stands still.
    pub fn tangent(&self, share: f64) -> Vec2 {
        let rise = self.rise(share);
        let norm = rise.norm();
        if norm > 1e-9 { rise / norm } else { Vec2::x() }
    }

    /// An upper bound of the second derivative of the place by the share, m. It is linear in each span, so its ends decide.
    pub fn bend(&self) -> f64 {
        let spans = SPANS as f64;
        let at = |k: usize| {
            let (p, q, v, w) = (self.places[k], self.places[k + 1], self.rises[k], self.rises[k + 1]);
            let rise = (q - p) * 6.0;
            (rise - v * 4.0 - w * 2.0).norm().max((rise - w * 4.0 - v * 2.0).norm())
        };
        (0..SPANS).map(at).fold(0.0, f64::max) * spans * spans
    }

    /// Its length, m, by five Gauss-Legendre points a span.
    pub fn length(&self) -> f64 {
        const POINTS: [(f64, f64); 5] = [
            (0.046_910_077_030_668, 0.118_463_442_528_094_5),
            (0.230_765_344_947_158_5, 0.239_314_335_249_683_2),
            (0.5, 0.284_444_444_444_444_4),
            (0.769_234_655_052_841_5, 0.239_314_335_249_683_2),
            (0.953_089_922_969_332, 0.118_463_442_528_094_5),
        ];
        let spans = SPANS as f64;
        let at = |k: usize| {
            POINTS.map(|(t, weight)| weight * self.rise((k as f64 + t) / spans).norm()).iter().sum::<f64>()
        };
        (0..SPANS).map(at).sum::<f64>() / spans
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]

    use super::*;

    fn shape(of: impl Fn(f64) -> Vec2) -> Shape {
        let landmarks = std::array::from_fn(|k| of((k + 1) as f64 / SPANS as f64) - of(0.0));
        Shape { landmarks, duration: 0.5 }
    }

    #[test]
    fn a_cubic_is_met_exactly() {
        // A spline with not-a-knot ends reproduces any cubic polynomial.
        let of = |t: f64| Vec2::new(0.7 * t - 0.2 * t * t + 0.1 * t * t * t, 0.3 * t * t - 0.25 * t * t * t);
        let rise = |t: f64| Vec2::new(0.7 - 0.4 * t + 0.3 * t * t, 0.6 * t - 0.75 * t * t);
        let curve = shape(of).curve();
        for k in 0..=100 {
            let t = f64::from(k) / 100.0;
            assert!((curve.place(t) - of(t)).norm() < 1e-14, "{t}");
            assert!((curve.rise(t) - rise(t)).norm() < 1e-13, "{t}");
        }
    }

    #[test]
    fn speed_and_its_change_do_not_jump_between_spans() {
        let curve = shape(|t| Vec2::new(0.7 * t, 0.03 * (9.0 * t).sin())).curve();
        let second = |t: f64| (curve.rise(t + 1e-6) - curve.rise(t - 1e-6)) / 2e-6;
        for k in 1..SPANS {
            let t = k as f64 / SPANS as f64;
            assert!((curve.rise(t - 1e-9) - curve.rise(t + 1e-9)).norm() < 1e-6);
            assert!((second(t - 1e-5) - second(t + 1e-5)).norm() < 1e-2, "{t}");
        }
    }

    #[test]
    fn an_arc_has_its_length_and_begins_along_x_when_aligned() {
        let arc = shape(|t| Vec2::new((0.3 + t * 0.8).cos(), (0.3 + t * 0.8).sin()));
        assert!((arc.curve().length() - 0.8).abs() < 1e-5);
        let begins = arc.aligned().curve().tangent(0.0);
        assert!((begins - Vec2::x()).norm() < 1e-12);
        assert!((arc.aligned().curve().length() - 0.8).abs() < 1e-5);
    }
}
