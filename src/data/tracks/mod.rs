//! Recorded tracks of people seen from above.

pub mod eth_biwi;
pub mod groups;
pub mod line;
pub mod recording;

pub use eth_biwi::read_eth_biwi;
pub use groups::read_groups;
pub use line::LineError;
pub use recording::{Observation, Person, Recording, Sample};
