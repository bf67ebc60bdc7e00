//! Floor 6: advice from observations (Given-Wilson, Legay, Sedwards, Zendra, "Modelling of Machine-Aided Human Group
//! Motion", 2017, Algorithms 1 and 4).
//!
//! An [`Adviser`] is given what sensors see, batch by batch. Each batch continues traces and groups
//! (`crate::perception`), from which the scenario is compiled anew; then the moves of the user are ranked.

mod advice;
mod adviser;
mod clock;
mod cycle;
mod grouping;
mod place;
mod role;
mod sight;

pub use advice::{Advice, GroupSeen, OptionSeen, Place, Status, UserSeen, Walked};
pub use adviser::{Adviser, Advising};
pub use cycle::{Cycles, Pushed};
pub use grouping::groups;
pub use role::{Role, id, role};
