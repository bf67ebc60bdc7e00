//! Roadmaps: graphs of straight free edges that are drawn once a run, and paths on them.
//!
//! Li, Li, Ge (J. Cent. South Univ. 26, 2019) plan on a probabilistic roadmap with a bridge test and compare it with
//! rapidly-exploring random trees. Collision tests are exact here. Paths of different classes pass obstacles on different
//! sides.

mod alternatives;
mod field;
mod free;
mod graph;
mod nearest;
mod prm;
mod rays;
mod rrt;
mod shortest;
#[cfg(test)]
mod tests;
mod word;

pub use alternatives::{Alternative, alternatives};
pub use field::DistanceField;
pub use free::FreeSpace;
pub use graph::{Roadmap, Sampler};
pub use prm::{Prm, SamplingRule};
pub use rays::Rays;
pub use rrt::Rrt;
pub use shortest::shortest;
pub use word::Word;
