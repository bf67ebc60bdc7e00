//! Monitors in continuous time against the definitions of `docs/semantics.md`.

mod random;
mod reference;
mod robust;
mod rows;
