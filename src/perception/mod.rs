//! Floor 3: from observations to traces and groups (Given-Wilson, Legay, Sedwards, Zendra, "Modelling of
//! Machine-Aided Human Group Motion", 2017, Algorithms 2 and 3).
//!
//! [`Tracker`] continues traces with the batches of one time, [`clusters()`] groups the people of an instant, [`Lineage`]
//! gives groups their numbers over time, and [`infer()`] does all of it for a whole recording.

pub mod assignment;
pub mod clusters;
mod fusion;
pub mod group_score;
pub mod infer;
pub mod lineage;
pub mod lives;
pub mod motion;
mod near;
pub mod score;
pub mod social_force;
pub mod trace;
pub mod tracker;

pub use clusters::{Clustering, clusters, instant_of};
pub use group_score::GroupScore;
pub use infer::{Inference, InferredPoint, InferredTrace, Inferring, infer};
pub use lineage::Lineage;
pub use lives::{Birth, Death, Group, Membership};
pub use motion::{ConstantVelocity, Motion, Standing};
pub use score::TrackScore;
pub use social_force::SocialForce;
pub use trace::{Trace, TracePoint};
pub use tracker::{Padding, Tracker, Tracking, TrackingError};
