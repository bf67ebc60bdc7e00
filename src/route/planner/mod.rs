//! Walkers that plan (Li, Li, Ge 2019): a path on a roadmap, its corners rounded, and speeds along it that differ from walker
//! to walker. The plan is the driving velocity of the social force, as their section 7 leaves it to future work.

mod errand;
mod options;
mod reach;
mod speeds;
mod terrain;
mod walker;

pub use errand::{Errand, Floor, point_in, shortest_of};
pub use options::{PathOption, path_options};
pub use reach::doubt;
pub use speeds::{Course, Speeds, pieces_of, stretches};
pub use terrain::{Terrain, Terrains, exits, middle, widest};
pub(in crate::route) use walker::walkers;
pub use walker::{Outline, Walkers, Wish};
