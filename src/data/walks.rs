//! Sets of walks: a table of comma-separated values with the columns `walk`, `t` (s), `x` and `y` (m), and perhaps `leg`.
//!
//! The columns stand in any order, others are passed over, and so are empty lines and comments (`#`). Rows with one name in
//! `walk` are one walk, wherever they stand; with a column `leg`, those with one name in both.

use super::outcomes::cells;
use super::tracks::LineError;
use super::tracks::line::quoted;
use crate::base::geometry::{Vec2, coordinate_fault};
use std::collections::BTreeMap;

/// After so many errors the rest of the table is not read.
const MOST_ERRORS: usize = 20;

/// Largest time, s: beyond, differences of times lose their digits.
const LATEST: f64 = 1e12;

/// A recorded or simulated walk: at least two places at increasing times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walk {
    /// Its name.
    pub name: String,
    /// The leg of a route that it belongs to, where the table has them.
    pub leg: Option<String>,
    /// The line of its first row, from 1.
    pub line: usize,
    /// Times, s.
    pub times: Vec<f64>,
    /// Where the walker is at these times, m.
    pub points: Vec<Vec2>,
}

impl Walk {
    /// From the first to the last time, s.
    pub fn duration(&self) -> f64 {
        self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Length of the path, m.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    /// `count` points of the path from its start to its end, at equal lengths from each other, m.
    pub fn resampled(&self, count: usize) -> Vec<Vec2> {
        let Some(&start) = self.points.first() else { return Vec::new() };
        let mut points = vec![start];
        let spacing = self.length() / count.saturating_sub(1).max(1) as f64;
        let mut passed = 0.0;
        for pair in self.points.windows(2) {
            let length = (pair[1] - pair[0]).norm();
            while points.len() + 1 < count && spacing * (points.len() as f64) < passed + length {
                let share = (spacing * points.len() as f64 - passed) / length;
                points.push(pair[0] + (pair[1] - pair[0]) * share);
            }
            passed += length;
        }
        // The last point, and those of a path without length.
        points.resize(count, self.points[self.points.len() - 1]);
        points
    }
}

/// Where the columns stand.
struct Columns {
    walk: usize,
    leg: Option<usize>,
    numbers: [usize; 3],
    count: usize,
}

impl Columns {
    fn new(number: usize, heads: &[&str]) -> Result<Self, LineError> {
        let place = |name: &str| heads.iter().position(|head| *head == name);
        let needed = ["walk", "t", "x", "y"].map(|name| (name, place(name)));
        if let [(_, Some(walk)), (_, Some(t)), (_, Some(x)), (_, Some(y))] = needed {
            return Ok(Self { walk, leg: place("leg"), numbers: [t, x, y], count: heads.len() });
        }
        let missing: Vec<String> =
            needed.iter().filter(|(_, place)| place.is_none()).map(|(name, _)| format!("`{name}`")).collect();
        let message = format!(
            "the table has no column {}; its columns are {}",
            missing.join(", "),
            heads.iter().take(12).map(|head| quoted(head)).collect::<Vec<_>>().join(", ")
        );
        Err(LineError::whole(number, message))
    }
}

/// Reads a table of at least two walks, in the order in which they begin.
///
/// # Errors
/// A missing column, fields that are no numbers, times that do not increase, walks with one point, tables with one walk.
pub fn read_walks(text: &str) -> Result<Vec<Walk>, Vec<LineError>> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate().map(|(k, line)| (k + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((number, header)) = lines.next() else {
        return Err(vec![LineError::of_file("the table is empty")]);
    };
    let columns = Columns::new(number, &cells(header)).map_err(|error| vec![error])?;
    let (mut walks, mut errors) = (Vec::<Walk>::new(), Vec::new());
    let mut known = BTreeMap::<(&str, Option<&str>), usize>::new();
    for (number, line) in lines {
        let row = cells(line);
        if row.len() == columns.count {
            let (name, leg) = (row[columns.walk], columns.leg.map(|place| row[place]));
            let at = *known.entry((name, leg)).or_insert(walks.len());
            if at == walks.len() {
                let leg = leg.map(str::to_owned);
                walks.push(Walk { name: name.to_owned(), leg, line: number, ..Walk::default() });
            }
            errors.extend(add(&mut walks[at], number, line, columns.numbers.map(|place| row[place])).err());
        } else {
            let message = format!("the row has {} cells, the header has {}", row.len(), columns.count);
            errors.push(LineError::whole(number, message));
        }
        if errors.len() >= MOST_ERRORS {
            break;
        }
    }
    if errors.is_empty() {
        let short = walks.iter().filter(|walk| walk.points.len() < 2).take(MOST_ERRORS);
        let message = |walk: &Walk| format!("walk {} has 1 point, but needs at least 2", quoted(&walk.name));
        errors.extend(short.map(|walk| LineError::whole(walk.line, message(walk))));
    }
    let few = "but a comparison needs at least 2";
    match walks.as_slice() {
        _ if !errors.is_empty() => Err(errors),
        [] => Err(vec![LineError::whole(number, format!("the table has no walk, {few}"))]),
        [one] => Err(vec![LineError::whole(one.line, format!("the table has 1 walk, {few}"))]),
        _ => Ok(walks),
    }
}

/// Adds a row to its walk.
fn add(walk: &mut Walk, number: usize, line: &str, row: [&str; 3]) -> Result<(), LineError> {
    let fail = |cell: &str, message: String| {
        let start = (cell.as_ptr() as usize).wrapping_sub(line.as_ptr() as usize);
        LineError::at(number, line.get(..start).unwrap_or_default().chars().count() + 1, message)
    };
    let mut numbers = [0.0; 3];
    for (value, (cell, name)) in numbers.iter_mut().zip(row.iter().zip(["t", "x", "y"])) {
        let read = cell.parse().ok().filter(|value: &f64| value.is_finite());
        *value =
            read.ok_or_else(|| fail(cell, format!("`{name}` must be a number (got {})", quoted(cell))))?;
    }
    let [t, x, y] = numbers;
    if let Some((cell, fault)) = [(row[1], x), (row[2], y)]
        .into_iter()
        .find_map(|(cell, value)| Some((cell, coordinate_fault(Vec2::new(value, 0.0))?)))
    {
        return Err(fail(cell, fault));
    }
    if t.abs() > LATEST {
        return Err(fail(row[0], format!("`t` must lie between -1e12 s and 1e12 s (got {t:e} s)")));
    }
    if let Some(before) = walk.times.last().filter(|before| **before >= t) {
        let name = quoted(&walk.name);
        return Err(fail(row[0], format!("`t` must increase along walk {name} (got {t} after {before})")));
    }
    walk.times.push(t);
    walk.points.push(Vec2::new(x, y));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn walks_come_in_the_order_in_which_they_begin() {
        let text = "\u{feff}y,t, leg ,walk,x,more\n0,0,1,b,0,-\n# so\n0,0,1,\"a, 2\",5,-\n\n4,1.5,1,b,3,-\r\n\
                    1,0.5,1,\"a, 2\",5,-\n0,0,2,b,0,-\n1,1,2,b,0,-\n";
        let walks = read_walks(text).unwrap();
        let names: Vec<_> =
            walks.iter().map(|w| (w.name.as_str(), w.leg.as_deref().unwrap(), w.line)).collect();
        assert_eq!(names, [("b", "1", 2), ("a, 2", "1", 4), ("b", "2", 8)]);
        assert_eq!((walks[0].length(), walks[0].duration()), (5.0, 1.5));
        assert_eq!(walks[1].points, [Vec2::new(5.0, 0.0), Vec2::new(5.0, 1.0)]);
        assert_eq!(read_walks("walk,t,x,y\n1,0,0,0\n1,1,0,0\n2,0,0,0\n2,1,0,0").unwrap()[0].leg, None);
    }

    #[test]
    fn resampled_points_are_at_equal_lengths() {
        let at = |points: &[[f64; 2]]| Walk {
            points: points.iter().map(|p| Vec2::new(p[0], p[1])).collect(),
            ..Walk::default()
        };
        let walk = at(&[[0.0, 0.0], [3.0, 0.0], [3.0, 0.0], [3.0, 1.0]]);
        let expected = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0]];
        let found = walk.resampled(5);
        assert!(found.iter().zip(&at(&expected).points).all(|(a, b)| (a - b).norm() < 1e-12), "{found:?}");
        assert_eq!(at(&[[2.0, 1.0], [2.0, 1.0]]).resampled(16), vec![Vec2::new(2.0, 1.0); 16]);
        assert!(at(&[]).resampled(3).is_empty());
    }

    #[test]
    fn errors_have_their_places() {
        let said = |text: &str| {
            let errors = read_walks(text).unwrap_err();
            errors.iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        assert_eq!(said(" \n"), ["the table is empty"]);
        assert_eq!(
            said("#\nwalk,time,x\n"),
            ["line 2: the table has no column `t`, `y`; its columns are `walk`, `time`, `x`"]
        );
        assert_eq!(said("walk,t,x,y"), ["line 1: the table has no walk, but a comparison needs at least 2"]);
        assert_eq!(
            said("walk,t,x,y\n1,0,0,0\n1,1,0,0\n"),
            ["line 2: the table has 1 walk, but a comparison needs at least 2"]
        );
        assert_eq!(
            said("walk,t,x,y\n1,0,0,0\n1,1,0,0\n2,1,1,1\n"),
            ["line 4: walk `2` has 1 point, but needs at least 2"]
        );
        assert_eq!(
            said("walk,t,x,y\né,0,0,no\né,0,nan\né,1,2e6,0\né,1,0,0\né,1,0,0\né,1e13,0,0\né,,0,0"),
            [
                "line 2, column 7: `y` must be a number (got `no`)",
                "line 3: the row has 3 cells, the header has 4",
                "line 4, column 5: a coordinate must lie between -1e6 m and 1e6 m (got 2e6 m)",
                "line 6, column 3: `t` must increase along walk `é` (got 1 after 1)",
                "line 7, column 3: `t` must lie between -1e12 s and 1e12 s (got 1e13 s)",
                "line 8, column 3: `t` must be a number (got ``)",
            ]
        );
        assert_eq!(said(&format!("walk,t,x,y\n{}", "1\n".repeat(100))).len(), MOST_ERRORS);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn any_text_is_read_or_refused(
            rows in prop::collection::vec("[ab\"],?[-0-9.e]{0,3},[0-9\",é]{1,3},[0-9]{0,2}", 0..12), any: String
        ) {
            let _ = read_walks(&any);
            if let Ok(walks) = read_walks(&format!("walk,t,x,y\n{}\n{any}", rows.join("\n"))) {
                prop_assert!(walks.len() > 1 && walks.iter().all(|walk| walk.duration() > 0.0));
            }
        }
    }
}
