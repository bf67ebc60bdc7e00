//! Mutations of every token of every example through the whole front end, with the file beside it: one change is one
//! error.

use super::{line, tokens};
use crate::texts::Front;
use smc::compile::{Files, requests};
use smc::syntax::diagnostic::{Diagnostic, Severity};
use smc::syntax::parse::parse_scenario;
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};

/// A scenario, the properties that go with it, and the files it names.
pub(super) struct Pair {
    pub(super) name: String,
    pub(super) texts: [String; 2],
    pub(super) files: Files,
}

pub(super) fn pairs() -> Vec<Pair> {
    let data = std::env::var("SMC_DATA").unwrap_or_else(|_| "../shared/data/eth-biwi".to_owned());
    let mut pairs = Vec::new();
    for entry in std::fs::read_dir("models").unwrap() {
        let path = entry.unwrap().path();
        // Floor plans are beside the models. The five rows of table1 are alike: a slip would count five times. The
        // variants of the hotel are alike, too.
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if path.extension().is_none_or(|end| end != "scn") || name == "table1" || name.starts_with("hotel-") {
            continue;
        }
        let texts = [
            std::fs::read_to_string(&path).unwrap(),
            std::fs::read_to_string(format!("properties/{name}.bltl")).unwrap(),
        ];
        let (tree, _) = parse_scenario(&Source::new(SourceId(0), "a.scn", texts[0].as_str()));
        let mut files = Files::default();
        let mut there = true;
        for request in requests(&tree) {
            let found = std::fs::read(format!("{data}/{}", request.path)).map_err(|e| e.to_string());
            there &= found.is_ok();
            files.provide(request.path, found);
        }
        if there {
            pairs.push(Pair { name, texts, files });
        } else {
            eprintln!("skipped: {name} needs a recording that is not in {data}");
        }
    }
    assert!(pairs.len() >= 11);
    pairs
}

/// The errors in a scenario and its properties.
pub(super) fn errors([scenario, properties]: [&str; 2], files: &Files) -> (Vec<Source>, Vec<Diagnostic>) {
    let front = Front::of(scenario, properties, |_| files.clone());
    let mut said = [front.misread, front.own].concat();
    said.retain(|one| one.severity == Severity::Error);
    (front.sources, said)
}

#[test]
fn one_change_is_one_error() {
    check(9);
}

#[test]
#[ignore = "takes minutes"]
fn one_change_of_any_token_is_one_error() {
    check(1);
}

/// Changes every n-th token of each text.
fn check(every: usize) {
    let others = ["=", ")", "}", "{", " xyzzy ", " 42 ", "->"];
    let (mut refused, mut several, mut elsewhere) = (0_u32, Vec::new(), 0_u32);
    for pair in pairs() {
        for (which, text) in pair.texts.iter().enumerate() {
            let tokens = tokens(text);
            for (k, token) in tokens.iter().enumerate().step_by(every) {
                // Each token is dropped, and replaced by some of the others in turn.
                let doubled = format!("{0} {0}", &text[token.clone()]);
                for replacement in ["", others[k % others.len()], others[(k + 3) % others.len()], &doubled] {
                    let mutant = format!("{}{replacement}{}", &text[..token.start], &text[token.end..]);
                    let mut texts = [pair.texts[0].as_str(), pair.texts[1].as_str()];
                    texts[which] = &mutant;
                    let (sources, found) = errors(texts, &pair.files);
                    let Some(first) = found.first() else { continue };
                    refused += 1;
                    let last = tokens.get(k + 1).map_or(text.len(), |next| next.start);
                    let lines = line(text, token.start)..=line(text, last);
                    let place = first.place.as_ref().map(|place| place.span);
                    let near = place.is_some_and(|place| {
                        place.source.0 as usize == which
                            && lines.contains(&line(&mutant, place.start as usize))
                    });
                    elsewhere += u32::from(!near);
                    if found.len() > 1 {
                        several.push(format!(
                            "{}: `{}` -> `{replacement}` in line {}\n{}",
                            pair.name,
                            &text[token.clone()],
                            line(text, token.start) + 1,
                            render(&found, &sources, false)
                        ));
                    }
                }
            }
        }
    }
    assert!(refused as usize * every > 3_000);
    assert!(several.len() as u32 * 250 < refused, "{} of {refused}\n{}", several.len(), several.join("\n"));
    // A name that is declared no more is missed where it is used, a brace where its block ends.
    assert!(elsewhere * 50 < refused, "{elsewhere} of {refused}");
}
