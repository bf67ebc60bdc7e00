//! Comments in what stands between two tokens.

/// A comment, in bytes of the text it was found in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::syntax) struct Comment {
    /// Its first byte.
    pub(in crate::syntax) start: usize,
    /// One past its last byte.
    pub(in crate::syntax) end: usize,
    /// `//`, up to the end of the line.
    pub(in crate::syntax) to_line_end: bool,
}

/// The comments of a text that holds nothing else but blanks and marks.
pub(in crate::syntax) fn comments(gap: &str) -> Vec<Comment> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(slash) = gap[at..].find('/') {
        let start = at + slash;
        let rest = &gap[start..];
        let (end, to_line_end) = if rest.starts_with("//") {
            (rest.find('\n').map_or(gap.len(), |length| start + length), true)
        } else if let Some(inside) = rest.strip_prefix("/*") {
            (inside.find("*/").map_or(gap.len(), |length| start + length + 4), false)
        } else {
            at = start + 1;
            continue;
        };
        found.push(Comment { start, end, to_line_end });
        at = end;
    }
    found
}
