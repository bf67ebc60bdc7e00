//! Speed along a path that is known: the fastest profile, the region of legal speeds, and varied profiles.
//!
//! The problem is the one of Li, Li, Ge, Journal of Central South University 26 (2019), p. 654. A path is a row of lines and arcs (`stretch`), x is the distance along it, and u = v^2. Then
//! du/dx is twice the acceleration along the path, and all limits are bounds on u and du/dx. The fastest profile has a
//! closed form on every stretch (`ramp`, `optimum`); the profiles whose u is straight between given knots form a convex
//! set, from which `varied` draws. `printed` is the algorithm of the paper as printed, for comparison.

mod law;
mod limit;
mod motion;
mod optimum;
mod printed;
mod ramp;
mod region;
mod stretch;
#[cfg(test)]
mod tests;
mod varied;

pub use law::Law;
pub use motion::Motion;
pub use optimum::{Optimum, optimal};
pub use printed::{NeverReturns, Printed, PrintedProfile, Violations, printed};
pub use region::{Region, region};
pub use stretch::{Infeasible, Limits, Stretch};
pub use varied::{Varied, Variety, varied};
