//! Reader of observations as JSON lines, one batch a line: the form of a live stream.
//!
//! `{"t":646.8,"sensor":"ceiling","seen":[{"x":2.1,"y":-3.0,"vx":0.1,"vy":1.4,"id":367}],"field":[[-3,-10],[4,-10],[4,4]]}`
//! where `sensor`, `vx`, `vy`, `id` and `field` are optional. Other members are ignored.

use super::batch::{Batch, Observation};
use super::line::{LineError, json_fault, json_velocity};
use super::recording::Recording;
use super::rows::{self, TimedRow};
use crate::base::geometry::{Vec2, coordinate_fault};
use serde::Deserialize;
use std::collections::BTreeMap;

/// A line for messages.
const EXAMPLE: &str = r#"{"t":0.4,"seen":[{"x":2.1,"y":-3,"id":7}]}"#;

#[derive(Deserialize)]
struct Line {
    t: f64,
    sensor: Option<String>,
    seen: Vec<Seen>,
    field: Option<Vec<[f64; 2]>>,
}

#[derive(Deserialize)]
struct Seen {
    x: f64,
    y: f64,
    vx: Option<f64>,
    vy: Option<f64>,
    id: Option<u32>,
}

/// Reads one line.
///
/// # Errors
/// The first error, with `line` 1: not such an object, a coordinate too far from the origin, `vx` without `vy`, an id
/// twice, and a field with fewer than three corners.
pub fn read_batch(line: &str) -> Result<Batch, LineError> {
    // A mark of the encoding may stand before the first line.
    let line = line.strip_prefix('\u{feff}').unwrap_or(line);
    let read: Line = serde_json::from_str(line).map_err(|error| {
        let fault = json_fault(1, line, &error);
        LineError { message: format!("{}; write for example {EXAMPLE}", fault.message), ..fault }
    })?;
    let wrong = |message: String| LineError::whole(1, message);
    let refuse = |message: String| Err(wrong(message));
    let mut seen = Vec::with_capacity(read.seen.len());
    let mut ids = Vec::new();
    for one in &read.seen {
        let position = Vec2::new(one.x, one.y);
        if let Some(fault) = coordinate_fault(position) {
            return refuse(fault);
        }
        let velocity = json_velocity("an observation", one.vx, one.vy).map_err(wrong)?;
        if let Some(id) = one.id {
            ids.push(id);
        }
        seen.push(Observation { position, velocity, id: one.id });
    }
    ids.sort_unstable();
    if let Some((id, _)) = ids.iter().zip(ids.iter().skip(1)).find(|(id, next)| id == next) {
        return refuse(format!("person {id} is seen twice"));
    }
    let field: Option<Vec<Vec2>> =
        read.field.map(|corners| corners.into_iter().map(|[x, y]| Vec2::new(x, y)).collect());
    if let Some(corners) = &field {
        if corners.len() < 3 {
            return refuse(format!("`field` must have at least 3 corners (got {})", corners.len()));
        }
        if let Some(fault) = corners.iter().find_map(|corner| coordinate_fault(*corner)) {
            return refuse(fault);
        }
    }
    Ok(Batch { time: read.t, sensor: read.sensor, seen, field })
}

/// Reads a whole text, in the order of its lines. Empty lines are passed over.
///
/// # Errors
/// Every bad line, a batch that is earlier than the one before or repeats its sensor at one time, and a text without
/// an observation.
pub fn read_observations(text: &str) -> Result<Vec<Batch>, Vec<LineError>> {
    let (lines, errors) = batches_of(text);
    if errors.is_empty() { Ok(lines.into_iter().map(|(_, batch)| batch).collect()) } else { Err(errors) }
}

/// The batches of a text as a recording. A person whom several sensors see at one time is at their mean.
///
/// # Errors
/// As [`read_observations`], and every observation without an id; as for a table with times.
pub(super) fn read_identified(text: &str) -> Result<Recording, Vec<LineError>> {
    let (lines, mut errors) = batches_of(text);
    let mut rows = Vec::new();
    for instant in lines.chunk_by(|a, b| a.1.time == b.1.time) {
        let mut people = BTreeMap::<u32, Vec<(usize, Observation)>>::new();
        for (line, batch) in instant {
            for one in &batch.seen {
                match one.id {
                    Some(id) => people.entry(id).or_default().push((*line, *one)),
                    None => {
                        errors
                            .push(LineError::whole(*line, "an observation of a recording must have an `id`"));
                    }
                }
            }
        }
        for (id, seen) in people {
            let (line, time) = (seen[0].0, instant[0].1.time);
            let position = seen.iter().map(|(_, one)| one.position).sum::<Vec2>() / seen.len() as f64;
            let known: Vec<Vec2> = seen.iter().filter_map(|(_, one)| one.velocity).collect();
            let velocity = (!known.is_empty()).then(|| known.iter().sum::<Vec2>() / known.len() as f64);
            rows.push(TimedRow { line, time, id, position, velocity });
        }
    }
    rows::recording(&rows, errors)
}

/// The good lines with their numbers, and all errors.
fn batches_of(text: &str) -> (Vec<(usize, Batch)>, Vec<LineError>) {
    let mut errors = Vec::new();
    let mut lines: Vec<(usize, Batch)> = Vec::new();
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let batch = match read_batch(line) {
            Ok(batch) => batch,
            Err(error) => {
                errors.push(LineError { line: k + 1, ..error });
                continue;
            }
        };
        if let Some((before, last)) = lines.last().filter(|(_, last)| last.time > batch.time) {
            let (time, earlier) = (batch.time, last.time);
            let message = format!("time runs backwards: {time} after {earlier} in line {before}");
            errors.push(LineError::whole(k + 1, message));
            continue;
        }
        let together = lines.iter().rev().take_while(|(_, other)| other.time == batch.time);
        if let Some((first, _)) = together.into_iter().find(|(_, other)| other.sensor == batch.sensor) {
            let time = batch.time;
            let message = format!("the same sensor is at time {time} twice, first in line {first}");
            errors.push(LineError::whole(k + 1, message));
        }
        lines.push((k + 1, batch));
    }
    if errors.is_empty() && lines.iter().all(|(_, batch)| batch.seen.is_empty()) {
        errors.push(LineError::of_file("the file contains no observation"));
    }
    (lines, errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = r#"{"t":646.8,"sensor":"ceiling","seen":[{"x":2.1,"y":-3.0,"vx":0.1,"vy":1.4,"id":367},{"x":0,"y":1}],"field":[[-3,-10],[4,-10],[4,4],[-3,4]]}"#;

    #[test]
    fn a_line_is_a_batch() {
        let batch = read_batch(LINE).unwrap();
        assert_eq!((batch.time, batch.sensor.as_deref()), (646.8, Some("ceiling")));
        assert_eq!(batch.seen[0].velocity, Some(Vec2::new(0.1, 1.4)));
        assert_eq!(batch.seen[1], Observation { position: Vec2::new(0.0, 1.0), velocity: None, id: None });
        assert_eq!(batch.field.as_ref().map(Vec::len), Some(4));
        assert!(batch.anonymous().seen.iter().all(|one| one.id.is_none()));
    }

    #[test]
    fn a_bad_line_is_refused_with_its_place() {
        let said = |line: &str| read_batch(line).unwrap_err().to_string();
        assert!(
            said("{\"t\":1}").starts_with("line 1, column 7: missing field `seen`"),
            "{}",
            said("{\"t\":1}")
        );
        assert!(said("{\"t\":1e999,\"seen\":[]}").contains("number out of range"));
        assert_eq!(
            said(r#"{"t":1,"seen":[{"x":0,"y":0,"vx":1}]}"#),
            "line 1: an observation must have both `vx` and `vy` or neither"
        );
        assert_eq!(
            said(r#"{"t":1,"seen":[{"x":0,"y":0,"id":1},{"x":0,"y":0,"id":1}]}"#),
            "line 1: person 1 is seen twice"
        );
        assert!(said(r#"{"t":1,"seen":[],"field":[[0,0]]}"#).contains("at least 3 corners (got 1)"));
        assert!(said(r#"{"t":1,"seen":[{"x":1e7,"y":0}]}"#).contains("a coordinate must lie"));
    }

    #[test]
    fn a_text_names_all_its_bad_lines() {
        let text = "{\"t\":1,\"seen\":[]}\nx\n{\"t\":0,\"seen\":[]}\n{\"t\":1,\"seen\":[]}\n{\"t\":1,\"sensor\":\"b\",\"seen\":[]}\n";
        let said: Vec<String> =
            read_observations(text).unwrap_err().iter().map(ToString::to_string).collect();
        assert!(said[0].starts_with("line 2, column 1: "), "{said:?}");
        assert_eq!(said[1], "line 3: time runs backwards: 0 after 1 in line 1");
        assert_eq!(said[2], "line 4: the same sensor is at time 1 twice, first in line 1");
        assert_eq!(said.len(), 3);
    }

    #[test]
    fn sensors_of_one_time_agree_on_the_mean() {
        let text = "{\"t\":1,\"sensor\":\"a\",\"seen\":[{\"x\":0,\"y\":0,\"id\":4}]}\n\
                    {\"t\":1,\"sensor\":\"b\",\"seen\":[{\"x\":0.2,\"y\":0,\"id\":4}]}\n";
        let recording = read_identified(text).unwrap();
        assert!((recording.at(1.0)[0].position.x - 0.1).abs() < 1e-12);
        let anonymous = read_identified("{\"t\":1,\"seen\":[{\"x\":0,\"y\":0}]}").unwrap_err();
        assert_eq!(anonymous[0].to_string(), "line 1: an observation of a recording must have an `id`");
    }
}
