//! A figure: a drawing with its caption.

/// Letters of a name.
const MOST_LETTERS: usize = 60;

/// A drawing and what it shows.
#[derive(Clone, Debug)]
pub(in crate::report::html) struct Figure {
    pub(in crate::report::html) caption: String,
    /// SVG, in which all texts are escaped.
    pub(in crate::report::html) svg: String,
    /// Whether it takes all the width of a page.
    pub(in crate::report::html) is_wide: bool,
}

/// A name as it is shown: very long ones are cut.
pub(super) fn brief_name(name: &str) -> String {
    let start: String = name.chars().take(MOST_LETTERS).collect();
    if start.len() < name.len() { format!("`{start}…`") } else { format!("`{start}`") }
}
