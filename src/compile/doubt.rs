//! Names with an uncertain meaning: declared twice as different things, or with an error in their declaration.
//!
//! That is told where it is declared. What follows from the one meaning that happens to stand would only confuse: such a name
//! is looked up as one that was reported.

use super::elaborator::{Elaborator, Locals};
use super::symbols::{Meaning, ScopeId};
use crate::syntax::ast::{Expr, ExprKind, Ident, Item, ScenarioFile, UnaryOp};
use crate::syntax::diagnostic::Diagnostic;

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

    /// Parameters whose default, a number as it is written, is of another dimension than both ends of its range, or beyond one:
    /// that is the slip, and not all that fits the range.
    pub(super) fn doubt_defaults(&mut self, file: &ScenarioFile) {
        for item in &file.items {
            let Item::Param { name, value, range: Some(range) } = item else { continue };
            let is_own = self.scopes[0].get(&name.name).is_some_and(|entry| entry.span == name.span);
            if is_own && let Some(error) = self.fault_of_default(name, value, range) {
                self.note(error);
                self.doubt(0, &name.name);
            }
        }
    }

    /// The error of such a default.
    pub(super) fn fault_of_default(
        &mut self,
        name: &Ident,
        value: &Expr,
        (low, high): &(Expr, Expr),
    ) -> Option<Diagnostic> {
        let locals = Locals::of(0);
        if !is_number(value) {
            return None;
        }
        let gist = |expr| self.gist(expr, &locals);
        let (found, expected) = (gist(value)?, gist(low)?);
        if gist(high)? != expected {
            return None;
        }
        if found != expected {
            return Some(self.other_dimension(value.span, expected, found));
        }
        if self.settings.contains_key(&name.name) || !is_number(low) || !is_number(high) {
            return None;
        }
        let mut number = |expr| self.number(expr, &locals).ok().map(|number| number.value);
        let (default, low, high) = (number(value)?, number(low)?, number(high)?);
        let is_beyond = low <= high && (default < low || default > high);
        is_beyond.then(|| {
            let text = format!("the default of `{}` is outside its range", name.name);
            error!(E0405, value.span, "{text}")
        })
    }

    /// Marks the meaning of a name as uncertain.
    pub(super) fn doubt(&mut self, scope: ScopeId, name: &str) {
        self.given_up = true;
        self.doubtful.insert((scope, name.to_owned()));
    }

    /// Whether the meaning of a name is uncertain.
    pub(super) fn is_doubtful(&self, scope: ScopeId, name: &str) -> bool {
        !self.doubtful.is_empty() && self.doubtful.contains(&(scope, name.to_owned()))
    }
}

/// Whether it is a number as it is written.
fn is_number(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Quantity(_) => true,
        ExprKind::Unary(UnaryOp::Minus, inner) => is_number(inner),
        _ => false,
    }
}
