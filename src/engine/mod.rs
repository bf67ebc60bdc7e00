//! Floor 5: trials, executors, and the outcomes of queries.

pub mod outcome;
