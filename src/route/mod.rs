//! Floor 3: ways around barriers, and the driver of agents that find their way.
//!
//! Ways are exact: the shortest ones of a disc with the radius of the body (`network`). All that depends on the scene and the
//! goal alone is made once a run (`atlas`); a look-up joins the place of an agent to it (`way`).

mod atlas;
mod cells;
mod circle;
mod field;
mod goal;
mod network;
mod storeys;
mod survey;
mod tangent;
#[cfg(test)]
mod tests;
mod way;
mod wayfinder;

pub mod grid;
pub mod path;
pub mod planner;
pub mod profile;
pub mod roadmap;

pub use atlas::Atlas;
pub use survey::{Doubt, DoubtKind};
pub use way::{Bend, ShortestWay};
pub use wayfinder::{Ways, drivers};
