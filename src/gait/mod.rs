//! Floor 4: how people step (Agethen, Gaisbauer, Manns, Link, Rukzio 2018): steps learned from motion capture or made from
//! published relations, and walks that are chains of them; and sets of walks compared.

pub mod compare;
mod curve;
mod driver;
pub mod model;
mod step;
pub mod steps;
pub mod synthetic;
pub mod walk;

pub use curve::Curve;
pub use driver::{drivers, present_foot};
pub use step::{Draws, Foot, Gait, Phase, RecordedStep, SPANS, Shape, Stance};
