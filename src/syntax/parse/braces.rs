//! Braces that do not pair up, found by the layout of the text.
//!
//! The grammar notices a missing brace late, where an outer block ends, and by then it has refused much that is
//! right. People indent, so the layout says where the brace belongs: a block lies deeper than the line that opens it,
//! and its closing brace stands as deep as that line. The text is mended there, without moving a byte (a blank becomes
//! a brace, a brace a blank), and parsed again; the one missing brace is the error. Only texts in which braces do
//! not pair up are looked at: nothing depends on layout in those in which they do.

use super::code;
use super::fault::quote;
use super::lexeme;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::source::{Source, Span};
use std::ops::Range;

/// Longest text that is mended, bytes: each way to mend it is parsed.
const LONGEST: usize = 1 << 17;
/// Most slips in one text; beyond them the layout says nothing.
const MOST_SLIPS: usize = 8;

/// Most braces that are turned for a try.
const MOST_TURNED: usize = 50;
/// Most ways to mend one slip that are tried, and most texts in all.
const MOST_WAYS: usize = 24;
const MOST_TRIES: usize = 40;
/// Most bytes of texts that are tried, those with a turned brace apart from the rest: of a long text fewer are. A
/// mebibyte takes less than a second.
const MOST_BYTES: usize = 1 << 20;

/// A line that has tokens.
struct Line<'t> {
    /// Column of its first token.
    indent: usize,
    tokens: Vec<(usize, &'t str)>,
}

impl Line<'_> {
    fn starts_with(&self, mark: &str) -> bool {
        self.tokens.first().is_some_and(|(_, token)| *token == mark)
    }

    fn has(&self, mark: &str) -> bool {
        self.tokens.iter().any(|(_, token)| *token == mark)
    }
}

/// An open brace.
#[derive(Clone, Copy)]
struct Open {
    at: usize,
    line: usize,
    indent: usize,
    /// Whether its line ends with it.
    last: bool,
}

/// An error of the braces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slip {
    /// A line lacks a `{`; or, where it has a `}` within it, at this byte, that one is too many.
    NotOpened { line: usize, close: Option<usize> },
    /// The `{` at this byte lacks its `}` at the end of a line.
    NotClosed { open: usize, line: usize },
    /// The `}` at this byte closes nothing.
    Stray { at: usize },
    /// The brace at this byte is turned the wrong way.
    Turned { at: usize },
}

/// A change of the text that keeps its length.
#[derive(Clone, Debug)]
struct Change {
    place: Range<usize>,
    by: char,
}

/// A text whose braces pair up, and what was wrong with it.
pub(super) struct Mended {
    /// The text, byte for byte as long as the one it was made of.
    pub(super) text: String,
    /// One error a slip.
    pub(super) errors: Vec<Diagnostic>,
}

fn lines(text: &str) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    let (mut at, mut end, mut start) = (0, 0, 0);
    while at < text.len() {
        let rest = &text[at..];
        if let Some(length) = lexeme::trivia(rest) {
            if let Some(newline) = rest[..length].rfind('\n') {
                start = at + newline + 1;
            }
            at += length;
            continue;
        }
        let token = lexeme::first(rest);
        match lines.last_mut() {
            Some(line) if end > start => line.tokens.push((at, token)),
            _ => lines.push(Line { indent: text[start..at].chars().count(), tokens: vec![(at, token)] }),
        }
        at += token.len().max(1);
        end = at;
    }
    lines
}

/// Whether the braces of a text pair up.
fn pairs_up(lines: &[Line<'_>]) -> bool {
    let mut depth = 0_usize;
    for (_, token) in lines.iter().flat_map(|line| &line.tokens) {
        match *token {
            "{" => depth += 1,
            "}" if depth == 0 => return false,
            "}" => depth -= 1,
            _ => {}
        }
    }
    depth == 0
}

/// The same of a text as it is written.
pub(super) fn is_even(text: &str) -> bool {
    pairs_up(&lines(text))
}

/// The line that should have opened the block that ends before line `end`: the last one that is no deeper.
fn header(lines: &[Line<'_>], end: usize) -> Option<usize> {
    let line = (0..end).rev().find(|&line| lines[line].indent <= lines[end].indent)?;
    // A line that opens a block of its own lacks none.
    let opens = lines[line].has("{");
    (lines[line].indent == lines[end].indent && line + 1 < end && !opens && !lines[line].starts_with("}"))
        .then_some(line)
}

/// What the layout says. Whether a `}` within a line may close a block of several lines is for the caller to try.
fn slips(lines: &[Line<'_>], closes_inside: bool) -> Vec<Slip> {
    let mut found = Vec::new();
    let mut stack: Vec<Open> = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        while let Some(open) = stack.last().copied()
            && (line.indent < open.indent || line.indent == open.indent && !line.starts_with("}"))
        {
            stack.pop();
            found.push(Slip::NotClosed { open: open.at, line: number - 1 });
        }
        for (k, &(at, token)) in line.tokens.iter().enumerate() {
            match (token, stack.last().copied()) {
                ("{", _) => {
                    let last = k + 1 == line.tokens.len();
                    stack.push(Open { at, line: number, indent: line.indent, last });
                }
                ("}", Some(open)) if k == 0 && open.indent == line.indent => drop(stack.pop()),
                ("}", _) if k == 0 => found.push(match header(lines, number) {
                    Some(line) => Slip::NotOpened { line, close: None },
                    None => Slip::Stray { at },
                }),
                ("}", Some(open)) if open.line == number || !open.last || closes_inside => drop(stack.pop()),
                ("}", _) => found.push(if line.has("{") {
                    Slip::Stray { at }
                } else {
                    Slip::NotOpened { line: number, close: Some(at) }
                }),
                _ => {}
            }
        }
    }
    found.extend(stack.iter().rev().map(|open| Slip::NotClosed { open: open.at, line: lines.len() - 1 }));
    found
}

/// The blank after a token, where a brace can stand; behind a comment, if need be.
fn blank_after(text: &str, end: usize) -> Option<Range<usize>> {
    let mut at = end;
    while at < text.len() {
        if text.as_bytes()[at].is_ascii_whitespace() {
            return Some(at..at + 1);
        }
        at += lexeme::trivia(&text[at..])?;
    }
    None
}

/// The ways to mend a slip, the likeliest first.
fn changes(text: &str, lines: &[Line<'_>], slip: Slip) -> Vec<Change> {
    let after = |&(at, token): &(usize, &str), by| {
        blank_after(text, at + token.len()).map(|place| Change { place, by })
    };
    // A place in the text must be one in the source, too: never within a letter.
    let instead = |&(at, token): &(usize, &str), by| {
        token.is_ascii().then(|| Change { place: at..at + token.len(), by })
    };
    match slip {
        Slip::Turned { at } => {
            vec![Change { place: at..at + 1, by: if text[at..].starts_with('{') { '}' } else { '{' } }]
        }
        Slip::Stray { at } => vec![Change { place: at..at + 1, by: ' ' }],
        Slip::NotClosed { open, line } => {
            let last = lines[line].tokens.last();
            let close =
                last.into_iter().flat_map(|last| after(last, '}').into_iter().chain(instead(last, '}')));
            // Something else stands where the brace belongs, alone on its line.
            let alone = lines
                .get(line + 1)
                .filter(|next| next.tokens.len() == 1)
                .and_then(|next| instead(&next.tokens[0], '}'));
            let mut changes: Vec<Change> = close.chain(alone).collect();
            let erased = Change { place: open..open + 1, by: ' ' };
            // One within a line that is not closed on it was hardly meant.
            let within = |tokens: &[(usize, &str)]| tokens.iter().rev().skip(1).any(|(at, _)| *at == open);
            if lines[..line].iter().any(|line| within(&line.tokens)) {
                changes.insert(0, erased);
            } else {
                changes.push(erased);
            }
            changes
        }
        Slip::NotOpened { line, close } => {
            // At the end of a line that starts a block; near the start of one that closes it, too.
            let mut tokens: Vec<&(usize, &str)> = lines[line].tokens.iter().collect();
            if close.is_none() {
                tokens.reverse();
            }
            let erased = close.map(|at| Change { place: at..at + 1, by: ' ' });
            let opened =
                tokens.into_iter().flat_map(|token| after(token, '{').into_iter().chain(instead(token, '{')));
            erased.into_iter().chain(opened).collect()
        }
    }
}

/// The text after some changes.
fn changed(text: &str, changes: &[Change]) -> Option<String> {
    let mut bytes = text.as_bytes().to_vec();
    for change in changes {
        bytes.get_mut(change.place.clone())?.fill(b' ');
        *bytes.get_mut(change.place.start)? = change.by as u8;
    }
    String::from_utf8(bytes).ok()
}

/// The error that a slip is, mended by a change.
fn error(source: &Source, slip: Slip, change: &Change) -> Diagnostic {
    let text = &source.text;
    let span = |from: usize, to: usize| Span::new(source.id, from, to);
    // What stands where the brace belongs, or after it; on a later line the place is the end of this one.
    let next = change.place.start + lexeme::all_trivia(&text[change.place.start..]);
    let found = lexeme::first(&text[next..]);
    let before = text[..change.place.start].trim_end().len();
    // A block of several lines should have ended before what stands there.
    let ends_block = matches!(
        slip,
        Slip::NotClosed { open, .. } if text.get(open..before).is_some_and(|block| block.contains('\n'))
    );
    let later = text[change.place.start..next].contains('\n') && !ends_block;
    let place = if later || found.is_empty() { span(before, before) } else { span(next, next + found.len()) };
    match slip {
        Slip::Turned { at } => {
            let title = format!("expected `{}`, found `{}`", change.by, &text[at..=at]);
            Diagnostic::error(code::UNEXPECTED, span(at, at + 1), title)
        }
        Slip::Stray { at } => Diagnostic::error(code::STRAY, span(at, at + 1), "`}` has no opening `{`"),
        Slip::NotOpened { close: Some(at), .. } if change.by == ' ' => {
            Diagnostic::error(code::STRAY, span(at, at + 1), "`}` has no opening `{`")
        }
        Slip::NotOpened { .. } => {
            Diagnostic::error(code::UNEXPECTED, place, format!("expected `{{`, found {}", quote(found)))
        }
        Slip::NotClosed { open, .. } if change.by == ' ' => {
            Diagnostic::error(code::UNEXPECTED, span(open, open + 1), "unexpected `{`, which is not closed")
        }
        Slip::NotClosed { open, .. } if found == "}" => {
            Diagnostic::error(code::UNCLOSED, span(open, open + 1), "`{` is not closed")
                .related(place, "this closes the block around it")
        }
        Slip::NotClosed { open, .. } => {
            Diagnostic::error(code::UNCLOSED, place, format!("expected `}}`, found {}", quote(found)))
                .related(span(open, open + 1), "`{` is not closed")
        }
    }
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
            Some(slip) if bytes(&slips[slip]).contains(&at) && !told.contains(&slip) => {
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

/// The cost of one error; the errors that it hides cost less.
pub(super) const ONE: usize = 1 << 10;

/// Mends a text whose braces do not pair up, in the way that leaves the fewest errors: `errors` weighs them, of a
/// mended text and of its slips, each `ONE`, and those that are hidden by another a little. `None` where they do pair up, or the layout is no help.
pub(super) fn mend(source: &Source, errors: &dyn Fn(&str, Vec<Diagnostic>) -> usize) -> Option<Mended> {
    let text = source.text.as_str();
    if text.len() > LONGEST {
        return None;
    }
    let lines = lines(text);
    if pairs_up(&lines) {
        return None;
    }
    let mut best: Option<(usize, Vec<Slip>, Vec<Change>)> = None;
    let tries = std::cell::Cell::new(0_usize);
    let affordable = MOST_BYTES / text.len().max(1);
    let most = MOST_TRIES.min(affordable);
    // One brace that is turned the wrong way is two that do not pair up; where the layout is right then, it is the one.
    let mut turns: Vec<(usize, Mended)> = Vec::new();
    for slip in turned(&lines) {
        let chosen = changes(text, &lines, slip);
        let Some(mended) = changed(text, &chosen) else { continue };
        let after = self::lines(&mended);
        if pairs_up(&after) {
            let crooked = slips(&after, false).len();
            let errors = said(source, &[slip], &chosen);
            turns.push((crooked, Mended { text: mended, errors }));
        }
    }
    turns.sort_by_key(|(crooked, _)| *crooked);
    for (_, mended) in turns.into_iter().take(affordable) {
        if errors(&mended.text, Vec::new()) == 0 {
            return Some(mended);
        }
    }
    // On a tie, what closes within a line is the slip.
    for closes_inside in [false, true] {
        let slips = slips(&lines, closes_inside);
        if slips.is_empty() || slips.len() > MOST_SLIPS {
            continue;
        }
        let ways: Vec<Vec<Change>> = slips.iter().map(|slip| changes(text, &lines, *slip)).collect();
        let Some(mut chosen) = ways.iter().map(|ways| ways.first().cloned()).collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let cost = |chosen: &[Change]| {
            tries.set(tries.get() + 1);
            if tries.get() > most {
                return usize::MAX;
            }
            let mended = changed(text, chosen).filter(|mended| pairs_up(&self::lines(mended)));
            mended.map_or(usize::MAX, |mended| errors(&mended, said(source, &slips, chosen)))
        };
        let mut least = cost(&chosen);
        for (place, ways) in ways.iter().enumerate() {
            for way in ways.iter().take(MOST_WAYS).skip(1) {
                // One is left for the likeliest ways of the other reading.
                if least <= ONE || tries.get() + usize::from(!closes_inside) >= most {
                    break;
                }
                let mut other = chosen.clone();
                other[place] = way.clone();
                let cost = cost(&other);
                if cost < least {
                    (least, chosen) = (cost, other);
                }
            }
        }
        if least < usize::MAX && best.as_ref().is_none_or(|(cost, ..)| least < *cost) {
            best = Some((least, slips, chosen));
        }
    }
    let (_, slips, chosen) = best?;
    Some(Mended { text: changed(text, &chosen)?, errors: said(source, &slips, &chosen) })
}

/// The braces one of which may be turned the wrong way: of those that are two too many.
fn turned(lines: &[Line<'_>]) -> Vec<Slip> {
    let all = |mark: &str| {
        let tokens = lines.iter().flat_map(|line| &line.tokens);
        tokens.filter(|(_, token)| *token == mark).map(|(at, _)| *at).collect::<Vec<usize>>()
    };
    let (opening, closing) = (all("{"), all("}"));
    let braces = match opening.len() as isize - closing.len() as isize {
        2 => opening,
        -2 => closing,
        _ => return Vec::new(),
    };
    braces.into_iter().take(MOST_TURNED).map(|at| Slip::Turned { at }).collect()
}

/// The errors that slips are.
fn said(source: &Source, slips: &[Slip], chosen: &[Change]) -> Vec<Diagnostic> {
    slips.iter().zip(chosen).map(|(slip, change)| error(source, *slip, change)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::source::SourceId;
    use std::cell::Cell;

    /// How often a text is weighed, as if it always had several errors.
    fn tries(text: &str) -> usize {
        let count = Cell::new(0);
        let weigh = |_: &str, _: Vec<Diagnostic>| {
            count.set(count.get() + 1);
            5 * ONE
        };
        mend(&Source::new(SourceId(0), "a.scn", text), &weigh);
        count.get()
    }

    /// Blocks, some of which lack their closing brace, among many that do not.
    fn blocks(whole: usize, broken: usize) -> String {
        let block = "kind k: sfm {\n  mass = 80 kg\n  radius = 0.3 m\n}\n";
        let lacking = "kind k: sfm {\n  mass = 80 kg\n  radius = 0.3 m\n";
        format!("{}{}", lacking.repeat(broken), block.repeat(whole))
    }

    #[test]
    fn the_longer_a_text_the_fewer_are_tried() {
        for broken in [1, 3, 8] {
            let short = tries(&blocks(20, broken));
            assert!((1..=MOST_TRIES).contains(&short), "{short}");
            let long = blocks(2_400, broken);
            assert!(long.len() < LONGEST);
            let count = tries(&long);
            assert!(count >= 2 && count * long.len() <= MOST_BYTES, "{count} of {}", long.len());
        }
        assert!(tries(&blocks(20, 8)) > MOST_BYTES / LONGEST, "a short one has all its tries");
        // Braces that may be turned the wrong way are tried apart from the rest.
        let turned = format!("kind k: sfm {{ mass = 80 kg {{\n{}", blocks(2_400, 0));
        let count = tries(&turned);
        assert!(count > MOST_BYTES / turned.len() && count * turned.len() <= 2 * MOST_BYTES, "{count}");
    }

    #[test]
    fn a_turned_brace_far_below_in_a_long_text_is_found_by_the_layout() {
        let block = format!("kind k: sfm {{\n  mass = 80 kg // {}\n}}\n", "x".repeat(3_000));
        let text = format!("{}kind k: sfm {{\n  mass = 80 kg\n{{\n", block.repeat(40));
        let at = text.rfind('{').unwrap();
        let weigh = |mended: &str, _: Vec<Diagnostic>| {
            if mended.as_bytes()[at] == b'}' { 0 } else { ONE }
        };
        let source = Source::new(SourceId(0), "a.scn", text.as_str());
        let mended = mend(&source, &weigh).unwrap();
        assert_eq!(&mended.text[at..=at], "}");
        assert_eq!(mended.errors.len(), 1);
    }
}
