//! How a condition of one state was written, down to its smallest parts: witnesses say which of them decided.

use super::elaborator::Elaborator;
use super::study::{Form, Part};
use crate::syntax::source::Span;
use std::sync::Arc;

impl Elaborator<'_> {
    /// A condition that is written at a place; `None` if no witness needs it.
    pub(super) fn phrase(&self, place: Span, form: Form) -> Option<Arc<Part>> {
        self.temporal.then(|| Arc::new(Part { place, frame: self.frame.clone(), said: None, form }))
    }

    /// The same for a generated condition.
    pub(super) fn unwritten(&self, place: Span, form: Form, text: &str) -> Option<Arc<Part>> {
        let said = Some(text.into());
        self.temporal.then(|| Arc::new(Part { place, frame: self.frame.clone(), said, form }))
    }

    /// The same of one that joins others. What joins them likewise is spliced, unless it has a name.
    pub(super) fn chained(&self, place: Span, is_all: bool, sides: Vec<Arc<Part>>) -> Option<Arc<Part>> {
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
        self.phrase(place, if is_all { Form::All(list) } else { Form::Any(list) })
    }
}
