//! What was found wrong with, or odd in, the inputs of a call, as reports quote it: plain data, without sources.

/// Where in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spot {
    /// The file as named in the call.
    pub file: String,
    /// Line and column of the first character, both from 1; the column counts characters.
    pub start: (usize, usize),
    /// Line and column one past the last character.
    pub end: (usize, usize),
}

/// One error or warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Whether it is an error, or a warning only.
    pub error: bool,
    /// Its code, such as `E0201`.
    pub code: String,
    /// Its place; `None` for what has none, such as a missing file.
    pub spot: Option<Spot>,
    /// What is wrong.
    pub message: String,
    /// What is said at the mark; may be empty.
    pub label: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Finding {
    /// `error[E0201] at a.bltl:3:8: there is no name …`
    pub fn line(&self) -> String {
        let word = if self.error { "error" } else { "warning" };
        let at = self.spot.as_ref().map_or(String::new(), |spot| {
            let (line, column) = spot.start;
            format!(" at {}:{line}:{column}", spot.file)
        });
        format!("{word}[{}]{at}: {}", self.code, self.message)
    }
}
