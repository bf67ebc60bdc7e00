//! Reader of CSV tables of positions: one row per frame, with columns `hip_x`, `hip_y` and so on for the root, the ankles and
//! the toes, a column `frame` or `t` (s), and a column `clip` if the file has several takes.

use super::layout::Layout;
use super::pose::number;
use super::take::{Frames, Places};
use crate::data::tracks::LineError;
use csv::{Reader, ReaderBuilder, StringRecord};
use std::collections::BTreeMap;

/// Largest difference between frames of one clip in time, as a share of the usual one.
const JITTER: f64 = 0.1;

/// A clip of the file.
#[derive(Debug, Default)]
pub(super) struct Clip {
    pub(super) name: String,
    pub(super) frames: Frames,
    /// Frame or time of its rows.
    marks: Vec<f64>,
}

/// A CSV reader, and where the named columns are in its header. Of columns written as `a|b` one is needed.
pub(super) fn table<'t, const N: usize>(
    text: &'t str,
    wanted: &[String; N],
) -> Result<(Reader<&'t [u8]>, [usize; N]), LineError> {
    let mut reader = ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| fault(&error))?.clone();
    let at = |name: &String| name.split('|').find_map(|name| header.iter().position(|field| field == name));
    let lacking: Vec<&str> = wanted.iter().filter(|name| at(name).is_none()).map(String::as_str).collect();
    if lacking.is_empty() {
        return Ok((reader, wanted.each_ref().map(|name| at(name).unwrap_or_default())));
    }
    let lacking = lacking.join(", ").replace('|', " or ");
    let found: Vec<&str> = header.iter().collect();
    let message = format!("the header lacks {lacking}; its columns are {}", super::layout::listed(&found));
    Err(LineError::whole(1, message))
}

/// An error of the CSV reader.
fn fault(error: &csv::Error) -> LineError {
    let line = error.position().map_or(0, |position| position.line() as usize);
    let message = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the row has {len} fields, but the header has {expected_len}")
        }
        _ => "the row is not CSV".to_owned(),
    };
    LineError::whole(line, message)
}

/// A row that is CSV; else its error is added.
pub(super) fn good(
    row: Result<StringRecord, csv::Error>,
    errors: &mut Vec<LineError>,
) -> Option<StringRecord> {
    row.map_err(|error| errors.push(fault(&error))).ok()
}

/// A field with the line and the column at which it begins, in a row without quotes.
pub(super) fn field(row: &StringRecord, at: usize) -> (usize, (usize, &str)) {
    let line = row.position().map_or(0, |position| position.line() as usize);
    let before: usize = row.iter().take(at).map(|field| field.chars().count() + 1).sum();
    (line, (before + 1, &row[at]))
}

/// Reads all clips, in the order in which they begin; a file without column `clip` is one clip without a name.
pub(super) fn read_positions(text: &str, layout: &Layout) -> Result<Vec<Clip>, Vec<LineError>> {
    let joints = layout.joints();
    let columns: [String; 16] = std::array::from_fn(|k| match k {
        15 => "frame|t".to_owned(),
        _ => format!("{}_{}", joints[k / 3], ["x", "y", "z"][k % 3]),
    });
    let (mut reader, at) = table(text, &columns).map_err(|error| vec![error])?;
    let header = reader.headers().map_err(|error| vec![fault(&error)])?;
    let (timed, name) = (&header[at[15]] == "t", header.iter().position(|field| field == "clip"));
    let (mut clips, mut known, mut errors) = (Vec::<Clip>::new(), BTreeMap::new(), Vec::new());
    for row in reader.records() {
        let Some(row) = good(row, &mut errors) else { continue };
        let before = errors.len();
        let mut places = Places::default();
        let mut mark = 0.0;
        for (k, column) in at.iter().enumerate() {
            let cell = if k < 15 { &mut places[k / 3][k % 3] } else { &mut mark };
            match row[*column].parse::<f64>() {
                Ok(value) if value.is_finite() => *cell = value,
                _ => {
                    let (line, field) = field(&row, *column);
                    errors.extend(number(line, field).err());
                }
            }
        }
        if errors.len() > before {
            continue;
        }
        let name = name.map_or("", |name| &row[name]);
        let clip = match known.get(name) {
            Some(&clip) => clip,
            None => {
                known.insert(name.to_owned(), clips.len());
                clips.push(Clip { name: name.to_owned(), ..Clip::default() });
                clips.len() - 1
            }
        };
        let (clip, (line, place)) = (&mut clips[clip], field(&row, at[15]));
        if let Some(last) = clip.marks.last() {
            let good = if timed { mark > *last } else { mark == last + 1.0 };
            if !good {
                let message =
                    format!("{} {mark} follows {last} in its clip", if timed { "time" } else { "frame" });
                errors.push(LineError::at(line, place.0, message));
            }
        }
        clip.marks.push(mark);
        clip.frames.places.push((line, places));
    }
    if timed && errors.is_empty() {
        errors.extend(clips.iter_mut().filter_map(rate));
    }
    if errors.is_empty() { Ok(clips) } else { Err(errors) }
}

/// Finds the frame rate of a clip from its times, which must be equally far apart.
fn rate(clip: &mut Clip) -> Option<LineError> {
    let (first, last) = (clip.marks.first()?, clip.marks.last()?);
    let usual = (last - first) / clip.marks.len().saturating_sub(1).max(1) as f64;
    clip.frames.fps = (usual > 0.0).then_some(1.0 / usual);
    let uneven = |pair: &[f64]| (pair[1] - pair[0] - usual).abs() > JITTER * usual;
    let at = clip.marks.windows(2).position(uneven)?;
    let gap = clip.marks[at + 1] - clip.marks[at];
    let message = format!("this frame is {gap:.4} s after the one before it, but usual are {usual:.4} s");
    Some(LineError::whole(clip.frames.places[at + 1].0, message))
}
