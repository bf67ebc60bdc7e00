//! Floor 1: both languages, from bytes to syntax trees and back, and the diagnostics about them.

#[macro_use]
pub mod diagnostic;

pub mod ast;
pub mod codes;
pub mod keywords;
pub mod names;
pub mod parse;
pub mod print;
pub mod render;
pub mod source;
