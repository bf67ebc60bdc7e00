//! Floor 2: moving state and its laws: one step of eight trials at once, or of one large crowd.
//!
//! The three rules: a trial is a pure function of (model, seed, index); one lane is one trial; what one
//! lane does never moves a byte of another.

mod barrier;
pub mod behaviour;
mod cells;
mod close;
pub mod code;
mod contact;
pub mod driver;
pub mod dynamics;
mod edges;
pub mod fault;
pub mod forces;
mod lanewise;
pub mod layout;
mod nearby;
mod noise;
mod pace;
mod parameters;
pub mod plan;
pub mod process;
pub mod program;
mod social;
pub mod start;
pub mod state;
mod surfaces;
mod vector;

pub use close::Close;
pub use code::{Code, Readings};
pub use dynamics::{Scratch, jump, refresh, step};
pub use program::Program;
pub use state::{Layout, Slot, State};
