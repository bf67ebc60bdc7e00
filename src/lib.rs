//! Statistical model checking of people in motion: scenarios, bounded temporal logic, and verdicts with
//! the guarantee they can honestly give.
//!
//! The floors, low to high, are described in `ARCHITECTURE.md` and held by `tests/floors.rs`.

pub mod base;
pub mod cli;
pub mod compile;
pub mod data;
pub mod engine;
pub mod kernel;
pub mod logic;
pub mod model;
pub mod report;
pub mod stats;
pub mod syntax;
