//! Recorded walking: the root and the feet of one person over time, from motion capture.
//!
//! Readers for BVH, for ASF/AMC and for CSV tables of positions. They take text, since the caller opens the files.

mod asf;
mod bvh;
mod layout;
mod pose;
mod positions;
mod read;
mod take;
mod takes;

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests;

pub use asf::Asf;
pub use bvh::bvh_preset;
pub use layout::{Layout, Up};
pub use read::read_takes;
pub use take::{FootTrack, NO_RATE, Take};
pub use takes::{TakeRow, read_take_table};
