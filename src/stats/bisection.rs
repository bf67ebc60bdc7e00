//! Bisection: where a condition begins to hold.

/// The smallest number at which a condition holds, between one at which it does not and one at which it does.
pub(super) fn first(mut low: u64, mut high: u64, holds: impl Fn(u64) -> bool) -> u64 {
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// The ends of what is left after so many halvings, or of two neighbours: where a condition holds, and where not.
pub(super) fn halved(mut yes: f64, mut no: f64, most: u32, holds: impl Fn(f64) -> bool) -> (f64, f64) {
    for _ in 0..most {
        let middle = 0.5 * (yes + no);
        if middle == yes || middle == no {
            break;
        }
        if holds(middle) {
            yes = middle;
        } else {
            no = middle;
        }
    }
    (yes, no)
}
