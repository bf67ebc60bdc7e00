//! Results of lowering, and the names that are bound around an expression.

use crate::compile::context::{parts::Frame, symbols::ScopeId, typed::Typed};
use crate::syntax::source::Span;
use std::sync::Arc;

/// An error was reported; what depends on it is left out without another word.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reported;

/// A result whose error has been reported.
pub(crate) type Lowered<T> = Result<T, Reported>;

/// How many expression nodes one combination of parameter values may expand to.
pub(crate) const MOST_NODES: u64 = 4_000_000;

/// Names of enclosing expressions: function arguments and quantified agents.
#[derive(Clone, Debug, Default)]
pub(crate) struct Locals {
    /// Which table of names is looked up after the locals.
    pub(crate) scope: ScopeId,
    /// Bound names, innermost last. `None`: the meaning is unknown, and expressions that need it report no error.
    pub(crate) names: Vec<(String, Option<Arc<Typed>>)>,
    /// Where the arguments of a function are written that is called, by their places among the names.
    pub(crate) written: Vec<(usize, Span)>,
    /// The bound names in texts.
    pub(crate) frame: Option<Arc<Frame>>,
    /// Number of enclosing folds over agents.
    pub(crate) running: u32,
    /// The process, and which of its copies, whose names come next.
    pub(crate) process: Option<(u32, u32)>,
    /// The process whose variables are being settled.
    pub(crate) settling: Option<u32>,
    /// The behaviour whose names come next, and how many of the bound names they see.
    pub(crate) behaviour: Option<(u32, usize)>,
}

impl Locals {
    /// No locals in a scope.
    pub(crate) fn of(scope: ScopeId) -> Self {
        Self { scope, ..Self::default() }
    }

    /// Binds a name, which hides others that are equal.
    pub(crate) fn bind(&mut self, name: &str, value: Typed) {
        self.names.push((name.to_owned(), Some(Arc::new(value))));
    }

    /// Binds a name with an unknown meaning.
    pub(crate) fn bind_unknown(&mut self, name: &str) {
        self.names.push((name.to_owned(), None));
    }
}
