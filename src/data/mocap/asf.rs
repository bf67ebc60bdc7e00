//! Reader of ASF (Acclaim skeleton file): the bones of a person, for the motions in AMC files.
//!
//! A bone begins at the end of its parent. With `C = Rz Ry Rx` of its `axis` and `B = Rz Ry Rx` of its values, its rotation is
//! `C B C^-1` within that of its parent. Limits and masses have no effect on a recorded motion and are ignored.

use super::layout::Layout;
use super::pose::{Channel, motion, numbers};
use crate::data::tracks::LineError;
use crate::data::tracks::line::{fields, quoted};
use nalgebra::{Matrix3, Vector3};

/// A skeleton.
#[derive(Clone, Debug)]
pub struct Asf {
    /// The root, then the other bones.
    pub(super) bones: Vec<Bone>,
    /// The `length` of the units: an inch is so many of the file's.
    pub(super) unit: f64,
}

/// More bones no person has: each is searched among all.
const MOST_BONES: usize = 1000;

#[derive(Clone, Debug)]
pub(super) struct Bone {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    /// From its begin to its end, in the axes of the file.
    along: Vector3<f64>,
    length: f64,
    axis: Matrix3<f64>,
    pub(super) channels: Vec<Channel>,
}

impl Bone {
    fn named(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            parent: None,
            along: Vector3::zeros(),
            length: 0.0,
            axis: Matrix3::identity(),
            channels: Vec::new(),
        }
    }

    /// Shift, rotation and shift after it, with the values of its channels.
    pub(super) fn link(&self, values: &[f64], layout: &Layout) -> (Vector3<f64>, Matrix3<f64>, Vector3<f64>) {
        // The channel that is written last turns first in the frame of the parent: B = Rz Ry Rx for `rx ry rz`.
        let values = self.channels.iter().copied().zip(values.iter().copied());
        let (shift, own) = motion(values.map(|one| layout.degrees(one)).rev());
        (shift.unwrap_or_default(), self.axis * own * self.axis.transpose(), self.along * self.length)
    }
}

impl Asf {
    /// Reads a skeleton.
    ///
    /// # Errors
    /// The first line that is not as the format says.
    pub fn read(text: &str) -> Result<Self, LineError> {
        let mut bones = vec![Bone::named("root")];
        let (mut section, mut unit) = ("", 0.45);
        for (k, line) in text.lines().enumerate() {
            let number = k + 1;
            let mut rest = fields(line);
            let Some((column, key)) = rest.next() else { continue };
            let fault = |message: String| Err(LineError::at(number, column, message));
            if key.starts_with(':') {
                section = key;
                continue;
            }
            let last = bones.len() - 1;
            match (section, key) {
                (":units", "angle") if rest.next().is_some_and(|(_, unit)| unit != "deg") => {
                    return fault("angles must be in degrees (`deg`)".to_owned());
                }
                (":units", "length") => {
                    unit = numbers(number, 1, key, rest)?[0];
                    if unit <= 0.0 {
                        return fault("the unit of length must be positive".to_owned());
                    }
                }
                (":root", "axis") => {
                    turns(number, rest.next())?;
                }
                (":root", "position" | "orientation") => {
                    let moved = numbers(number, 3, key, rest)?;
                    if moved != [0.0; 3] {
                        return fault(format!("a root with {key} other than 0 0 0 is not supported"));
                    }
                }
                (":root", "order") => bones[0].channels = channels(number, rest)?,
                (":bonedata", "begin") if bones.len() >= MOST_BONES => {
                    return fault(format!("a skeleton has at most {MOST_BONES} bones"));
                }
                (":bonedata", "begin") => bones.push(Bone::named("")),
                (":bonedata", "name" | "direction" | "length" | "axis" | "dof") if last == 0 => {
                    return fault(format!("`{key}` stands outside of a bone (`begin` … `end`)"));
                }
                (":bonedata", "name") => {
                    rest.next().unwrap_or_default().1.clone_into(&mut bones[last].name);
                }
                (":bonedata", "direction") => {
                    bones[last].along = Vector3::from_vec(numbers(number, 3, key, rest)?);
                }
                (":bonedata", "length") => bones[last].length = numbers(number, 1, key, rest)?[0],
                (":bonedata", "axis") => bones[last].axis = axis(number, rest)?,
                (":bonedata", "dof") => bones[last].channels = channels(number, rest)?,
                (":hierarchy", "begin" | "end") => {}
                (":hierarchy", parent) => {
                    let mut find = |(column, name): (usize, &str)| {
                        let at = bones.iter().position(|bone| bone.name == name);
                        at.ok_or_else(|| {
                            LineError::at(number, column, format!("the file has no bone {}", quoted(name)))
                        })
                    };
                    let parent = find((column, parent))?;
                    let children = rest.map(&mut find).collect::<Result<Vec<usize>, _>>()?;
                    for child in children {
                        bones[child].parent = Some(parent);
                    }
                }
                _ => {}
            }
        }
        if bones.len() == 1 {
            return Err(LineError::of_file("the file has no bones; is it a skeleton (.asf)?"));
        }
        Ok(Self { bones, unit })
    }
}

fn channels<'a>(
    line: usize,
    fields: impl Iterator<Item = (usize, &'a str)>,
) -> Result<Vec<Channel>, LineError> {
    let channel = |(column, field): (usize, &str)| {
        let channel = field.split_at_checked(1).and_then(|(kind, axis)| Channel::of(axis, kind, "t", "r"));
        let fault = || format!("{} is not supported; use tx, ty, tz, rx, ry and rz", quoted(field));
        channel.ok_or_else(|| LineError::at(line, column, fault()))
    };
    fields.map(channel).collect()
}

/// The three different axes of an order such as `XYZ`.
fn turns(line: usize, order: Option<(usize, &str)>) -> Result<Vec<Channel>, LineError> {
    let turn = |name: char| Channel::of(name.encode_utf8(&mut [0; 4]), "r", "t", "r");
    let found: Option<Vec<Channel>> = order.and_then(|(_, order)| order.chars().map(turn).collect());
    let has = |axis| found.iter().flatten().filter(|turn| **turn == Channel::Turn(axis)).count() == 1;
    if (0..3).all(has) {
        return Ok(found.unwrap_or_default());
    }
    let message = "`axis` needs an order of the three axes behind its angles, as in `0 0 20 XYZ`";
    Err(LineError::at(line, order.map_or(1, |(column, _)| column), message))
}

/// `C` of the line `axis`: three angles and their order, the one that turns first written first.
fn axis<'a>(line: usize, fields: impl Iterator<Item = (usize, &'a str)>) -> Result<Matrix3<f64>, LineError> {
    let mut fields: Vec<(usize, &str)> = fields.collect();
    let order = fields.pop();
    let angles = numbers(line, 3, "`axis`", fields.into_iter())?;
    let turns = turns(line, order)?;
    // The angles are those around x, y and z, whatever their order.
    let value = |turn: &Channel| match turn {
        Channel::Turn(axis) | Channel::Move(axis) => angles[*axis],
    };
    Ok(motion(turns.iter().rev().map(|turn| (*turn, value(turn)))).1)
}
