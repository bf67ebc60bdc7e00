//! A figure: a drawing with its caption.

/// A drawing and what it shows.
#[derive(Clone, Debug)]
pub(in crate::report::html) struct Figure {
    pub(in crate::report::html) caption: String,
    /// SVG, in which all texts are escaped.
    pub(in crate::report::html) svg: String,
    /// Whether it takes all the width of a page.
    pub(in crate::report::html) is_wide: bool,
}
