//! Tokens and comments to lines.

use super::lines::Line;
use super::token::{Node, Token};
use crate::syntax::parse::comments::{Comment, comments};

/// Blocks on one line may reach this column.
const WIDTH: usize = 100;
const INDENT: usize = 2;
/// Further indentation of the later lines of a declaration.
const CONTINUED: usize = 4;

struct Writer<'t> {
    text: &'t str,
    lines: Vec<Line>,
    /// End of the last token or comment in the source.
    at: usize,
    indent: usize,
    /// The next line follows an opening brace or is the first: no empty line before it.
    opens: bool,
    /// No blank before the next token.
    glued: bool,
    /// Inside a block on one line: its `=` are not aligned with those of other lines.
    one_line: bool,
}

/// Writes the members of a file.
pub(super) fn write(text: &str, members: &[Vec<Node>]) -> Vec<Line> {
    let mut writer =
        Writer { text, lines: Vec::new(), at: 0, indent: 0, opens: true, glued: true, one_line: false };
    writer.members(members);
    writer.own_lines(text.len());
    writer.lines
}

impl Writer<'_> {
    fn members(&mut self, members: &[Vec<Node>]) {
        for member in members {
            let Some(first) = start(member) else { continue };
            let empty_before = self.own_lines(first);
            self.line(String::new(), empty_before);
            self.glued = true;
            self.at = first;
            self.nodes(member);
        }
    }

    fn nodes(&mut self, nodes: &[Node]) {
        for node in nodes {
            match node {
                Node::Token(token) => self.token(token),
                Node::Block { open, members, close } => self.block(open, members, close),
            }
        }
    }

    fn block(&mut self, open: &Token, members: &[Vec<Node>], close: &Token) {
        // A break before the brace is not kept; comments there are.
        self.inline_comments(open.start);
        // After a comment that has a line of its own nothing else fits there.
        let commented = self.lines.last().is_some_and(|line| line.text.starts_with("//"));
        if commented {
            self.line(String::new(), false);
        } else if !self.glued {
            self.push(" ");
        }
        self.push("{");
        self.at = open.end;
        self.glued = false;
        let inside = &self.text[open.end..close.start];
        if members.is_empty() && comments(inside).is_empty() {
            self.push("}");
            self.at = close.end;
            return;
        }
        if !inside.contains('\n') {
            let lines = (self.lines.clone(), self.at);
            let count = self.lines.len();
            let outer = std::mem::replace(&mut self.one_line, true);
            for (k, member) in members.iter().enumerate() {
                if k > 0 {
                    self.push(";");
                }
                self.nodes(member);
            }
            self.one_line = outer;
            self.inline_comments(close.start);
            self.push(" }");
            self.at = close.end;
            self.glued = false;
            if self.lines.len() == count && self.lines.last().is_some_and(|line| line.width() <= WIDTH) {
                return;
            }
            (self.lines, self.at) = lines;
        }
        self.indent += INDENT;
        self.opens = true;
        self.members(members);
        self.own_lines(close.start);
        self.indent -= INDENT;
        self.line("}".to_owned(), false);
        self.at = close.end;
        self.glued = false;
    }

    fn token(&mut self, token: &Token) {
        let gap = &self.text[self.at..token.start];
        let found = comments(gap);
        let breaks = if found.is_empty() { gap.contains('\n') } else { self.inline_comments(token.start) };
        if breaks {
            self.continued();
        } else if !self.glued && !token.glued_left {
            self.push(" ");
        }
        if token.aligned
            && !self.one_line
            && let Some(line) = self.lines.last_mut().filter(|line| line.assign.is_none())
        {
            line.assign = Some(line.text.len());
        }
        self.push(&token.text);
        self.at = token.end;
        self.glued = token.glued_right;
    }

    /// Comments inside a declaration. Says whether the next token starts a line.
    fn inline_comments(&mut self, until: usize) -> bool {
        let gap = &self.text[self.at..until];
        let base = self.at;
        let mut end = 0;
        let mut breaks = false;
        for Comment { start, end: stop, to_line_end } in comments(gap) {
            breaks |= gap[end..start].contains('\n');
            if breaks {
                self.continued();
            }
            let comment = gap[start..stop].trim_end();
            if to_line_end && !self.lines.last().is_some_and(|line| line.text.is_empty()) {
                self.trail(comment, base + start);
            } else {
                if !self.lines.last().is_some_and(|line| line.text.is_empty()) {
                    self.push(" ");
                }
                self.push(comment);
            }
            breaks = to_line_end;
            self.glued = false;
            end = stop;
        }
        breaks |= gap[end..].contains('\n');
        self.at = base + end;
        breaks
    }

    /// Comments between declarations: those after a token stay on its line, others get lines of their
    /// own. Says whether an empty line stands before `until`.
    fn own_lines(&mut self, until: usize) -> bool {
        let gap = &self.text[self.at..until];
        let mut end = 0;
        for Comment { start, end: stop, .. } in comments(gap) {
            let breaks = gap[end..start].matches('\n').count();
            let comment = gap[start..stop].trim_end();
            if breaks == 0 && !self.lines.is_empty() {
                self.trail(comment, self.at + start);
            } else {
                self.line(comment.to_owned(), breaks > 1);
            }
            end = stop;
        }
        let empty = gap[end..].matches('\n').count() > 1;
        self.at = until;
        empty
    }

    /// Starts a line.
    fn line(&mut self, text: String, empty_before: bool) {
        let empty_before = empty_before && !self.opens;
        self.opens = false;
        self.lines.push(Line { indent: self.indent, text, empty_before, ..Line::default() });
    }

    /// Goes on with the declaration on a further line.
    fn continued(&mut self) {
        self.lines.push(Line { indent: self.indent + CONTINUED, ..Line::default() });
        self.glued = true;
    }

    fn push(&mut self, text: &str) {
        if let Some(line) = self.lines.last_mut() {
            line.text.push_str(text);
        }
    }

    /// A comment at the end of a line, which begins at a byte of the source.
    fn trail(&mut self, comment: &str, at: usize) {
        let before = &self.text[..at];
        let stood = before[before.rfind('\n').map_or(0, |end| end + 1)..].chars().count();
        if let Some(line) = self.lines.last_mut() {
            let trail = line.comment.get_or_insert_default();
            if trail.is_empty() {
                line.stood = stood;
            } else {
                trail.push(' ');
            }
            trail.push_str(comment);
        }
    }
}

fn start(nodes: &[Node]) -> Option<usize> {
    Some(match nodes.first()? {
        Node::Token(token) => token.start,
        Node::Block { open, .. } => open.start,
    })
}
