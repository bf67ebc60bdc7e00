//! Reader of BVH (Biovision hierarchy): a skeleton, then one line of channel values per frame.

use super::layout::{Layout, listed};
use super::pose::{Channel, DEEPEST, chain, end, motion, number, numbers};
use super::take::Frames;
use crate::data::tracks::LineError;
use crate::data::tracks::line::{fields, quoted};
use nalgebra::{Matrix3, Vector3};

#[derive(Debug, Default)]
struct Joint {
    name: String,
    parent: Option<usize>,
    offset: Vector3<f64>,
    channels: Vec<Channel>,
    /// Column of its first channel.
    first: usize,
}

/// Reads a file. Without a layout it chooses the preset whose joints the skeleton has.
pub(super) fn read_bvh(text: &str, layout: Option<&Layout>) -> Result<(Frames, Layout), Vec<LineError>> {
    let (joints, motion) = hierarchy(text).map_err(|error| vec![error])?;
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let Some(layout) = layout.cloned().or_else(|| preset(&names)) else {
        let message = format!(
            "no layout fits the skeleton; state which joints are root, ankles and toes among {}",
            listed(&names)
        );
        return Err(vec![LineError::of_file(message)]);
    };
    let found = layout.find(&names).map_err(|error| vec![error])?;
    let chains = found.map(|joint| chain(joint, |at| joints[at].parent).unwrap_or_default());
    let columns = joints.iter().map(|joint| joint.channels.len()).sum();
    let (mut frames, mut errors) = (Frames::default(), Vec::new());
    let (count, dt) = head(text, motion).map_err(|error| vec![error])?;
    frames.fps = Some(1.0 / dt);
    for (k, line) in text.lines().enumerate().skip(motion + 3).filter(|(_, line)| !line.trim().is_empty()) {
        match numbers(k + 1, columns, "a frame", fields(line)) {
            Err(error) => errors.push(error),
            Ok(values) => {
                let places = chains
                    .each_ref()
                    .map(|chain| end(chain.iter().map(|&at| link(&joints[at], &values, &layout))));
                frames.places.push((k + 1, places));
            }
        }
    }
    if errors.is_empty() && frames.places.len() as f64 != count {
        let message = format!("`Frames:` says {count} frames, but there are {}", frames.places.len());
        errors.push(LineError::whole(motion + 2, message));
    }
    if errors.is_empty() { Ok((frames, layout)) } else { Err(errors) }
}

/// The preset whose joints a skeleton has.
fn preset(joints: &[&str]) -> Option<Layout> {
    Layout::presets().into_iter().map(|(_, layout)| layout).find(|layout| layout.find(joints).is_ok())
}

/// The preset whose joints the skeleton of a BVH file has; none for other texts.
pub fn bvh_preset(text: &str) -> Option<Layout> {
    let (joints, _) = hierarchy(text).ok()?;
    preset(&joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>())
}

fn link(joint: &Joint, values: &[f64], layout: &Layout) -> (Vector3<f64>, Matrix3<f64>, Vector3<f64>) {
    let values = values[joint.first..].iter().copied();
    let (shift, rotation) = motion(joint.channels.iter().copied().zip(values).map(|one| layout.degrees(one)));
    let before = match shift {
        Some(shift) if layout.replace_offsets => shift,
        shift => joint.offset + shift.unwrap_or_default(),
    };
    (before, rotation, Vector3::zeros())
}

/// The two lines after `MOTION`: the count of frames and the seconds between them.
fn head(text: &str, motion: usize) -> Result<(f64, f64), LineError> {
    let mut lines = text.lines().enumerate().skip(motion + 1);
    let mut value = |words: &[&str]| {
        let (k, line) = lines.next().unwrap_or((motion, ""));
        let mut found = fields(line);
        let good = words.iter().all(|word| found.next().is_some_and(|(_, field)| field == *word));
        let message = || format!("`{}` and one number are expected here", words.join(" "));
        match (found.next(), found.next()) {
            (Some(field), None) if good => Ok((k + 1, number(k + 1, field)?)),
            _ => Err(LineError::whole(k + 1, message())),
        }
    };
    let (_, count) = value(&["Frames:"])?;
    let (line, dt) = value(&["Frame", "Time:"])?;
    if dt > 0.0 {
        return Ok((count, dt));
    }
    Err(LineError::whole(line, format!("`Frame Time:` must be positive (got {dt})")))
}

/// A word with its line and column.
type Word<'a> = (usize, usize, &'a str);

fn expected((line, column, word): Word<'_>, wanted: &str) -> LineError {
    LineError::at(line, column, format!("{wanted} is expected here (got {})", quoted(word)))
}

/// The joints, each after its parent, and the index of the line `MOTION`.
fn hierarchy(text: &str) -> Result<(Vec<Joint>, usize), LineError> {
    let Some(motion) = text.lines().position(|line| line.trim() == "MOTION") else {
        return Err(LineError::of_file("the file has no line `MOTION`"));
    };
    let mut words = text
        .trim_start_matches('\u{feff}')
        .lines()
        .take(motion)
        .enumerate()
        .flat_map(|(k, line)| fields(line).map(move |(column, word)| (k + 1, column, word)));
    let (mut joints, mut open, mut columns) = (Vec::<Joint>::new(), Vec::<usize>::new(), 0);
    let ends =
        |wanted: &str| LineError::whole(motion + 1, format!("the skeleton ends where {wanted} is expected"));
    let first = words.next().ok_or_else(|| ends("`HIERARCHY`"))?;
    if first.2 != "HIERARCHY" {
        return Err(expected(first, "`HIERARCHY`"));
    }
    while let Some(word) = words.next() {
        let mut next = |wanted: &str| words.next().ok_or_else(|| ends(wanted));
        match (word.2, open.last().copied()) {
            ("ROOT", None) | ("JOINT" | "End", Some(_)) => {
                let (parent, name) = (open.last().copied(), next("a name")?.2);
                let name = match parent {
                    Some(parent) if word.2 == "End" => format!("{}.end", joints[parent].name),
                    _ => name.to_owned(),
                };
                let brace = next("`{`")?;
                if brace.2 != "{" {
                    return Err(expected(brace, "`{`"));
                }
                open.push(joints.len());
                joints.push(Joint { name, parent, ..Joint::default() });
                if open.len() > DEEPEST {
                    let message = format!("joints are nested more than {DEEPEST} deep");
                    return Err(LineError::at(brace.0, brace.1, message));
                }
            }
            ("OFFSET", Some(at)) => {
                for axis in 0..3 {
                    let (line, column, field) = next("a number")?;
                    joints[at].offset[axis] = number(line, (column, field))?;
                }
            }
            ("CHANNELS", Some(at)) if joints[at].channels.is_empty() => {
                let word = next("a number")?;
                let Ok(count @ 0..=6) = word.2.parse::<u8>() else {
                    return Err(expected(word, "a number of channels from 0 to 6"));
                };
                joints[at].first = columns;
                columns += usize::from(count);
                for _ in 0..count {
                    let word = next("a channel")?;
                    let channel = word.2.split_at_checked(1);
                    let channel =
                        channel.and_then(|(axis, kind)| Channel::of(axis, kind, "position", "rotation"));
                    let wanted = "a channel such as `Xposition` or `Zrotation`";
                    joints[at].channels.push(channel.ok_or_else(|| expected(word, wanted))?);
                }
            }
            ("}", Some(_)) => {
                open.pop();
            }
            (_, None) => return Err(expected(word, "`ROOT` or `MOTION`")),
            _ => return Err(expected(word, "`JOINT`, `End Site`, `OFFSET`, `CHANNELS` or `}`")),
        }
    }
    if open.is_empty() && !joints.is_empty() { Ok((joints, motion)) } else { Err(ends("`}`")) }
}
