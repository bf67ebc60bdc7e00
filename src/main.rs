//! The command line; it only dispatches.
fn main() {}
