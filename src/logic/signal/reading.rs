//! What a monitor in continuous time found.

/// What a monitor found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// The formula's truth.
    Truth(bool),
    /// The metric; times are in seconds.
    Value(f64),
    /// The trial needs more stored pieces than are possible.
    Unresolved,
}
