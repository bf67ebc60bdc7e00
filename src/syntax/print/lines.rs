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
    /// The column in which that stood.
    pub(super) stood: usize,
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
        |_, _| false,
        |line, blanks| {
            if let Some(at) = line.assign {
                line.text.insert_str(at, &" ".repeat(blanks));
            }
        },
    );
    align(
        &mut lines,
        |line| line.comment.as_ref().map(|_| line.width()),
        |one, other| one.stood == other.stood,
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

/// Widens the lines of each run with a column to the widest of them. A run is of neighbours with one indentation, and of
/// lines without an empty line between them that were aligned, whatever stands between them.
fn align(
    lines: &mut [Line],
    column: impl Fn(&Line) -> Option<usize>,
    were_aligned: impl Fn(&Line, &Line) -> bool,
    widen: impl Fn(&mut Line, usize),
) {
    let mut run: Vec<usize> = Vec::new();
    for at in 0..=lines.len() {
        let goes_on = lines.get(at).is_some_and(|line| !line.empty_before);
        let has_column = lines.get(at).is_some_and(|line| column(line).is_some());
        if goes_on && !has_column {
            continue;
        }
        let joins = run.last().is_some_and(|&last| {
            goes_on
                && (last + 1 == at && lines[last].indent == lines[at].indent
                    || were_aligned(&lines[last], &lines[at]))
        });
        if !joins {
            let widest = run.iter().filter_map(|&k| column(&lines[k])).max().unwrap_or(0);
            for k in run.drain(..) {
                let blanks = widest - column(&lines[k]).unwrap_or(widest);
                widen(&mut lines[k], blanks);
            }
        }
        run.extend(has_column.then_some(at));
    }
}
