//! Diagnostics as text with the marked source, in the manner of rustc. The only file that knows
//! annotate-snippets.

use super::diagnostic::{Diagnostic, Label, Severity};
use super::source::Source;
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

/// Renders diagnostics, each followed by an empty line. `color`: with ANSI colours.
pub fn render(diagnostics: &[Diagnostic], sources: &[Source], color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.decor_style(DecorStyle::Ascii);
    let mut text = String::new();
    for diagnostic in diagnostics {
        text.push_str(&renderer.render(&[group(diagnostic, sources)]));
        text.push_str("\n\n");
    }
    text
}

fn group<'a>(diagnostic: &'a Diagnostic, sources: &'a [Source]) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.title.as_str()).id(diagnostic.code);
    let mut group = Group::with_title(title);
    let mut rest: Vec<&Label> = diagnostic.related.iter().collect();
    if let Some(place) = &diagnostic.place {
        // One snippet a source: that of the place first, then those of other files.
        let mut of = Some((place.span.source, Some(place)));
        while let Some((id, primary)) = of {
            let (here, elsewhere): (Vec<_>, Vec<_>) =
                rest.into_iter().partition(|label| label.span.source == id);
            if let Some(source) = sources.iter().find(|source| source.id == id) {
                let mut snippet = Snippet::source(source.text.as_str()).path(source.name.as_str());
                if let Some(label) = primary {
                    snippet = snippet.annotation(annotation(AnnotationKind::Primary, label, source));
                }
                for label in here {
                    snippet = snippet.annotation(annotation(AnnotationKind::Context, label, source));
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
    group
}

fn annotation<'a>(
    kind: AnnotationKind,
    label: &'a Label,
    source: &Source,
) -> annotate_snippets::Annotation<'a> {
    let end = floor(&source.text, label.span.end as usize);
    let start = floor(&source.text, label.span.start as usize).min(end);
    let annotation = kind.span(start..end);
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
}
