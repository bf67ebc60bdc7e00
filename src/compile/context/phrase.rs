//! How a condition of one state was written, down to its smallest parts: witnesses say which of them decided.

use crate::compile::context::{
    Context,
    parts::{Form, Part},
};
use crate::syntax::source::Span;
use std::sync::Arc;

/// A condition that is written at a place; `None` if no witness needs it.
pub(crate) fn phrase(context: &Context<'_>, place: Span, form: Form) -> Option<Arc<Part>> {
    context.temporal.then(|| Arc::new(Part { place, frame: context.words.frame.clone(), said: None, form }))
}

/// The same for a generated condition.
pub(crate) fn unwritten(context: &Context<'_>, place: Span, form: Form, text: &str) -> Option<Arc<Part>> {
    let said = Some(text.into());
    context.temporal.then(|| Arc::new(Part { place, frame: context.words.frame.clone(), said, form }))
}

/// The same of one that joins others. What joins them likewise is spliced, unless it has a name.
pub(crate) fn chained(
    context: &Context<'_>,
    place: Span,
    is_all: bool,
    sides: Vec<Arc<Part>>,
) -> Option<Arc<Part>> {
    let mut list: Vec<Arc<Part>> = Vec::new();
    for side in sides {
        let is_alike = match &side.form {
            Form::All(_) => is_all,
            Form::Any(_) => !is_all,
            _ => false,
        };
        if !is_alike || side.said.is_some() {
            list.push(side);
            continue;
        }
        // The text of a chain is used only once, so it is moved.
        let inner = match Arc::try_unwrap(side) {
            Ok(Part { form: Form::All(inner) | Form::Any(inner), .. }) => inner,
            Err(shared) => match &shared.form {
                Form::All(inner) | Form::Any(inner) => inner.clone(),
                _ => Vec::new(),
            },
            Ok(_) => Vec::new(),
        };
        if list.is_empty() { list = inner } else { list.extend(inner) }
    }
    phrase(context, place, if is_all { Form::All(list) } else { Form::Any(list) })
}
