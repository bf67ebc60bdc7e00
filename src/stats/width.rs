//! Looking ahead: how many outcomes cannot yet bring a rule on successes and failures to its stop.

use super::Counts;

/// Skips the trials at which a rule cannot stop.
///
/// It is meant for rules like "the interval is narrow enough", for which, after k more trials, one of the
/// two extreme continuations (k failures, k successes) is the first to stop, and each of these, once
/// stopped, stays so. Then no continuation stops at k or before if neither extreme does at k.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Ahead {
    /// The next number of trials at which the rule must be evaluated.
    next: u64,
    /// How far the last look reached.
    stride: u64,
}

impl Ahead {
    pub(super) const fn new() -> Self {
        Self { next: 1, stride: 1 }
    }

    /// Whether `rule` holds at `counts`, evaluated only where it can.
    #[inline]
    pub(super) fn reached(&mut self, counts: Counts, limit: u64, rule: impl Fn(Counts) -> bool) -> bool {
        let n = counts.trials();
        if n < self.next {
            return false;
        }
        if n >= limit || rule(counts) {
            return true;
        }
        self.look(counts, limit, rule);
        false
    }

    #[cold]
    fn look(&mut self, counts: Counts, limit: u64, rule: impl Fn(Counts) -> bool) {
        let open = |k: u64| {
            !rule(Counts { failures: counts.failures + k, ..counts })
                && !rule(Counts { successes: counts.successes + k, ..counts })
        };
        let n = counts.trials();
        let most = limit - n;
        let cap = |k: u64| if k > most { most } else { k };
        let mut k = cap(self.stride);
        if open(k) {
            while k < most {
                let further = cap(2 * k);
                if !open(further) {
                    break;
                }
                k = further;
            }
        } else {
            while k > 0 && !open(k) {
                k /= 2;
            }
        }
        self.stride = if k > 0 { k } else { 1 };
        self.next = cap(k + 1) + n;
    }
}
