//! Diagnostics as text with the marked source, in the manner of rustc. The only file that knows
//! annotate-snippets.

use super::diagnostic::{Diagnostic, Label, Severity};
use super::source::Source;
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::ops::Range;

/// Renders diagnostics, each followed by an empty line. `color`: with ANSI colours.
pub fn render(diagnostics: &[Diagnostic], sources: &[Source], color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.decor_style(DecorStyle::Ascii);
    let mut text = String::new();
    for diagnostic in diagnostics {
        let (group, cuts) = group(diagnostic, sources);
        let rendered = renderer.render(&[group]);
        text.push_str(&cuts.iter().fold(rendered, |rendered, cut| cut.undone(rendered)));
        text.push_str("\n\n");
    }
    text
}

/// Characters that a line lost at its start before it was rendered.
struct Cut {
    /// What stands before the column of a place on that line.
    place: String,
    characters: usize,
}

impl Cut {
    /// Counts the column from the start of the line.
    fn undone(&self, mut rendered: String) -> String {
        let Some(from) = rendered.find(&self.place).map(|at| at + self.place.len()) else { return rendered };
        let length = rendered[from..].bytes().take_while(u8::is_ascii_digit).count();
        if let Ok(column) = rendered[from..from + length].parse::<usize>() {
            rendered.replace_range(from..from + length, &(column + self.characters).to_string());
        }
        rendered
    }
}

fn group<'a>(diagnostic: &'a Diagnostic, sources: &'a [Source]) -> (Group<'a>, Vec<Cut>) {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.title.as_str()).id(diagnostic.code);
    let mut group = Group::with_title(title);
    let mut cuts = Vec::new();
    let mut rest: Vec<&Label> = diagnostic.related.iter().collect();
    if let Some(place) = &diagnostic.place {
        // One snippet a source: that of the place first, then those of other files.
        let mut of = Some((place.span.source, Some(place)));
        while let Some((id, primary)) = of {
            let (here, elsewhere): (Vec<_>, Vec<_>) =
                rest.into_iter().partition(|label| label.span.source == id);
            if let Some(source) = sources.iter().find(|source| source.id == id) {
                let window = window(source, primary.into_iter().chain(here.iter().copied()));
                let (line, column) = source.line_column(window.start as u32);
                if column > 1 {
                    cuts.push(Cut { place: format!("{}:{line}:", source.name), characters: column - 1 });
                }
                let mut snippet =
                    Snippet::source(&source.text[window.clone()]).line_start(line).path(source.name.as_str());
                let kinds = primary.map(|label| (AnnotationKind::Primary, label)).into_iter();
                let others = here.into_iter().map(|label| (AnnotationKind::Context, label));
                for (kind, label) in kinds.chain(others) {
                    snippet = snippet.annotation(annotation(kind, label, source, window.start));
                }
                group = group.element(snippet);
            }
            of = elsewhere.first().map(|label| (label.span.source, None));
            rest = elsewhere;
        }
    }
    if let Some(hint) = &diagnostic.hint {
        group = group.element(Level::HELP.message(hint.as_str()));
    }
    (group, cuts)
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
    let line = |at: usize| text[..at].rfind('\n');
    let newline = |from: usize| text[from..].find('\n').map(|at| from + at + 1);
    let mut start = line(low).and_then(line).map_or(0, |newline| newline + 1);
    let mut end = newline(high).and_then(newline).unwrap_or(text.len());
    if text.get(low..high).is_some_and(|marked| !marked.contains('\n')) {
        // Blanks at the start count as indentation: a line that is cut starts with something else.
        let first = line(low).map_or(0, |newline| newline + 1);
        let left = floor(text, low.saturating_sub(AROUND)).max(first);
        if let Some(at) = text[first..left].rfind(|c: char| !c.is_whitespace()) {
            start = first + at;
        }
        let right = floor(text, high + AROUND);
        if newline(high).is_none_or(|newline| right < newline) {
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
    use crate::syntax::source::{SourceId, Span};

    #[test]
    fn places_of_two_sources_and_places_out_of_range() {
        let first = Source::new(SourceId(0), "a.scn", "horizon = 3 m\n");
        let second = Source::new(SourceId(1), "b.bltl", "é = 1");
        let diagnostic = Diagnostic::error("E0101", Span::new(SourceId(0), 10, 13), "expected a time")
            .label("this is a length")
            .related(Span::new(SourceId(1), 1, 900), "used here")
            .hint("write `3 s`");
        let text =
            render(&[diagnostic, Diagnostic::placeless("E0701", "no such file")], &[first, second], false);
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
        let diagnostic = Diagnostic::error("E0101", Span::new(SourceId(0), at, at + 1), "expected a time")
            .related(Span::new(SourceId(0), at + 4, at + 5), "a number");
        render(&[diagnostic], &[source], false)
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
