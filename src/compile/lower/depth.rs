//! How deep expressions go, and how large they become, once names are expanded.

use crate::compile::context::{Context, Lowered, MOST_NODES, Reported};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// How deep expressions may nest once names are expanded.
const DEEPEST: u32 = 1000;

impl Context<'_> {
    /// Counts one more level; an error if an expression is too deep or too large.
    pub(crate) fn descend(&mut self, span: Span) -> Lowered<()> {
        if self.extent.depth == 0 {
            self.extent.outermost = span;
        }
        self.extent.nodes += 1;
        // Said once: what is too long is so wherever one looks at it.
        if (self.extent.depth >= DEEPEST || self.extent.nodes > MOST_NODES) && self.endless() {
            return Err(Reported);
        }
        if self.extent.depth >= DEEPEST {
            let mut error = error!(
                E0211,
                self.extent.outermost,
                "the expression has more than {DEEPEST} levels after names are expanded"
            );
            if let Some((_, name)) = self.names.expanding.first() {
                error = error.hint(format!("`{name}` expands through {} names", self.names.expanding.len()));
            }
            if span != self.extent.outermost {
                error = error.related(span, "too deep here");
            }
            return self.report(error);
        }
        self.extent.depth += 1;
        if self.extent.nodes > MOST_NODES {
            self.extent.depth -= 1;
            return self.too_large(span);
        }
        Ok(())
    }

    /// Reports an expression that is too large.
    pub(crate) fn too_large<T>(&mut self, span: Span) -> Lowered<T> {
        if self.endless() {
            return Err(Reported);
        }
        self.report(error!(E0211, span, "the expression is too large after names are expanded";
            hint: "a quantifier over formulas is expanded for every agent; quantify over states instead: `F<=1 s (forall a in crowd: …)`"))
    }

    /// Whether an expression was already reported as too deep or too large.
    fn endless(&self) -> bool {
        self.sink.diagnostics.iter().any(|d| d.code == Code::E0211)
    }

    /// Reports a name that expands through too many others.
    pub(crate) fn expand_further(&mut self, span: Span) -> Lowered<()> {
        if self.names.expanding.len() < DEEPEST as usize {
            return Ok(());
        }
        if self.endless() {
            return Err(Reported);
        }
        let first = self.names.expanding.first().map_or("", |(_, name)| name.as_str());
        let text = format!("`{first}` expands through more than {DEEPEST} names");
        self.report(error!(E0211, span, "{text}"))
    }
}
