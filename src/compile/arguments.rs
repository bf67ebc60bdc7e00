//! The named arguments of a procedure: `sprt(alpha = 0.01, indifference = 0.02)`.

use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::measures::Sketch;
use super::nearest::nearest;
use crate::syntax::ast::{Clauses, Method};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Named numbers of a method, in order of their names here.
pub(super) struct Arguments<'m, const N: usize> {
    pub(super) method: &'m Method,
    pub(super) values: [Option<(f64, Span)>; N],
    /// Whether some argument is wrong; that was said.
    failed: bool,
}

impl<const N: usize> Arguments<'_, N> {
    /// An error where some argument is wrong.
    pub(super) fn sound(&self) -> Lowered<()> {
        if self.failed { Err(Reported) } else { Ok(()) }
    }
}

impl Elaborator<'_> {
    /// The arguments of a method; all are pure numbers but `epsilon`, which is in the unit of the measure.
    pub(super) fn arguments<'m, const N: usize>(
        &mut self,
        (clauses, method): (&Clauses, &'m Method),
        names: [&str; N],
        sketch: Sketch,
        locals: &Locals,
    ) -> Arguments<'m, N> {
        let mut values = [None; N];
        let mut failed = false;
        for argument in &method.arguments {
            let Some(at) = names.iter().position(|n| *n == argument.name.name) else {
                let known = if N == 0 {
                    "it has no arguments".to_owned()
                } else {
                    format!("its arguments are {}", names.join(", "))
                };
                let hint = nearest(&argument.name.name, names.iter().copied())
                    .map_or(known, |n| format!("did you mean `{n}`?"));
                let error = Diagnostic::error(
                    Code::E0604,
                    argument.name.span,
                    format!("`{}` has no argument `{}`", method.name.name, argument.name.name),
                );
                self.note(error.formal().hint(hint));
                let _ = self.number(&argument.value, locals);
                failed = true;
                continue;
            };
            if let Some(first) = method.arguments.iter().find(|a| a.name.name == argument.name.name)
                && first.name.span != argument.name.span
            {
                let text = format!("`{}` is given twice", argument.name.name);
                let error = Diagnostic::error(Code::E0604, argument.name.span, text);
                self.note(error.formal().related(first.name.span, "first given here"));
                failed = true;
                continue;
            }
            if let (Some(clause), "alpha" | "beta" | "delta") = (&clauses.confidence, names[at]) {
                let text = format!("the error is given twice: by `confidence` and by `{}`", names[at]);
                let error = Diagnostic::error(Code::E0604, argument.name.span, text);
                self.note(error.formal().related(clause.span, "given here"));
                failed = true;
                continue;
            }
            let sketch = if names[at] == "epsilon" { sketch } else { Sketch::PROBABILITY };
            match self.number_in(&argument.value, sketch, locals) {
                Ok(number) => values[at] = Some((number.value, argument.value.span)),
                Err(_) => failed = true,
            }
        }
        Arguments { method, values, failed }
    }

    pub(super) fn required<const N: usize>(
        &mut self,
        arguments: &Arguments<'_, N>,
        at: usize,
        name: &str,
    ) -> Lowered<(f64, Span)> {
        match arguments.values[at] {
            Some(found) => Ok(found),
            None if arguments.failed => Err(Reported),
            None => {
                let method = arguments.method;
                let error = Diagnostic::error(
                    Code::E0604,
                    method.span,
                    format!("`{}` needs `{name}`", method.name.name),
                );
                self.report(error.formal())
            }
        }
    }
}
