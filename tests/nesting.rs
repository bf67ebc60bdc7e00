//! Depth: 200 levels of everything that nests are read, and what is too deep is refused with one error.

use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::print::format_properties;
use smc::syntax::source::{Source, SourceId};

fn nested(depth: usize, before: &str, after: &str) -> Source {
    let text = format!("property p = {}q{}\n", before.repeat(depth), after.repeat(depth));
    Source::new(SourceId(0), "deep.bltl", text)
}

/// What opens and closes a level, and whether a level is a bracket or prefix.
const LEVELS: [(&str, &str); 20] = [
    ("(", ")"),
    ("!(", ")"),
    ("!", ""),
    ("-", ""),
    ("¬", ""),
    ("F ", ""),
    ("G<=2 s ", ""),
    ("X (", ")"),
    ("F[0 s, 2 s] (", ")"),
    ("F<=(", ") r"),
    ("G[0 s, ", "] r"),
    ("forall a in s(b): ", ""),
    ("forall a in s(", "): r"),
    ("count(a in c: ", ")"),
    ("count(a in c(", "): r)"),
    ("min(", " for a in c)"),
    ("f(", ", 1)"),
    ("min<=2 s (", ")"),
    ("min[1 s, ", "] r"),
    ("(1, ", ") m"),
];

/// A parser that tries a level twice takes 2^200 times as long: such a test would never end.
#[test]
fn two_hundred_levels_of_everything_are_read() {
    for (before, after) in LEVELS {
        let before = before.replace("- ", "-");
        let separated = if before == "-" { "- ".to_owned() } else { before };
        let depth = if after.is_empty() || separated.matches(['(', '[']).count() < 2 { 200 } else { 120 };
        let (file, said) = parse_properties(&nested(depth, &separated, after));
        assert!(said.is_empty() && file.items.len() == 1, "{separated}: {said:?}");
        // The same with a slip in the middle.
        let (_, said) = parse_properties(&nested(depth, &separated, "$"));
        assert!(!said.is_empty(), "{separated}");
    }
}

#[test]
fn the_deepest_trees_fit_a_small_stack() {
    std::thread::Builder::new()
        // Code that is not optimised has larger frames.
        .stack_size(if cfg!(debug_assertions) { 16 << 20 } else { 2 << 20 })
        .spawn(|| {
            for (before, after) in
                [("(", ")"), ("!", ""), ("F<=2 s (", ")"), ("f(", ")"), ("forall a in c: (", ")")]
            {
                let source = nested(if before.contains(": (") { 255 } else { 256 }, before, after);
                let (file, said) = parse_properties(&source);
                assert!(said.is_empty(), "{said:?}");
                let text = format!("{file:?}{:?}", file.clone() == file);
                assert!(text.len() > 100);
                assert!(format_properties(&source).is_ok());
            }
        })
        .unwrap()
        .join()
        .unwrap();
}

#[test]
fn what_is_too_deep_gives_one_error() {
    for (depth, before, after) in
        [(100_000, "(", ")"), (100_000, "!", ""), (100_000, "F ", ""), (257, "[", "]"), (100_000, "- ", "")]
    {
        let (file, said) = parse_properties(&nested(depth, before, after));
        assert_eq!(said.len(), 1, "{before}");
        assert_eq!(said[0].code.name(), "E0106", "{before}");
        assert!(file.fails);
    }
}

#[test]
fn long_chains_are_refused_before_they_overflow_anything() {
    for operator in [" + ", " & ", " => ", " U "] {
        let text = format!("let x = {}", vec!["a"; 100_000].join(operator));
        let (_, said) = parse_properties(&Source::new(SourceId(0), "long.bltl", text));
        assert_eq!(said.len(), 1);
        assert_eq!(said[0].code.name(), "E0120");
        let text = format!("let x = {}", vec!["a"; 400].join(operator));
        let (_, said) = parse_properties(&Source::new(SourceId(0), "long.bltl", text));
        assert!(said.is_empty());
    }
}

#[test]
fn what_is_too_deep_after_a_slip_on_its_line_is_skipped_or_refused() {
    let deep = format!("const b = {}1{}", "(".repeat(100_000), ")".repeat(100_000));
    let told = move || {
        for before in [
            "\" ",
            "\"\\",
            "\" } ",
            "const a = \"x\\\" ",
            "kind k: sfm { mass = \" } ",
            "$ \"x\" \" ",
            "\"\u{A0}} ",
            "/* \" */ ",
            "{ { { \"x\" } } } ",
            "} ) ] ",
            "' ",
        ] {
            let source = Source::new(SourceId(0), "deep.scn", format!("{before}{deep}\n"));
            for said in [parse_scenario(&source).1, parse_properties(&source).1] {
                assert!(!said.is_empty(), "{before}");
                // Nothing but the limit ends a parse: the stack would end it elsewhere on another machine.
                assert!(said.iter().all(|said| said.title != "unexpected `(`"), "{before}");
            }
        }
    };
    // As large as that of the program: there the grammar gets deeper than what comes after it.
    std::thread::Builder::new().stack_size(256 << 20).spawn(told).unwrap().join().unwrap();
}
