//! Floor 5: trials, executors, and the outcomes of queries.

mod blame;
pub mod budget;
pub mod cell;
mod contrast;
pub mod executor;
mod fault;
mod observer;
pub mod outcome;
mod procedure;
mod race;
mod session;
mod splitting;
mod standing;
pub mod subject;
mod survey;
mod tally;
mod trial;
mod watch;
mod witness;
mod words;
mod worker;

pub use budget::Budget;
pub use executor::{Executor, Threads};
pub use fault::Fault;
pub use session::{Call, crowded, run};
pub use subject::Subject;
pub use watch::{Forecast, Nobody, Watch};
pub use words::at_most;
