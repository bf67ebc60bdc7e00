//! Mutations of every token of every example, and noise: nothing panics, the first error lies where the text was
//! changed, and it is the only one.

mod front;
mod pairs;

use proptest::prelude::*;
use smc::syntax::diagnostic::{Diagnostic, Severity};
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::print::{format_properties, format_scenario};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};
use std::ops::Range;

/// All models and property files, by their paths.
fn examples() -> Vec<Source> {
    let mut paths = Vec::new();
    for folder in ["models", "properties"] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path().to_str().unwrap().to_owned();
            // A block behind tracks may be theirs, and a clause of people may go on: slips there are reported nearby.
            let is_recorded = ["/hotel", "/square"].iter().any(|name| path.contains(name));
            if (path.ends_with(".scn") || path.ends_with(".bltl")) && !is_recorded {
                paths.push(path);
            }
        }
    }
    paths.sort();
    assert!(paths.len() >= 22, "{paths:?}");
    paths.iter().map(|path| Source::new(SourceId(0), path, std::fs::read_to_string(path).unwrap())).collect()
}

fn diagnostics(source: &Source) -> Vec<Diagnostic> {
    if source.name.ends_with(".scn") { parse_scenario(source).1 } else { parse_properties(source).1 }
}

/// Words, numbers, texts and marks, comments left out: a scanner of its own, apart from the grammar's.
fn tokens(text: &str) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        let first = rest.chars().next().unwrap();
        let length = if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
            continue;
        } else if first == '"' {
            rest[1..].find('"').unwrap() + 2
        } else if first.is_ascii_digit() {
            rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '.').unwrap_or(rest.len())
        } else if first.is_alphabetic() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else if ["==", "->", "--", "<=", ">=", "=>", ".."].iter().any(|mark| rest.starts_with(mark)) {
            2
        } else {
            first.len_utf8()
        };
        found.push(at..at + length);
        at += length;
    }
    found
}

fn line(text: &str, byte: usize) -> usize {
    text[..byte.min(text.len())].matches('\n').count()
}

#[test]
fn the_examples_are_accepted() {
    for source in examples() {
        let said = diagnostics(&source);
        assert!(said.is_empty(), "{}", render(&said, &[source], false));
    }
}

#[test]
fn the_first_error_lies_where_the_text_was_changed() {
    check_places(17);
}

#[test]
#[ignore = "takes minutes"]
fn the_first_error_lies_where_any_token_was_changed() {
    check_places(1);
}

#[test]
fn a_text_that_breaks_off_is_refused_or_whole_and_never_panics() {
    let mut refused = 0;
    for Source { name, text, .. } in examples() {
        for token in tokens(&text).iter().step_by(5) {
            for end in [token.start, token.end] {
                let source = Source::new(SourceId(0), name.as_str(), &text[..end]);
                let said = diagnostics(&source);
                render(&said, std::slice::from_ref(&source), false);
                refused += usize::from(!said.is_empty());
            }
        }
    }
    assert!(refused > 1_000, "{refused}");
}

/// Changes every n-th token of each text.
fn check_places(every: usize) {
    let replacements = ["", "=", ")", "}", "(", "{", "xyzzy", "42", ",", "->", "$", "\"", "&&", "é"];
    let (mut mutants, mut refused, mut several) = (0, 0, 0);
    let mut misplaced = Vec::new();
    for Source { name, text, .. } in examples() {
        let tokens = tokens(&text);
        for (k, token) in tokens.iter().enumerate().step_by(every) {
            let doubled = format!("{0} {0}", &text[token.clone()]);
            // Each token is dropped and doubled, and replaced by every other of the rest.
            let some = replacements.into_iter().enumerate().filter(|(r, _)| *r == 0 || (r + k) % 2 == 0);
            for replacement in some.map(|(_, replacement)| replacement).chain([doubled.as_str()]) {
                let mutant = format!("{}{replacement}{}", &text[..token.start], &text[token.end..]);
                let source = Source::new(SourceId(0), name.as_str(), mutant);
                let said = diagnostics(&source);
                mutants += 1;
                let Some(error) = said.iter().find(|diagnostic| diagnostic.severity == Severity::Error)
                else {
                    continue;
                };
                refused += 1;
                let place = error.place.as_ref().unwrap().span.start as usize;
                let first = line(&text, token.start);
                let last = tokens.get(k + 1).map_or(line(&text, text.len()), |next| line(&text, next.start));
                let found = line(&source.text, place);
                // At the end of the text the place is right after its last token.
                let at_end = source.text[place..].trim().is_empty()
                    || source.text[place..].trim_start().starts_with("//");
                // Of a brace too many or too few the layout says where it belongs.
                let closes_early = replacement == "}" || matches!(&text[token.clone()], "{" | "}");
                let errors = said.iter().filter(|diagnostic| diagnostic.severity == Severity::Error).count();
                let in_place = (first..=last).contains(&found) || found >= first && closes_early || at_end;
                if errors > 1 {
                    several += 1;
                }
                if !in_place || errors > 2 {
                    misplaced.push(format!(
                        "{name}: `{}` -> `{replacement}` in line {}\n{}",
                        &text[token.clone()],
                        first + 1,
                        render(&said, std::slice::from_ref(&source), false)
                    ));
                }
            }
        }
    }
    assert!(
        misplaced.is_empty(),
        "{} of {mutants}\n{}",
        misplaced.len(),
        misplaced[..misplaced.len().min(300)].join("\n")
    );
    assert!(refused * 2 > mutants, "{refused} of {mutants}");
    // No cascade: one change is one error, but for a few.
    assert!(several * 200 < refused, "{several} of {refused}");
}

const WORDS: [&str; 64] = [
    "property",
    "check",
    "estimate",
    "rank",
    "compare",
    "let",
    "const",
    "param",
    "kind",
    "agent",
    "agents",
    "group",
    "scene",
    "wall",
    "region",
    "process",
    "behaviour",
    "state",
    "source",
    "when",
    "after",
    "on",
    "choose",
    "moves",
    "heading",
    "forall",
    "exists",
    "min",
    "count",
    "F",
    "G",
    "X",
    "U",
    "P(",
    "E(",
    "Q(",
    "in",
    "for",
    "at",
    "with",
    "under",
    "a",
    "s",
    "queue.n",
    "3",
    "0.5 m",
    "1 /s",
    "#4",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "<=",
    "=",
    "==",
    "=>",
    "|",
    "->",
    "--",
    "..",
    ":",
    ";",
];

fn never_panics(text: &str) {
    for name in ["soup.scn", "soup.bltl"] {
        let source = Source::new(SourceId(0), name, text);
        let said = diagnostics(&source);
        for diagnostic in &said {
            let span = diagnostic.place.as_ref().unwrap().span;
            assert!(span.start <= span.end && span.end as usize <= text.len());
            assert!(text.is_char_boundary(span.start as usize) && text.is_char_boundary(span.end as usize));
        }
        let fails = said.iter().any(|diagnostic| diagnostic.severity == Severity::Error);
        let formatted =
            if name.ends_with("scn") { format_scenario(&source) } else { format_properties(&source) };
        assert_eq!(formatted.is_err(), fails);
        render(&said, std::slice::from_ref(&source), false);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn noise_never_panics(text in "\\PC{0,200}") {
        never_panics(&text);
    }

    #[test]
    fn bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        never_panics(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn braces_in_wrong_places_never_panic(
        which in 0_usize..100,
        braces in proptest::collection::vec((0_usize..10_000, 0_u8..4), 1..7),
        flat in any::<bool>(),
    ) {
        let examples = examples();
        let mut text = examples[which % examples.len()].text.clone();
        for (at, what) in braces {
            let tokens = tokens(&text);
            let token = tokens[at % tokens.len()].clone();
            match what {
                0 => text.insert(token.start, '{'),
                1 => text.insert(token.start, '}'),
                2 => text.replace_range(token, "{"),
                _ => {
                    let brace = tokens.iter().filter(|t| ["{", "}"].contains(&&text[t.start..t.end])).nth(at % 5);
                    text.replace_range(brace.cloned().unwrap_or(token), "");
                }
            }
        }
        never_panics(&if flat { text.replace('\n', " ") } else { text });
    }

    #[test]
    fn soup_never_panics(words in proptest::collection::vec(proptest::sample::select(&WORDS[..]), 0..60)) {
        never_panics(&words.join(" "));
    }
}
