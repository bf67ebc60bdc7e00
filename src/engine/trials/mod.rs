//! Worlds made ready to run, and the executors that run trials in them.

pub mod dependence;
pub mod executor;
pub mod given;
pub mod outcomes;
pub(in crate::engine) mod placement;
pub mod prepared;
pub mod sample;
#[cfg(test)]
pub(in crate::engine) mod tests;
pub(in crate::engine) mod trial;
