//! Floor 2: moving state and its laws: one step of eight trials at once, or of one large crowd.
//!
//! The three rules: a trial is a pure function of (model, seed, index); one lane is one trial; what one
//! lane does never moves a byte of another.

mod barrier;
pub mod behaviour;
mod cells;
pub mod code;
mod composure;
mod contact;
mod doors;
pub mod driver;
pub mod dynamics;
mod edges;
pub mod fault;
pub mod force;
mod lanewise;
pub mod layout;
mod mover;
mod near;

pub mod noise;
mod pace;
mod parameters;
mod passing;
pub mod plan;
mod plane;
pub mod process;
pub mod program;
mod rest;
pub mod run;
mod speed;
pub mod start;
pub mod state;
mod storeys;
pub mod tape;
mod vector;

pub use code::{Code, Readings, Voronoi};
pub use dynamics::{Scratch, refresh, step};
pub use near::Close;
pub use passing::is_crossed;
pub use program::Program;
pub use run::{Address, End, Run};
pub use state::{Layout, Slot, State};
