//! Floor 1: both languages, from bytes to syntax trees and back, and the diagnostics about them.

pub mod ast;
pub mod diagnostic;
pub mod source;
