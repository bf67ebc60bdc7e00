//! Floor 2: from syntax to scenarios and questions: names, units, types, horizons.
//!
//! A scenario is elaborated once for every combination of parameter values that is asked about; each is a
//! world with its own agents, and the formulas over them.

mod arguments;
mod asks;
mod behaviour;
mod bindings;
mod bounds;
mod call_arguments;
mod consequences;
mod contests;
pub mod dimension;
mod doubt;
mod elaborator;
mod failures;
mod families;
mod files;
mod filter;
mod findings;
mod imports;
mod interned;
mod kinds;
mod laws;
mod lower;
pub mod margin;
mod measures;
pub mod methods;
mod moments;
pub mod nearest;
mod number;
mod observed;
mod people;
mod phrase;
mod places;
mod planners;
mod planning;
mod positions;
pub mod presets;
mod process;
mod queries;
mod rankings;
mod recordings;
mod said;
mod scenery;
mod settings;
mod sources;
mod starts;
mod step;
mod stepping;
pub mod study;
mod sweeps;
mod symbols;
mod told;
mod typed;
mod ways;
mod weight;
mod wording;
mod world;
mod written;

pub use consequences::own_errors;
pub use files::{Files, Request, requests};
pub use queries::{Examined, Input, compile, examine};
pub use settings::Setting;
pub use starts::Starts;
pub use study::Study;
pub use written::Written;
