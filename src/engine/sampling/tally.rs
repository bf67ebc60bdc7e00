//! What was consumed for one query, besides what its procedure keeps.

use crate::engine::outcome::{ConsumedTrials, Counts};
use crate::trials::cell::{Cell, Reading};

/// Trials of which something is noted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::engine) struct Noted {
    /// How many.
    pub(in crate::engine) trials: u64,
    /// Index of the first of them.
    pub(in crate::engine) first: Option<u64>,
}

impl Noted {
    fn note(&mut self, index: u64) {
        self.trials += 1;
        self.first.get_or_insert(index);
    }
}

/// Consumed trials of one query.
#[derive(Clone, Debug, Default)]
pub(in crate::engine) struct Tally {
    /// Trials by outcome.
    pub(in crate::engine) counts: Counts,
    /// Steps of the model until the column was decided.
    pub(in crate::engine) steps: u64,
    /// Values outside the declared range.
    pub(in crate::engine) clipped: u64,
    /// Trials in which radii were shrunk.
    pub(in crate::engine) shrunk: Noted,
    /// Trials in which somebody had no way to a goal.
    pub(in crate::engine) no_way: Noted,
    /// Implications that were triggered in some trial.
    pub(in crate::engine) triggered: u64,
    /// Index of the first trial that passes, of the first that fails, and of the first that is unresolved.
    pub(in crate::engine) first: [Option<u64>; 3],
    /// Index and value of the trial with the smallest and of that with the largest value.
    pub(in crate::engine) extremes: [Option<(u64, f64)>; 2],
}

impl Tally {
    /// Keeps the first trial on each side of a threshold of a metric.
    #[inline]
    pub(in crate::engine) fn side(&mut self, index: u64, passing: bool) {
        self.first[usize::from(!passing)].get_or_insert(index);
    }

    /// Counts trials with their indices, if each says whether a formula held: the same as one by one, without a branch
    /// that depends on chance. How many of them held.
    pub(in crate::engine) fn add_truths<'c>(
        &mut self,
        trials: &(impl Iterator<Item = (u64, &'c Cell)> + Clone),
    ) -> Option<u64> {
        if !matches!(trials.clone().next()?.1.reading, Reading::Truth(_)) {
            return None;
        }
        let (mut all, mut truths, mut held) = (0, 0, 0);
        let (mut steps, mut noted, mut triggered) = (0, false, 0);
        for (_, cell) in trials.clone() {
            all += 1;
            truths += u64::from(matches!(cell.reading, Reading::Truth(_)));
            held += u64::from(cell.reading == Reading::Truth(true));
            steps += cell.steps;
            noted |= cell.shrunk | cell.no_way;
            triggered |= cell.triggered;
        }
        if truths < all {
            return None;
        }
        self.counts.trials += all;
        self.counts.successes += held;
        self.counts.failures += all - held;
        self.steps += steps;
        self.triggered |= triggered;
        if noted {
            trials.clone().for_each(|(index, cell)| self.note(index, cell));
        }
        for (first, truth) in self.first.iter_mut().zip([true, false]) {
            if first.is_none() {
                let mut of_this = trials.clone().filter(|(_, cell)| cell.reading == Reading::Truth(truth));
                *first = of_this.next().map(|(index, _)| index);
            }
        }
        Some(held)
    }

    fn note(&mut self, index: u64, cell: &Cell) {
        if cell.shrunk {
            self.shrunk.note(index);
        }
        if cell.no_way {
            self.no_way.note(index);
        }
    }

    /// Counts a trial; `range` is that of an expectation.
    #[inline]
    pub(in crate::engine) fn add(&mut self, index: u64, cell: &Cell, range: Option<(f64, f64)>) {
        self.counts.trials += 1;
        self.steps += cell.steps;
        self.note(index, cell);
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

    /// The counts that a result shows.
    pub(in crate::engine) const fn consumed(&self) -> ConsumedTrials {
        ConsumedTrials {
            counts: self.counts,
            clipped: self.clipped,
            shrunk: self.shrunk.trials,
            no_way: self.no_way.trials,
            steps: self.steps,
        }
    }

    /// Sums of several tallies; indices of trials, which belong to one of them, are left out.
    pub(in crate::engine) fn total(tallies: &[Self]) -> Self {
        let mut sum = Self::default();
        for tally in tallies {
            sum.counts = sum.counts.and(tally.counts);
            sum.steps += tally.steps;
            sum.clipped += tally.clipped;
            sum.shrunk.trials += tally.shrunk.trials;
            sum.no_way.trials += tally.no_way.trials;
            sum.triggered |= tally.triggered;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_at_once_count_as_one_by_one() {
        let cell = |k: u64| Cell {
            reading: Reading::Truth(k % 5 == 3),
            steps: 10 + k,
            triggered: 1 << k,
            shrunk: k.is_multiple_of(4),
            no_way: k == 6,
        };
        let cells: Vec<Cell> = (0..9).map(cell).collect();
        let trials = |from: usize, to: usize| (from as u64..).zip(&cells[from..to]);
        let (mut one, mut many) = (Tally::default(), Tally::default());
        trials(0, 9).for_each(|(index, cell)| one.add(index, cell, None));
        assert_eq!(many.add_truths(&trials(0, 2)), Some(0));
        assert_eq!(many.add_truths(&trials(2, 9)), Some(2));
        assert_eq!(format!("{one:?}"), format!("{many:?}"));
        let mixed = [cells[0], Cell::BLANK];
        assert_eq!(many.add_truths(&(9..).zip(&mixed)), None);
        assert_eq!(format!("{one:?}"), format!("{many:?}"));
    }
}
