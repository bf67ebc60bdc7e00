//! The combinations of the values of few variables, numbered: rows of tables.

use super::super::code::{Code, Readings};
use super::super::state::{Layout, State};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::model::{Domain, VariableId};
use std::collections::BTreeSet;

/// The variables that a table depends on.
#[derive(Clone, Debug)]
pub(super) struct Keys {
    /// Each variable, and what one more is worth in the number of the row.
    list: Vec<(u32, f64)>,
    /// Smallest value and number of values of each.
    ranges: Vec<(f64, u64)>,
    /// Number of the row in which all variables are 0; perhaps negative.
    origin: f64,
    rows: u64,
}

impl Keys {
    /// The combinations of some variables, if they are finitely many and not more than `most`.
    pub(super) fn of(read: &BTreeSet<VariableId>, domains: &[Domain], most: u64) -> Option<Self> {
        let mut rows = 1u64;
        let (mut list, mut ranges) = (Vec::new(), Vec::new());
        for id in read {
            let (low, count) = domains.get(id.0 as usize)?.values()?;
            list.push((id.0, rows as f64));
            ranges.push((low, count));
            rows = rows.checked_mul(count).filter(|&rows| rows <= most)?;
        }
        if rows > most {
            return None;
        }
        let origin = -list.iter().zip(&ranges).map(|((_, worth), (low, _))| worth * low).sum::<f64>();
        Some(Self { list, ranges, origin, rows })
    }

    /// Number of combinations.
    pub(super) fn rows(&self) -> u64 {
        self.rows
    }

    /// The row of a lane.
    #[inline(always)]
    pub(super) fn row(&self, variables: &[Lanes], lane: usize) -> usize {
        let mut place = self.origin;
        for &(variable, worth) in &self.list {
            place += variables[variable as usize].0[lane] * worth;
        }
        place as usize
    }

    /// The row of each lane.
    #[inline(always)]
    pub(super) fn rows_in_lanes(&self, variables: &[Lanes]) -> [usize; LANES] {
        let mut place = Lanes::splat(self.origin);
        for &(variable, worth) in &self.list {
            place = place.zip(variables[variable as usize], |sum, value| sum + value * worth);
        }
        place.0.map(|place| place as usize)
    }

    /// Calls `each` with what code reads in each row, and the lane of it, until that says stop; of so many variables those
    /// that no key names are 0.
    pub(super) fn each_row(
        &self,
        code: &Code,
        variables: usize,
        mut each: impl FnMut(&Readings, usize) -> Option<()>,
    ) -> Option<()> {
        let mut state = State::new(Layout::Trials, 0);
        state.occupied = Mask::ALL;
        state.variables = vec![Lanes::ZERO; variables];
        let mut readings = Readings::default();
        for start in (0..self.rows).step_by(LANES) {
            let here = LANES.min((self.rows - start) as usize);
            for lane in 0..here {
                self.put(start + lane as u64, &mut state.variables, lane);
            }
            code.read(Layout::Trials, &state, &mut readings);
            for lane in 0..here {
                each(&readings, lane)?;
            }
        }
        Some(())
    }

    /// Puts the values of a row into a lane.
    pub(super) fn put(&self, row: u64, variables: &mut [Lanes], lane: usize) {
        let mut rest = row;
        for ((variable, _), (low, count)) in self.list.iter().zip(&self.ranges) {
            variables[*variable as usize].0[lane] = low + (rest % count) as f64;
            rest /= count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_the_row_of_its_values() {
        let domains = [Domain::Whole { low: -2, high: 3 }, Domain::Real, Domain::Truth];
        let read = BTreeSet::from([VariableId(0), VariableId(2)]);
        let keys = Keys::of(&read, &domains, 12).unwrap();
        let mut variables = vec![Lanes::ZERO; 3];
        for row in 0..keys.rows() {
            keys.put(row, &mut variables, 5);
            assert!(domains[0].contains(variables[0].0[5]) && domains[2].contains(variables[2].0[5]));
            assert_eq!(keys.row(&variables, 5), row as usize);
        }
        assert!(Keys::of(&read, &domains, 11).is_none());
        assert!(Keys::of(&BTreeSet::from([VariableId(1)]), &domains, 1 << 20).is_none());
    }
}
