//! Reader of traces as JSON lines, as `smc simulate --format jsonl` writes them: objects with `time` (s), `agent`, `x` and `y`
//! (m), and perhaps `trial`, `vx` and `vy` (m/s) and `present`. Other members are kept where they are numbers.

use super::line::{LineError, json_fault, json_velocity};
use super::recording::Recording;
use super::rows::{TimedRow, Traces};
use crate::base::geometry::{Vec2, coordinate_fault};
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct Line {
    time: f64,
    trial: Option<u64>,
    agent: Name,
    x: Option<f64>,
    y: Option<f64>,
    vx: Option<f64>,
    vy: Option<f64>,
    present: Option<bool>,
    #[serde(flatten)]
    others: BTreeMap<String, serde_json::Value>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Name {
    Text(String),
    Number(u32),
}

/// Reads a trial of a whole file. Empty lines and agents that are absent are passed over.
///
/// # Errors
/// Every bad line: not such an object, a position too far from the origin, and `vx` without `vy`; several trials of which
/// none is wanted; as for a table with times.
pub fn read_json_lines(text: &str, trial: Option<u64>) -> Result<Recording, Vec<LineError>> {
    let (mut errors, mut traces) = (Vec::new(), Traces::default());
    for (k, text) in text.lines().enumerate().filter(|(_, text)| !text.trim().is_empty()) {
        let line = k + 1;
        match serde_json::from_str::<Line>(text) {
            Err(error) => errors.push(json_fault(line, text, &error)),
            Ok(read) if read.present == Some(false) => {}
            Ok(read) => match point(&read) {
                Err(fault) => errors.push(LineError::whole(line, fault)),
                Ok((position, velocity)) => {
                    let id = match read.agent {
                        Name::Text(name) => traces.place(&name),
                        Name::Number(id) => traces.place(&id.to_string()),
                    };
                    traces.push(read.trial, TimedRow { line, time: read.time, id, position, velocity });
                    for (name, value) in &read.others {
                        if let Some(value) = value.as_f64() {
                            traces.columns.push(name, line, value);
                        }
                    }
                }
            },
        }
    }
    traces.recording(errors, trial)
}

/// Position and velocity.
fn point(line: &Line) -> Result<(Vec2, Option<Vec2>), String> {
    let (Some(x), Some(y)) = (line.x, line.y) else {
        return Err("an agent that is present must have `x` and `y`".to_owned());
    };
    let velocity = json_velocity("a line", line.vx, line.vy)?;
    let position = Vec2::new(x, y);
    coordinate_fault(position).map_or(Ok((position, velocity)), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "{\"time\":0,\"trial\":3,\"agent\":\"a\",\"x\":null,\"y\":null,\"present\":false}\n\
        {\"time\":0,\"trial\":3,\"agent\":\"b\",\"x\":1,\"y\":2,\"vx\":0.5,\"vy\":0,\"present\":true}\n\
        {\"time\":0.5,\"trial\":3,\"agent\":\"a\",\"x\":5,\"y\":5,\"vx\":0,\"vy\":0,\"present\":true}\n\
        {\"time\":0,\"trial\":4,\"agent\":\"a\",\"x\":9,\"y\":9,\"vx\":0,\"vy\":0}\n";

    fn said(text: &str, trial: Option<u64>) -> Vec<String> {
        read_json_lines(text, trial).unwrap_err().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn agents_are_numbered_as_they_come() {
        let recording = read_json_lines(TEXT, Some(3)).unwrap();
        assert_eq!(recording.ids().collect::<Vec<_>>(), [1, 2]);
        assert_eq!(recording.at(0.0)[0].position, Vec2::new(1.0, 2.0));
        assert_eq!(recording.at(0.0)[0].velocity, Vec2::new(0.5, 0.0));
        assert_eq!(
            read_json_lines(&TEXT.replace("\"b\"", "70").replace("\"a\"", "\"7\""), Some(3))
                .unwrap()
                .ids()
                .collect::<Vec<_>>(),
            [7, 70]
        );
    }

    #[test]
    fn a_trial_is_chosen_among_those_that_are_there() {
        assert_eq!(said(TEXT, None), ["the table has the trials 3, 4: choose one with `trial`"]);
        assert_eq!(said(TEXT, Some(5)), ["the table has no trial 5; its trials are 3, 4"]);
        let bare = "{\"time\":0,\"agent\":\"a\",\"x\":1,\"y\":2}";
        assert_eq!(said(bare, Some(0)), ["the table has no column `trial`"]);
        assert!(read_json_lines(bare, None).is_ok());
        assert_eq!(said("", Some(0)), ["the file contains no observation"]);
    }

    #[test]
    fn bad_lines_are_named() {
        let text = "{\"time\":0,\"agent\":\"a\",\"x\":1}\n{\"time\":0,\"agent\":[],\"x\":1,\"y\":1}\n\
                    {\"time\":0,\"agent\":\"a\",\"x\":1,\"y\":1e7}\n{\"time\":0,\"agent\":\"a\",\"x\":1,\"y\":1,\"vx\":2}\n";
        let said = said(text, None);
        assert_eq!(said[0], "line 1: an agent that is present must have `x` and `y`");
        assert!(said[1].starts_with("line 2, column"), "{said:?}");
        assert!(said[2].contains("a coordinate must lie"), "{said:?}");
        assert_eq!(said[3], "line 4: a line must have both `vx` and `vy` or neither");
    }
}
