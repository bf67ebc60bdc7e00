//! Planted errors: each file of `planted/` and what is said about it.

use crate::texts::Front;
use smc::syntax::diagnostic::Diagnostic;
use smc::syntax::parse::{decode, parse_properties, parse_scenario, parse_value};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};

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
fn bytes_that_are_no_text() {
    let error = decode(SourceId(0), "a.scn", b"horizon = 30 s\n// Gr\xfc\xdfe\n").unwrap_err();
    assert_eq!((error.code.name(), error.place.as_ref().unwrap().span.start), ("E0107", 20));
    assert!(error.title.contains("a.scn:2:6"), "{}", error.title);
    let error = decode(SourceId(0), "a.scn", b"\xff\xfeh\0o\0").unwrap_err();
    assert!(error.hint.unwrap().contains("UTF-16"));
    assert_eq!(decode(SourceId(0), "a.scn", b" \n\t").unwrap_err().code.name(), "E0108");
    assert_eq!(decode(SourceId(0), "a.scn", b"").unwrap_err().code.name(), "E0108");
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

/// The number of errors in two texts, one of them a scenario.
fn told(scenario: &str, properties: &str) -> usize {
    let front = Front::plain(scenario, properties);
    let said = [front.misread, front.own].concat();
    render(&said, &front.sources, false);
    said.len()
}

#[test]
fn thousands_of_errors_are_all_reported() {
    const CLOCK: &str = "horizon = 10 s\nprocess p { var n: 0 .. 5 = 0; when n < 5 at 1 /s -> n = n + 1 }\n";
    type Write = Box<dyn Fn(usize) -> String>;
    type Case = (Write, fn(usize) -> usize);
    let parts = |before: &'static str, part: fn(usize) -> String, after: &'static str| -> Write {
        Box::new(move |count| format!("{before}{}{after}", (0..count).map(part).collect::<String>()))
    };
    let scenarios: [Case; 14] = [
        (parts(CLOCK, |k| format!("const a{k} = 1 )\n"), ""), |n| n),
        (parts(CLOCK, |k| format!("}}\nconst a{k} = 1\n"), ""), |n| n),
        (parts("agent a: b { ", |_| "x = 1; ".to_owned(), "}\n"), |n| n + 2),
        (
            parts(
                "scene { ",
                |_| "wall a: (1, 2) -- (1 2); wall b: (1, 2) -- (1, 2); ".to_owned(),
                "}\nhorizon = 1 s\nstep = 1 s\n",
            ),
            // What could not be read hides neither that the walls between have no length, nor that they are of one name.
            |n| 3 * n - 1,
        ),
        (
            parts(
                "scene {\n",
                |k| format!("obstacle a{k}: circel (1, 2) radius 1 m; "),
                "\n}\nhorizon = 1 s\nstep = 1 s\n",
            ),
            |n| n,
        ),
        (parts("const a = \"", |_| "\\\"".to_owned(), "\n"), |_| 1),
        (parts("const a = \"", |_| " } {".to_owned(), "x\n"), |_| 1),
        // The rest is one line each.
        (parts(CLOCK, |k| format!("const a{k} = 1 ]; const b{k} = 1;"), "\n"), |n| n),
        (
            parts(
                "horizon = 1 s\nstep = 1 s\nbehaviour b { state s { ",
                |k| format!("after 2 s x{k}; when true -> s;"),
                "} }\n",
            ),
            |n| n,
        ),
        (parts(CLOCK, |k| format!("let a{k} = F<=2 s (3 > 2);"), "\n"), |n| n),
        (parts(CLOCK, |k| format!("a{k} = 30 s = 2 s;"), "\n"), |n| n),
        (parts("process q { ", |_| "when true -> n = 2 m = 3;".to_owned(), "}\nhorizon = #9\n"), |n| n),
        (parts(CLOCK, |_| "const a = 1\n".to_owned(), ""), |n| n - 1),
        (parts(CLOCK, |_| "const a = 1;".to_owned(), "\n"), |n| n - 1),
    ];
    let properties: [Case; 2] = [
        (
            parts("property a = F<=1 s (p.n == 3)\n", |_| "check P(a) >= 0.5 with n = 3; ".to_owned(), ""),
            |n| n,
        ),
        (parts("", |k| format!("property a{k} = 0 < 1 < p.n; "), ""), |n| n),
    ];
    let both = scenarios.into_iter().map(|case| (true, case)).chain(properties.map(|case| (false, case)));
    for (of_scenario, (write, errors)) in both {
        for count in [1, 4_000] {
            let text = write(count);
            let said = if of_scenario { told(&text, "let fine = 1\n") } else { told(CLOCK, &text) };
            assert_eq!(said, errors(count), "{}", &text[..40]);
        }
    }
}
