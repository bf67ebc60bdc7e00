//! The monitor against the definition.

mod exhaustive;
mod random;
mod reference;
mod rows;
mod whole;
