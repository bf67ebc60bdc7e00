//! The crate as a library: a model from texts, checks with results, trials state by state.
//!
//! [`Model::parse`] reads a scenario, [`Draft`] one with parameters and files. [`Model::check`] answers the queries of a
//! property file and returns a [`Report`]. [`Model::trial`] runs a trial and yields its states. Errors come back as the
//! command line shows them: [`Diagnostics`].

mod diagnostics;
mod episode;
mod front;
mod laws;
mod model;
mod models;
mod options;
mod own;
mod paths;
pub mod program;
mod refusal;
mod report;
mod trial;
pub mod verify;
mod ways;

pub use diagnostics::{Diagnostics, findings};
pub use episode::{Episode, Stage};
pub use front::{Folder, Inputs, Names, Parsed, STACK, conclude, load, parse};
pub use model::{Draft, Model};
pub use options::{Options, chosen};
pub use paths::find_paths;
pub use refusal::{of_model, refusal, refusals};
pub use report::Report;
pub use trial::{AgentState, Snapshot, Trial};
pub use ways::{is_refused, survey};
