//! Floor 1: bytes to tracks and geometry, and traces to tables.
//!
//! These functions read text and write to writers that the caller has opened. A bad input gives all its errors
//! at once, each with its place.

pub mod geometry;
pub mod mocap;
pub mod outcomes;
pub mod rows;
pub mod table;
pub mod tracks;
pub mod trials;
pub mod walks;
