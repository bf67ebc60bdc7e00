//! The lower floors of `smc`, which its main crate re-exports: whatever is simulated or computed while sampling goes on.
//!
//! They are a crate of their own for the compiler's sake: it translates them with all optimisation on one core, while the
//! other core works on the floors above, which need less (ARCHITECTURE.md, "Two crates").

pub mod base;
pub mod data;
pub mod gait;
pub mod kernel;
pub mod logic;
pub mod model;
pub mod route;
pub mod stats;
pub mod trials;
