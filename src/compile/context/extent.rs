//! Size and depth of the expression that is being lowered.

use crate::syntax::source::Span;

/// Size and depth of the expression that is being lowered.
#[derive(Default)]
pub(crate) struct Extent {
    /// Present depth of lowering.
    pub(crate) depth: u32,
    /// Where the outermost expression that is being lowered stands.
    pub(crate) outermost: Span,
    /// Nodes lowered so far.
    pub(crate) nodes: u64,
}
