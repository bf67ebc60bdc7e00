//! Procedures on their way: they ask for trials, read them in the order of their indices, and stop.

pub(in crate::engine) mod compare;
pub(in crate::engine) mod contest;
pub(in crate::engine) mod entry;
pub(in crate::engine) mod estimate;
pub(in crate::engine) mod forecast;
pub(in crate::engine) mod least;
pub(in crate::engine) mod pilot;
pub(in crate::engine) mod procedure;
pub(in crate::engine) mod rank;
pub(in crate::engine) mod resources;
pub(in crate::engine) mod splitting;
pub(in crate::engine) mod tally;
pub(in crate::engine) mod watch;
