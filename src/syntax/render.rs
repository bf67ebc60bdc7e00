//! Diagnostics as text with the marked source, in the manner of rustc. The only file that knows
//! annotate-snippets.

use super::diagnostic::{Diagnostic, Label, Severity};
use super::source::Source;
use crate::base::visible::{same_length, visible};
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::borrow::Cow;
use std::ops::Range;

/// Renders diagnostics, each followed by an empty line. `color`: with ANSI colours.
pub fn render(diagnostics: &[Diagnostic], sources: &[Source], color: bool) -> String {
    let sources = &shown_sources(sources);
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.decor_style(DecorStyle::Ascii);
    let mut text = String::new();
    for diagnostic in diagnostics {
        let diagnostic = &shown(diagnostic);
        let (group, cuts) = group(diagnostic, sources);
        let rendered = renderer.render(&[group]);
        if cuts.iter().all(|cut| cut.characters == 0) {
            text.push_str(&rendered);
        } else {
            undone(&cuts, &rendered, &mut text);
        }
        text.push_str("\n\n");
    }
    text
}

/// Sources as they are shown, with all places where they were. The renderer replaces controls of one byte itself; a mark of
/// UTF-8 at the start stays.
fn shown_sources(sources: &[Source]) -> Cow<'_, [Source]> {
    let start = |source: &Source| if source.text.starts_with('\u{FEFF}') { '\u{FEFF}'.len_utf8() } else { 0 };
    let is_fine = |source: &Source| {
        let (name, text) = (visible(&source.name), same_length(&source.text[start(source)..]));
        matches!((name, text), (Cow::Borrowed(_), Cow::Borrowed(_)))
    };
    if sources.iter().all(is_fine) {
        return Cow::Borrowed(sources);
    }
    let replaced = sources.iter().map(|source| {
        let (mark, rest) = source.text.split_at(start(source));
        let text = format!("{mark}{}", same_length(rest));
        Source::new(source.id, visible(&source.name).into_owned(), text)
    });
    Cow::Owned(replaced.collect())
}

/// A diagnostic as it is shown. What it quotes beside the marked source is in these texts.
fn shown(diagnostic: &Diagnostic) -> Diagnostic {
    let mut shown = diagnostic.clone();
    let labels = shown.place.iter_mut().chain(&mut shown.related).map(|label| &mut label.text);
    for text in labels.chain([&mut shown.title]).chain(&mut shown.hint) {
        if let Cow::Owned(escaped) = visible(text) {
            *text = escaped;
        }
    }
    shown
}

/// Characters that the line of a snippet lost at its start before it was rendered.
struct Cut {
    /// What stands before the column of a place on that line.
    place: String,
    characters: usize,
}

impl Cut {
    /// The line above the snippet with the column counted from the start of its line.
    fn heading(&self, heading: &str) -> Option<String> {
        let (before, rest) = heading.split_once(&self.place)?;
        let length = rest.bytes().take_while(u8::is_ascii_digit).count();
        let column = rest[..length].parse::<usize>().ok()? + self.characters;
        Some(format!("{before}{}{column}{}", self.place, &rest[length..]))
    }
}

/// Counts the columns above snippets from the starts of their lines: each snippet has its cut.
fn undone(cuts: &[Cut], rendered: &str, text: &mut String) {
    let mut cuts = cuts.iter();
    for line in rendered.split_inclusive('\n') {
        let mut mark = line.trim_start();
        while let Some((_, behind)) = mark.strip_prefix("\x1b[").and_then(|color| color.split_once('m')) {
            mark = behind;
        }
        let is_heading = mark.starts_with("-->") || mark.starts_with(":::");
        let heading = if is_heading { cuts.next().and_then(|cut| cut.heading(line)) } else { None };
        text.push_str(heading.as_deref().unwrap_or(line));
    }
}

fn group<'a>(diagnostic: &'a Diagnostic, sources: &'a [Source]) -> (Group<'a>, Vec<Cut>) {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.title.as_str()).id(diagnostic.code.name());
    let mut group = Group::with_title(title);
    let mut cuts = Vec::new();
    let mut rest: Vec<&Label> = diagnostic.related.iter().collect();
    if let Some(place) = &diagnostic.place {
        // One snippet a source, and one for what lies far away in it: that of the place first, then those of others.
        let mut of = Some((place, Some(place)));
        while let Some((first, primary)) = of {
            let (here, elsewhere) = near(first, rest);
            if let Some(source) = sources.iter().find(|source| source.id == first.span.source) {
                let window = window(source, primary.into_iter().chain(here.iter().copied()));
                let (line, column) = source.line_column(window.start as u32);
                cuts.push(Cut { place: format!("{}:{line}:", source.name), characters: column - 1 });
                let mut snippet =
                    Snippet::source(&source.text[window.clone()]).line_start(line).path(source.name.as_str());
                let kinds = primary.map(|label| (AnnotationKind::Primary, label)).into_iter();
                let others = here.into_iter().map(|label| (AnnotationKind::Context, label));
                for (kind, label) in kinds.chain(others) {
                    snippet = snippet.annotation(annotation(kind, label, source, window.start));
                }
                group = group.element(snippet);
            }
            of = elsewhere.first().map(|label| (*label, None));
            rest = elsewhere;
        }
    }
    if let Some(hint) = &diagnostic.hint {
        group = group.element(Level::HELP.message(hint.as_str()));
    }
    (group, cuts)
}

/// Bytes between two places that are shown apart.
const FAR: u32 = 1 << 13;

/// Those of some labels that are shown with the first one, and the others: the renderer reads all that stands between
/// those which it shows together, and for thousands of errors that point back at one place that would be much.
fn near<'a>(first: &Label, labels: Vec<&'a Label>) -> (Vec<&'a Label>, Vec<&'a Label>) {
    let (mut low, mut high) = (first.span.start, first.span.end);
    let (mut here, mut rest) = (Vec::new(), labels);
    loop {
        let is_near = |label: &&Label| {
            label.span.source == first.span.source
                && label.span.start <= high.saturating_add(FAR)
                && low <= label.span.end.saturating_add(FAR)
        };
        let (found, others): (Vec<_>, Vec<_>) = rest.into_iter().partition(is_near);
        rest = others;
        if found.is_empty() {
            return (here, rest);
        }
        for label in &found {
            (low, high) = (low.min(label.span.start), high.max(label.span.end));
        }
        here.extend(found);
    }
}

/// Bytes of a line on either side of what is marked there: more than fit on a line of output.
const AROUND: usize = 1 << 10;

/// The lines of some labels and one more on either side, of a very long line what stands around its labels: all that is
/// shown. The renderer reads what it is given from end to end, and of a long text that would be much for each of
/// thousands of errors.
fn window<'a>(source: &Source, labels: impl Iterator<Item = &'a Label>) -> Range<usize> {
    let (mut low, mut high) = (source.text.len(), 0);
    for label in labels {
        let end = floor(&source.text, label.span.end as usize);
        low = low.min(floor(&source.text, label.span.start as usize)).min(end);
        high = high.max(end);
    }
    let text = source.text.as_str();
    let line = |at: usize| source.line_start(at as u32) as usize;
    // One past the line break at the end of a line.
    let next_line = |at: usize| (source.line_end(at as u32) as usize + 1).min(text.len());
    let mut start = line(line(low).saturating_sub(1));
    let mut end = next_line(next_line(high));
    if text.get(low..high).is_some_and(|marked| !marked.contains('\n')) {
        // Blanks at the start count as indentation: a line that is cut starts with something else.
        let first = line(low);
        let left = floor(text, low.saturating_sub(AROUND)).max(first);
        if let Some(at) = text[first..left].rfind(|c: char| !c.is_whitespace()) {
            start = first + at;
        }
        let right = floor(text, high + AROUND);
        if right < next_line(high) {
            end = right;
        }
    }
    start..end
}

fn annotation<'a>(
    kind: AnnotationKind,
    label: &'a Label,
    source: &Source,
    from: usize,
) -> annotate_snippets::Annotation<'a> {
    let end = floor(&source.text, label.span.end as usize);
    let start = floor(&source.text, label.span.start as usize).min(end);
    let annotation = kind.span(start - from..end - from);
    if label.text.is_empty() { annotation } else { annotation.label(label.text.as_str()) }
}

/// The nearest character boundary not above a byte.
fn floor(text: &str, byte: usize) -> usize {
    let mut at = byte.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::codes::Code;
    use crate::syntax::source::{SourceId, Span};

    #[test]
    fn places_of_two_sources_and_places_out_of_range() {
        let first = Source::new(SourceId(0), "a.scn", "horizon = 3 m\n");
        let second = Source::new(SourceId(1), "b.bltl", "é = 1");
        let diagnostic = error!(E0101, Span::new(SourceId(0), 10, 13), "expected a time")
            .label("this is a length")
            .related(Span::new(SourceId(1), 1, 900), "used here")
            .hint("write `3 s`");
        let text = render(
            &[diagnostic, Diagnostic::placeless(Code::E0701, "no such file")],
            &[first, second],
            false,
        );
        for part in [
            "error[E0101]: expected a time",
            "--> a.scn:1:11",
            "b.bltl:1:1",
            "write `3 s`",
            "error[E0701]: no such file",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
    }

    /// An error at `x` between `before` and `after`, rendered.
    fn marked(before: &str, after: &str) -> String {
        let source = Source::new(SourceId(0), "a.scn", format!("a = 1\n{before}x = 2 s{after}\nb = 1\n"));
        let at = 6 + before.len();
        let diagnostic = error!(E0101, Span::new(SourceId(0), at, at + 1), "expected a time")
            .related(Span::new(SourceId(0), at + 4, at + 5), "a number");
        render(&[diagnostic], &[source], false)
    }

    #[test]
    fn places_far_apart_are_shown_apart() {
        let line = "const a = 1\n";
        let many = |parted: usize, line: &str| {
            let text = line.repeat(parted + 1);
            let at = text.len() - line.len();
            let source = Source::new(SourceId(0), "a.scn", text);
            let name = |at: usize| Span::new(SourceId(0), at + 6, at + 7);
            let diagnostic = error!(E0202, name(at), "`a` is declared twice")
                .related(name(0), "first declared here")
                .related(name(line.len()), "and here");
            [false, true]
                .map(|color| render(std::slice::from_ref(&diagnostic), std::slice::from_ref(&source), color))
        };
        let [plain, _] = many(100, line);
        assert!(plain.contains("--> a.scn:101:7\n") && plain.contains("\n...\n"), "{plain}");
        assert!(!plain.contains(":::"), "{plain}");
        let [plain, color] = many(1_000, line);
        assert!(plain.contains("--> a.scn:1001:7\n") && plain.contains("::: a.scn:1:7\n"), "{plain}");
        assert!(plain.contains("first declared here") && plain.contains("and here"), "{plain}");
        assert!(color.contains("a.scn:1001:7") && color.contains("a.scn:1:7"), "{color}");
        // On one line, too.
        for text in many(1_000, "const a = 1;") {
            assert!(text.contains("a.scn:1:12007") && text.contains("a.scn:1:7"), "{text}");
            assert!(text.contains("first declared here") && text.contains("and here"), "{text}");
        }
    }

    #[test]
    fn of_a_very_long_line_the_same_is_shown_as_of_a_long_one() {
        for part in ["y = 3 m; ", "é = 3 m; ", "\ty = 3  ", "    "] {
            let sides = |times: usize| marked(&format!("y{}", part.repeat(times)), &part.repeat(times));
            let columns = |times: usize| 2 + part.chars().count() * times;
            // Nothing is cut of the shorter one.
            let (long, very) = (AROUND / 10, 50 * AROUND);
            let (short, column) = (sides(long), columns(long));
            assert!(short.contains(&format!("--> a.scn:2:{column}\n")), "{short}");
            let expected = short.replace(&format!(":{column}\n"), &format!(":{}\n", columns(very)));
            assert_eq!(sides(very), expected);
            assert_eq!(marked("", &part.repeat(very)), marked("", &part.repeat(long)));
            let blank =
                |times: usize| marked(&" ".repeat(times), "").replace(&format!(":{}\n", times + 1), "");
            assert_eq!(blank(very), blank(long));
        }
    }
}
