//! Rows of cells in aligned columns.

use crate::report::palette::{Paint, Palette};
use std::fmt::Write as _;

/// A cell: a text, how it looks, and to which side it leans.
pub(in crate::report) struct Cell {
    text: String,
    paint: Option<Paint>,
    right: bool,
}

impl Cell {
    /// Its text.
    pub(in crate::report) fn text(&self) -> &str {
        &self.text
    }

    /// Leans to the left.
    pub(in crate::report) fn left(text: impl Into<String>) -> Self {
        Self { text: text.into(), paint: None, right: false }
    }

    /// Leans to the right.
    pub(in crate::report) fn right(text: impl Into<String>) -> Self {
        Self { right: true, ..Self::left(text) }
    }

    /// Looks like this.
    pub(in crate::report) fn paint(self, paint: impl Into<Option<Paint>>) -> Self {
        Self { paint: paint.into(), ..self }
    }
}

/// Lines of aligned columns, two blanks apart, without blanks at their ends. Columns that are empty in
/// every row take no room.
pub(in crate::report) fn lines(rows: &[Vec<Cell>], palette: Palette) -> Vec<String> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width =
        |k: usize| rows.iter().filter_map(|r| r.get(k)).map(|c| c.text.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    rows.iter()
        .map(|row| {
            let last = row.iter().rposition(|cell| !cell.text.is_empty()).map_or(0, |k| k + 1);
            let mut line = String::new();
            let mut first = true;
            for (k, cell) in row[..last].iter().enumerate() {
                if widths[k] == 0 {
                    continue;
                }
                if !first {
                    line.push_str("  ");
                }
                first = false;
                let pad = " ".repeat(widths[k] - cell.text.chars().count());
                let shown =
                    cell.paint.map_or_else(|| cell.text.clone(), |paint| palette.paint(paint, &cell.text));
                if cell.right {
                    line += &pad;
                    line += &shown;
                } else {
                    line += &shown;
                    if k + 1 < last {
                        line += &pad;
                    }
                }
            }
            line
        })
        .collect()
}

/// Writes a table with heads. The first column leans to the left, all others to the right.
pub(in crate::report) fn table(
    out: &mut String,
    indent: &str,
    heads: &[&str],
    rows: impl IntoIterator<Item = Vec<String>>,
) {
    let cells = |row: Vec<String>| -> Vec<Cell> {
        let cell = |(k, text): (usize, String)| if k == 0 { Cell::left(text) } else { Cell::right(text) };
        row.into_iter().enumerate().map(cell).collect()
    };
    let heads = heads.iter().map(|head| (*head).to_owned()).collect();
    let rows: Vec<Vec<Cell>> = std::iter::once(heads).chain(rows).map(cells).collect();
    for line in lines(&rows, Palette::PLAIN) {
        let _ = writeln!(out, "{indent}{line}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_align_whatever_the_colour() {
        let rows = || {
            vec![
                vec![Cell::left("a").paint(Paint::Good), Cell::left(""), Cell::right("1")],
                vec![Cell::left("bcd"), Cell::left(""), Cell::right("100"), Cell::left("µ")],
            ]
        };
        assert_eq!(lines(&rows(), Palette::PLAIN), ["a      1", "bcd  100  µ"]);
        assert_eq!(lines(&rows(), Palette::ANSI)[0], "\u{1b}[1;32ma\u{1b}[0m      1");
    }
}
