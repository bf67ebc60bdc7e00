//! Floor 1: bytes to tracks and geometry, and traces to tables.
//!
//! Everything here reads text that somebody else has opened and writes to what somebody else has
//! created. A bad input gives every fault in it at once, each with its place.

pub mod geometry;
pub mod outcomes;
pub mod table;
pub mod tracks;
