//! Floor 5: the queries of a call are sampled, and answered.
//!
//! ```text
//! session     a whole call: worlds made ready, queries in groups that share trials, turns in the time that is left
//!   trials      a world made ready, where everybody can be placed, and executors, which run items and hand back cells
//!   sampling    procedures on their way: checks and estimates, comparisons, rankings, splitting; pilots and forecasts
//!   answer      what was found, as numbers and sentences
//!   witness     the trials that show it, and what decided them
//!   outcome     all that as plain data, for reports
//!   traces      trials run again for pages
//!   shards      the same work on other machines
//! ```

mod answer;
mod call;
mod fault;
mod flaw;
pub mod outcome;
mod sampling;
mod session;
pub mod shards;
pub mod traces;
pub mod trials;
mod witness;

pub use crate::trials::budget::Budget;
pub use answer::words::at_most;
pub use call::{Call, CommandLine, quoted};
pub use fault::Fault;
pub use flaw::Flaw;
pub use sampling::procedure::last_evidence;
pub use sampling::watch::{CallForecast, Forecast, Likely, Nobody, Watch};
pub use session::{forecast, run};
pub use trials::executor::{Executor, Threads, Within};
pub use trials::outcomes::Outcomes;
pub use trials::placement::{overfull_starts, placeable};
pub use trials::prepared::PreparedWorld;
pub use witness::cause::{divergence, no_start, smaller};
