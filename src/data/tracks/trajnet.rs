//! Reader of `TrajNet++` (one JSON object a line).
//!
//! A line is `{"scene": {"id", "p", "s", "e", "fps"}}` or `{"track": {"f", "p", "x", "y"}}`; other members are ignored.
//! `fps` is the rate of the rows: frames keep the numbers of the film, while rows are resampled to so many a second
//! (Kothari, Kreiss, Alahi, "Human trajectory forecasting in crowds", 2021, and the tools of the data set). So rows of
//! one person that are usually ten frames apart, at 2.5 a second, are of a film with 25 frames a second. Rows with
//! `prediction_number` are predictions and are passed over.

use super::line::{LineError, json_fault};
use super::recording::{Clock, Recording};
use super::rows::{Row, agreed, people, usual_stride};
use crate::base::geometry::{Vec2, coordinate_fault};
use serde::Deserialize;

#[derive(Deserialize)]
struct Line {
    scene: Option<Scene>,
    track: Option<Track>,
}

#[derive(Deserialize)]
struct Scene {
    fps: Option<f64>,
}

#[derive(Deserialize)]
struct Track {
    f: u32,
    p: u32,
    x: f64,
    y: f64,
    prediction_number: Option<u32>,
}

/// Reads a whole file. Empty lines are passed over. Time 0 is the first frame; velocities are the seen ones.
///
/// # Errors
/// Every bad line: not such an object, a position too far from the origin, a rate that is not positive or not that of
/// the first scene, and a person who is in one frame twice; a file without a rate.
pub fn read_trajnet(text: &str, fps: Option<f64>) -> Result<Recording, Vec<LineError>> {
    let mut errors = Vec::new();
    let mut rows = Vec::with_capacity(text.len() / 64);
    let mut rate: Option<(f64, usize)> = None;
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let number = k + 1;
        match serde_json::from_str::<Line>(line) {
            Err(error) => errors.push(json_fault(number, line, &error)),
            Ok(Line { scene: Some(Scene { fps }), track: None }) => match (fps, rate) {
                (None, _) => {}
                (Some(fps), _) if fps <= 0.0 => {
                    errors.push(LineError::whole(number, format!("`fps` must be positive (got {fps})")));
                }
                (Some(fps), None) => rate = Some((fps, number)),
                (Some(fps), Some((first, at))) if fps != first => {
                    let message = format!("`fps` is {fps}, but {first} in line {at}: the rates are mixed");
                    errors.push(LineError::whole(number, message));
                }
                _ => {}
            },
            Ok(Line { scene: None, track: Some(track) }) => {
                if track.prediction_number.is_some() {
                    continue;
                }
                let position = Vec2::new(track.x, track.y);
                match coordinate_fault(position) {
                    Some(fault) => errors.push(LineError::whole(number, fault)),
                    None => {
                        rows.push(Row {
                            line: number,
                            frame: track.f,
                            id: track.p,
                            position,
                            velocity: None,
                        });
                    }
                }
            }
            Ok(_) => errors.push(LineError::whole(number, "expected either `scene` or `track`")),
        }
    }
    let rate = agreed(rate.map(|(rate, _)| rate), fps, &mut errors);
    if rate.is_none() && errors.is_empty() && !rows.is_empty() {
        errors.push(LineError::of_file("no scene has a rate `fps`"));
    }
    let people = people(rows, errors, |row| format!("in frame {}", row.frame))?;
    let stride = usual_stride(&people).unwrap_or(1);
    let rows_per_second = rate.unwrap_or(1.0);
    Ok(Recording::new(people, Clock::film(stride, 1.0 / (rows_per_second * f64::from(stride)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_that_of_the_rows() {
        let text = "{\"scene\": {\"id\": 1, \"p\": 3, \"s\": 10, \"e\": 20, \"fps\": 2.5, \"tag\": 2}}\n\
                    {\"track\": {\"f\": 10, \"p\": 3, \"x\": 1, \"y\": 2.5}}\n\n\
                    {\"track\": {\"f\": 20, \"p\": 3, \"x\": 1.4, \"y\": 2.5}}\n\
                    {\"track\": {\"f\": 20, \"p\": 3, \"x\": 9, \"y\": 9, \"prediction_number\": 0}}\n";
        let recording = read_trajnet(text, None).unwrap();
        assert!((recording.frames_per_second() - 25.0).abs() < 1e-12);
        assert!((recording.duration() - 0.4).abs() < 1e-12);
        assert!((recording.people()[0].samples[1].velocity.unwrap().x - 1.0).abs() < 1e-12);
    }

    #[test]
    fn all_faults_come_at_once_and_in_order() {
        let text = "{\"scene\": {\"fps\": 2.5}}\n{\"scene\": {\"fps\": 5}}\n{\"track\": {\"f\": 1, \"p\": 1, \"x\": 0}}\n\
                    oops\n{}\n{\"track\": {\"f\": -1, \"p\": 1, \"x\": 0, \"y\": 0}}\n\
                    {\"track\": {\"f\": 1, \"p\": 1, \"x\": 0, \"y\": 9e9}}\n{\"scene\": {\"fps\": 0}}\n";
        let said: Vec<String> =
            read_trajnet(text, None).unwrap_err().iter().map(ToString::to_string).collect();
        assert_eq!(said.len(), 7, "{said:?}");
        assert_eq!(said[0], "line 2: `fps` is 5, but 2.5 in line 1: the rates are mixed");
        assert!(said[1].starts_with("line 3, column") && said[1].contains("missing field `y`"), "{said:?}");
        assert!(said[2].starts_with("line 4, column 1: "), "{said:?}");
        assert_eq!(said[3], "line 5: expected either `scene` or `track`");
        assert_eq!(said[6], "line 8: `fps` must be positive (got 0)");
        let bare = read_trajnet("{\"track\": {\"f\": 1, \"p\": 1, \"x\": 0, \"y\": 0}}", None).unwrap_err();
        assert_eq!(bare[0].to_string(), "no scene has a rate `fps`");
        assert_eq!(read_trajnet("", None).unwrap_err()[0].to_string(), "the file contains no observation");
    }
}
