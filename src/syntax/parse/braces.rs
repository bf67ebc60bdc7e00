//! Braces that do not pair up, found by the layout of the text.
//!
//! A missing brace would be noticed late, where an outer block ends, and by then items stand in the wrong blocks. People
//! indent, so the layout says where the brace belongs: a block lies deeper than the line that opens it, and its closing
//! brace stands as deep as that line. The tokens are mended there: a brace is put in, taken out or turned, and that is
//! the error. Only texts in which braces do not pair up are looked at: nothing depends on layout in those in which
//! they do.

use super::layout::Token;
use super::lexeme::starts_name;
use super::nouns::{quote, starts_declaration};
use crate::syntax::ast::Broken;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::keywords::Place;
use crate::syntax::source::{Source, Span};
use std::ops::Range;

/// Most slips in one text; beyond them the layout says nothing.
const MOST_SLIPS: usize = 8;
/// Most braces that are turned for a try.
const MOST_TURNED: usize = 50;

/// A line that has tokens.
struct Line {
    /// Column of its first token.
    indent: usize,
    tokens: Range<usize>,
}

/// An open brace.
#[derive(Clone, Copy)]
struct Open {
    token: usize,
    line: usize,
    indent: usize,
    /// Whether its line ends with it.
    last: bool,
    /// Whether the line behind it is deeper.
    deepens: bool,
}

/// An error of the braces; tokens and lines by their places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slip {
    /// A line lacks a `{` at its end.
    NotOpened { line: usize },
    /// The `{` lacks its `}` at the end of a line.
    NotClosed { open: usize, line: usize },
    /// The `{` is one too many: it stands within a line and is not closed there.
    Opens { open: usize },
    /// The `}` closes nothing.
    Stray { close: usize },
    /// A `{` stands for a `}`, or anything else for the other.
    Turned { brace: usize },
}

/// The text at hand.
struct Text<'s, 't> {
    source: &'s Source,
    tokens: &'s [Token<'t>],
    lines: Vec<Line>,
    /// Whether what stands in a block is written deeper; where it is not, the layout says nothing of blocks.
    indents: bool,
}

/// Whether the braces of a text pair up.
fn pairs_up(tokens: &[Token<'_>]) -> bool {
    let mut depth = 0_usize;
    for token in tokens {
        match token.text {
            "{" => depth += 1,
            "}" if depth == 0 => return false,
            "}" => depth -= 1,
            _ => {}
        }
    }
    depth == 0
}

impl<'s, 't> Text<'s, 't> {
    fn of(source: &'s Source, tokens: &'s [Token<'t>]) -> Self {
        let mut lines: Vec<Line> = Vec::new();
        for (at, token) in tokens.iter().enumerate() {
            match lines.last_mut() {
                Some(line) if !token.starts_line => line.tokens.end = at + 1,
                _ => {
                    let start = source.line_start(token.at as u32) as usize;
                    let indent = source.text[start..token.at].chars().count();
                    lines.push(Line { indent, tokens: at..at + 1 });
                }
            }
        }
        let opens = |line: &Line| tokens[line.tokens.end - 1].text == "{";
        let indents = lines.windows(2).any(|pair| opens(&pair[0]) && pair[1].indent > pair[0].indent);
        Self { source, tokens, lines, indents }
    }

    fn first(&self, line: usize) -> &'t str {
        self.tokens[self.lines[line].tokens.start].text
    }

    fn has(&self, line: usize, mark: &str) -> bool {
        self.tokens[self.lines[line].tokens.clone()].iter().any(|token| token.text == mark)
    }

    /// The line that should have opened the block that ends before line `end`: the last one that is no deeper.
    fn header(&self, end: usize) -> Option<usize> {
        let line = (0..end).rev().find(|&line| self.lines[line].indent <= self.lines[end].indent)?;
        let is_as_deep = self.lines[line].indent == self.lines[end].indent && line + 1 < end;
        // A line that opens a block of its own lacks none, unless it closes that, too.
        let last = self.tokens[self.lines[line].tokens.end - 1].text;
        (is_as_deep && (!self.has(line, "{") || last == "}") && self.first(line) != "}").then_some(line)
    }

    /// The slips that the layout shows. Whether a `}` within a line may close a block of several lines is for the caller to choose.
    fn slips(&self, closes_inside: bool) -> Vec<Slip> {
        let mut found = Vec::new();
        let mut stack: Vec<Open> = Vec::new();
        let not_closed = |open: Open, line: usize| {
            let last = self.lines[line].tokens.clone();
            let first = self.lines.get(open.line + 1).map_or(0, |first| first.indent);
            // One within a line that is not closed on it was hardly meant, nor one that no deeper line follows.
            if if open.last { self.indents && !open.deepens } else { open.line < line } {
                Slip::Opens { open: open.token }
            } else if last.len() == 1 && line > open.line + 1 && self.lines[line].indent < first {
                // Something else stands where the brace belongs, alone on its line.
                Slip::Turned { brace: last.start }
            } else {
                Slip::NotClosed { open: open.token, line }
            }
        };
        for (number, line) in self.lines.iter().enumerate() {
            let first = self.first(number);
            while let Some(open) = stack.last().copied() {
                let is_out = line.indent < open.indent || line.indent == open.indent && first != "}";
                if !is_out || !self.indents && !starts_declaration(first) {
                    break;
                }
                stack.pop();
                found.push(not_closed(open, number - 1));
            }
            if let Some(open) = stack.last_mut() {
                open.deepens |= line.indent > open.indent || first == "}";
            }
            for at in line.tokens.clone() {
                let starts = at == line.tokens.start;
                match (self.tokens[at].text, stack.last().copied()) {
                    ("{", _) => {
                        let last = at + 1 == line.tokens.end;
                        let indent = line.indent;
                        stack.push(Open { token: at, line: number, indent, last, deepens: false });
                    }
                    ("}", Some(open)) if starts && (open.indent == line.indent || !self.indents) => {
                        let _ = stack.pop();
                    }
                    ("}", _) if starts => found.push(match self.header(number) {
                        Some(header) if !self.has(header, "{") => Slip::NotOpened { line: header },
                        // `process p { var n = 0 }`, and the block goes on below.
                        Some(header) => Slip::Stray { close: self.lines[header].tokens.end - 1 },
                        None => Slip::Stray { close: at },
                    }),
                    ("}", Some(open)) if open.line == number || !open.last || closes_inside => {
                        let _ = stack.pop();
                    }
                    ("}", _) => found.push(Slip::Stray { close: at }),
                    _ => {}
                }
            }
        }
        let last = self.lines.len().saturating_sub(1);
        found.extend(stack.iter().rev().map(|open| not_closed(*open, last)));
        found
    }

    /// The tokens once a slip is mended; of several the last one in the text comes first.
    fn mended(&self, slips: &[Slip]) -> Vec<Token<'t>> {
        let mut tokens: Vec<Option<Token<'t>>> = self.tokens.iter().copied().map(Some).collect();
        let mut added: Vec<(usize, &'static str)> = Vec::new();
        for slip in slips {
            match *slip {
                Slip::Stray { close: at } | Slip::Opens { open: at } => tokens[at] = None,
                Slip::Turned { brace } => {
                    let text = if self.tokens[brace].text == "}" { "{" } else { "}" };
                    tokens[brace] = Some(Token { text, ..self.tokens[brace] });
                }
                Slip::NotClosed { line, .. } => added.push((self.lines[line].tokens.end, "}")),
                Slip::NotOpened { line } => added.push((self.lines[line].tokens.end, "{")),
            }
        }
        added.sort_by_key(|(at, _)| *at);
        let (mut mended, mut added) = (Vec::new(), added.into_iter().peekable());
        for at in 0..=tokens.len() {
            while let Some((_, text)) = added.next_if(|(place, _)| *place == at) {
                let end = self.tokens[at - 1].end();
                mended.push(Token { at: end, text, starts_line: false });
            }
            mended.extend(tokens.get(at).copied().flatten());
        }
        mended
    }

    /// The error that a slip is.
    fn error(&self, slip: Slip) -> Diagnostic {
        let span = |at: usize| {
            let token = self.tokens[at];
            Span::new(self.source.id, token.at, token.end())
        };
        // The place at the end of a line: there, or at what follows a block that should have ended before.
        let end_of = |line: usize, is_before_next: bool| {
            let end = self.lines[line].tokens.end;
            let next = self.tokens.get(end).filter(|_| is_before_next);
            let before = self.tokens[end - 1].end();
            next.map_or(Span::new(self.source.id, before, before), |_| span(end))
        };
        let found = |line: usize| match self.tokens.get(self.lines[line].tokens.end) {
            Some(next) => quote(next.text),
            None => "the end of the file".to_owned(),
        };
        match slip {
            Slip::Turned { brace } => {
                let found = self.tokens[brace].text;
                let wanted = if found == "}" { "{" } else { "}" };
                let title = format!("expected `{wanted}`, found {}", quote(found));
                error!(E0101, span(brace), "{title}")
            }
            Slip::Stray { close } => error!(E0103, span(close), "`}}` has no opening `{{`"),
            Slip::Opens { open } => {
                error!(E0101, span(open), "unexpected `{{`, which is not closed")
            }
            Slip::NotOpened { line } => {
                let title = format!("expected `{{`, found {}", found(line));
                error!(E0101, end_of(line, false), "{title}")
            }
            Slip::NotClosed { open, line }
                if self.tokens.get(self.lines[line].tokens.end).is_some_and(|next| next.text == "}") =>
            {
                error!(E0102, span(open), "`{{` is not closed")
                    .related(end_of(line, true), "this closes the block around it")
            }
            Slip::NotClosed { open, line } => {
                let spans_lines = !self.lines[line].tokens.contains(&open);
                let title = format!("expected `}}`, found {}", found(line));
                error!(E0102, end_of(line, spans_lines), "{title}").related(span(open), "`{` is not closed")
            }
        }
    }

    /// The lines of some errors: what stands there may have been meant otherwise.
    fn lines_of(&self, errors: &[Diagnostic]) -> Vec<Broken> {
        let places = errors.iter().flat_map(|one| one.place.iter().chain(&one.related));
        places
            .map(|label| {
                let (start, end) =
                    (self.source.line_start(label.span.start), self.source.line_end(label.span.start));
                let here =
                    self.tokens.iter().filter(|token| (start as usize..end as usize).contains(&token.at));
                let words = here.map(|token| token.text).filter(|text| text.starts_with(starts_name));
                Broken {
                    span: Span { start, end, ..label.span },
                    place: Place::Other,
                    name: None,
                    words: words.map(str::to_owned).collect(),
                }
            })
            .collect()
    }

    /// The one brace that is turned the wrong way, if turning it leaves the layout right: such a brace is two too many.
    fn turned(&self) -> Option<Slip> {
        let count = |mark: &str| self.tokens.iter().filter(|token| token.text == mark).count() as isize;
        let mark = match count("{") - count("}") {
            2 => "{",
            -2 => "}",
            _ => return None,
        };
        let braces = (0..self.tokens.len()).filter(|at| self.tokens[*at].text == mark).take(MOST_TURNED);
        braces.map(|brace| Slip::Turned { brace }).find(|turned| {
            let mended = self.mended(&[*turned]);
            pairs_up(&mended) && Text::of(self.source, &mended).slips(false).is_empty()
        })
    }
}

/// Braces that do not pair up.
#[derive(Default)]
pub(super) struct Mended {
    /// The errors.
    pub(super) slips: Vec<Diagnostic>,
    /// The lines on which it was.
    pub(super) lines: Vec<Broken>,
    /// Whether the layout is no help, so that items may stand in the wrong blocks.
    pub(super) is_torn: bool,
}

/// The braces without a partner: those that open a block, and those that close one.
fn unmatched(tokens: &[Token<'_>]) -> (Vec<usize>, Vec<usize>) {
    let (mut open, mut stray) = (Vec::new(), Vec::new());
    for (at, token) in tokens.iter().enumerate() {
        match token.text {
            "{" => open.push(at),
            "}" if open.pop().is_none() => stray.push(at),
            _ => {}
        }
    }
    (open, stray)
}

/// Mends tokens whose braces do not pair up.
pub(super) fn mend(source: &Source, tokens: &mut Vec<Token<'_>>, in_properties: bool) -> Mended {
    if pairs_up(tokens) {
        return Mended::default();
    }
    let text = Text::of(source, tokens);
    let mut ways: Vec<Vec<Slip>> = text.turned().into_iter().map(|turned| vec![turned]).collect();
    ways.extend([false, true].map(|closes_inside| text.slips(closes_inside)));
    if in_properties {
        // No block stands there.
        let (open, stray) = unmatched(tokens);
        let open = open.into_iter().map(|open| Slip::Opens { open });
        ways = vec![open.chain(stray.into_iter().map(|close| Slip::Stray { close })).collect()];
    }
    ways.retain(|slips| slips.len() <= MOST_SLIPS && pairs_up(&text.mended(slips)));
    // On a tie, what closes within a line is the slip.
    if let Some(slips) = ways.into_iter().min_by_key(Vec::len) {
        let slips_said: Vec<Diagnostic> = slips.iter().map(|slip| text.error(*slip)).collect();
        let lines = text.lines_of(&slips_said);
        let mended = text.mended(&slips);
        *tokens = mended;
        return Mended { slips: slips_said, lines, is_torn: false };
    }
    // The layout is no help: braces that close nothing are errors, and the first that is not closed.
    let (open, stray) = unmatched(tokens);
    let stray: Vec<Slip> = stray.into_iter().map(|close| Slip::Stray { close }).collect();
    let last = text.lines.len() - 1;
    let unclosed = open.iter().map(|open| Slip::NotClosed { open: *open, line: last });
    let told = stray.len() + 1;
    let slips: Vec<Slip> = stray.into_iter().chain(unclosed).collect();
    let errors = slips.iter().take(told).map(|slip| text.error(*slip)).collect();
    let mended = text.mended(&slips);
    *tokens = mended;
    Mended { slips: errors, lines: Vec::new(), is_torn: true }
}

/// What the grammar says of a mended text, and what was wrong with its braces. On the lines of a brace that lacks its
/// partner the grammar stumbles over what the brace left behind: one error is enough, and where both are about one
/// brace, that of the grammar knows what should stand there.
pub(super) fn together(source: &Source, said: Vec<Diagnostic>, slips: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let line = |byte: u32| source.line(byte);
    let start = |one: &Diagnostic| one.place.as_ref().map(|place| place.span.start);
    let bytes = |slip: &Diagnostic| {
        let related = slip.related.iter().map(|label| label.span.start);
        start(slip).into_iter().chain(related).collect::<Vec<u32>>()
    };
    let (mut kept, mut told) = (Vec::new(), Vec::new());
    for one in said {
        let Some(at) = start(&one).filter(|_| one.severity == Severity::Error) else {
            kept.push(one);
            continue;
        };
        let near = slips.iter().position(|slip| bytes(slip).iter().any(|&byte| line(byte) == line(at)));
        match near {
            None => kept.push(one),
            // An error before a brace that closes nothing may be its cause.
            Some(slip)
                if !told.contains(&slip)
                    && (bytes(&slips[slip]).contains(&at)
                        || slips[slip].code == Code::E0103 && start(&slips[slip]) > Some(at)) =>
            {
                told.push(slip);
                kept.push(one);
            }
            Some(_) => {}
        }
    }
    let rest = slips.into_iter().enumerate().filter(|(place, _)| !told.contains(place));
    kept.extend(rest.map(|(_, slip)| slip));
    kept
}
