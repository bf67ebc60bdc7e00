//! Reader of tracks as comma-separated values.
//!
//! The header names the columns, in any order and in capitals or not: `id` or `agent`, `x,y`, and either `time` in seconds or `frame`; `vx,vy` may
//! follow, `trial` where a table has several, and `present`, which is 0 in rows of agents that are absent. Other columns are
//! kept where they have numbers. Cells may be separated by semicolons or tabs, and numbers then have commas as decimal points. Lengths are metres. A table with `frame` needs the frames per second. `smc simulate` writes such tables.

use super::cells::{cells, records, separator};
use super::format::Reading;
use super::line::{LineError, number, quoted, whole_fault};
use super::recording::{Clock, Recording};
use super::rows::{Row, TimedRow, Traces, people, usual_stride};
use crate::base::geometry::{Vec2, coordinate_fault};
use std::borrow::Cow;

/// Names of columns; `time` and `frame` exclude each other. The first are numbers.
const COLUMNS: [&str; 10] = ["time", "frame", "id", "x", "y", "vx", "vy", "agent", "trial", "present"];
const NUMBERS: usize = 7;
const FRAME: usize = 1;
const ID: usize = 2;
const AGENT: usize = 7;
const TRIAL: usize = 8;
const PRESENT: usize = 9;

/// Whether a column of this name says who is in a row.
pub(super) fn is_person(name: &str) -> bool {
    [COLUMNS[ID], COLUMNS[AGENT]].iter().any(|known| name.eq_ignore_ascii_case(known))
}

/// The numbers of the columns of a table, from 0, the separator of its cells, the length of a unit of its lengths, m, and the
/// other columns with their names.
struct Header([Option<usize>; COLUMNS.len()], char, f64, Vec<(usize, String)>);

/// Units of lengths that may stand behind the name of a column, `x/cm`, and their sizes, m.
const LENGTHS: [(&str, f64); 3] = [("m", 1.0), ("cm", 0.01), ("mm", 0.001)];

impl Header {
    fn read(line: usize, record: &str, separator: char) -> Result<Self, Vec<LineError>> {
        let mut places = [None; COLUMNS.len()];
        let mut errors = Vec::new();
        let (mut size, mut others) = (None, Vec::new());
        for (k, (column, field)) in cells(record, separator).enumerate() {
            let (field, unit) = match field.split_once('/') {
                Some((name, unit)) if ["x", "y"].iter().any(|own| name.trim().eq_ignore_ascii_case(own)) => {
                    let found = LENGTHS.iter().find(|(known, _)| *known == unit.trim());
                    if found.is_none() {
                        let said = format!("the unit {} of a length is not m, cm or mm", quoted(unit.trim()));
                        errors.push(LineError::at(line, column, said));
                    }
                    (Cow::from(name.trim().to_owned()), found.map(|(_, size)| *size))
                }
                _ => (field, None),
            };
            if let Some(unit) = unit {
                if size.is_some_and(|known| known != unit) {
                    errors.push(LineError::at(line, column, "`x` and `y` must have one unit"));
                }
                size = Some(unit);
            }
            let Some(name) = COLUMNS.iter().position(|name| field.eq_ignore_ascii_case(name)) else {
                others.push((k, field.trim().to_owned()));
                continue;
            };
            if places[name].replace(k).is_some() {
                errors.push(LineError::at(line, column, format!("column {} is there twice", quoted(&field))));
            }
        }
        if places[ID].is_some() {
            places[AGENT] = None;
        }
        let [time, frame, id, x, y, vx, vy, agent, ..] = places;
        for (name, place) in [("id", id.or(agent)), ("x", x), ("y", y)] {
            if place.is_none() {
                errors.push(LineError::whole(line, format!("the header has no column `{name}`")));
            }
        }
        if time.is_some() == frame.is_some() {
            let found = if time.is_some() { "both" } else { "neither" };
            let message = format!("the header must have `time` or `frame` (it has {found})");
            errors.push(LineError::whole(line, message));
        }
        if vx.is_some() != vy.is_some() {
            errors.push(LineError::whole(line, "the header must have both `vx` and `vy` or neither"));
        }
        if errors.is_empty() { Ok(Self(places, separator, size.unwrap_or(1.0), others)) } else { Err(errors) }
    }
}

/// Reads a table, of several trials one. A table with `time` keeps its times; one with `frame` begins at time 0. Empty lines
/// are passed over.
///
/// # Errors
/// A header without the columns, `frame` without `frames_per_second`, several trials of which none is wanted, and every bad
/// line: a field that is missing or not a finite number, an id or a frame that is not a whole number, a position too far from
/// the origin, a person twice at one time, and time that runs backwards.
pub fn read_csv(
    text: &str,
    frames_per_second: Option<f64>,
    trial: Option<u64>,
) -> Result<Recording, Vec<LineError>> {
    read_columns(text, &Reading { frames_per_second, trial, columns: None })
}

/// The same of a table whose columns are perhaps named by the call and not by its first line. Then blanks separate cells, unless
/// there are commas, semicolons or tabs, and lines that begin with `#` are comments.
pub(super) fn read_columns(text: &str, reading: &Reading) -> Result<Recording, Vec<LineError>> {
    let Reading { frames_per_second, trial, columns } = reading;
    let (frames_per_second, trial) = (*frames_per_second, *trial);
    let separator = separator(text.trim_start().lines().next().unwrap_or_default());
    let spaced = columns.as_ref().filter(|_| separator == ',' && !text.contains(',')).map(|_| in_cells(text));
    let text = spaced.as_deref().unwrap_or(text);
    let mut records =
        records(text, separator).filter(|(_, record, _)| columns.is_none() || !record.starts_with('#'));
    let (line, header) = match columns {
        Some(columns) => (
            1,
            Header::read(0, columns, ',').map(|header| Header(header.0, separator, header.2, header.3))?,
        ),
        None => {
            let Some((line, first, _)) = records.next() else {
                return Err(vec![LineError::of_file("the file contains no observation")]);
            };
            (line, Header::read(line, first, separator)?)
        }
    };
    let has_frames = header.0[FRAME].is_some();
    if !has_frames && frames_per_second.is_some() {
        let message = "the table has times, so it takes no number of frames per second";
        return Err(vec![LineError::at(line, 1, message)]);
    }
    let rate = frames_per_second.filter(|rate| rate.is_finite() && *rate > 0.0);
    if has_frames && rate.is_none() {
        let found = frames_per_second.map_or_else(String::new, |rate| format!(" (got {rate})"));
        let message = format!("a table with frames needs a positive number of frames per second{found}");
        return Err(vec![LineError::at(line, 1, message)]);
    }
    let (mut errors, mut traces) = (Vec::new(), Traces::default());
    for (line, record, ends) in records {
        if ends {
            read_row(line, record, &header, (&mut traces, &mut errors));
        } else {
            errors.push(LineError::whole(line, "a quoted cell does not end"));
        }
    }
    let Some(rate) = rate.filter(|_| has_frames) else { return traces.recording(errors, trial) };
    let columns = std::mem::take(&mut traces.columns);
    let rows = traces.of_trial(trial).unwrap_or_else(|error| {
        errors.insert(0, error);
        Vec::new()
    });
    let framed = rows.into_iter().map(|row| {
        let TimedRow { line, time, id, position, velocity } = row;
        Row { line, frame: time as u32, id, position, velocity }
    });
    let people = people(framed.collect(), errors, |row| format!("in frame {}", row.frame))?;
    let stride = usual_stride(&people).unwrap_or(1);
    Ok(Recording::new(people, Clock::film(stride, 1.0 / rate)).beside(columns))
}

/// The same lines with commas between the cells.
fn in_cells(text: &str) -> String {
    let lines = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(","));
    lines.collect::<Vec<_>>().join("\n")
}

/// One row; of a table with frames, its time is the frame.
fn read_row(
    line: usize,
    record: &str,
    header: &Header,
    (traces, errors): (&mut Traces, &mut Vec<LineError>),
) {
    let (before, mut others) = (errors.len(), Vec::new());
    let mut found: [Option<(usize, Cow<'_, str>)>; COLUMNS.len()] = [const { None }; COLUMNS.len()];
    for (k, cell) in cells(record, header.1).enumerate() {
        if let Some(name) = header.0.iter().position(|place| *place == Some(k)) {
            found[name] = Some(cell);
        } else if let Some((_, name)) = header.3.iter().find(|(place, _)| *place == k) {
            others.push((name, number(&pointed(&cell.1, header.1))));
        }
    }
    match &found[PRESENT] {
        Some((_, cell)) if cell == "0" || cell == "false" => return,
        Some((column, cell)) if cell != "1" && cell != "true" => {
            errors.push(LineError::at(line, *column, format!("present {} is neither 0 nor 1", quoted(cell))));
        }
        _ => {}
    }
    let mut values = [0.0; NUMBERS];
    let mut fault = |name: usize, (column, cell): &(usize, Cow<'_, str>), fault: &str| {
        errors.push(LineError::at(line, *column, format!("{} {} {fault}", COLUMNS[name], quoted(cell))));
    };
    for (name, value) in values.iter_mut().enumerate() {
        let Some(cell) = &found[name] else { continue };
        match number(&pointed(&cell.1, header.1)) {
            Err(said) => fault(name, cell, said),
            Ok(number) => {
                *value = number;
                if let Some(said) = whole_fault(number).filter(|_| name == FRAME || name == ID) {
                    fault(name, cell, said);
                }
            }
        }
    }
    let trial = found[TRIAL].as_ref().and_then(|cell| {
        let trial = cell.1.parse::<u64>().ok();
        if trial.is_none() {
            fault(TRIAL, cell, "is not a whole number");
        }
        trial
    });
    for (name, place) in header.0.iter().enumerate() {
        if place.is_some() && found[name].is_none() {
            errors.push(LineError::whole(line, format!("column `{}` is missing", COLUMNS[name])));
        }
    }
    let position = Vec2::new(values[3], values[4]) * header.2;
    if let Some(fault) = coordinate_fault(position) {
        errors.push(LineError::whole(line, fault));
    }
    if errors.len() == before {
        let velocity = header.0[5].map(|_| Vec2::new(values[5], values[6]));
        let time = if header.0[FRAME].is_some() { values[1] } else { values[0] };
        let id = found[AGENT].as_ref().map_or(values[ID] as u32, |(_, name)| traces.place(name));
        traces.push(trial, TimedRow { line, time, id, position, velocity });
        for (name, value) in others {
            if let Ok(value) = value {
                traces.columns.push(name, line, value);
            }
        }
    }
}

/// A number with a decimal point; between cells that commas do not separate, it may have a comma.
fn pointed(cell: &str, separator: char) -> Cow<'_, str> {
    if separator == ',' { cell.into() } else { cell.replace(',', ".").into() }
}

#[cfg(test)]
mod tests {
    use super::super::format::{Format, Reading};
    use super::super::recording::Velocity;
    use super::*;

    fn said(text: &str, rate: Option<f64>) -> Vec<String> {
        read_csv(text, rate, None).unwrap_err().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn times_stay_as_written_and_velocities_look_back() {
        let recording = read_csv("time,id,x,y\n100.0,3,0,0\n100.5,3,1,0\n101,3,2,1\n", None, None).unwrap();
        assert_eq!(recording.velocity(), Velocity::Seen);
        assert_eq!(recording.presence(3), Some((100.0, 101.0)));
        assert!((recording.step() - 0.5).abs() < 1e-12);
        let velocities: Vec<_> = recording.people()[0].samples.iter().map(|s| s.velocity).collect();
        assert_eq!(velocities[0], None);
        assert!((velocities[2].unwrap() - Vec2::new(2.0, 2.0)).norm() < 1e-9);
        assert!((recording.at(100.25)[0].position.x - 0.5).abs() < 1e-9);
    }

    #[test]
    fn frames_need_their_rate_and_columns_have_any_order() {
        let text = " y , x,vy,vx,frame,id,extra\n2,1,0.5,0,30,7,a\n\n";
        let recording = read_csv(text, Some(25.0), None).unwrap();
        assert_eq!(recording.velocity(), Velocity::Recorded);
        let sample = recording.people()[0].samples[0];
        assert_eq!(
            (sample.frame, sample.position, sample.velocity),
            (30, Vec2::new(1.0, 2.0), Some(Vec2::new(0.0, 0.5)))
        );
        assert!(said(text, None)[0].contains("needs a positive number"), "{:?}", said(text, None));
        assert!(said(text, Some(0.0))[0].ends_with("(got 0)"));
    }

    #[test]
    fn all_faults_come_at_once_and_in_order() {
        assert_eq!(
            said(
                "time,id,x,y\n0,1,0,0\n1,1,0\n-0.5,1,0,0\n2,x,é,inf\n2,-1,0,0\n2,4,0,2e6\n0,2,1,1\n0,2,1,1\n",
                None
            ),
            [
                "line 3: column `y` is missing",
                "line 4: the time of person 1 runs backwards: -0.5 after 0 in line 2",
                "line 5, column 3: id `x` is not a number",
                "line 5, column 5: x `é` is not a number",
                "line 5, column 7: y `inf` is not a finite number",
                "line 6, column 3: id `-1` is negative",
                "line 7: a coordinate must lie between -1e6 m and 1e6 m (got 2e6 m)",
                "line 9: person 2 is at time 0 twice, first in line 8",
            ]
        );
        assert_eq!(
            said("time,frame,id,vx,x,x\n", None),
            [
                "line 1, column 20: column `x` is there twice",
                "line 1: the header has no column `y`",
                "line 1: the header must have `time` or `frame` (it has both)",
                "line 1: the header must have both `vx` and `vy` or neither",
            ]
        );
        assert_eq!(said("", None), ["the file contains no observation"]);
        assert_eq!(said("time,id,x,y\n", None), ["the file contains no observation"]);
        assert!(said("time,id,x,y\n0,1,0,0\n1e9,1,0,0\n", None)[0].contains("119 hours"));
    }

    #[test]
    fn mixed_rates_are_refused_and_holes_are_not() {
        let rows = |id: u32, step: f64, count: u32| -> String {
            (0..count).map(|k| format!("{},{id},0,{k}\n", f64::from(k) * step)).collect()
        };
        let head = "time,id,x,y\n";
        let mixed = format!("{head}{}{}", rows(1, 0.4, 9), rows(2, 0.1, 4));
        assert_eq!(
            said(&mixed, None),
            ["line 11: person 2 is recorded every 0.1 s, most others every 0.4 s"]
        );
        let sparse = format!("{head}{}0,2,0,0\n0.4,2,0,0\n1.2,2,0,0\n2,2,0,0\n", rows(1, 0.4, 9));
        assert!(read_csv(&sparse, None, None).is_ok());
        // A thirtieth of a second in milliseconds is 33 or 34 of them.
        let film: String = (0..60).map(|k| format!("{:.3},1,0,{k}\n", f64::from(k) / 30.0)).collect();
        let recording = read_csv(&format!("{head}{film}"), None, None).unwrap();
        assert_eq!(recording.stretches().len(), 1);
    }

    #[test]
    fn traces_have_names_trials_and_rows_of_absent_agents() {
        let text = "time,trial,agent,x,y,vx,vy,speed,present,n\n0,3,\"cm,\"\"\n\",1.5,2,0,1,1,1,5\n0,3,b,,,,,,0,\n\
                    0.1,3,b,4,4,0,0,0,1,5\n0,4,b,9,9,0,0,0,1,5\n";
        let recording = read_csv(text, None, Some(3)).unwrap();
        assert_eq!(recording.ids().collect::<Vec<_>>(), [1, 2]);
        let first = recording.at(0.0);
        assert_eq!((first.len(), first[0].position), (1, Vec2::new(1.5, 2.0)));
        assert_eq!(recording.velocity(), Velocity::Recorded);
        assert_eq!(said(text, None), ["the table has the trials 3, 4: choose one with `trial`"]);
        assert_eq!(
            said("time,agent,x,y,trial,present\n0,a,0,0,-1,1\n0,a,0,0,1,2\n0,\"a,0,0,1,1\n", None),
            [
                "line 2, column 9: trial `-1` is not a whole number",
                "line 3, column 11: present `2` is neither 0 nor 1",
                "line 4: a quoted cell does not end",
            ]
        );
    }

    #[test]
    fn spreadsheets_write_tables_too() {
        let wanted = read_csv("time,id,x,y\n0,1,0.5,2\n0.4,1,1,2.5\n", None, None).unwrap();
        for text in [
            "\"time\",\"id\",\"x\",\"y\"\n\"0\",\"1\",\"0.5\",\"2\"\n\"0.4\",\"1\",\"1\",\"2.5\"\n",
            "Time,ID,X,Y\r\n0,1,0.5,2\r\n0.4,1,1,2.5\r\n",
            "time;id;x;y\n0;1;0,5;2\n0,4;1;1;2,5\n",
            "TIME\tAgent\tx\ty\n0\t1\t0.5\t2\n0.4\t1\t1\t2.5\n",
        ] {
            assert_eq!(read_csv(text, None, None).unwrap(), wanted, "{text}");
            let marked = format!("\u{feff}{text}");
            let format = Format::of(&marked).unwrap();
            assert_eq!(
                (format.name, format.read(&marked, &Reading::default()).unwrap()),
                ("csv", wanted.clone())
            );
        }
        assert_eq!(
            said("time,id,x,y\n0,1,0,0\n", Some(25.0)),
            ["line 1, column 1: the table has times, so it takes no number of frames per second"]
        );
    }
}
