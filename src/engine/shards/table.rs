//! Outcomes of trials in a row, packed: each kind of number of a block of trials as what it is above the least of them, in
//! as many bits as the largest one needs. A truth value takes a bit, a length of a few hundred steps nine, what is the same
//! in all trials of a block none; nothing is rounded.

use super::part::{Damaged, UNFIT};
use crate::trials::cell::{Cell, Reading};
use serde::{Deserialize, Serialize};

/// Trials of a block.
pub(super) const BLOCK: usize = 1024;
/// Kinds of numbers: what is read and its marks, steps, triggered implications, value.
const KINDS: usize = 4;
/// Bytes after the last number, so that sixteen can be read from any.
const PADDING: usize = 16;
/// Marks of a cell beside what it reads.
const SHRUNK: u64 = 8;
const NO_WAY: u64 = 16;

/// Numbers of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    least: u64,
    /// Bits of each, at most 64.
    width: u8,
    /// Where its bytes begin.
    #[serde(skip)]
    at: usize,
}

/// Outcomes of trials in a row.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    columns: usize,
    trials: usize,
    /// Block by block and column by column, one a kind.
    rows: Vec<Row>,
    bytes: Vec<u8>,
}

#[inline]
fn numbers(cell: &Cell) -> [u64; KINDS] {
    let (kind, value) = match cell.reading {
        Reading::Truth(held) => (u64::from(held), 0),
        Reading::Value(value) => (2, value.to_bits()),
        Reading::Unresolved => (3, 0),
        Reading::Faulty => (4, 0),
    };
    let marks = u64::from(cell.shrunk) * SHRUNK + u64::from(cell.no_way) * NO_WAY;
    [kind | marks, cell.steps, cell.triggered, value]
}

fn cell([mark, steps, triggered, value]: [u64; KINDS]) -> Cell {
    let reading = match mark & 7 {
        0 => Reading::Truth(false),
        1 => Reading::Truth(true),
        2 => Reading::Value(f64::from_bits(value)),
        3 => Reading::Unresolved,
        _ => Reading::Faulty,
    };
    Cell { reading, steps, triggered, shrunk: mark & SHRUNK != 0, no_way: mark & NO_WAY != 0 }
}

impl Table {
    /// A table without trials yet.
    pub fn new(columns: usize) -> Self {
        Self { columns, ..Self::default() }
    }

    /// Appends the cells of some trials, trial by trial. All calls but the last one bring whole blocks.
    pub(super) fn push(&mut self, cells: &[Cell]) {
        if cells.is_empty() {
            return;
        }
        let mut all = vec![[0; BLOCK]; KINDS];
        for block in cells.chunks(BLOCK * self.columns) {
            let trials = block.len() / self.columns;
            self.trials += trials;
            for column in 0..self.columns {
                for (k, trial) in block.chunks_exact(self.columns).enumerate() {
                    [all[0][k], all[1][k], all[2][k], all[3][k]] = numbers(&trial[column]);
                }
                for row in &all {
                    self.row(&row[..trials]);
                }
            }
        }
    }

    /// Appends numbers, word by word.
    fn row(&mut self, numbers: &[u64]) {
        let first = numbers.first().copied().unwrap_or_default();
        if numbers.iter().fold(0, |all, number| all | (number ^ first)) == 0 {
            return self.rows.push(Row { least: first, width: 0, at: 0 });
        }
        let (least, most) = numbers.iter().fold((u64::MAX, 0), |(a, b), &n| (a.min(n), b.max(n)));
        let width = u64::BITS - (most - least).leading_zeros();
        self.rows.push(Row { least, width: width as u8, at: 0 });
        let (mut word, mut filled) = (0, 0);
        for number in numbers.iter().map(|number| number - least) {
            word |= number << filled;
            filled += width;
            if filled >= u64::BITS {
                self.bytes.extend_from_slice(&word.to_le_bytes());
                filled -= u64::BITS;
                // What did not fit begins the next word.
                word = number.checked_shr(width - filled).unwrap_or(0);
            }
        }
        self.bytes.extend_from_slice(&word.to_le_bytes()[..filled.div_ceil(8) as usize]);
    }

    /// Makes a table that was read ready for looks at its cells, if it has so many trials and columns.
    pub(super) fn settle(&mut self, trials: u64, columns: usize) -> Result<(), Damaged> {
        let blocks = self.trials.div_ceil(BLOCK);
        let is_sized = self.trials as u64 == trials && self.columns == columns && columns > 0;
        if !is_sized || blocks.checked_mul(columns * KINDS) != Some(self.rows.len()) {
            return Err(UNFIT);
        }
        let mut at = 0;
        for (k, row) in self.rows.iter_mut().enumerate() {
            let block = k / (columns * KINDS);
            let trials = BLOCK.min(self.trials - block * BLOCK);
            row.at = at;
            at += (trials * usize::from(row.width)).div_ceil(8);
        }
        if at != self.bytes.len() || self.rows.iter().any(|row| u32::from(row.width) > u64::BITS) {
            return Err(UNFIT);
        }
        self.bytes.resize(at + PADDING, 0);
        Ok(())
    }

    /// The cell of a trial and a column, both counted from 0, of a table that is settled.
    #[inline]
    pub(super) fn cell(&self, trial: usize, column: usize) -> Cell {
        let rows = &self.rows[(trial / BLOCK * self.columns + column) * KINDS..][..KINDS];
        cell(std::array::from_fn(|kind| self.number(&rows[kind], trial % BLOCK)))
    }

    #[inline]
    fn number(&self, row: &Row, k: usize) -> u64 {
        let width = usize::from(row.width);
        if width == 0 {
            return row.least;
        }
        let bit = k * width;
        let bytes = &self.bytes[row.at + bit / 8..][..PADDING];
        let word = u128::from_le_bytes(bytes.try_into().unwrap_or_default()) >> (bit % 8);
        row.least.wrapping_add(word as u64 & (u64::MAX >> (64 - width)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_cell() -> impl Strategy<Value = Cell> {
        let reading = prop_oneof![
            any::<bool>().prop_map(Reading::Truth),
            any::<f64>().prop_map(Reading::Value),
            Just(Reading::Unresolved),
            Just(Reading::Faulty),
        ];
        (reading, any::<u64>(), any::<u64>(), any::<bool>(), any::<bool>()).prop_map(
            |(reading, steps, triggered, shrunk, no_way)| Cell { reading, steps, triggered, shrunk, no_way },
        )
    }

    fn same(a: &Cell, b: &Cell) -> bool {
        numbers(a) == numbers(b)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn any_cells_come_back(cells in prop::collection::vec(any_cell(), 1..300), columns in 1usize..4, times in 1usize..12) {
            let trials = cells.len() / columns * times;
            prop_assume!(trials > 0);
            let cells: Vec<Cell> = cells.iter().copied().cycle().take(trials * columns).collect();
            let mut table = Table::new(columns);
            table.push(&cells);
            let bytes = postcard::to_stdvec(&table).unwrap();
            let mut table: Table = postcard::from_bytes(&bytes).unwrap();
            prop_assert!(table.settle(trials as u64 + 1, columns).is_err());
            table.settle(trials as u64, columns).unwrap();
            for (k, cell) in cells.iter().enumerate() {
                prop_assert!(same(cell, &table.cell(k / columns, k % columns)));
            }
        }
    }

    #[test]
    fn truth_values_take_a_bit_and_lengths_what_they_differ_by() {
        let cells: Vec<Cell> = (0..4 * BLOCK as u64)
            .map(|k| Cell { reading: Reading::Truth(k % 3 == 0), steps: 200 + k % 16, ..Cell::BLANK })
            .collect();
        let mut table = Table::new(1);
        table.push(&cells);
        assert_eq!(table.bytes.len(), cells.len() * 5 / 8);
    }
}
