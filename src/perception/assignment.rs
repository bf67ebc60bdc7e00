//! The assignment problem: pairs of rows and columns with the least sum of costs, by the Hungarian method with
//! shortest augmenting paths (Kuhn 1955; Jonker and Volgenant 1987), in O(n² m). Where only some pairs are possible, each
//! set of rows and columns that they connect is a problem of its own.

use super::near::connected;
use std::collections::BTreeMap;

/// Costs of rows and columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Costs {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl Costs {
    /// The costs that a function gives for each row and column. They must be finite.
    pub fn of(rows: usize, columns: usize, mut cost: impl FnMut(usize, usize) -> f64) -> Self {
        let values = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| cost(i, j));
        Self { rows, columns, values: values.collect() }
    }

    /// The cost of a row and a column.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.columns + column]
    }

    /// The column of each row, such that the sum is least; as many pairs as the smaller side has members. Ties are
    /// broken in the order of rows and columns.
    pub fn assign(&self) -> Vec<Option<usize>> {
        if self.rows <= self.columns {
            return augment(self.rows, self.columns, &self.values).into_iter().map(Some).collect();
        }
        let turned = Self::of(self.columns, self.rows, |j, i| self.at(i, j));
        let mut assigned = vec![None; self.rows];
        for (column, row) in augment(turned.rows, turned.columns, &turned.values).into_iter().enumerate() {
            assigned[row] = Some(column);
        }
        assigned
    }
}

/// Pairs of rows and columns among those that are possible, such that the sum of what each costs less than `most` is
/// greatest. Possible pairs are given with their costs.
pub fn assign_some(
    rows: usize,
    columns: usize,
    possible: &[(usize, usize, f64)],
    most: f64,
) -> Vec<Option<usize>> {
    let costs: BTreeMap<(usize, usize), f64> =
        possible.iter().map(|(i, j, cost)| ((*i, *j), *cost)).collect();
    let mut assigned = vec![None; rows];
    for set in connected(rows + columns, costs.keys().map(|(i, j)| (*i, rows + *j))) {
        let (own, others) = set.split_at(set.partition_point(|member| *member < rows));
        let cost = |i: usize, j: usize| costs.get(&(own[i], others[j] - rows)).copied().unwrap_or(most);
        let costs = Costs::of(own.len(), others.len(), cost);
        for (i, j) in costs.assign().into_iter().enumerate() {
            assigned[own[i]] = j.filter(|j| costs.at(i, *j) < most).map(|j| others[j] - rows);
        }
    }
    assigned
}

/// No row, or no column.
const FREE: usize = usize::MAX;

/// Gives each row its cheapest column, whose potential falls by as much as the second one costs more; the row that had
/// the column takes its turn at once (augmenting row reduction of Jonker and Volgenant). Returns the rows without one.
fn exchange(
    left: Vec<usize>,
    costs: &[f64],
    row_of: &mut [usize],
    row_potential: &mut [f64],
    column_potential: &mut [f64],
) -> Vec<usize> {
    let columns = row_of.len();
    let mut rest = Vec::new();
    // Rounding could make rows take turns forever.
    let mut turns = 4 * columns;
    for first in left {
        let mut row = first;
        loop {
            let line = &costs[row * columns..(row + 1) * columns];
            let (mut least, mut second, mut at) = (f64::INFINITY, f64::INFINITY, 0);
            for (column, (cost, potential)) in line.iter().zip(column_potential.iter()).enumerate() {
                let reduced = cost - potential;
                if reduced < least {
                    second = least;
                    least = reduced;
                    at = column;
                } else if reduced < second {
                    second = reduced;
                }
            }
            let before = row_of[at];
            if (before != FREE && second <= least) || turns == 0 {
                rest.push(row);
                break;
            }
            turns -= 1;
            row_of[at] = row;
            if before == FREE {
                row_potential[row] = least;
                break;
            }
            column_potential[at] -= second - least;
            row_potential[row] = second;
            row = before;
        }
    }
    rest
}

/// A column that is not yet reached by a path.
struct Open {
    column: usize,
    potential: f64,
    /// Length of the shortest path to it so far, in reduced costs.
    distance: f64,
    /// The column before it on that path.
    previous: usize,
}

/// The column of each row; there are no fewer columns than rows. Each row is added with the cheapest path of
/// exchanges, in costs reduced by the potentials of rows and columns.
fn augment(rows: usize, columns: usize, costs: &[f64]) -> Vec<usize> {
    let mut row_potential = vec![0.0; rows];
    let mut column_potential = vec![0.0; columns];
    let mut row_of = vec![FREE; columns];
    let mut distance = vec![0.0; columns];
    let mut previous = vec![FREE; columns];
    let mut open: Vec<Open> = Vec::with_capacity(columns);
    let mut reached: Vec<usize> = Vec::with_capacity(columns);
    // Each row begins at its least cost, and takes such a column if it is free. A column that may stay free must keep
    // the potential 0, so only a square is reduced by columns as well.
    for (potential, line) in row_potential.iter_mut().zip(costs.chunks_exact(columns.max(1))) {
        *potential = line.iter().copied().fold(f64::INFINITY, f64::min);
    }
    if rows == columns {
        column_potential.fill(f64::INFINITY);
        for (base, line) in row_potential.iter().zip(costs.chunks_exact(columns.max(1))) {
            for (potential, cost) in column_potential.iter_mut().zip(line) {
                *potential = potential.min(cost - base);
            }
        }
    }
    let mut left = Vec::with_capacity(rows);
    for (row, line) in costs.chunks_exact(columns.max(1)).enumerate() {
        let tight =
            |j: &usize| row_of[*j] == FREE && line[*j] - row_potential[row] - column_potential[*j] <= 0.0;
        match (0..columns).find(tight) {
            Some(column) => row_of[column] = row,
            None => left.push(row),
        }
    }
    if columns > 1 {
        for _ in 0..2 {
            left = exchange(left, costs, &mut row_of, &mut row_potential, &mut column_potential);
        }
    }
    for start in left {
        open.clear();
        open.extend((0..columns).map(|column| Open {
            column,
            potential: column_potential[column],
            distance: f64::INFINITY,
            previous: FREE,
        }));
        reached.clear();
        let (mut row, mut so_far, mut last) = (start, 0.0, FREE);
        let end = loop {
            let line = &costs[row * columns..(row + 1) * columns];
            let base = so_far - row_potential[row];
            let (mut best, mut at) = (f64::INFINITY, 0);
            for (k, one) in open.iter_mut().enumerate() {
                let through = base + line[one.column] - one.potential;
                if through < one.distance {
                    one.distance = through;
                    one.previous = last;
                }
                if one.distance < best {
                    best = one.distance;
                    at = k;
                }
            }
            let one = open.swap_remove(at);
            so_far = best;
            distance[one.column] = one.distance;
            previous[one.column] = one.previous;
            if row_of[one.column] == FREE {
                break one.column;
            }
            reached.push(one.column);
            last = one.column;
            row = row_of[one.column];
        };
        row_potential[start] += so_far;
        for &column in &reached {
            let slack = so_far - distance[column];
            row_potential[row_of[column]] += slack;
            column_potential[column] -= slack;
        }
        let mut column = end;
        loop {
            let before = previous[column];
            if before == FREE {
                row_of[column] = start;
                break;
            }
            row_of[column] = row_of[before];
            column = before;
        }
    }
    let mut column_of = vec![0; rows];
    for (column, &row) in row_of.iter().enumerate() {
        if row != FREE {
            column_of[row] = column;
        }
    }
    column_of
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    /// The least sum over all ways to pair the smaller side.
    fn brute(costs: &Costs) -> f64 {
        fn from(costs: &Costs, row: usize, used: &mut Vec<bool>, left_out: usize) -> f64 {
            if row == costs.rows {
                return 0.0;
            }
            let mut best = f64::INFINITY;
            if left_out > 0 {
                best = from(costs, row + 1, used, left_out - 1);
            }
            for column in 0..costs.columns {
                if !used[column] {
                    used[column] = true;
                    best = best.min(costs.at(row, column) + from(costs, row + 1, used, left_out));
                    used[column] = false;
                }
            }
            best
        }
        from(costs, 0, &mut vec![false; costs.columns], costs.rows.saturating_sub(costs.columns))
    }

    #[test]
    fn the_sum_is_that_of_trying_all() {
        let stream = Stream::of(TrialKey::default(), 0, Purpose::Test);
        let mut draw = 0;
        for rows in 0..6 {
            for columns in 0..6 {
                for levels in [1.0, 3.0, 1e6] {
                    let costs = Costs::of(rows, columns, |_, _| {
                        draw += 1;
                        (stream.uniform(draw) * levels).floor() - 1.0
                    });
                    let assigned = costs.assign();
                    let pairs: Vec<(usize, usize)> =
                        assigned.iter().enumerate().filter_map(|(i, j)| j.map(|j| (i, j))).collect();
                    assert_eq!(pairs.len(), rows.min(columns));
                    let mut taken: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
                    taken.sort_unstable();
                    taken.dedup();
                    assert_eq!(taken.len(), pairs.len(), "each column once");
                    let sum: f64 = pairs.iter().map(|&(i, j)| costs.at(i, j)).sum();
                    assert!((sum - brute(&costs)).abs() < 1e-6, "{costs:?}");
                }
            }
        }
    }

    #[test]
    fn ties_go_to_the_lowest_columns() {
        assert_eq!(Costs::of(3, 5, |_, _| 1.0).assign(), [Some(0), Some(1), Some(2)]);
    }

    #[test]
    fn possible_pairs_are_assigned_as_if_all_others_cost_the_most() {
        let stream = Stream::of(TrialKey::default(), 2, Purpose::Test);
        for case in 0..200 {
            let draw = |k: u32| stream.uniform(case * 200 + k);
            let (rows, columns) = ((7.0 * draw(0)) as usize, (7.0 * draw(1)) as usize);
            let costs = Costs::of(rows, columns, |i, j| (4.0 * draw((2 + i * 7 + j) as u32)).min(1.0));
            let all = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
            let possible: Vec<(usize, usize, f64)> =
                all.map(|(i, j)| (i, j, costs.at(i, j))).filter(|pair| pair.2 < 1.0).collect();
            let assigned = assign_some(rows, columns, &possible, 1.0);
            let saved: f64 =
                assigned.iter().enumerate().filter_map(|(i, j)| Some(1.0 - costs.at(i, (*j)?))).sum();
            let least = rows.min(columns) as f64 - saved;
            assert!((least - brute(&costs)).abs() < 1e-9, "{costs:?} {assigned:?}");
        }
    }
}
