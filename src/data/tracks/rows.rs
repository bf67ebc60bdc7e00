//! Rows of tables as recordings: with frames, with times, and of several trials whose agents have names.
//!
//! ```text
//! Traces     trial, name, time   of_trial: one trial, names numbered
//!   TimedRow   id, time            recording: times count in frames of 0.1 ms from the first one
//!     Row        id, frame           people: in any order, as people with samples of ascending frames
//! ```

use super::line::LineError;
use super::recording::{Clock, Columns, Person, Recording, Sample};
use crate::base::geometry::Vec2;
use std::collections::{BTreeMap, BTreeSet};

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
    let sample = |row: &Row| {
        let Row { line, frame, position, velocity, .. } = *row;
        Sample { frame, position, velocity, row: line as u32 }
    };
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

// Rows with times instead of frames.

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

/// The recording of all rows, which keeps their times. The usual distance of a person's rows is the step; clocks of sensors
/// are not exact, so rows up to one and a half steps apart are not a hole.
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

// Rows of several trials, with names of agents instead of ids.

/// Trials that a message names.
const NAMED: usize = 8;

/// The rows of a table. Until they are numbered, the id of an agent that has a name is the place of this name.
#[derive(Debug, Default)]
pub(super) struct Traces {
    rows: Vec<(Option<u64>, TimedRow)>,
    names: Vec<String>,
    known: BTreeMap<String, u32>,
    /// Numbers of other columns, by the lines of their rows.
    pub(super) columns: Columns,
}

impl Traces {
    /// The place of a name, which stands for its id.
    pub(super) fn place(&mut self, name: &str) -> u32 {
        if let Some(place) = self.known.get(name) {
            return *place;
        }
        let place = self.names.len() as u32;
        self.names.push(name.to_owned());
        self.known.insert(name.to_owned(), place);
        place
    }

    /// The next row, with its trial where the table has trials.
    pub(super) fn push(&mut self, trial: Option<u64>, row: TimedRow) {
        self.rows.push((trial, row));
    }

    /// The rows of a trial, or of the only one. Names that are all whole numbers are the ids; else the agents are 1, 2, …
    /// in the order in which they come.
    ///
    /// # Errors
    /// Where several trials could be meant, or the one that is wanted is not there.
    pub(super) fn of_trial(self, wanted: Option<u64>) -> Result<Vec<TimedRow>, LineError> {
        let Self { rows, names, .. } = self;
        let trials: BTreeSet<u64> = rows.iter().filter_map(|(trial, _)| *trial).collect();
        let listed = || {
            let shown: Vec<String> = trials.iter().take(NAMED).map(u64::to_string).collect();
            format!("{}{}", shown.join(", "), if trials.len() > NAMED { ", …" } else { "" })
        };
        let fault = match wanted {
            Some(_) if rows.is_empty() => None,
            Some(_) if trials.is_empty() => Some("the table has no column `trial`".to_owned()),
            Some(trial) if !trials.contains(&trial) => {
                Some(format!("the table has no trial {trial}; its trials are {}", listed()))
            }
            None if trials.len() > 1 => {
                Some(format!("the table has the trials {}: choose one with `trial`", listed()))
            }
            _ => None,
        };
        if let Some(fault) = fault {
            return Err(LineError::of_file(fault));
        }
        let chosen = rows.into_iter().filter(|(trial, _)| wanted.is_none() || *trial == wanted);
        let mut rows: Vec<TimedRow> = chosen.map(|(_, row)| row).collect();
        if names.is_empty() {
            return Ok(rows);
        }
        let whole = |name: &String| name.parse::<u32>().ok().filter(|id| id.to_string() == *name);
        let ids: Option<Vec<u32>> = names.iter().map(whole).collect();
        let mut numbers = BTreeMap::<u32, u32>::new();
        for row in &mut rows {
            let next = numbers.len() as u32 + 1;
            row.id = match &ids {
                Some(ids) => ids[row.id as usize],
                None => *numbers.entry(row.id).or_insert(next),
            };
        }
        Ok(rows)
    }

    /// The recording of a trial.
    ///
    /// # Errors
    /// The errors found so far, those of [`Traces::of_trial`], and as for a table with times.
    pub(super) fn recording(
        mut self,
        mut errors: Vec<LineError>,
        wanted: Option<u64>,
    ) -> Result<Recording, Vec<LineError>> {
        let columns = std::mem::take(&mut self.columns);
        match self.of_trial(wanted) {
            Ok(rows) => Ok(recording(&rows, errors)?.beside(columns)),
            Err(error) => {
                errors.insert(0, error);
                Err(errors)
            }
        }
    }
}
