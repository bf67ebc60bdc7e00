//! Floor 3: trials one after the other: what is read from each, and the loops that run them.

pub mod batch;
pub mod budget;
pub mod cell;
pub mod chain;
pub mod columns;
pub mod group;
pub mod observer;
pub mod runner;
pub mod setup;
