//! Parameters of a kind, fitted to a recording by a search without derivatives.
//!
//! Trials begin at instants of the recording. The loss is the mean negative logarithm of the predictive density
//! (`replay/region.rs`) at the recorded positions after 1, 2 and 4.8 s, or the Brier score of properties. All candidates read
//! the same random numbers, so the loss is a function of the parameters alone, and [`Evolution`](crate::stats::evolution::Evolution)
//! minimises it on the scale of each parameter ([`Fitted`]).

mod cases;
mod parameter;
mod search;
mod surface;

pub use cases::{Cases, Counting, Parts};
pub use parameter::Fitted;
pub use search::{Candidate, Comparison, FEWEST, Found, Generation, Searching, search};
