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

/// The subject of an error, for those that follow from one another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum About {
    /// None of these.
    #[default]
    Other,
    /// A name: nothing has it, or it is set twice. At its other places the error is the same.
    Name(String),
    /// A definition that leads back to itself.
    Circle,
    /// Something whose number or value is not known where it is asked for.
    Unsettled,
    /// A value of another unit than the one wanted, which is described.
    Unit {
        /// `a speed (m/s)`
        wanted: String,
        /// Whether the value has no unit.
        is_bare: bool,
        /// Whether one of the two is a number of steps.
        in_steps: bool,
    },
    /// A horizon or step that nothing sets.
    Clock,
    /// An agent without a start.
    Start,
    /// An agent without moves.
    Moves,
    /// More people than there is room for.
    Crowd,
    /// A door without a wall.
    Door,
    /// A level or stairs without a field.
    Storey,
    /// Values of a parameter that make no difference.
    Idle,
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
    /// Its subject.
    pub about: About,
    /// The declaration of a number without a unit that causes it.
    pub comes_of: Option<Span>,
    /// The names that are known at its place, where it is about an unknown one: an editor offers them.
    pub known: Vec<String>,
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
            about: About::Other,
            comes_of: None,
            known: Vec::new(),
        }
    }

    /// Marks that it depends on a value at another place.
    #[must_use]
    pub fn hanging_on(mut self, value: Span) -> Self {
        self.hangs_on.push(value);
        self
    }

    /// Says which names are known at its place.
    #[must_use]
    pub fn knowing<'n>(mut self, names: impl IntoIterator<Item = &'n str>) -> Self {
        self.known = names.into_iter().map(str::to_owned).collect();
        self
    }

    /// Marks that it depends on no value at its place.
    #[must_use]
    pub fn formal(mut self) -> Self {
        self.is_formal = true;
        self
    }

    /// Says what it is about.
    #[must_use]
    pub fn about(mut self, about: About) -> Self {
        self.about = about;
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
