//! Rows with times instead of frames, as a recording.
//!
//! Times count in frames of 0.1 ms from the first one. The usual distance of a person's rows is the step; clocks of
//! sensors are not exact, so rows up to one and a half steps apart are not a hole.

use super::line::LineError;
use super::recording::{Clock, Person, Recording};
use super::rows::{Row, people};
use crate::base::geometry::Vec2;
use std::collections::BTreeMap;

/// Length of a frame, s.
const FRAME: f64 = 1e-4;
/// Distances of rows that differ by this factor are of different rates.
const OTHER_RATE: f64 = 1.5;
/// Fewest rows of a person that show a rate.
const ROWS_OF_A_RATE: usize = 4;

/// One good row of a table with times.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimedRow {
    /// Line of the file, from 1.
    pub(super) line: usize,
    /// Time, s.
    pub(super) time: f64,
    pub(super) id: u32,
    /// Position, m.
    pub(super) position: Vec2,
    /// Velocity, m/s, if the table has it.
    pub(super) velocity: Option<Vec2>,
}

/// The recording of all rows, which keeps their times.
///
/// # Errors
/// The errors found so far; time that runs backwards in the rows of a person, a person twice at one time, times
/// farther apart than 119 hours, and a person recorded at another rate than the others.
pub(super) fn recording(rows: &[TimedRow], mut errors: Vec<LineError>) -> Result<Recording, Vec<LineError>> {
    let start = rows.iter().map(|row| row.time).fold(f64::INFINITY, f64::min);
    let mut last = BTreeMap::<u32, TimedRow>::new();
    let mut framed = Vec::with_capacity(rows.len());
    for row in rows {
        let frame = ((row.time - start) / FRAME).round();
        if frame > f64::from(u32::MAX) {
            let message = format!("time {} is more than 119 hours after the first time {start}", row.time);
            errors.push(LineError::whole(row.line, message));
            continue;
        }
        let before = last.insert(row.id, *row);
        if let Some(before) = before.filter(|before| before.time > row.time) {
            let (id, time, earlier, line) = (row.id, row.time, before.time, before.line);
            let message =
                format!("the time of person {id} runs backwards: {time} after {earlier} in line {line}");
            errors.push(LineError::whole(row.line, message));
        }
        let TimedRow { line, id, position, velocity, .. } = *row;
        framed.push(Row { line, frame: frame as u32, id, position, velocity });
    }
    let lines: BTreeMap<u32, usize> = framed.iter().rev().map(|row| (row.id, row.line)).collect();
    let people = people(framed, errors, |row| format!("at time {}", start + f64::from(row.frame) * FRAME))?;
    let mut all: Vec<u32> = people.iter().flat_map(distances).collect();
    all.sort_unstable();
    let Some(&step) = all.get(all.len() / 2) else {
        let clock = Clock { start, seconds_per_frame: FRAME, stride: 1, longest_gap: 1 };
        return Ok(Recording::new(people, clock));
    };
    let mixed: Vec<LineError> = people
        .iter()
        .filter(|person| person.samples.len() >= ROWS_OF_A_RATE)
        .filter_map(|person| {
            let mut own: Vec<u32> = distances(person).collect();
            own.sort_unstable();
            let (least, median, usual) =
                (f64::from(*own.first()?), f64::from(*own.get(own.len() / 2)?), f64::from(step));
            // A person with holes has long distances too; only one without a short one has another rate.
            let is_other = median * OTHER_RATE < usual || least > usual * OTHER_RATE;
            is_other.then(|| {
                let (own, usual) = (median * FRAME, usual * FRAME);
                let message =
                    format!("person {} is recorded every {own} s, most others every {usual} s", person.id);
                LineError::whole(lines.get(&person.id).copied().unwrap_or(0), message)
            })
        })
        .collect();
    if !mixed.is_empty() {
        return Err(mixed);
    }
    let longest_gap = (f64::from(step) * OTHER_RATE) as u32;
    Ok(Recording::new(people, Clock { start, seconds_per_frame: FRAME, stride: step, longest_gap }))
}

fn distances(person: &Person) -> impl Iterator<Item = u32> + '_ {
    person.samples.windows(2).map(|pair| pair[1].frame - pair[0].frame)
}
