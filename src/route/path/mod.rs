//! Smooth paths: polylines whose corners are rounded by arcs as large as the barriers allow.
//!
//! Li, Li and Ge (2019, J. Cent. South Univ. 26:654) round the corners of a path from a roadmap by arcs and choose a speed
//! profile along it. Here the largest free radius of each corner has a closed form (`clearance`).

mod around;
mod clearance;
mod fillet;
#[allow(clippy::module_inception, reason = "the file of the type")]
mod path;
mod piece;
mod rounding;
mod shape;
mod shortcut;
mod taut;
#[cfg(test)]
mod tests;

pub use path::Path;
pub use piece::{Piece, Place};
pub use rounding::{round, round_by};
pub use shape::{Part, PathShape, ShapeError};
pub use shortcut::shortcut;
