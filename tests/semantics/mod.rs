//! The monitor against the definition.

mod antecedents;
mod exhaustive;
mod random;
mod reference;
mod robust;
mod rows;
mod whole;
