//! Names with an uncertain meaning: declared twice as different things, or with an error in their declaration.
//!
//! That is told where it is declared. What follows from the one meaning that happens to stand would only confuse: such a name
//! is looked up as one that was reported.

use crate::compile::context::{
    Context,
    symbols::{Meaning, ScopeId},
};
use crate::syntax::ast::Ident;

/// Declares a name of the scenario.
pub(crate) fn enter<'a>(context: &mut Context<'a>, name: &Ident, meaning: Meaning<'a>) {
    let is_like = context.names.scopes[0].get(&name.name).map(|first| first.meaning.is_like(&meaning));
    if let Err(error) = context.names.scopes[0].declare(&name.name, name.span, meaning) {
        context.note(error);
    }
    if is_like == Some(false) {
        doubt(context, 0, &name.name);
    }
}

/// Marks the meaning of a name as uncertain.
pub(crate) fn doubt(context: &mut Context<'_>, scope: ScopeId, name: &str) {
    context.given_up = true;
    context.names.doubtful.insert((scope, name.to_owned()));
}
