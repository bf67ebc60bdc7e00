//! Rows of a table of tracks, in any order, as people with samples of ascending frames.

use super::line::LineError;
use super::recording::{Person, Sample};
use crate::base::geometry::Vec2;
use std::collections::BTreeMap;

/// One good row of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Line of the file, from 1.
    pub(super) line: usize,
    pub(super) frame: u32,
    pub(super) id: u32,
    /// Position, m.
    pub(super) position: Vec2,
    /// Velocity, m/s, if the table has it.
    pub(super) velocity: Option<Vec2>,
}

/// The people of all rows, by ascending id. `when` names the time of a row in an error, as "in frame 7".
///
/// # Errors
/// The errors found so far and every person who is at one time twice, by line; a table without a row.
pub(super) fn people(
    mut rows: Vec<Row>,
    mut errors: Vec<LineError>,
    when: impl Fn(&Row) -> String,
) -> Result<Vec<Person>, Vec<LineError>> {
    rows.sort_by_key(|row| (row.id, row.frame, row.line));
    for pair in rows.windows(2) {
        if (pair[0].id, pair[0].frame) == (pair[1].id, pair[1].frame) {
            let (id, when, first) = (pair[1].id, when(&pair[1]), pair[0].line);
            let message = format!("person {id} is {when} twice, first in line {first}");
            errors.push(LineError::whole(pair[1].line, message));
        }
    }
    if rows.is_empty() && errors.is_empty() {
        errors.push(LineError::of_file("the file contains no observation"));
    }
    if !errors.is_empty() {
        errors.sort_by_key(|error| (error.line, error.column));
        return Err(errors);
    }
    let sample = |row: &Row| Sample { frame: row.frame, position: row.position, velocity: row.velocity };
    let person = |track: &[Row]| Person { id: track[0].id, samples: track.iter().map(sample).collect() };
    Ok(rows.chunk_by(|a, b| a.id == b.id).map(person).collect())
}

/// The frames per second of a file that states `own`, and of a call that states others; an error where they differ.
pub(super) fn agreed(own: Option<f64>, stated: Option<f64>, errors: &mut Vec<LineError>) -> Option<f64> {
    if let (Some(own), Some(stated)) = (own, stated)
        && (stated / own - 1.0).abs() > 0.01
    {
        let message = format!("the file has {own} frames per second, but {stated} are stated");
        errors.push(LineError::of_file(message));
    }
    own.or(stated)
}

/// The most frequent distance in frames between successive observations of one person; of equally
/// frequent ones the smallest.
pub(super) fn usual_stride(people: &[Person]) -> Option<u32> {
    let mut counts = BTreeMap::<u32, usize>::new();
    for person in people {
        for pair in person.samples.windows(2) {
            *counts.entry(pair[1].frame - pair[0].frame).or_default() += 1;
        }
    }
    counts
        .into_iter()
        .max_by_key(|&(stride, count)| (count, std::cmp::Reverse(stride)))
        .map(|(stride, _)| stride)
}
