//! Steps of recorded walks: when the feet touch the ground (Agethen et al. 2018, section 3.3), and the root path from each contact to
//! the next one.

mod contact;
mod cut;
mod report;
mod signal;

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests;

pub use contact::Contact;
pub use cut::doubt;
pub use cut::{Cut, Dropped, NoSteps, cut};
pub(in crate::gait) use report::measures;
pub use report::{report, write_drawn_steps, write_steps};
