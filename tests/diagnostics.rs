//! Planted errors: each file of `planted/` and what is said about it.

#![allow(clippy::case_sensitive_file_extension_comparisons, reason = "names are given in lower case")]
#![allow(clippy::disallowed_methods, reason = "a test reads its own files")]

use smc::syntax::diagnostic::Diagnostic;
use smc::syntax::parse::{decode, parse_properties, parse_scenario, parse_value};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};
use std::time::{Duration, Instant};

fn diagnostics(source: &Source) -> Vec<Diagnostic> {
    if source.name.ends_with(".scn") { parse_scenario(source).1 } else { parse_properties(source).1 }
}

#[test]
fn planted_errors() {
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::glob!("planted/*", |path| {
            let name = path.file_name().unwrap().to_str().unwrap();
            let source = Source::new(SourceId(0), name, std::fs::read_to_string(path).unwrap());
            let said = diagnostics(&source);
            assert!(!said.is_empty(), "nothing said about {name}");
            let text = format!("{}\n{}", source.text, render(&said, std::slice::from_ref(&source), false));
            insta::assert_snapshot!("diagnostics", text);
        });
    });
}

#[test]
fn every_code_has_a_page() {
    for entry in std::fs::read_dir("tests/planted").unwrap() {
        let path = entry.unwrap().path();
        let source =
            Source::new(SourceId(0), path.to_str().unwrap(), std::fs::read_to_string(&path).unwrap());
        for diagnostic in diagnostics(&source) {
            assert!(smc::syntax::codes::page(diagnostic.code).is_some(), "{}", diagnostic.code);
        }
    }
}

#[test]
fn bytes_that_are_no_text() {
    let error = decode(SourceId(0), "a.scn", b"horizon = 30 s\n// Gr\xfc\xdfe\n").unwrap_err();
    assert_eq!((error.code, error.place.as_ref().unwrap().span.start), ("E0107", 20));
    assert!(error.title.contains("a.scn:2:6"), "{}", error.title);
    let error = decode(SourceId(0), "a.scn", b"\xff\xfeh\0o\0").unwrap_err();
    assert!(error.hint.unwrap().contains("UTF-16"));
    assert_eq!(decode(SourceId(0), "a.scn", b" \n\t").unwrap_err().code, "E0108");
    assert_eq!(decode(SourceId(0), "a.scn", b"").unwrap_err().code, "E0108");
    assert!(decode(SourceId(0), "a.scn", "\u{FEFF}horizon = 3 s".as_bytes()).is_ok());
}

#[test]
fn values() {
    let value = |text: &str| parse_value(&Source::new(SourceId(0), "--set density", text));
    for text in ["0.8", "0.8 /m^2", "-3 m", "1/2", "true", "normal(1 m, 0.1 m)", "(1, 2) m"] {
        assert!(value(text).is_ok(), "{text}");
    }
    for text in ["", "0.8 /m^2 x", "3 +", "(1", "a = 3"] {
        let said = value(text).unwrap_err();
        assert_eq!(said.len(), 1, "{text}: {said:?}");
    }
}

#[test]
fn thousands_of_errors_are_told_in_seconds() {
    let lines = |count: usize, line: &dyn Fn(usize) -> String| (0..count).map(line).collect::<String>();
    let faults = lines(32_000, &|k| format!("const a{k} = 1 )\n"));
    let strays = lines(16_000, &|k| format!("}}\nconst a{k} = 1\n"));
    let fields = format!("agent a: b {{ {}}}\n", "x = 1 ".repeat(100_000));
    let on_a_line =
        format!("scene {{ {}}}\n", "wall a: (1, 2) -- (1 2) wall b: (1, 2) -- (1, 2) ".repeat(4_000));
    let quotes = format!("const a = \"{}\n", "\\\"".repeat(32_000));
    let braces = format!("const a = \"{}x\n", " } {".repeat(100_000));
    for (text, count) in
        [(faults, 32_000), (strays, 16_000), (fields, 0), (on_a_line, 4_000), (quotes, 1), (braces, 1)]
    {
        let source = Source::new(SourceId(0), "many.scn", text);
        let start = Instant::now();
        let said = diagnostics(&source);
        render(&said, std::slice::from_ref(&source), false);
        let took = start.elapsed();
        assert_eq!(said.len(), count, "{}", &source.text[..40]);
        // It is less than two; with work in proportion to the square of the errors it would be ten or more.
        assert!(took < Duration::from_secs(6), "{took:?}: {}", &source.text[..40]);
    }
}
