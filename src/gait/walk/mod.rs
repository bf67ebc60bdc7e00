//! Walks: chains of steps among obstacles, from a place to a goal point (Agethen et al. 2018, sections 3.4 and 4.2). Every step
//! is swept with the body, not only its end, and the last steps are scaled to end at the goal point.

mod candidate;
mod cells;
mod course;
mod ground;
mod guided;
mod hybrid;
mod last;
mod no_step;
mod others;
mod placed;
mod search;
mod task;
#[cfg(test)]
mod tests;
mod turn;
mod walker;

pub use ground::Ground;
pub use no_step::NoStep;
pub use others::{Gaps, OtherBody, least_gap};
pub use placed::PlacedStep;
pub use task::{HybridAStar, Search, Walk};
pub use walker::Walker;
