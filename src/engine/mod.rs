//! Floor 5: trials, executors, and the outcomes of queries.

mod answer;
mod blame;
pub mod budget;
pub mod cell;
mod contrast;
pub mod executor;
mod fault;
mod forecast;
mod jumper;
mod observer;
pub mod outcome;
mod procedure;
mod race;
mod recall;
mod rehearsal;
mod runner;
mod session;
mod splitting;
mod standing;
pub mod subject;
mod survey;
mod tally;
mod trial;
mod walker;
mod watch;
mod witness;
mod words;
mod worker;

pub use budget::Budget;
pub use executor::{Executor, Threads};
pub use fault::Fault;
pub use session::{Call, forecast, placeable, run};
pub use subject::Subject;
pub use watch::{Forecast, Nobody, Outlook, Watch};
pub use words::at_most;
