//! Tables on a page.

/// A table of texts.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// What is to be said of it; may be empty.
    pub note: String,
    /// Heads of the columns.
    pub columns: Vec<&'static str>,
    /// The rows, of which the first 2 000 are shown.
    pub rows: Vec<Vec<String>>,
}
