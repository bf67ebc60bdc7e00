//! Floor 1: both languages, from bytes to syntax trees and back, and the diagnostics about them.

pub mod ast;
pub mod codes;
pub mod diagnostic;
pub mod keywords;
pub mod parse;
pub mod print;
pub mod render;
pub mod source;
