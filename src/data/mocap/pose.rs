//! Forward kinematics: where a joint is, from the rotations along the chain of joints from the root to it.

use crate::base::math::sin_cos;
use crate::data::tracks::LineError;
use crate::data::tracks::line::quoted;
use nalgebra::{Matrix3, Vector3};

/// Longest chain of joints.
pub(super) const DEEPEST: usize = 100;

/// A degree of freedom: along or around axis 0, 1 or 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Channel {
    Move(usize),
    Turn(usize),
}

impl Channel {
    /// The channel with a name: an axis and `moves` or `turns`, as in `Xposition` (BVH) and `tx` (ASF).
    pub(super) fn of(axis: &str, kind: &str, moves: &str, turns: &str) -> Option<Self> {
        let axis = ["x", "y", "z"].iter().position(|name| axis.eq_ignore_ascii_case(name))?;
        if kind.eq_ignore_ascii_case(moves) {
            Some(Self::Move(axis))
        } else {
            kind.eq_ignore_ascii_case(turns).then_some(Self::Turn(axis))
        }
    }
}

/// A rotation around an axis.
fn turn(axis: usize, degrees: f64) -> Matrix3<f64> {
    let (sin, cos) = sin_cos(degrees * (std::f64::consts::PI / 180.0));
    match axis {
        0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos),
        1 => Matrix3::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos),
        _ => Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0),
    }
}

/// The shift and the rotation (the product from the left to the right) of channels and their values in degrees.
pub(super) fn motion(channels: impl Iterator<Item = (Channel, f64)>) -> (Option<Vector3<f64>>, Matrix3<f64>) {
    let (mut shift, mut rotation) = (None, Matrix3::identity());
    for (channel, value) in channels {
        match channel {
            Channel::Move(axis) => shift.get_or_insert_with(Vector3::zeros)[axis] += value,
            Channel::Turn(axis) => rotation *= turn(axis, value),
        }
    }
    (shift, rotation)
}

/// The end of a chain of links, each a shift, a rotation, and a shift after it.
pub(super) fn end(links: impl Iterator<Item = (Vector3<f64>, Matrix3<f64>, Vector3<f64>)>) -> [f64; 3] {
    let (mut place, mut rotation) = (Vector3::zeros(), Matrix3::identity());
    for (before, own, after) in links {
        place += rotation * before;
        rotation *= own;
        place += rotation * after;
    }
    place.into()
}

/// The joints from the root to one of them; `None` if there are too many, as in a circle.
pub(super) fn chain(joint: usize, parent: impl Fn(usize) -> Option<usize>) -> Option<Vec<usize>> {
    let mut chain: Vec<usize> =
        std::iter::successors(Some(joint), |&at| parent(at)).take(DEEPEST + 1).collect();
    chain.reverse();
    (chain.len() <= DEEPEST).then_some(chain)
}

/// The number in a field.
pub(super) fn number(line: usize, (column, field): (usize, &str)) -> Result<f64, LineError> {
    let fault = match field.parse::<f64>() {
        Ok(value) if value.is_finite() => return Ok(value),
        Ok(_) => "finite number",
        Err(_) => "number",
    };
    Err(LineError::at(line, column, format!("{} is not a {fault}", quoted(field))))
}

/// So many numbers, in all fields that are left of a line.
pub(super) fn numbers<'a>(
    line: usize,
    count: usize,
    what: &str,
    fields: impl Iterator<Item = (usize, &'a str)>,
) -> Result<Vec<f64>, LineError> {
    let values = fields.map(|field| number(line, field)).collect::<Result<Vec<f64>, _>>()?;
    if values.len() == count {
        return Ok(values);
    }
    Err(LineError::whole(line, format!("{what} needs {count} numbers (got {})", values.len())))
}
