//! The levels of a scene while it is compiled.

use crate::compile::context::{Context, symbols::Meaning};
use std::ops::Range;

/// The levels of a scene, in order of writing.
#[derive(Debug, Default)]
pub(crate) struct Levels {
    pub(crate) all: Vec<Level>,
    /// The level whose items are settled at present: places on it are as written, in its own coordinates.
    pub(crate) frame: Option<usize>,
}

/// A level.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub(crate) name: String,
    /// Its barriers and lines among all that are declared.
    pub(crate) barriers: Range<usize>,
    pub(crate) lines: Range<usize>,
}

/// The full name of what an unadorned name means among the items of a level, if it means something of this level.
pub(crate) fn on_level(context: &Context<'_>, name: &str) -> Option<String> {
    let level = &context.levels.all[context.levels.frame?];
    let full = format!("{}.{name}", level.name);
    context.names.scopes[0].get(&full).map(|_| full)
}

/// The level that a name stands for.
pub(crate) fn level(context: &Context<'_>, name: &str) -> Option<usize> {
    match context.names.scopes[0].get(name)?.meaning {
        Meaning::Level(level) => Some(level),
        _ => None,
    }
}
