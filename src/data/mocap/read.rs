//! Reading the takes of one file, in the format that its extension says.

use super::asf::Asf;
use super::bvh::read_bvh;
use super::layout::{Layout, listed};
use super::pose::{DEEPEST, chain, end, numbers};
use super::positions::{Clip, read_positions};
use super::take::{Frames, NO_RATE, Take};
use super::takes::{TakeRow, stem};
use crate::data::tracks::LineError;
use crate::data::tracks::line::{fields, quoted};
use std::collections::BTreeMap;

/// The takes of a file with its text; an AMC file needs its skeleton. The rows are those of a table of takes that name the file:
/// they choose clips and state rates. Without rows all takes of the file are read. Without a layout the preset of the format
/// is used, for a BVH file the one whose joints it has.
///
/// # Errors
/// Every line that is wrong, or else what the whole file lacks.
pub fn read_takes(
    file: &str,
    text: &str,
    skeleton: Option<&Asf>,
    layout: Option<&Layout>,
    rows: &[TakeRow],
) -> Result<Vec<Take>, Vec<LineError>> {
    let one = |message: String| Err(vec![LineError::of_file(message)]);
    let Some((preset, own)) = Layout::of_file(file, skeleton) else {
        return one(format!("{} has no known extension (.bvh, .amc or .csv)", quoted(file)));
    };
    let layout_or_preset = layout.cloned().unwrap_or(own);
    let (frames, layout) = match (preset, skeleton) {
        ("csv", _) => return clips(file, text, &layout_or_preset, rows),
        ("bvh", _) => read_bvh(text, layout)?,
        (_, Some(skeleton)) => (read_amc(skeleton, text, &layout_or_preset)?, layout_or_preset),
        (_, None) => return one("an AMC file needs its skeleton (.asf)".to_owned()),
    };
    let take = match rows {
        [] => frames.take(stem(file), "", None, &layout),
        [row] => frames.take(&row.name, &row.subject, row.fps, &layout),
        [a, b, ..] => {
            return one(format!(
                "the file has one take, but lines {} and {} of the table name it",
                a.line, b.line
            ));
        }
    };
    take.map(|take| vec![take]).map_err(|error| vec![error])
}

fn clips(file: &str, text: &str, layout: &Layout, rows: &[TakeRow]) -> Result<Vec<Take>, Vec<LineError>> {
    let clips = read_positions(text, layout)?;
    if rows.is_empty() {
        let rate = |clip: &Clip| clip.frames.fps.map(|fps| (fps, clip.name.clone()));
        let rates: Vec<(f64, String)> = clips.iter().filter_map(rate).collect();
        let other = rates.iter().find(|(fps, _)| (fps / rates[0].0 - 1.0).abs() > 0.01);
        if let (Some((fps, name)), None) = (other, layout.fps) {
            let (first, clip) = &rates[0];
            let message = format!(
                "clips {} and {} have {first:.2} and {fps:.2} frames per second; list them in a table of takes",
                quoted(clip),
                quoted(name)
            );
            return Err(vec![LineError::of_file(message)]);
        }
        let name = |clip: &Clip| if clip.name.is_empty() { stem(file).to_owned() } else { clip.name.clone() };
        let take = |clip: &Clip| {
            let named = |error: LineError| match error.message.as_str() {
                NO_RATE => error,
                said => LineError { message: format!("clip {}: {said}", quoted(&clip.name)), ..error },
            };
            clip.frames.take(&name(clip), "", None, layout).map_err(named)
        };
        return collected(clips.iter().map(take));
    }
    let names: Vec<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
    collected(rows.iter().map(|row| match clips.iter().find(|clip| clip.name == row.clip) {
        Some(clip) => clip.frames.take(&row.name, &row.subject, row.fps, layout),
        None => {
            let (clip, line, names) = (quoted(&row.clip), row.line, listed(&names));
            let message = format!("the file has no clip {clip} (line {line} of the table); it has {names}");
            Err(LineError::of_file(message))
        }
    }))
}

/// All takes, or all errors.
fn collected(takes: impl Iterator<Item = Result<Take, LineError>>) -> Result<Vec<Take>, Vec<LineError>> {
    let (mut good, mut errors) = (Vec::new(), Vec::new());
    for take in takes {
        match take {
            Ok(take) => good.push(take),
            Err(error) => errors.push(error),
        }
    }
    // One rate is missing for all.
    errors.dedup();
    if good.is_empty() && errors.is_empty() {
        errors.push(LineError::of_file("the file has no frames"));
    }
    if errors.is_empty() { Ok(good) } else { Err(errors) }
}

// Reader of AMC (Acclaim motion capture): for each frame the values of the bones of a skeleton, in degrees.

/// Reads a motion of a skeleton.
fn read_amc(asf: &Asf, text: &str, layout: &Layout) -> Result<Frames, Vec<LineError>> {
    let names: Vec<&str> = asf.bones.iter().map(|bone| bone.name.as_str()).collect();
    let found = layout.find(&names).map_err(|error| vec![error])?;
    let chains = found.map(|bone| chain(bone, |at| asf.bones[at].parent));
    let [Some(root), Some(left_ankle), Some(left_toe), Some(right_ankle), Some(right_toe)] = chains else {
        let message = format!("the bones of the skeleton form a circle or a chain of more than {DEEPEST}");
        return Err(vec![LineError::of_file(message)]);
    };
    let chains = [root, left_ankle, left_toe, right_ankle, right_toe];
    let known: BTreeMap<&str, usize> = names.iter().enumerate().map(|(k, name)| (*name, k)).collect();
    let (mut frames, mut errors) = (Frames::default(), Vec::new());
    let mut values = vec![Vec::<f64>::new(); names.len()];
    let mut open = None;
    let mut close = |(line, frame): (usize, u64), values: &mut Vec<Vec<f64>>, errors: &mut Vec<LineError>| {
        let lacks = |k: &usize| values[*k].len() != asf.bones[*k].channels.len();
        if let Some(bone) = (0..names.len()).find(lacks) {
            errors.push(LineError::whole(line, format!("frame {frame} lacks {}", quoted(names[bone]))));
        }
        let places = chains
            .each_ref()
            .map(|chain| end(chain.iter().map(|&at| asf.bones[at].link(&values[at], layout))));
        frames.places.push((line, places));
        values.iter_mut().for_each(Vec::clear);
    };
    for (k, line) in text.lines().enumerate() {
        let mut rest = fields(line);
        let Some((column, key)) = rest.next() else { continue };
        if key.starts_with(['#', ':']) {
            if key.eq_ignore_ascii_case(":radians") && !layout.radians {
                errors.push(LineError::at(k + 1, column, "angles must be in degrees (`:DEGREES`)"));
            }
        } else if let Ok(frame) = key.parse::<u64>() {
            if let Some((before, number)) = open {
                close((before, number), &mut values, &mut errors);
                if frame != number.saturating_add(1) {
                    let message = format!("frame {frame} follows frame {number}");
                    errors.push(LineError::at(k + 1, column, message));
                }
            }
            open = Some((k + 1, frame));
        } else if let Some(&bone) = known.get(key) {
            let count = asf.bones[bone].channels.len();
            let again = !values[bone].is_empty();
            match numbers(k + 1, count, &quoted(key), rest) {
                Ok(_) if again || open.is_none() => {
                    let fault =
                        if again { "is in this frame twice" } else { "stands before the first frame" };
                    errors.push(LineError::at(k + 1, column, format!("{} {fault}", quoted(key))));
                }
                Ok(found) => values[bone] = found,
                Err(error) => {
                    errors.push(error);
                    // One error is enough: the frame does not lack this bone.
                    values[bone] = vec![0.0; count];
                }
            }
        } else {
            let message = format!("the skeleton has no bone {}", quoted(key));
            errors.push(LineError::at(k + 1, column, message));
        }
    }
    if let Some(last) = open {
        close(last, &mut values, &mut errors);
    }
    if errors.is_empty() { Ok(frames) } else { Err(errors) }
}
