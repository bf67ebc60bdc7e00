//! What the front end says about a source: code, place, message, hint.

use super::codes::Code;
use super::source::Span;
use crate::base::visible::shortened;

/// An error with its code, its place, its title and, if there is one, its hint; the last two as in `format!`.
///
/// ```text
/// error!(E0303, span, "expected {wanted}, found {found}"; hint: "write `{number} {wanted}`")
/// ```
macro_rules! error {
    ($code:ident, $span:expr, $($title:expr),+ $(; hint: $($hint:expr),+)?) => {
        $crate::syntax::diagnostic::Diagnostic::error(
            $crate::syntax::codes::Code::$code,
            $span,
            format!($($title),+),
        )$(.hint(format!($($hint),+)))?
    };
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Nothing runs.
    Error,
    /// It runs, but look.
    Warning,
}

/// A place and what is said there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The marked bytes.
    pub span: Span,
    /// Said beside the mark; may be empty.
    pub text: String,
}

/// One error or warning. One sentence, lower case, no full stop; the remedy in the hint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Stable code, such as `E0201`; every code has a page (`smc explain`).
    pub code: Code,
    /// The error, in one line.
    pub title: String,
    /// The place. `None` only for what has none (a missing file).
    pub place: Option<Label>,
    /// Further places that explain it.
    pub related: Vec<Label>,
    /// How to correct it.
    pub hint: Option<String>,
    /// The places of other values that it depends on: a threshold may be outside a range.
    pub hangs_on: Vec<Span>,
    /// Whether it depends on no value at its place: an argument may be missing.
    pub is_formal: bool,
    /// The declaration of a number without a unit that causes it.
    pub comes_of: Option<Span>,
}

impl Diagnostic {
    /// An error at a place.
    pub fn error(code: Code, span: Span, title: impl Into<String>) -> Self {
        Self { place: Some(Label { span, text: String::new() }), ..Self::placeless(code, title) }
    }

    /// A warning at a place.
    pub fn warning(code: Code, span: Span, title: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, span, title) }
    }

    /// An error that has no place in a source.
    pub fn placeless(code: Code, title: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            title: shortened(title.into()),
            place: None,
            related: Vec::new(),
            hint: None,
            hangs_on: Vec::new(),
            is_formal: false,
            comes_of: None,
        }
    }

    /// Marks that it depends on a value at another place.
    #[must_use]
    pub fn hanging_on(mut self, value: Span) -> Self {
        self.hangs_on.push(value);
        self
    }

    /// Marks that it depends on no value at its place.
    #[must_use]
    pub fn formal(mut self) -> Self {
        self.is_formal = true;
        self
    }

    /// Says something beside the mark.
    #[must_use]
    pub fn label(mut self, text: impl Into<String>) -> Self {
        if let Some(place) = &mut self.place {
            place.text = shortened(text.into());
        }
        self
    }

    /// Marks a further place.
    #[must_use]
    pub fn related(mut self, span: Span, text: impl Into<String>) -> Self {
        self.related.push(Label { span, text: shortened(text.into()) });
        self
    }

    /// Says what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(shortened(hint.into()));
        self
    }
}

/// Errors come in lists: so `?` makes a list of one.
impl From<Diagnostic> for Vec<Diagnostic> {
    fn from(one: Diagnostic) -> Self {
        vec![one]
    }
}
