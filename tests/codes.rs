//! Codes of errors and warnings: each one that the sources use has a page, each page belongs to a code in use,
//! and `smc explain` prints it.

#![allow(clippy::disallowed_methods, reason = "a test reads the sources and calls the program")]

use smc::syntax::codes::{page, pages};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Quoted codes of a text.
fn codes(text: &str) -> Vec<String> {
    text.split('"')
        .filter(|word| {
            word.len() == 5 && word.starts_with(['E', 'W']) && word[1..].bytes().all(|b| b.is_ascii_digit())
        })
        .map(str::to_owned)
        .collect()
}

/// All codes in the sources, with the first file that uses each; pages and tests do not count.
fn in_use(directory: &Path, found: &mut BTreeMap<String, String>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            // The constants of the parser stand beside their pages.
            if !path.ends_with("codes") {
                in_use(&path, found);
            }
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap();
            for code in codes(code) {
                found.entry(code).or_insert_with(|| path.display().to_string());
            }
        }
    }
}

#[test]
fn every_code_has_a_page_and_every_page_a_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut used = BTreeMap::new();
    in_use(&root, &mut used);
    // The parser names its codes: the constants that it uses.
    let syntax = std::fs::read_to_string(root.join("syntax/codes/syntax.rs")).unwrap();
    let mut parser = String::new();
    for entry in std::fs::read_dir(root.join("syntax/parse")).unwrap() {
        parser += &std::fs::read_to_string(entry.unwrap().path()).unwrap();
    }
    for line in syntax.lines().filter(|l| l.contains("const ") && l.contains(": &str")) {
        let name = line.split("const ").nth(1).unwrap().split(':').next().unwrap();
        let word = |text: &str| {
            text.match_indices(name).any(|(at, _)| {
                let inside = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
                !inside(text[..at].chars().next_back()) && !inside(text[at + name.len()..].chars().next())
            })
        };
        if word(&parser) {
            used.insert(codes(line).remove(0), format!("the parser, as {name}"));
        }
    }
    assert!(used.len() > 50, "the codes are found: {}", used.len());
    let bare: Vec<_> = used.iter().filter(|(code, _)| page(code).is_none()).collect();
    assert!(bare.is_empty(), "codes without a page: {bare:?}");
    let idle: Vec<_> = pages().map(|p| p.code).filter(|code| !used.contains_key(*code)).collect();
    assert!(idle.is_empty(), "pages that no error leads to: {idle:?}");
}

#[test]
fn every_page_has_a_wrong_and_a_right_example() {
    for page in pages() {
        let has = |words: [&str; 2]| words.iter().any(|w| page.text.contains(w));
        assert!(has(["Wrong:\n", "Probably wrong:\n"]), "{}", page.code);
        assert!(has(["Right:\n", "Clear:\n"]), "{}", page.code);
        assert!(!page.title.ends_with('.'), "{}", page.code);
        assert!(page.text.lines().all(|line| line.chars().count() <= 130), "{} is too wide", page.code);
    }
}

#[test]
fn explain_prints_the_page() {
    let explain =
        |code: &str| Command::new(env!("CARGO_BIN_EXE_smc")).args(["explain", code]).output().unwrap();
    for page in pages() {
        let output = explain(page.code);
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(0));
        assert!(text.starts_with(&format!("{}: {}\n", page.code, page.title)), "{text}");
        assert!(text.contains(page.text.trim_end()), "{text}");
    }
    assert_eq!(explain("e0303").status.code(), Some(0), "lower case is the same");
    let output = explain("E0333");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("E0303"), "the nearest code is named");
}
