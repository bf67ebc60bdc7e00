//! Distance of a projected trace and an observation, `D_trace`:
//! `D² = |Δx|² + (1 s · |Δv| / 2)²`, without the second term where one side has no velocity.

use crate::base::geometry::Vec2;

/// Position, m, and velocity, m/s, if it is known.
pub(super) type Placed = (Vec2, Option<Vec2>);

/// `D_trace`, m; `discount` divides the difference of velocities.
pub(super) fn distance((a, v): Placed, (b, w): Placed, discount: f64) -> f64 {
    let speed = match (v, w) {
        (Some(v), Some(w)) => (v - w).norm_squared() / (discount * discount),
        _ => 0.0,
    };
    ((a - b).norm_squared() + speed).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_count_half_and_only_if_both_are_known() {
        let (a, b) = (Vec2::new(0.0, 0.0), Vec2::new(3.0, 0.0));
        let fast = Some(Vec2::new(0.0, 8.0));
        assert_eq!(distance((a, fast), (b, Some(Vec2::zeros())), 2.0), 5.0);
        assert_eq!(distance((a, fast), (b, None), 2.0), 3.0);
        assert_eq!(distance((a, None), (b, fast), 2.0), 3.0);
    }
}
