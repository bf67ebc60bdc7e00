//! A step as a row of eleven numbers: the landmarks x1, y1, ... x5, y5 in m and the duration in s (Agethen et al. 2018,
//! section 4.1, has the first ten).

use crate::base::geometry::Vec2;
use crate::gait::{Foot, SPANS, Shape};

/// Numbers of a step.
pub(super) const COLUMNS: usize = 2 * SPANS + 1;

/// The column with the x of the last landmark: the length of a straight step.
pub(super) const LENGTH: usize = 2 * SPANS - 2;

/// The column with the duration.
pub(super) const DURATION: usize = 2 * SPANS;

/// A row of a step, or a difference of rows.
pub(super) type Columns = [f64; COLUMNS];

/// The row of a step.
pub(super) fn of(shape: &Shape) -> Columns {
    let mut row = [shape.duration; COLUMNS];
    for (k, landmark) in shape.landmarks.iter().enumerate() {
        row[2 * k] = landmark.x;
        row[2 * k + 1] = landmark.y;
    }
    row
}

/// The step of a row. No step is shorter than a fifth of a second, whatever is drawn.
pub(super) fn shape(row: &Columns) -> Shape {
    let duration = if row[DURATION] > 0.2 { row[DURATION] } else { 0.2 };
    Shape { landmarks: std::array::from_fn(|k| Vec2::new(row[2 * k], row[2 * k + 1])), duration }
}

/// The row seen from a foot: left and right are exchanged for the right one. Twice, it is the row itself. In this view a
/// turn of a walk gives opposite rows on both sides and cancels in means, and what the body does to a side does not.
pub(super) fn seen_from(foot: Foot, row: &Columns) -> Columns {
    let sign = if foot == Foot::Left { 1.0 } else { -1.0 };
    std::array::from_fn(|k| if k % 2 == 1 { sign * row[k] } else { row[k] })
}

/// The sum of two rows, the second one with a factor.
pub(super) fn plus(a: &Columns, factor: f64, b: &Columns) -> Columns {
    std::array::from_fn(|k| a[k] + factor * b[k])
}
