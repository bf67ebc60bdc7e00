//! Reader of AMC (Acclaim motion capture): for each frame the values of the bones of a skeleton, in degrees.

use super::asf::Asf;
use super::layout::Layout;
use super::pose::{DEEPEST, chain, end, numbers};
use super::take::Frames;
use crate::data::tracks::LineError;
use crate::data::tracks::line::{fields, quoted};
use std::collections::BTreeMap;

/// Reads a motion of a skeleton.
pub(super) fn read_amc(asf: &Asf, text: &str, layout: &Layout) -> Result<Frames, Vec<LineError>> {
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
