//! The level gamma at which sequential Clopper-Pearson misses with probability at most delta: the proven
//! table, and the proof itself for other half-widths and errors.
//!
//! Given the number of successes, all orders are equally likely, so the probability R of reaching a point
//! (n, s) without an earlier stop, among all orders, is free of p; one pass over the lattice finds it. For
//! an interval [c, d] of p, noncoverage is at most `P_c(U < d) + P_d(L > c)`, because a larger p only moves
//! the stopping point along the boundary, on which both ends rise (checked). Branch and bound over [0, 1/2]
//! closes the proof; the other half is its mirror.

use super::{Counts, clopper_pearson, okamoto};
use crate::base::math;
use crate::base::special::ln_gamma;
use std::cell::Cell;

/// Smallest half-width for which a proof is tried.
const LEAST_EPSILON: f64 = 0.005;
/// Largest size of Okamoto's plan for which it is: the time of a proof grows with its square, and is seconds at this one.
const LARGEST_PLAN: u64 = 60_000;
/// Largest error worth a proof: beyond, trials are so few that the bound is loose.
const MOST_DELTA: f64 = 0.3;
/// Rounding that the proof allows for.
const ROUNDING: f64 = 1e-8;
/// Most work of a proof, in cells of the lattice: a few seconds. It is counted and not timed, so that a proof comes to the
/// same on every machine.
const MOST_WORK: u64 = 6_000_000_000;
/// The work of one stop in a bound, in cells of the lattice.
const STOP_WORK: u64 = 8;
/// No proven level is a larger share of delta than this.
pub(super) const LARGEST_SHARE: f64 = 0.76;
/// Tried levels over delta, the largest first; those above the second number hardly ever hold for errors
/// of 0.02 and below, and are left out there.
const LADDER: ([f64; 8], f64) = ([LARGEST_SHARE, 0.72, 0.68, 0.64, 0.60, 0.55, 0.48, 0.40], 0.65);

/// A proven level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Half-width.
    pub epsilon: f64,
    /// Error.
    pub delta: f64,
    /// Level of the intervals.
    pub gamma: f64,
}

/// The proven levels.
#[derive(Clone, Copy, Debug)]
pub struct Table;

impl Table {
    /// All rows; `Boundary::proves` holds for each of them: a test for half-widths of 0.005 and more, the bench
    /// `statistics -- proofs` for the smaller ones, whose proofs take up to minutes.
    pub const ROWS: [Row; 27] = [
        Row { epsilon: 0.1, delta: 0.05, gamma: 0.033 },
        Row { epsilon: 0.05, delta: 0.05, gamma: 0.035 },
        Row { epsilon: 0.05, delta: 0.01, gamma: 0.006 },
        Row { epsilon: 0.02, delta: 0.05, gamma: 0.036 },
        Row { epsilon: 0.02, delta: 0.01, gamma: 0.006 },
        Row { epsilon: 0.01, delta: 0.1, gamma: 0.076 },
        Row { epsilon: 0.01, delta: 0.05, gamma: 0.036 },
        Row { epsilon: 0.01, delta: 0.01, gamma: 0.006 },
        Row { epsilon: 0.1, delta: 0.1, gamma: 0.068 },
        Row { epsilon: 0.1, delta: 0.02, gamma: 0.012_8 },
        Row { epsilon: 0.1, delta: 0.01, gamma: 0.006 },
        Row { epsilon: 0.05, delta: 0.1, gamma: 0.076 },
        Row { epsilon: 0.05, delta: 0.02, gamma: 0.012 },
        Row { epsilon: 0.02, delta: 0.1, gamma: 0.076 },
        Row { epsilon: 0.02, delta: 0.02, gamma: 0.012_8 },
        Row { epsilon: 0.01, delta: 0.02, gamma: 0.012_8 },
        Row { epsilon: 0.005, delta: 0.1, gamma: 0.076 },
        Row { epsilon: 0.005, delta: 0.05, gamma: 0.036 },
        Row { epsilon: 0.005, delta: 0.02, gamma: 0.012_8 },
        Row { epsilon: 0.005, delta: 0.01, gamma: 0.006_4 },
        Row { epsilon: 0.004, delta: 0.05, gamma: 0.036 },
        Row { epsilon: 0.004, delta: 0.01, gamma: 0.006_4 },
        Row { epsilon: 0.003, delta: 0.05, gamma: 0.036 },
        Row { epsilon: 0.003, delta: 0.01, gamma: 0.006_4 },
        Row { epsilon: 0.002, delta: 0.05, gamma: 0.036 },
        Row { epsilon: 0.002, delta: 0.01, gamma: 0.006_4 },
        Row { epsilon: 0.001, delta: 0.05, gamma: 0.036 },
    ];

    /// The row of a half-width and an error, if there is one; 1 - 0.95 counts as 0.05.
    pub fn row(epsilon: f64, delta: f64) -> Option<Row> {
        let same = |x: f64, y: f64| (x - y).abs() <= 1e-12;
        Self::ROWS.into_iter().find(|row| same(row.epsilon, epsilon) && same(row.delta, delta))
    }

    /// The row of the same half-width with the largest error that is not above `delta`: it keeps the promise too.
    pub fn row_below(epsilon: f64, delta: f64) -> Option<Row> {
        let below = |row: &Row| (row.epsilon - epsilon).abs() <= 1e-12 && row.delta <= delta;
        Self::ROWS.into_iter().filter(below).max_by(|a, b| a.delta.total_cmp(&b.delta))
    }
}

/// When a proof is given up. Nothing that it says ever leads to another procedure: which one it is comes from the
/// half-width and the error alone.
#[derive(Clone, Copy)]
pub struct Patience<'g> {
    /// Whether to go on; once it says no, nothing more is sampled.
    pub go_on: &'g dyn Fn() -> bool,
}

impl Patience<'_> {
    /// Never.
    pub const ENDLESS: Patience<'static> = Patience { go_on: &|| true };
}

/// Whether there is a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// Proven.
    Proven(f64),
    /// Not worth a proof, or no level of the ladder can be proven.
    None,
}

/// What is known of the level for a half-width and an error without a proof: that of the table, or of a row of a smaller
/// error. That one spares a proof, which takes a second at half-widths near 0.01, where the errors are alike: at 0.8 of
/// the error a few percent more trials are needed, at half of it up to two fifths more. (A list of estimates shares its error,
/// and so asks for errors such as 0.05/3.) `None` where it takes a proof to know.
pub fn known(epsilon: f64, delta: f64) -> Option<Level> {
    let alike = if epsilon < 0.02 { 0.5 } else { 0.8 };
    let below = Table::row_below(epsilon, delta);
    let row = Table::row(epsilon, delta).or_else(|| below.filter(|row| row.delta >= alike * delta));
    if let Some(row) = row {
        return Some(Level::Proven(row.gamma));
    }
    let affordable = is_affordable(epsilon, math::at_most(delta, MOST_DELTA));
    (!affordable).then(|| below.map_or(Level::None, |row| Level::Proven(row.gamma)))
}

/// The level for a half-width and an error, proven here and now where it is not known; `None` if that is given up.
pub fn level(epsilon: f64, delta: f64, patience: Patience<'_>) -> Option<Level> {
    known(epsilon, delta).or_else(|| {
        match calibrate(epsilon, math::at_most(delta, MOST_DELTA), patience.go_on) {
            Some(gamma) => Some(Level::Proven(gamma)),
            None if !(patience.go_on)() => None,
            None => {
                Some(Table::row_below(epsilon, delta).map_or(Level::None, |row| Level::Proven(row.gamma)))
            }
        }
    })
}

/// A point where the procedure can stop.
#[derive(Clone, Copy, Debug)]
struct Stop {
    successes: f64,
    failures: f64,
    /// Logarithm of the number of ways to get there.
    ln_ways: f64,
    low: f64,
    high: f64,
}

/// All stopping points, from few successes to many.
#[derive(Clone, Debug)]
pub struct Boundary {
    stops: Vec<Stop>,
}

impl Boundary {
    /// Follows the procedure of half-width `epsilon` at level `gamma`. None if the ends of the intervals
    /// do not rise along the boundary or a stop is too wide, which no level met so far.
    pub fn new(epsilon: f64, gamma: f64) -> Option<Self> {
        Self::while_patient(epsilon, gamma, &|_| true)
    }

    /// The same; `None` too where it is given up. `go_on` is told of the work since it was asked last.
    fn while_patient(epsilon: f64, gamma: f64, go_on: &dyn Fn(u64) -> bool) -> Option<Self> {
        let limit = clopper_pearson::size(epsilon, gamma) as usize;
        let mut ln_factorial = Vec::with_capacity(limit + 1);
        for n in 0..=limit {
            ln_factorial.push(ln_gamma(n as f64 + 1.0));
        }
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        // Shares of orders that reach s successes in n trials without a stop, for s in first ..= last.
        let mut reach = vec![0.0; limit + 2];
        let mut next = vec![0.0; limit + 2];
        let whole: Vec<f64> = (0..limit + 2).map(|s| s as f64).collect();
        reach[0] = 1.0;
        let (mut first, mut last) = (0, 0);
        let mut open_from = 0;
        for n in 1..=limit {
            let total = n as f64;
            if n.is_multiple_of(256) && !go_on(256 * (last - first) as u64) {
                return None;
            }
            // Going on is possible for s in open_from ..= n - open_from.
            while 2 * open_from <= n
                && (n == limit
                    || clopper_pearson::narrow(
                        Counts { successes: open_from as u64, failures: (n - open_from) as u64 },
                        gamma,
                        2.0 * epsilon,
                    ))
            {
                open_from += 1;
            }
            next[first] = reach[first] * ((total - first as f64) / total);
            // The middle cells, as one plain loop: this is where the time goes.
            let per_trial = 1.0 / total;
            let (from, to) = (&reach[first..last], &reach[first + 1..=last]);
            let cells = next[first + 1..=last].iter_mut().zip(from).zip(to);
            for (((cell, before), same), s) in cells.zip(&whole[first + 1..=last]) {
                *cell = (before * s + same * (total - s)) * per_trial;
            }
            next[last + 1] = reach[last] * ((last + 1) as f64 / total);
            last += 1;
            std::mem::swap(&mut reach, &mut next);
            let stop = |s: usize, reach: &[f64]| {
                let ways = ln_factorial[n] - ln_factorial[s] - ln_factorial[n - s] + math::ln(reach[s]);
                let counts = Counts { successes: s as u64, failures: (n - s) as u64 };
                let interval = clopper_pearson::interval(counts, gamma);
                Stop {
                    successes: s as f64,
                    failures: (n - s) as f64,
                    ln_ways: ways,
                    low: interval.low,
                    high: interval.high,
                }
            };
            if n < 2 * open_from {
                // The interval is narrow whatever the outcomes: all that is left stops here.
                for s in first..=last {
                    lower.push(stop(s, &reach));
                }
                break;
            }
            while first < open_from {
                lower.push(stop(first, &reach));
                first += 1;
            }
            while last > n - open_from {
                upper.push(stop(last, &reach));
                last -= 1;
            }
        }
        upper.reverse();
        lower.append(&mut upper);
        let rising = lower.windows(2).all(|w| w[0].low <= w[1].low && w[0].high <= w[1].high);
        let narrow = lower.iter().all(|stop| stop.high - stop.low <= 2.0 * epsilon + 1e-9);
        (rising && narrow).then_some(Self { stops: lower })
    }

    /// The probability at `p` of the stops of `range`.
    fn mass(&self, p: f64, range: std::ops::Range<usize>) -> f64 {
        let (ln_p, ln_q) = (math::ln(p), math::ln_1p(-p));
        let mut sum = 0.0;
        for stop in &self.stops[range] {
            let from_successes = if stop.successes == 0.0 { 0.0 } else { stop.successes * ln_p };
            let ln_mass = stop.ln_ways + from_successes + stop.failures * ln_q;
            if ln_mass > -45.0 {
                sum += math::exp(ln_mass);
            }
        }
        sum
    }

    /// The probability at `p`, in (0, 1), that the interval misses it.
    pub fn miss(&self, p: f64) -> f64 {
        let below = self.stops.partition_point(|stop| stop.high < p);
        let above = self.stops.partition_point(|stop| stop.low <= p);
        self.mass(p, 0..below) + self.mass(p, above..self.stops.len())
    }

    /// The largest number of trials.
    pub fn limit(&self) -> u64 {
        self.stops.iter().map(|stop| (stop.successes + stop.failures) as u64).fold(0, u64::max)
    }

    /// A bound on the probability of missing, for all p in [c, d].
    fn bound(&self, c: f64, d: f64) -> f64 {
        let below = self.stops.partition_point(|stop| stop.high < d);
        let above = self.stops.partition_point(|stop| stop.low <= c);
        self.mass(c, 0..below) + self.mass(d, above..self.stops.len())
    }

    /// Whether the probability of missing is proven to be at most `delta` for every p.
    pub fn proves(&self, delta: f64) -> bool {
        self.proves_while_patient(delta, &|_| true)
    }

    /// The same; not so where it is given up.
    fn proves_while_patient(&self, delta: f64, go_on: &dyn Fn(u64) -> bool) -> bool {
        let work = STOP_WORK * self.stops.len() as u64;
        let allowed = delta - ROUNDING;
        // Between neighbouring ends of intervals the sets of stops that miss do not change, so cutting
        // exactly there costs nothing.
        let mut cuts: Vec<f64> =
            self.stops.iter().flat_map(|s| [s.low, s.high]).filter(|p| *p > 0.0 && *p < 0.5).collect();
        cuts.extend([0.0, 0.5]);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        // A cheap look first: just above each upper end and just below each lower end it misses most.
        let stride = 1 + cuts.len() / 500;
        if cuts.iter().step_by(stride).any(|p| {
            !go_on(2 * work)
                || self.miss(p.next_up()) > allowed
                || (*p > 0.0 && self.miss(p.next_down()) > allowed)
        }) {
            return false;
        }
        let mut open = vec![(0, cuts.len() - 1)];
        while let Some((i, j)) = open.pop() {
            if !go_on(work) {
                return false;
            }
            if self.bound(cuts[i], cuts[j]) <= allowed {
                continue;
            }
            if j - i > 1 {
                let middle = usize::midpoint(i, j);
                open.push((i, middle));
                open.push((middle, j));
            } else if !self.proves_between(cuts[i], cuts[j], allowed, go_on) {
                return false;
            }
        }
        true
    }

    /// The same between two neighbouring ends, where the bound falls continuously with the width.
    fn proves_between(&self, c: f64, d: f64, allowed: f64, go_on: &dyn Fn(u64) -> bool) -> bool {
        // For p strictly inside, `high < d` is what `high < p` is there, and `low > c` what `low > p` is.
        // At p = c and p = d fewer stops miss.
        let below = self.stops.partition_point(|stop| stop.high < d);
        let above = self.stops.partition_point(|stop| stop.low <= c);
        let mut open = vec![(c, d, 0)];
        while let Some((c, d, depth)) = open.pop() {
            let bound = self.mass(c, 0..below) + self.mass(d, above..self.stops.len());
            if bound <= allowed {
                continue;
            }
            if depth >= 12 || !go_on(STOP_WORK * self.stops.len() as u64) {
                return false;
            }
            let middle = 0.5 * (c + d);
            open.push((c, middle, depth + 1));
            open.push((middle, d, depth + 1));
        }
        true
    }
}

/// A level for half-width `epsilon` and error `delta`, proven here and now; None where no level of the ladder can be
/// proven with the work that there is, or somebody ends the proof.
fn calibrate(epsilon: f64, delta: f64, go_on: &dyn Fn() -> bool) -> Option<f64> {
    let (ladder, most_at_small_errors) = LADDER;
    let done = Cell::new(0);
    let go_on = |work: u64| {
        done.set(done.get() + work);
        done.get() <= MOST_WORK && go_on()
    };
    ladder
        .into_iter()
        .filter(|part| delta > 0.02 || *part < most_at_small_errors)
        .map(|part| part * delta)
        .find(|gamma| {
            Boundary::while_patient(epsilon, *gamma, &go_on)
                .is_some_and(|boundary| boundary.proves_while_patient(delta, &go_on))
        })
}

/// Whether a proof is worth a try, and takes seconds at most.
fn is_affordable(epsilon: f64, delta: f64) -> bool {
    (LEAST_EPSILON..=0.4).contains(&epsilon)
        && delta > 1e-6
        && delta <= MOST_DELTA
        && okamoto::size(epsilon, delta) <= LARGEST_PLAN
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean number of trials at `p` in (0, 1).
    fn mean_trials(boundary: &Boundary, p: f64) -> f64 {
        let trials = |k: usize| boundary.stops[k].successes + boundary.stops[k].failures;
        (0..boundary.stops.len()).map(|k| boundary.mass(p, k..k + 1) * trials(k)).sum()
    }

    #[test]
    fn rows_of_the_table_are_proven_and_meet_their_sizes() {
        let sizes = [121, 462, 771, 2796, 4765];
        for (k, row) in Table::ROWS.into_iter().enumerate().filter(|(_, row)| row.epsilon >= 0.02) {
            let boundary = Boundary::new(row.epsilon, row.gamma).unwrap();
            assert!(boundary.proves(row.delta), "{row:?}");
            if k < sizes.len() {
                assert_eq!(boundary.limit(), sizes[k], "{row:?}");
            }
        }
    }

    #[test]
    fn the_naive_level_is_refuted() {
        assert!(!Boundary::new(0.05, 0.05).unwrap().proves(0.05));
        assert!(!Boundary::new(0.02, 0.05).unwrap().proves(0.05));
        assert!(!Boundary::new(0.05, 0.01).unwrap().proves(0.01));
    }

    /// T10 and T11 without chance: errors and mean numbers of trials by the lattice.
    #[test]
    fn exact_errors_of_the_reference() {
        let boundary = Boundary::new(0.05, 0.035).unwrap();
        let cases = [
            (0.05, 0.008_47, 93.97),
            (0.1, 0.038_26, 169.67),
            (0.107, 0.044_30, 180.21),
            (0.3, 0.030_10, 389.63),
            (0.5, 0.031_30, 461.10),
        ];
        for (p, miss, trials) in cases {
            assert!((boundary.miss(p) - miss).abs() < 1e-5, "{p}: {}", boundary.miss(p));
            assert!((mean_trials(&boundary, p) - trials).abs() < 0.01, "{p}: {}", mean_trials(&boundary, p));
        }
        let naive = Boundary::new(0.05, 0.05).unwrap();
        assert!((naive.miss(0.107) - 0.064_09).abs() < 1e-5);
        assert!((mean_trials(&naive, 0.107) - 157.22).abs() < 0.01);
    }

    #[test]
    fn probabilities_of_the_stops_sum_to_one() {
        let boundary = Boundary::new(0.05, 0.035).unwrap();
        for p in [1e-6, 0.03, 0.5, 0.77] {
            assert!((boundary.mass(p, 0..boundary.stops.len()) - 1.0).abs() < 1e-10, "{p}");
        }
    }
}
