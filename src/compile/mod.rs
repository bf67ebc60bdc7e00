//! Floor 2: from syntax to scenarios and questions: names, units, types, horizons.
//!
//! A scenario is elaborated once for every combination of parameter values that is asked about; each is a
//! world with its own agents, and the formulas over them.

mod behaviour;
mod consequences;
mod context;
pub mod dimension;
mod drawings;
mod files;
mod lower;
pub mod nearest;
mod people;
pub mod presets;
mod process;
mod query;
mod scene;
pub mod study;
mod world;
mod written;

pub use consequences::own_errors;
pub use context::notes::Notes;
pub use context::roster::Starts;
pub use context::sighting::{Grouping, Seen, Sighting, Site};
pub use drawings::Drawings;
pub use files::{Files, Request, Unread, is_series, matches, requests};
pub use lower::builtin::{BUILT_IN, DISTRIBUTIONS};
pub use lower::margin;
pub use people::tracks::reading_of;
pub use query::methods;
pub use query::settings::Setting;
pub use query::{Examined, Input, compile, examine};
pub use study::Study;
pub use written::Written;
