//! The smallest gap that is certified: the root of the evidence less its threshold, which rises with the gap.
//!
//! The root lies between two neighbours of a lattice of 2^20 points, those that bisection would visit; regula
//! falsi in the form of Illinois (Dowell and Jarratt 1971) finds them in fewer steps. The answer is the
//! upper neighbour, at which the evidence was computed.

/// Halvings of the largest gap: the answer is within a millionth of it.
const STEPS: u32 = 20;

/// A point of the lattice: where halvings of `0 .. most` would come to, with the same rounding.
fn point(place: u32, most: f64) -> f64 {
    let (mut low, mut high) = ((0u32, 0.0), (1 << STEPS, most));
    if place == 0 {
        return 0.0;
    }
    while place != high.0 {
        let middle = (low.0 + (high.0 - low.0) / 2, 0.5 * (low.1 + high.1));
        if place > middle.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high.1
}

/// The smallest point of the lattice at which `excess`, which rises, is not below 0; it is taken for granted that
/// it is not at `most`.
pub(super) fn smallest(most: f64, mut excess: impl FnMut(f64) -> f64) -> f64 {
    let mut low = (0u32, excess(0.0));
    if low.1 >= 0.0 {
        return 0.0;
    }
    let end = excess(most);
    let mut high = (1u32 << STEPS, if end > 0.0 { end } else { 0.0 });
    // Which end moved last, and how often in a row the bracket was not halved.
    let (mut moved_up, mut slow) = (None, 0);
    while high.0 - low.0 > 1 {
        let width = high.0 - low.0;
        let part = low.1 / (low.1 - high.1);
        let guess = low.0 + (part * f64::from(width)).ceil() as u32;
        let place = if slow < 2 { guess.clamp(low.0 + 1, high.0 - 1) } else { low.0 + width / 2 };
        let value = excess(point(place, most));
        if value < 0.0 {
            low = (place, value);
            if moved_up == Some(true) {
                high.1 *= 0.5;
            }
            moved_up = Some(true);
        } else {
            high = (place, value);
            if moved_up == Some(false) {
                low.1 *= 0.5;
            }
            moved_up = Some(false);
        }
        slow = if 2 * (high.0 - low.0) > width { slow + 1 } else { 0 };
    }
    point(high.0, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math;

    fn bisected(most: f64, excess: impl Fn(f64) -> f64) -> f64 {
        if excess(0.0) >= 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, most);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if excess(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    #[test]
    fn it_finds_what_bisection_finds_in_fewer_steps() {
        let shapes: [fn(f64, f64) -> f64; 4] = [
            |gap, root| gap - root,
            |gap, root| 500.0 * (math::ln(1.0 + 0.3 * gap) - math::ln(1.0 + 0.3 * root)),
            |gap, root| math::exp(30.0 * gap) - math::exp(30.0 * root),
            |gap, root| if gap < root { -1e-3 } else { 40.0 * (gap - root) + 1e-9 },
        ];
        for most in [0.02, 0.3, 1.0] {
            for share in [0.0, 1e-7, 0.001, 0.123_456, 0.5, 0.9, 0.999_999_9, 1.0] {
                for (k, shape) in shapes.iter().enumerate() {
                    let root = share * most;
                    let mut calls = 0;
                    let found = smallest(most, |gap| {
                        calls += 1;
                        shape(gap, root)
                    });
                    assert_eq!(
                        found.to_bits(),
                        bisected(most, |gap| shape(gap, root)).to_bits(),
                        "{k} {root}"
                    );
                    assert!(
                        calls <= if k < 2 { STEPS } else { 62 },
                        "{calls} calls of {k} for {root} of {most}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_never_reached_is_the_largest() {
        assert_eq!(smallest(1.0, |_| -1.0), 1.0);
        assert_eq!(smallest(0.02, |_| 0.0), 0.0);
    }
}
