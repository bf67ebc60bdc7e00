//! Spellings of other tools: the hint writes them in this language.

use super::*;
use crate::syntax::parse::{parse_properties, parse_scenario};
use crate::syntax::source::{Source, SourceId};

/// Texts around a form.
const AROUND: [&str; 19] = [
    "%",
    "property p = %",
    "property p = % (b)",
    "property p = a % b",
    "property p = forall a in %: b",
    "let p %",
    "% var n = 1 }",
    "process p { var n = 1; %",
    "process p { % }",
    "process p { var n: 0 .. 3 = 0; when n == 0 -> % }",
    "process p { % = 0 }",
    "scene { % }",
    "scene { region r: % }",
    "scene { wall % }",
    "agent a: k { at % }",
    "agent a: k { at = % }",
    "agent a: k { % }",
    "horizon = 3 s\n%\nstep = 1 s",
    "property p = a\n%\nproperty q = b",
];

fn said(file: In, text: &str) -> Vec<Diagnostic> {
    let source = Source::new(SourceId(0), "a", text);
    if file == Properties { parse_properties(&source).1 } else { parse_scenario(&source).1 }
}

#[test]
fn each_form_is_told_and_what_is_to_be_written_can_be_read() {
    let example = |text: &str, quoted: &str| {
        let mut parts = text.split('$');
        let first = parts.next().unwrap_or("").to_owned();
        let filled = parts.map(|part| {
            let text = match part.as_bytes()[0] {
                b'n' => "3",
                b't' => "3 s",
                b'q' => quoted,
                b'r' => ">=",
                b'o' => "F",
                b'p' => "0.5",
                b'y' => "double",
                b'c' => "b > 2",
                b'u' => "n = 1",
                b'l' => "words",
                b'e' => "b",
                _ => "a",
            };
            let rest = part.trim_start_matches(|c: char| c.is_ascii_alphanumeric());
            format!("{text}{rest}")
        });
        filled.fold(first, |filled, part| filled + &part)
    };
    let is_right = |row: &Row| {
        let (pattern, ours) = (example(&row.2.replace("@ ", ""), "\"a\""), example(row.3, "a"));
        let hint = ours.strip_prefix(' ').map_or_else(|| format!("write `{ours}`"), str::to_owned);
        let is_whole = !ours.contains('…') && !ours.starts_with(' ');
        let files = [Properties, Scenario].into_iter().filter(|file| row.0 == Both || row.0 == *file);
        files.flat_map(|file| AROUND.map(|around| (file, around))).any(|(file, around)| {
            let errors = said(file, &around.replace('%', &pattern));
            let right = said(file, &around.replace('%', &ours));
            errors.iter().any(|error| error.hint.as_ref() == Some(&hint)) && (!is_whole || right.is_empty())
        })
    };
    let wrong: Vec<&str> = FORMS.iter().filter(|row| !is_right(row)).map(|row| row.2).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
