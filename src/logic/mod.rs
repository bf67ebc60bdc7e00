//! Floor 1: bounded linear temporal logic over traces: formulas, online monitors, metrics.
//!
//! The logic reads truth values and numbers of each state by index; it knows nothing of people.

mod critical;
pub mod explain;
pub mod flat;
pub mod formula;
pub mod invalid;
pub mod monitor;
mod need;
pub mod offline;
mod present;
mod reach;
mod root;
pub mod signal;
mod source;

pub use critical::{Critical, critical};
pub use explain::{Explanation, Reason, explain, open_atoms};
pub use flat::{Flat, Sort};
pub use formula::{
    Aggregation, AtomId, Node, NodeId, Operation, Relation, SignalId, Term, TermId, Tree, Window,
};
pub use invalid::Invalid;
pub use monitor::robustness::Robustness;
pub use monitor::{Antecedent, Monitor};
pub use need::Needs;
pub use offline::Recording;
pub use reach::{Part, Reach, leaves, looks_ahead, reach};
pub use root::{Root, Sought};
pub use signal::robustness::{Bounds, SignalRobustness};
pub use signal::{Glance, Reading, SignalMonitor};
pub use source::{Source, sides, sources};
