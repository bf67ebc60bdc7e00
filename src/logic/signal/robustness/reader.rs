//! A bound of a margin over time as an operand, perhaps with its sign turned.

use crate::logic::signal::moment::Moment;
use crate::logic::signal::stream::Stream;

/// The bound, and whether its sign is turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reader<'c> {
    pub(super) curve: &'c Stream,
    pub(super) negated: bool,
}

impl Reader<'_> {
    fn value(&self, value: f64) -> f64 {
        if self.negated { -value } else { value }
    }

    /// The first moment after the piece around `at`, and the value; minus infinity where nothing is asked.
    pub(super) fn around(&self, at: Moment) -> (Moment, f64) {
        if at >= self.curve.known {
            return (Moment::MAX, f64::NEG_INFINITY);
        }
        let (end, value) = self.curve.around(at);
        (end, if self.curve.len() == 0 { f64::NEG_INFINITY } else { self.value(value) })
    }

    /// Pieces from the one around `at` on: first moment, first moment after it, value.
    pub(super) fn pieces(&self, at: Moment) -> impl Iterator<Item = (Moment, Moment, f64)> {
        self.curve.pieces(at).map(|(start, end, value)| (start, end, self.value(value)))
    }
}
