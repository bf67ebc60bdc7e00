//! Recorded tracks of people seen from above, and batches of observations.

pub mod batch;
mod cells;
pub mod csv;
pub mod eth_biwi;
pub mod format;
pub mod groups;
pub mod jsonl;
pub mod line;
pub mod observations;
pub mod parquet;
pub mod pedpy;
mod plausible;
pub mod recording;
mod rows;
pub mod sqlite;
pub mod trajnet;

pub use batch::{Batch, Observation};
pub use csv::read_csv;
pub use eth_biwi::read_eth_biwi;
pub use format::{Format, Reading};
pub use groups::read_groups;
pub use jsonl::read_json_lines;
pub use line::LineError;
pub use observations::{read_batch, read_observations};
pub use parquet::read_parquet;
pub use pedpy::read_pedpy;
pub use plausible::Doubt;
pub use recording::{Person, PersonState, Recording, Sample, Velocity};
pub use sqlite::read_sqlite;
pub use trajnet::read_trajnet;
