//! What was consumed for one query, besides what its procedure keeps.

use super::cell::{Cell, Reading};
use super::outcome::Counts;

/// Consumed trials of one query.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    /// Trials by outcome.
    pub(super) counts: Counts,
    /// Steps of the model until the column was decided.
    pub(super) steps: u64,
    /// Values outside the declared range.
    pub(super) clipped: u64,
    /// Trials in which radii were shrunk.
    pub(super) shrunk: u64,
    /// Implications that were triggered in some trial.
    pub(super) triggered: u64,
    /// Index of the first trial that passes, of the first that fails, and of the first that is unresolved.
    pub(super) first: [Option<u64>; 3],
    /// Index and value of the trial with the smallest and of that with the largest value.
    pub(super) extremes: [Option<(u64, f64)>; 2],
}

impl Tally {
    /// Keeps the first trial on each side of a threshold of a metric.
    pub(super) fn side(&mut self, index: u64, passing: bool) {
        self.first[usize::from(!passing)].get_or_insert(index);
    }

    /// Counts a trial; `range` is that of an expectation.
    #[inline]
    pub(super) fn add(&mut self, index: u64, cell: &Cell, range: Option<(f64, f64)>) {
        self.counts.trials += 1;
        self.steps += cell.steps;
        self.shrunk += u64::from(cell.shrunk);
        self.triggered |= cell.triggered;
        let place = match cell.reading {
            Reading::Truth(true) => {
                self.counts.successes += 1;
                0
            }
            Reading::Truth(false) => {
                self.counts.failures += 1;
                1
            }
            Reading::Value(value) => {
                self.clipped += u64::from(range.is_some_and(|(low, high)| value < low || value > high));
                if self.extremes[0].is_none_or(|(_, least)| value < least) {
                    self.extremes[0] = Some((index, value));
                }
                if self.extremes[1].is_none_or(|(_, most)| value > most) {
                    self.extremes[1] = Some((index, value));
                }
                return;
            }
            Reading::Unresolved | Reading::Faulty => {
                self.counts.unresolved += 1;
                2
            }
        };
        self.first[place].get_or_insert(index);
    }
}
