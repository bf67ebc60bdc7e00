//! How deep expressions go, and how large they become, once names are expanded.

use super::elaborator::{Elaborator, Lowered, MOST_NODES, Reported};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// How deep expressions may nest once names are expanded.
const DEEPEST: u32 = 1000;

impl Elaborator<'_> {
    /// Counts one more level; an error if an expression is too deep or too large.
    pub(super) fn descend(&mut self, span: Span) -> Lowered<()> {
        if self.depth == 0 {
            self.outermost = span;
        }
        self.nodes += 1;
        // Said once: what is too long is so wherever one looks at it.
        if (self.depth >= DEEPEST || self.nodes > MOST_NODES) && self.endless() {
            return Err(Reported);
        }
        if self.depth >= DEEPEST {
            let mut error = error!(
                E0211,
                self.outermost, "the expression has more than {DEEPEST} levels after names are expanded"
            );
            if let Some((_, name)) = self.expanding.first() {
                error = error.hint(format!("`{name}` expands through {} names", self.expanding.len()));
            }
            if span != self.outermost {
                error = error.related(span, "too deep here");
            }
            return self.report(error);
        }
        self.depth += 1;
        if self.nodes > MOST_NODES {
            self.depth -= 1;
            return self.too_large(span);
        }
        Ok(())
    }

    /// Reports an expression that is too large.
    pub(super) fn too_large<T>(&mut self, span: Span) -> Lowered<T> {
        if self.endless() {
            return Err(Reported);
        }
        self.report(error!(E0211, span, "the expression is too large after names are expanded";
            hint: "a quantifier over formulas is expanded for every agent; quantify over states instead: `F<=1 s (forall a in crowd: …)`"))
    }

    /// Whether an expression was already reported as too deep or too large.
    fn endless(&self) -> bool {
        self.diagnostics.iter().any(|d| d.code == Code::E0211)
    }

    /// Reports a name that expands through too many others.
    pub(super) fn expand_further(&mut self, span: Span) -> Lowered<()> {
        if self.expanding.len() < DEEPEST as usize {
            return Ok(());
        }
        if self.endless() {
            return Err(Reported);
        }
        let first = self.expanding.first().map_or("", |(_, name)| name.as_str());
        let text = format!("`{first}` expands through more than {DEEPEST} names");
        self.report(error!(E0211, span, "{text}"))
    }
}
