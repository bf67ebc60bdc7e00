//! Lines, their alignment, and the text they make.

/// One line of the result.
#[derive(Clone, Default)]
pub(super) struct Line {
    /// Blanks before it.
    pub(super) indent: usize,
    /// Without indentation and comment.
    pub(super) text: String,
    /// Byte of the `=` to align.
    pub(super) assign: Option<usize>,
    /// The comment at its end.
    pub(super) comment: Option<String>,
    /// An empty line stands before it.
    pub(super) empty_before: bool,
}

impl Line {
    /// Characters up to the comment.
    pub(super) fn width(&self) -> usize {
        self.indent + self.text.chars().count()
    }
}

/// Aligns and joins lines.
pub(super) fn join(mut lines: Vec<Line>) -> String {
    align(
        &mut lines,
        |line| line.assign.map(|at| line.text[..at].chars().count()),
        |line, blanks| {
            if let Some(at) = line.assign {
                line.text.insert_str(at, &" ".repeat(blanks));
            }
        },
    );
    align(
        &mut lines,
        |line| line.comment.as_ref().map(|_| line.width()),
        |line, blanks| {
            line.text.push_str(&" ".repeat(blanks + 2));
        },
    );
    let mut text = String::new();
    for line in lines {
        if line.empty_before {
            text.push('\n');
        }
        let whole = line.text + line.comment.as_deref().unwrap_or("");
        if !whole.trim().is_empty() {
            text.push_str(&" ".repeat(line.indent));
            text.push_str(whole.trim_end());
        }
        text.push('\n');
    }
    text
}

/// Widens the lines of each run of neighbours with a column to the widest of them.
fn align(lines: &mut [Line], column: impl Fn(&Line) -> Option<usize>, widen: impl Fn(&mut Line, usize)) {
    let mut first = 0;
    while first < lines.len() {
        let mut end = first + 1;
        if column(&lines[first]).is_some() {
            while end < lines.len()
                && column(&lines[end]).is_some()
                && lines[end].indent == lines[first].indent
                && !lines[end].empty_before
            {
                end += 1;
            }
            let widest = lines[first..end].iter().filter_map(&column).max().unwrap_or(0);
            for line in &mut lines[first..end] {
                let blanks = widest - column(line).unwrap_or(widest);
                widen(line, blanks);
            }
        }
        first = end;
    }
}
