//! Names of which nobody knows what they mean: declared twice as different things, or wrong where they are declared.
//!
//! That is told where it is declared. What follows from the one meaning that happens to stand would only confuse: such a name
//! is looked up as one that was reported.

use super::elaborator::Elaborator;
use super::symbols::{Meaning, ScopeId};
use crate::syntax::ast::Ident;

impl<'a> Elaborator<'a> {
    /// Declares a name of the scenario.
    pub(super) fn enter(&mut self, name: &Ident, meaning: Meaning<'a>) {
        let is_like = self.scopes[0].get(&name.name).map(|first| first.meaning.is_like(&meaning));
        if let Err(error) = self.scopes[0].declare(&name.name, name.span, meaning) {
            self.note(error);
        }
        if is_like == Some(false) {
            self.doubt(0, &name.name);
        }
    }

    /// What a name means is anybody's guess from now on.
    pub(super) fn doubt(&mut self, scope: ScopeId, name: &str) {
        self.doubtful.insert((scope, name.to_owned()));
    }

    /// Whether it is anybody's guess what a name means.
    pub(super) fn is_doubtful(&self, scope: ScopeId, name: &str) -> bool {
        !self.doubtful.is_empty() && self.doubtful.contains(&(scope, name.to_owned()))
    }
}
