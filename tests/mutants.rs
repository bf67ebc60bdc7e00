//! Mutated examples through the whole front end: tokens dropped, doubled, swapped, replaced. Nothing panics, and
//! what is refused is refused with a place inside the text.

use crate::texts::Front;
use proptest::prelude::*;
use smc::compile::{Files, Request};
use smc::syntax::render::render;

macro_rules! pair {
    ($name:literal) => {
        (
            include_str!(concat!("../models/", $name, ".scn")),
            include_str!(concat!("../properties/", $name, ".bltl")),
        )
    };
}

/// Pairs of scenario and properties; the recording of the hotel is not read, so that its names stay unknown.
const PAIRS: [(&str, &str); 32] = [
    pair!("building"),
    pair!("corner"),
    pair!("corridor"),
    pair!("crowds"),
    pair!("detour"),
    pair!("die"),
    pair!("distracted"),
    pair!("door"),
    pair!("epidemic"),
    pair!("exits"),
    pair!("floor"),
    pair!("hall"),
    pair!("hotel"),
    pair!("hotel-any"),
    pair!("hotel-groups"),
    pair!("hotel-laws"),
    pair!("hotel-people"),
    pair!("leader"),
    pair!("overflow"),
    pair!("queue"),
    pair!("ring"),
    pair!("robot"),
    pair!("sensors"),
    pair!("square"),
    pair!("station"),
    pair!("storeys"),
    pair!("table1"),
    pair!("tandem"),
    pair!("plaza"),
    pair!("ward"),
    pair!("workplace"),
    (include_str!("refused/base.scn"), include_str!("../properties/corridor.bltl")),
];

/// Pieces of a text: words, numbers, single marks and what is between them.
fn pieces(text: &str) -> Vec<&str> {
    let kind = |c: char| if c.is_alphanumeric() || c == '_' || c == '.' { 0 } else { 1 + c as u32 };
    let mut found = Vec::new();
    let mut start = 0;
    let mut last = None;
    for (at, c) in text.char_indices() {
        let now = kind(c);
        if last.is_some_and(|l| l != now || now != 0) {
            found.push(&text[start..at]);
            start = at;
        }
        last = Some(now);
    }
    found.push(&text[start..]);
    found
}

const SPARE: [&str; 24] = [
    "0",
    "-1",
    "1e300",
    "3 m",
    "user",
    "hall",
    "crowd",
    "adult",
    "(",
    ")",
    "{",
    "}",
    "F<=2 s ",
    "G ",
    "X ",
    "min",
    "for a in",
    "normal(1, 2)",
    "steps",
    "contact(user)",
    "=",
    "<=",
    "..",
    "at end",
];

#[derive(Clone, Debug)]
enum Change {
    Drop,
    Double,
    Swap(usize),
    Replace(usize),
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        Just(Change::Drop),
        Just(Change::Double),
        (1usize..40).prop_map(Change::Swap),
        (0..SPARE.len()).prop_map(Change::Replace),
    ]
}

fn mutated(text: &str, changes: &[(usize, Change)]) -> String {
    let mut pieces = pieces(text);
    for (at, change) in changes {
        let solid: Vec<usize> = (0..pieces.len()).filter(|i| !pieces[*i].trim().is_empty()).collect();
        if solid.is_empty() {
            break;
        }
        let at = solid[at % solid.len()];
        match change {
            Change::Drop => {
                pieces.remove(at);
            }
            Change::Double => pieces.insert(at, pieces[at]),
            Change::Swap(by) => {
                let other = (at + by) % pieces.len();
                pieces.swap(at, other);
            }
            Change::Replace(with) => pieces[at] = SPARE[*with],
        }
    }
    pieces.concat()
}

/// Everything from two texts to a study or to rendered errors.
fn front_end(scenario: &str, properties: &str) -> Result<(), TestCaseError> {
    let left_out = |requests: Vec<Request>| {
        let mut files = Files::default();
        for request in requests {
            files.provide(request.path, Err("left out".to_owned()));
        }
        files
    };
    let Front { sources, misread, found, study, .. } = Front::of(scenario, properties, left_out);
    let is_error =
        |d: &smc::syntax::diagnostic::Diagnostic| d.severity == smc::syntax::diagnostic::Severity::Error;
    let refused = found.iter().any(is_error);
    let (is_whole, is_misread) = (study.is_some(), misread.iter().any(is_error));
    prop_assert!(is_whole != refused || !is_whole && is_misread, "a study, or a reason why not");
    let said = [misread, found].concat();
    for label in said.iter().flat_map(|d| d.place.iter().chain(&d.related)) {
        let text = &sources[label.span.source.0 as usize].text;
        let (start, end) = (label.span.start as usize, label.span.end as usize);
        prop_assert!(start <= end && end <= text.len());
        prop_assert!(text.is_char_boundary(start) && text.is_char_boundary(end));
    }
    render(&said, &sources, false);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutants_never_panic(
        pair in 0..PAIRS.len(),
        which in any::<bool>(),
        changes in proptest::collection::vec((0usize..2000, change()), 1..4),
    ) {
        let (scenario, properties) = PAIRS[pair];
        if which {
            front_end(&mutated(scenario, &changes), properties)?;
        } else {
            front_end(scenario, &mutated(properties, &changes))?;
        }
    }
}

#[test]
fn every_model_has_its_mutants() {
    let models = std::fs::read_dir("models").unwrap().map(|entry| entry.unwrap().path());
    let count = models.filter(|path| path.extension().is_some_and(|end| end == "scn")).count();
    assert_eq!(PAIRS.len(), count + 1);
}

#[test]
fn examples_survive_being_cut_to_pieces_and_joined() {
    for (scenario, properties) in PAIRS {
        assert_eq!(pieces(scenario).concat(), scenario);
        assert_eq!(mutated(properties, &[]), properties);
        assert!(front_end(scenario, properties).is_ok());
    }
}
