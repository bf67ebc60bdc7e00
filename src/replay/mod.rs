//! Floor 7: models beside recordings: what people did who were recorded, and what a model had predicted of them.
//!
//! A [`Replay`] is a model with a recording. At each of its instants the model is compiled with those who were there, as
//! `smc check` compiles it with `from hotel at T`; then its formulas are asked of what happened next ([`monitor()`]), and of
//! trials that begin there ([`evaluate()`]). [`measure`] reads numbers from a recording alone. [`calibrate`] tells how often that was true.

pub mod calibrate;
mod cast;
mod course;
mod displacement;
mod evaluate;
pub mod fit;
mod formulas;
mod instants;
mod kinds;
pub mod measure;
mod monitor;
mod realism;
mod region;
mod situation;
mod source;

pub use cast::Cast;
pub use course::Beyond;
pub use displacement::Displacement;
pub use evaluate::{Evaluating, PREDICTED, PositionFits, Predicted, Prediction, eligible, evaluate};
pub use formulas::{Asked, Formulas, Sought};
pub use instants::Instant;
pub use kinds::{CONSTANT, LANGEVIN, first_tracks, user_kind};
pub use monitor::{Judged, monitor, numbers};
pub use realism::{FEATURES, PersonRealism, ROLLOUTS, realism};
pub use region::{Fit, HORIZONS, REGION};
pub use situation::{Replay, Whose};
pub use source::source;

/// What could be made of an input, or what is wrong with it.
pub type Diagnosed<T> = Result<T, Vec<crate::syntax::diagnostic::Diagnostic>>;
