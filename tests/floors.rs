//! The order of floors: a module uses only floors below its own, and modules on one floor do not use
//! each other. `ARCHITECTURE.md` has the picture; here every path that starts at the crate is read,
//! and every one that climbs up to it by `super::`.

use std::path::{Path, PathBuf};

/// The floors, from the ground.
const FLOORS: [&[&str]; 11] = [
    &["base"],
    &["syntax", "model", "logic", "stats", "data"],
    &["compile", "kernel"],
    &["route", "perception", "trials"],
    &["gait"],
    &["engine"],
    &["advise"],
    &["replay"],
    &["report"],
    &["library"],
    &["cli"],
];

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|modules| modules.contains(&module))
}

/// A line without its comment: `//` within a word, as in an address, begins none.
fn bare(line: &str) -> &str {
    let begins = |at: &usize| line[..*at].chars().next_back().is_none_or(char::is_whitespace);
    line.match_indices("//").map(|(at, _)| at).find(begins).map_or(line, |at| &line[..at]).trim_end()
}

/// A source without comments, in which paths that climb up to the crate begin with `crate::`. `depth` is how many
/// `super::` lead from the file to the crate; inline modules are one deeper, and end with a brace below their start.
fn rooted(text: &str, depth: usize) -> String {
    let mut inline: Vec<String> = Vec::new();
    let mut code = String::new();
    for line in text.lines().map(bare) {
        if inline.last().is_some_and(|open| line.strip_prefix(open.as_str()) == Some("}")) {
            inline.pop();
        }
        code += &line.replace(&"super::".repeat(depth + inline.len()), "crate::");
        code.push('\n');
        if line.ends_with('{') && line.split_whitespace().rev().nth(2) == Some("mod") {
            inline.push(line[..line.len() - line.trim_start().len()].to_owned());
        }
    }
    code
}

/// The modules that a rooted source names after `crate::`, with their lines. A list in braces counts whole.
fn used(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices("crate::") {
        let line = text[..at].matches('\n').count() + 1;
        let rest = &text[at + "crate::".len()..];
        let name = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
        if let Some(list) = rest.strip_prefix('{') {
            let (mut depth, mut start) = (1, true);
            for (i, c) in list.char_indices() {
                match c {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    ',' if depth == 1 => start = true,
                    c if c.is_whitespace() => {}
                    _ if depth == 1 && start => {
                        found.push((line, name(&list[i..])));
                        start = false;
                    }
                    _ => {}
                }
                if depth == 0 {
                    break;
                }
            }
        } else {
            found.push((line, name(rest)));
        }
    }
    found
}

/// What is wrong with the arrows of one file of a module.
fn wrong(module: &str, text: &str) -> Vec<String> {
    let Some(own) = floor(module) else { return vec![format!("`{module}` stands on no floor")] };
    used(text)
        .into_iter()
        .filter(|(_, other)| other != module)
        .filter_map(|(line, other)| match floor(&other) {
            None => Some(format!("{line}: `{other}` stands on no floor")),
            Some(floor) if floor > own => Some(format!("{line}: `{module}` looks up to `{other}`")),
            Some(floor) if floor == own => Some(format!("{line}: `{module}` knows its neighbour `{other}`")),
            Some(_) => None,
        })
        .collect()
}

fn sources(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_module_uses_floors_below_its_own() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    assert!(files.len() > 100, "the sources are found");
    let mut faults = Vec::new();
    let mut arrows = 0;
    for path in files {
        let relative = path.strip_prefix(&root).unwrap();
        let first = relative.components().next().unwrap().as_os_str().to_str().unwrap();
        let module = first.strip_suffix(".rs").unwrap_or(first);
        // The roots name everything.
        if matches!(module, "lib" | "main" | "core") {
            continue;
        }
        let depth = relative.components().count() - usize::from(relative.ends_with("mod.rs"));
        let text = rooted(&std::fs::read_to_string(&path).unwrap(), depth);
        arrows += used(&text).len();
        faults.extend(wrong(module, &text).into_iter().map(|w| format!("{}:{w}", relative.display())));
    }
    assert!(arrows > 300, "the arrows are found: {arrows}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn wrong_arrows_are_seen() {
    let fine = "use crate::base::tick::Tick;\nuse crate::model::Law;\n// crate::cli is a comment\n";
    assert_eq!(wrong("kernel", &rooted(fine, 2)), Vec::<String>::new());
    assert_eq!(wrong("model", "\nuse crate::kernel::State;"), ["2: `model` looks up to `kernel`"]);
    assert_eq!(wrong("stats", "use crate::logic::Node;"), ["1: `stats` knows its neighbour `logic`"]);
    assert_eq!(
        wrong("logic", "fn f(x: crate::stats::Counts) {}"),
        ["1: `logic` knows its neighbour `stats`"]
    );
    assert_eq!(
        wrong("kernel", "use crate::{base::math, compile::{Study, Files}, engine};").len(),
        2,
        "a list counts whole"
    );
    assert_eq!(wrong("base", "use crate::helpers::x;"), ["1: `helpers` stands on no floor"]);
    assert_eq!(wrong("utils", ""), ["`utils` stands on no floor"]);
    assert_eq!(wrong("model", "use crate::model::Law;"), Vec::<String>::new());
}

#[test]
fn paths_that_climb_up_to_the_crate_are_read() {
    let text = "use super::super::kernel::State;\nlet a = \"http://x\"; super::super::cli::run(); // super::super::engine
mod tests {
    use super::super::forces::pull;
    use super::super::super::{engine, base};
}
use super::super::report::Format;
";
    let lines = used(&rooted(text, 2));
    let found: Vec<_> = lines.iter().map(|(line, module)| (*line, module.as_str())).collect();
    assert_eq!(found, [(1, "kernel"), (2, "cli"), (5, "engine"), (5, "base"), (7, "report")]);
    assert_eq!(wrong("model", &rooted("use super::kernel::State;", 1)), ["1: `model` looks up to `kernel`"]);
}
